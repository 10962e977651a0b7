#include "srbf/shader.h"

#include <fmt/format.h>

#include <cassert>
#include <concepts>

#include "base/half.h"
#include "brdf/parts.h"
#include "code/bsdf_code.h"
#include "generated/code/texts.h"
#include "models/kind/parameters.h"
#include "sampling/mixture.h"
#include "srbf/kernel.h"

namespace SRBF_NAMESPACE {
namespace {

/// Vectors of four for the numbers of a node of a mixture.
constexpr int k_node_vectors = (int(k_node_numbers) + 3) / 4;

/// The macros of a material for host.glsl and material.glsl.
std::string macros(const Flat&) { return fmt::format("#define VALUE {:.9f}\n", Flat::k_value); }
std::string macros(const MerlTable& table) {
    const auto [h, d, p] = table.size;
    return fmt::format("#define MERL_SIZE vec3({}.0, {}.0, {}.0)\n", p, d, h);
}
int kernel_texels(const PmModel& model) { return model.axial ? (model.variates + 3) / 4 : model.variates; }
std::string macros(const PmModel& model) {
    std::vector<int> downs(std::size_t(model.lobes));
    for (int j = 0; j < model.lobes; ++j)
        for (int n = 0; n < model.variates; ++n) downs[std::size_t(j)] |= int(Kernel<float>::pm_down(model, j, n)) << n;
    std::string text = fmt::format(
        "#define PM_LOBES {}\n#define PM_VARIATES {}\n#define PM_FEATURES {}\n#define PM_AXIAL {:d}\n"
        "#define PM_RECIPROCAL {:d}\n#define PM_KERNELS {}\n",
        model.lobes, model.variates, features(model.form), model.axial, is_reciprocal(model.form),
        model.lobes * kernel_texels(model));
    if (model.axial) text += fmt::format("#define PM_DOWNS {}\n", fmt::join(downs, ", "));
    return text;
}
std::string macros(const SuModel& model) {
    const DirectionMap map = model.index ? model.index->map : DirectionMap::cube;
    return fmt::format(
        "#define SU_LOBES {}\n#define SU_VIEWS {}\n#define SU_ROTATED {:d}\n#define SU_NEIGHBOURS {}\n"
        "#define SU_CUBE {:d}\n#define SU_OF_LIGHTS {:d}\n",
        model.lobes, model.direction.size(), model.interpolation == SuInterpolation::rotated, model.neighbours,
        map == DirectionMap::cube, model.discretise == Discretise::light);
}

std::string beam_macros(const Beams& beams) {
    return fmt::format("#define HAS_BEAM {:d}\n#define HAS_MIRROR_BEAM {:d}\n", !beams[2].empty() || !beams[3].empty(),
                       !beams[0].empty() || !beams[1].empty());
}
std::string macros(const BsdfModel& model) { return beam_macros(model.beam); }
std::string macros(const BsdfTables& tables) {
    const auto [h, d, p] = size_of(tables);
    return fmt::format("#define MERL_SIZE vec3({}.0, {}.0, {}.0)\n", p, d, h) + beam_macros(tables.beam);
}

/// A model of few numbers, which are a uniform that its formula reads.
template <typename M>
concept OfFewNumbers = !(std::same_as<M, Flat> || std::same_as<M, MerlTable> || std::same_as<M, BsdfTables> ||
                         std::same_as<M, PmModel> || std::same_as<M, SuModel> || std::same_as<M, BsdfModel>);
template <OfFewNumbers M> std::string macros(const M&) { return "#define VALUE model_value(wl, wv)\n"; }

std::string uniform_name(const Model& model) { return fmt::format("{}_numbers", kind(model)); }

/// The text that a material adds to the kernel's text.
const char* kernel_text(const Material& material) {
    if (std::holds_alternative<PmModel>(material)) return k_pm_text;
    return std::holds_alternative<SuModel>(material) ? k_su_text : "";
}
/// The code that precedes material.glsl.
template <typename M> std::string value_code(const M&) { return {}; }
template <OfFewNumbers M> std::string value_code(const M& formula) {
    const Model model{formula, {}};
    std::size_t count = 0;
    const std::string statements = formula_text(model, [&](float, auto, auto) {
        const std::size_t i = count++;
        return fmt::format("{}[{}].{}", uniform_name(model), i / 4, "xyzw"[i % 4]);
    });
    return fmt::format("uniform vec4 {}[{}];\nVec3 model_value(Vec3 wl, Vec3 wv) {{\n{}}}\n", uniform_name(model),
                       (count + 3) / 4, statements);
}
std::string value_code(const BsdfTables& tables) { return beam_code("material", tables.beam, CodeLanguage::glsl); }
std::string value_code(const BsdfModel& bsdf) {
    const Model model{bsdf, {}};
    const auto code = shading_code(std::vector<NamedModel>{{"material", &model}}, "material");
    assert(code.ok());  // only view-by-view models are errors
    return code.ok() ? *code : std::string();
}

}  // namespace

std::string_view name(Dialect dialect) { return dialect == Dialect::gl_450 ? "OpenGL 4.5" : "OpenGL ES 3.0"; }

std::string version_text(Dialect dialect) {
    if (dialect == Dialect::gl_450) return "#version 450 core\n";
    std::string text = "#version 300 es\n";
    for (const char* type : {"float", "int", "sampler2D", "sampler3D", "usampler2D", "usamplerCube"})
        text += fmt::format("precision highp {};\n", type);
    return text;
}

std::string brdf_text(const Material& material) {
    const std::string macro_text = std::visit([](const auto& content) { return macros(content); }, material);
    const std::string code = std::visit([](const auto& content) { return value_code(content); }, material);
    return fmt::format("#define SIDES {}\n", is_two_sided(material) ? 2 : 1) + macro_text + k_host_text +
           k_common_text + kernel_text(material) + code + k_material_text;
}

std::string proposal_text(int parts) {
    return fmt::format(
               "#define MIXTURE_NODES {}\n#define MIXTURE_COMPONENTS {}\n#define MIXTURE_VECTORS {}\n#define "
               "MIXTURE_PARTS {}\n",
               MixtureProposal::k_nodes, MixtureProposal::k_components, k_node_vectors, parts) +
           k_proposal_text + k_mixture_text;
}

Proposals propose_parts(const Evaluate& bsdf, const ProposeOptions& options) {
    std::vector<MixtureProposal> proposals;
    for (std::size_t p = 0; p < k_parts; ++p) proposals.push_back(propose(part_of(bsdf, Part(p)), options));
    return Proposals(std::move(proposals));
}

ProposalNumbers proposal_numbers(const Proposals& proposals) {
    ProposalNumbers packed;
    for (const MixtureProposal& proposal : proposals.by_part) {
        for (std::size_t node = 0; node < MixtureProposal::k_nodes; ++node) {
            const std::vector<float> numbers = node_numbers(proposal, node, true);
            packed.nodes.insert(packed.nodes.end(), numbers.begin(), numbers.end());
            packed.nodes.resize(packed.nodes.size() + std::size_t(4 * k_node_vectors) - numbers.size());
        }
        packed.grains.push_back({proposal.cosine, proposal.sine});
    }
    return packed;
}

namespace {

template <typename M> Uniform uniform_of(const M&) { return {}; }
template <OfFewNumbers M> Uniform uniform_of(const M& formula) {
    const Model model{formula, {}};
    Uniform uniform{uniform_name(model), {}};
    std::size_t count = 0;
    formula_text(model, [&](float x, auto, auto) {
        if (count % 4 == 0) uniform.numbers.emplace_back();
        uniform.numbers.back()[count++ % 4] = x;
        return std::string();
    });
    return uniform;
}

}  // namespace

Uniform uniform_of(const Material& material) {
    return std::visit([](const auto& content) { return uniform_of(content); }, material);
}

std::vector<Float4> pm_numbers(const PmModel& model) {
    using Formulas = Kernel<float>;
    const int J = model.lobes, N = model.variates, F = features(model.form);
    std::vector<Float4> numbers;
    for (int j = 0; j < J; ++j) {
        const Vec3f beta = Formulas::pm_coefficient(model, j);
        numbers.push_back({beta.x, beta.y, beta.z, float(Formulas::pm_log2_scale(model, j))});
    }
    for (int j = 0; j < J; ++j)
        for (int k = 0; k < F; ++k) {
            if (k % 4 == 0) numbers.emplace_back();
            numbers.back()[std::size_t(k % 4)] = float(Formulas::pm_exponent(model, j, k));
        }
    for (int j = 0; j < J; ++j)
        for (int n = 0; n < N; ++n) {
            const float log2_falloff = float(Formulas::pm_log2_falloff(model, j, n));
            const Vec3f centre = Formulas::pm_centre(model, j, n);
            if (!model.axial) {
                numbers.push_back({centre.x, centre.y, centre.z, log2_falloff});
                continue;
            }
            if (n % 4 == 0) numbers.emplace_back();
            numbers.back()[std::size_t(n % 4)] = log2_falloff;
        }
    for (const Parameterization& weights : model.parameterization) numbers.push_back({weights.a, weights.b, 0, 0});
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
            const Vec3f shift = model.centre[j] - mirror(w);
            texels.numbers.push_back({to_half(beta.r), to_half(beta.g), to_half(beta.b), to_half(model.bandwidth[j])});
            texels.numbers.push_back({to_half(shift.x), to_half(shift.y), to_half(shift.z), 0});
        }
    }
    return texels;
}

std::array<std::uint32_t, 3> size_of(const BsdfTables& tables) {
    const auto any = std::ranges::find_if(tables.part, [](const auto& part) { return part != nullptr; });
    return any == tables.part.end() ? std::array<std::uint32_t, 3>{1, 1, 1} : (*any)->size;
}
std::vector<Float4> merl_texels(const BsdfTables& tables) {
    const auto [h, d, p] = size_of(tables);
    std::vector<Float4> texels;
    for (std::size_t part = 0; part < k_parts; ++part) {
        // Light and viewer need not be exchanged, since tables are reciprocal.
        if (const MerlTable* table = part_source(tables.part, Part(part)).brdf) {
            const auto table_texels = merl_texels(*table);
            texels.insert(texels.end(), table_texels.begin(), table_texels.end());
        } else {
            texels.insert(texels.end(), std::size_t(h) * d * p, {0, 0, 0, 1});
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

}  // namespace
