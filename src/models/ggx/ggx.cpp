#include "srbf/models/ggx.h"

#include "base/errors.h"
#include "base/floating_point.h"
#include "brdf/rows.h"
#include "brdf/values.h"
#include "models/ggx/ggx_functions.h"
#include "models/ggx/ggx_kind.h"
#include "srbf/kernel.h"
#include "srbf/model.h"

namespace SRBF_NAMESPACE {
namespace {

using Formula = Kernel<float>;

Formula::GgxLobe kernel_lobe(const GgxModel& model, std::size_t i) {
    if (i >= model.lobes.size()) return {1, {0, 0, 0}, 0};
    const GgxModel::Lobe& lobe = model.lobes[i];
    return {lobe.roughness, {lobe.f0.r, lobe.f0.g, lobe.f0.b}, lobe.f90};
}

std::string number_of_lobes(const GgxModel& model) { return model.lobes.size() == 1 ? "one lobe" : "two lobes"; }

}  // namespace

Rgb value(const GgxModel& model, Vec3f wl, Vec3f wv) {
    Rgb f;
    evaluate(model, {&wl, 1}, {&wv, 1}, {&f, 1});
    return f;
}

void evaluate(const GgxModel& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
    const StandardArithmetic mode;
    require_equal_lengths(wl.size(), wv.size(), f.size());
    const Vec3f diffuse{model.diffuse.r, model.diffuse.g, model.diffuse.b};
    const auto first = kernel_lobe(model, 0), second = kernel_lobe(model, 1);
    for (std::size_t i = 0; i < f.size(); ++i) {
        const Vec3f rho = Formula::ggx_value(diffuse, first, second, wl[i], wv[i]);
        f[i] = above_horizon(wl[i], wv[i]) ? Rgb{rho.x, rho.y, rho.z} : Rgb{};
    }
}

Evaluate evaluator(const GgxModel& model) {
    return [&model](auto wl, auto wv, auto f) { evaluate(model, wl, wv, f); };
}

GgxModel rounded(const GgxModel& model) { return *as_stored(model); }

Result<GgxModel> Kind<GgxModel>::read(Safetensors& content, const std::string& file_name) {
    const auto tensor = content.tensors.find("roughness");
    const auto shape = tensor == content.tensors.end() ? std::vector<std::uint64_t>{1} : tensor->second.shape;
    if (shape.size() != 1 || shape[0] < 1 || shape[0] > k_most_ggx_lobes)
        return input_error(file_name, "tensor 'roughness': shape", fmt::format("[1] or [{}]", k_most_ggx_lobes),
                           shape_text(shape));
    return read_into({{}, std::vector<GgxModel::Lobe>(shape[0])}, content, file_name);
}

std::string Kind<GgxModel>::summary(const GgxModel& model) {
    return fmt::format("ggx, {} and Lambert", number_of_lobes(model));
}

void Kind<GgxModel>::add_rows(std::string& text, const GgxModel& model) {
    add_row(text, "model", "ggx: Lambert and GGX");
    add_row(text, "size", fmt::format("{} of GGX, {} bytes", number_of_lobes(model), payload_bytes(model)));
    add_numbers(text, model, 18);
}

Parameters Kind<GgxModel>::members(const GgxModel& model) {
    return {{"form", std::string("ggx")}, {"lobes", int(model.lobes.size())}, {"variates", 1}, {"axial", true}};
}

std::string Kind<GgxModel>::formula_text(const GgxModel& model, const NumberText& number) {
    const auto colour = [&](const Rgb& rgb, const char* parameter, std::size_t i) {
        const std::string r = number(rgb.r, parameter, 3 * i), g = number(rgb.g, parameter, 3 * i + 1),
                          b = number(rgb.b, parameter, 3 * i + 2);
        return fmt::format("Vec3({}, {}, {})", r, g, b);
    };
    constexpr std::array<const char*, k_most_ggx_lobes> names{"first", "second"};
    std::string text, sum = "Real(2.0 / SRBF_TWO_PI) * " + colour(model.diffuse, "diffuse", 0);
    for (std::size_t i = 0; i < model.lobes.size(); ++i) {
        const GgxModel::Lobe& lobe = model.lobes[i];
        const std::string roughness = number(lobe.roughness, "roughness", i), f0 = colour(lobe.f0, "f0", i),
                          f90 = number(lobe.f90, "f90", i);
        text += fmt::format("    GgxLobe {0};\n    {0}.roughness = {1};\n    {0}.f0 = {2};\n    {0}.f90 = {3};\n",
                            names[i], roughness, f0, f90);
        sum += fmt::format(" + ggx_lobe_value({}, wl, wv)", names[i]);
    }
    return text + "    return " + sum + ";\n";
}

}  // namespace srbf
