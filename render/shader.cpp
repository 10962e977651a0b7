#include "render/shader.h"

#include <fmt/format.h>

#include <cassert>
#include <cmath>

#include "render/shader_text.h"
#include "srbf/half.h"
#include "srbf/kernel.h"

namespace srbf {
namespace {

std::string version(Dialect dialect) {
    if (dialect == Dialect::gl_450) return "#version 450 core\n";
    std::string text = "#version 300 es\n";
    for (const char* type : {"float", "int", "sampler2D", "sampler3D", "usampler2D", "usamplerCube"})
        text += fmt::format("precision highp {};\n", type);
    return text;
}

/// The shape of a material, as the macros of host.glsl and pixel.glsl.
std::string shape(const Flat&) { return fmt::format("#define FLAT {:.9f}\n", Flat::k_value); }
std::string shape(const MerlTable& table) {
    const auto [h, d, p] = table.size;
    return fmt::format("#define MERL_SIZE vec3({}.0, {}.0, {}.0)\n", p, d, h);
}
int kernel_texels(const PmModel& model) { return model.axial ? (model.variates + 3) / 4 : model.variates; }
std::string shape(const PmModel& model) {
    std::vector<int> downs(std::size_t(model.lobes));
    for (int j = 0; j < model.lobes; ++j)
        for (int n = 0; n < model.variates; ++n) downs[std::size_t(j)] |= int(Kernel<float>::pm_down(model, j, n)) << n;
    std::string text = fmt::format(
        "#define PM_LOBES {}\n#define PM_VARIATES {}\n#define PM_FEATURES {}\n#define PM_AXIAL {:d}\n"
        "#define PM_KERNELS {}\n",
        model.lobes, model.variates, features(model.form), model.axial, model.lobes * kernel_texels(model));
    if (model.axial) text += fmt::format("#define PM_DOWNS {}\n", fmt::join(downs, ", "));
    return text;
}
std::string shape(const SuModel& model) {
    const DirectionMap map = model.index ? model.index->map : DirectionMap::cube;
    return fmt::format(
        "#define SU_LOBES {}\n#define SU_VIEWS {}\n#define SU_ROTATED {:d}\n#define SU_NEIGHBOURS {}\n"
        "#define SU_CUBE {:d}\n#define SU_OF_LIGHTS {:d}\n",
        model.lobes, model.direction.size(), model.interpolation == SuInterpolation::rotated, model.neighbours,
        map == DirectionMap::cube, model.discretise == Discretise::light);
}

std::string shape(const GgxModel&) { return "#define GGX 1\n"; }

}  // namespace

std::string_view name(Dialect dialect) { return dialect == Dialect::gl_450 ? "OpenGL 4.5" : "OpenGL ES 3.0"; }

ShaderText shader_text(const Material& material, const ShaderOptions& options) {
    assert(options.lights >= 1);
    std::string each_light;
    for (int k = 0; k < options.lights; ++k) each_light += fmt::format(" f({})", k);
    const bool deferred = options.input == PixelInput::surface;
    const std::string first = version(options.dialect);
    return {first + (deferred ? k_whole_text : k_surface_text),
            first +
                fmt::format("#define LIGHTS {}\n#define EACH_LIGHT(f){}\n#define DEFERRED {:d}\n#define SHOWN {:d}\n",
                            options.lights, each_light, deferred, options.output == PixelOutput::shown) +
                std::visit([](const auto& of) { return shape(of); }, material) + k_host_text + k_kernel_text +
                k_shading_text + k_pixel_text};
}

ShaderText surface_shader_text(Dialect dialect) {
    return {version(dialect) + k_surface_text, version(dialect) + k_surface_pixel_text};
}

std::array<Float4, 4> ggx_numbers(const GgxModel& model) {
    std::array<Float4, 4> numbers{
        {{model.diffuse.r, model.diffuse.g, model.diffuse.b, 0}, {0, 0, 0, 1}, {0, 0, 0, 1}, {}}};
    for (std::size_t i = 0; i < model.lobes.size(); ++i) {
        const GgxModel::Lobe& lobe = model.lobes[i];
        numbers[1 + i] = {lobe.facing.r, lobe.facing.g, lobe.facing.b, lobe.roughness};
        numbers[3 * i][3] = lobe.grazing;
    }
    return numbers;
}

std::vector<Float4> pm_numbers(const PmModel& model) {
    using Formulas = Kernel<float>;
    const int J = model.lobes, N = model.variates, F = features(model.form);
    std::vector<Float4> numbers;
    for (int j = 0; j < J; ++j) {
        const Vec3f beta = Formulas::pm_coefficient(model, j);
        numbers.push_back({beta.x, beta.y, beta.z, float(Formulas::pm_log2_scale(model, j))});
    }
    for (int j = 0; F > 0 && j < J; ++j) {
        Float4& exponents = numbers.emplace_back();
        for (int k = 0; k < F; ++k) exponents[std::size_t(k)] = float(Formulas::pm_exponent(model, j, k));
    }
    for (int j = 0; j < J; ++j)
        for (int n = 0; n < N; ++n) {
            const float sharpness = float(Formulas::pm_sharpness(model, j, n));
            const Vec3f centre = Formulas::pm_centre(model, j, n);
            if (!model.axial) {
                numbers.push_back({centre.x, centre.y, centre.z, sharpness});
                continue;
            }
            if (n % 4 == 0) numbers.emplace_back();
            numbers.back()[std::size_t(n % 4)] = sharpness;
        }
    for (const Parameterization& of : model.parameterization) numbers.push_back({of.a, of.b, 0, 0});
    return numbers;
}

SuTexels su_texels(const SuModel& model) {
    const auto J = std::size_t(model.lobes);
    SuTexels texels;
    texels.numbers.reserve(2 * model.centre.size());
    for (std::size_t i = 0; i < model.direction.size(); ++i) {
        const Vec3f w = model.direction[i];
        texels.directions.push_back({w.x, w.y, w.z, 0});
        for (std::size_t j = i * J; j < (i + 1) * J; ++j) {
            const Rgb& beta = model.coefficient[j];
            const Vec3f apart = model.centre[j] - mirror(w);
            texels.numbers.push_back({to_half(beta.r), to_half(beta.g), to_half(beta.b), to_half(model.bandwidth[j])});
            texels.numbers.push_back({to_half(apart.x), to_half(apart.y), to_half(apart.z), 0});
        }
    }
    return texels;
}

std::vector<Float4> merl_texels(const MerlTable& table) {
    std::vector<Float4> texels;
    texels.reserve(table.cells.size());
    for (const Rgb& f : table.cells) texels.push_back(is_finite(f) ? Float4{f.r, f.g, f.b, 1} : Float4{});
    return texels;
}

}  // namespace srbf
