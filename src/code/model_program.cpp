#include "code/model_program.h"

#include <fmt/format.h>

#include <algorithm>

#include "code/lanes_code.h"
#include "code/print.h"
#include "generated/code/texts.h"
#include "models/kind/parameters.h"
#include "models/model_files.h"
#include "sampling/elevation_nodes.h"
#include "sampling/mixture.h"
#include "srbf/prepared.h"

namespace SRBF_NAMESPACE {
namespace {

using syntax::Program;
using syntax::Table;

/// Exponents of models are to the base e, exponents of kernel.glsl to the base 2.
constexpr const char* k_log2_e = "1.4426950408889634";
constexpr const char* k_half_log2_e = "0.7213475204444817";

/// The positions of numbers in a lobe's row, and the size of the row.
struct LobeRow {
    std::size_t scale, variates, variate_size, exponents, size;
    LobeRow(const PmModel& model, ParameterStorage storage)
        : scale(storage == ParameterStorage::arguments ? 0 : 3),
          variates(scale + 1),
          variate_size(model.axial ? 1 : 4),
          exponents(variates + variate_size * std::size_t(model.variates)),
          size(exponents + std::size_t(features(model.form))) {}
};
bool any_down(const PmModel& model) {
    return model.axial && std::ranges::any_of(model.centre, [](const Vec3f& centre) { return centre.z < 0; });
}
Table lobes_of(const PmModel& model, ParameterStorage storage) {
    const auto N = std::size_t(model.variates), F = std::size_t(features(model.form));
    std::string variates = model.axial ? "a bandwidth for each variate" : "the centre and bandwidth of each variate";
    if (any_down(model)) variates += ", negative where its centre is -z";
    Table lobes{fmt::format("A row for each lobe: its {}log scale, {}{}.",
                            storage == ParameterStorage::arguments ? "" : "coefficient (R, G, B) and ", variates,
                            F > 0 ? ", exponents" : ""),
                "lobes",
                {},
                LobeRow(model, storage).size};
    for (std::size_t j = 0; j < std::size_t(model.lobes); ++j) {
        for (int c = 0; c < 3 && storage != ParameterStorage::arguments; ++c)
            lobes.add(model.coefficient[j][c], "coefficient", 3 * j + std::size_t(c));
        lobes.add(model.log_scale[j], "log_scale", j);
        for (std::size_t n = j * N; n < (j + 1) * N; ++n) {
            const Vec3f& xi = model.centre[n];
            if (!model.axial) {
                lobes.add(xi.x, "centre", 3 * n);
                lobes.add(xi.y, "centre", 3 * n + 1);
                lobes.add(xi.z, "centre", 3 * n + 2);
            }
            if (model.axial && xi.z < 0)
                lobes.add(-model.bandwidth[n], "-bandwidth", n);
            else
                lobes.add(model.bandwidth[n], "bandwidth", n);
        }
        for (std::size_t k = j * F; k < (j + 1) * F; ++k) lobes.add(model.exponent[k], "exponent", k);
    }
    return lobes;
}

std::string numbers_code(const PmModel& model, ParameterStorage storage, Program& program) {
    const LobeRow row(model, storage);
    Table weights{"The weights a, b of each variate.", "variates", {}, 2};
    for (const auto& [a, b] : model.parameterization)
        for (const float weight : {a, b}) weights.add(weight, "parameterization", weights.numbers.size());
    program.tables = {std::move(weights), lobes_of(model, storage)};

    const auto number = [&](std::size_t offset, const char* index = "") {
        return fmt::format("lobes[{} * j + {}{}]", row.size, offset, index);
    };
    std::string text = fmt::format(
        "int pm_lobes(Pm pm) {{ return {}; }}\n"
        "int pm_variates(Pm pm) {{ return {}; }}\n"
        "int pm_features(Pm pm) {{ return {}; }}\n"
        "bool pm_axial(Pm pm) {{ return {}; }}\n"
        "bool pm_reciprocal(Pm pm) {{ return {}; }}\n"
        "Real pm_weight_l(Pm pm, int n) {{ return variates[2 * n]; }}\n"
        "Real pm_weight_v(Pm pm, int n) {{ return variates[2 * n + 1]; }}\n"
        "Vec3 pm_coefficient(Pm pm, int j) {{ return {}; }}\n"
        "Real pm_log2_scale(Pm pm, int j) {{ return {} * {}; }}\n"
        "Real pm_exponent(Pm pm, int j, int k) {{ return {} * {}; }}\n",
        model.lobes, model.variates, features(model.form), model.axial, is_reciprocal(model.form),
        storage == ParameterStorage::arguments ? "pm.lobe[j]"
                                               : fmt::format("Vec3({}, {}, {})", number(0), number(1), number(2)),
        k_log2_e, number(row.scale), k_log2_e, number(row.exponents, " + k"));
    if (model.axial) {
        const std::string bandwidth = number(row.variates, " + n");
        text += fmt::format(
            "Real pm_log2_falloff(Pm pm, int j, int n) {{ return {} * {}; }}\n"
            "bool pm_down(Pm pm, int j, int n) {{ return {}; }}\n"
            "Vec3 pm_centre(Pm pm, int j, int n) {{ return Vec3(0.0, 0.0, 1.0); }}\n",
            k_half_log2_e, any_down(model) ? "abs(" + bandwidth + ")" : bandwidth,
            any_down(model) ? bandwidth + " < 0.0" : "false");
    } else {
        text += fmt::format(
            "Real pm_log2_falloff(Pm pm, int j, int n) {{ return {} * {}; }}\n"
            "bool pm_down(Pm pm, int j, int n) {{ return false; }}\n"
            "Vec3 pm_centre(Pm pm, int j, int n) {{ return Vec3({}, {}, {}); }}\n",
            k_half_log2_e, number(row.variates + 3, " + 4 * n"), number(row.variates, " + 4 * n"),
            number(row.variates + 1, " + 4 * n"), number(row.variates + 2, " + 4 * n"));
    }
    return text;
}

/// The accessors of a view-by-view model, whose numbers (`shading_data`) the host supplies.
constexpr std::size_t k_view_numbers = 3, k_view_lobe_numbers = 7;
std::string numbers_code(const SuModel& model, Program& program) {
    const std::size_t J = std::size_t(model.lobes), row = k_view_numbers + k_view_lobe_numbers * J;
    program.tables.push_back(
        {fmt::format(
             "number i of the data, float32 in little-endian order; a function or macro of the host. {} rows of {}: "
             "the direction of a view (x, y, z), and for each of its lobes, {}, coefficient (R, G, B), bandwidth, "
             "centre (x, y, z).",
             model.direction.size(), row, J),
         "number",
         {}});
    const auto number = [&](std::size_t offset) {
        return fmt::format("number[{} * view + {} * j + {}]", row, k_view_lobe_numbers, k_view_numbers + offset);
    };
    return fmt::format(
        "struct Su {{ }};\n"
        "struct SuNearest {{ }};\n"
        "int su_nearest(SuNearest nearest, int k) {{ return 0; }}\n"
        "int su_lobes(Su su) {{ return {0}; }}\n"
        "int su_views(Su su) {{ return {1}; }}\n"
        "Vec3 su_direction(Su su, int view) {{ return Vec3(number[{2} * view], number[{2} * view + 1], "
        "number[{2} * view + 2]); }}\n"
        "Vec3 su_coefficient(Su su, int view, int j) {{ return Vec3({3}, {4}, {5}); }}\n"
        "Real su_bandwidth(Su su, int view, int j) {{ return {6}; }}\n"
        "Vec3 su_centre(Su su, int view, int j) {{ return Vec3({7}, {8}, {9}); }}\n",
        J, model.direction.size(), row, number(0), number(1), number(2), number(3), number(4), number(5), number(6));
}

std::string real(float x) { return fmt::format("Real({})", syntax::digits(x)); }
std::string vector(const Rgb& rgb) { return fmt::format("Vec3({}, {}, {})", real(rgb.r), real(rgb.g), real(rgb.b)); }

/// The function `brdf`. `statements` compute the value above the horizon. C recognises a NaN by its bits.
std::string brdf_function(CodeLanguage language, const std::string& statements) {
    return "// The BRDF f_r [1/sr] in linear sRGB, without the cosine: multiply by wl.z and by the irradiance of the "
           "light on a\n"
           "// surface that faces it. wl points to the light and wv to the viewer: unit vectors in the local frame, "
           "whose z is the\n"
           "// shading normal. 0 where one of them is not above the horizon, or has a NaN.\n"
           "Vec3 brdf(Vec3 wl, Vec3 wv, Pm pm) {\n"
           "    if (!(Real(0.0) < wl.z && Real(0.0) < wv.z && " +
           syntax::are_finite(language, {"wl", "wv"}) + "))\n        return Vec3(Real(0.0), Real(0.0), Real(0.0));\n" +
           statements + "}\n";
}
constexpr const char* k_value_pdf_text = R"(
// The BRDF and the density of samples, as multiple importance sampling needs them together.
struct ValuePdf {
    Vec3 value;
    Real pdf;
};
ValuePdf value_pdf(Vec3 wl, Vec3 wv, Pm pm) {
    ValuePdf both;
    both.value = brdf(wl, wv, pm);
    both.pdf = light_pdf(wl, wv);
    return both;
}
)";
std::string brdf_of(const Model& model, CodeLanguage language, ParameterStorage storage, Program& program) {
    if (storage != ParameterStorage::tables)
        return brdf_function(language, formula_text(model, [](float x, auto, auto) { return real(x); }));
    Table numbers{"The numbers of the model.", "model_numbers", {}};
    const std::string statements = formula_text(model, [&](float x, std::string_view parameter, std::size_t index) {
        numbers.add(x, parameter, index);
        return fmt::format("{}[{}]", numbers.name, numbers.numbers.size() - 1);
    });
    if (!numbers.numbers.empty()) program.tables.push_back(std::move(numbers));
    return brdf_function(language, statements);
}

/// Directional albedos at the nodes. They are computed from the model, whose values are the same on every processor,
/// not from the faster functions for renderers.
std::vector<Rgb> node_albedos(const Model& model) {
    const PreparedBrdf brdf = prepare<Model>(model, CosineProposal{});
    std::vector<Rgb> reflected;
    for (int i = 0; i < k_albedo_nodes; ++i) reflected.push_back(albedo_of_node(brdf, albedo_cosine(i)));
    return reflected;
}
/// The function that albedo.glsl requires. It sums over lobes if coefficients are arguments. An unused table is empty.
std::string albedo_node_text(const Model& model, ParameterStorage storage, bool is_used, Program& program) {
    Table nodes{"Directional albedo (R, G, B), a row for each node.", "albedo_nodes", {}, 3};
    if (storage != ParameterStorage::arguments) {
        for (const Rgb& albedo : is_used ? node_albedos(model) : std::vector<Rgb>())
            nodes.numbers.insert(nodes.numbers.end(), {albedo.r, albedo.g, albedo.b});
        program.tables.push_back(std::move(nodes));
        return "Vec3 albedo_node(Pm pm, int i) { return Vec3(albedo_nodes[3 * i], albedo_nodes[3 * i + 1], "
               "albedo_nodes[3 * i + 2]); }\n";
    }
    const auto& lobes = std::get<PmModel>(model.model);
    const auto J = std::size_t(lobes.lobes);
    nodes.comment = "Directional albedo of each lobe with coefficient 1, a row for each node.";
    nodes.columns = J;
    nodes.numbers.resize(is_used ? k_albedo_nodes * J : 0);
    for (std::size_t j = 0; j < J && is_used; ++j) {
        const std::vector<Rgb> albedo = node_albedos(lobe_alone(lobes, j));
        for (std::size_t i = 0; i < albedo.size(); ++i) nodes.numbers[i * J + j] = albedo[i].g;
    }
    program.tables.push_back(std::move(nodes));
    return fmt::format(
        "Vec3 albedo_node(Pm pm, int i) {{\n"
        "    Vec3 sum = Vec3(Real(0.0), Real(0.0), Real(0.0));\n"
        "    for (int j = 0; j < {0}; ++j) sum = sum + albedo_nodes[{0} * i + j] * pm.lobe[j];\n"
        "    return sum;\n}}\n",
        J);
}

/// The mixture that samples of a model follow; without sampling, one that nothing reads.
MixtureProposal mixture_of(const Model& model, const CodeOptions& options) {
    if (!options.sampling) return {};
    return std::get<MixtureProposal>(propose(model, {azimuths_for(is_isotropic(model)), options.threads}));
}

/// The functions and the macro that mixture.glsl requires.
std::string mixture_numbers_text(const MixtureProposal& mixture, const CodeOptions& options, Program& program,
                                 std::map<std::string, std::string>& defines) {
    const bool has_facets = mixture.facets.has_value();
    Table nodes{
        fmt::format("The proposal, a row for each node: weights of lobes{}, stretch and power of half vectors{}.",
                    has_facets ? " and facets" : "", has_facets ? ", the matrices of facets" : ""),
        "mixture_numbers",
        {},
        has_facets ? k_node_numbers : MixtureProposal::k_lobes + k_shape_numbers};
    for (std::size_t node = 0; options.sampling && node < MixtureProposal::k_nodes; ++node) {
        const std::vector<float> numbers = node_numbers(mixture, node, has_facets);
        nodes.numbers.insert(nodes.numbers.end(), numbers.begin(), numbers.end());
    }
    defines["MIXTURE_COMPONENTS"] =
        std::to_string(has_facets ? MixtureProposal::k_components : MixtureProposal::k_lobes);
    const std::size_t columns = nodes.columns;
    program.tables.push_back(std::move(nodes));
    return fmt::format(
        "Real mixture_number(int node, int i) {{ return mixture_numbers[{} * node + i]; }}\n"
        "Vec3 mixture_tangent(Vec3 wv) {{ return {}; }}\n",
        columns, mixture.has_axis() ? vector({mixture.cosine, mixture.sine, 0}) : "wv");
}

std::string coefficients_of(const PmModel& basis) {
    return fmt::format(
        "// The coefficients of a material: R, G, B of each lobe.\n"
        "struct Pm {{ Vec3 lobe[{}]; }};\n",
        basis.lobes);
}
std::string look_up_text(const PmModel& basis) {
    return fmt::format(
        "// The coefficient of lobe j at (u, v), which the host looks up in its textures: R, G, B of layer j.\n"
        "Vec3 layer(int j, Real u, Real v);\n"
        "// The coefficients there.\n"
        "Pm coefficients(Real u, Real v) {{\n"
        "    Pm pm;\n"
        "    for (int j = 0; j < {}; ++j) pm.lobe[j] = layer(j, u, v);\n"
        "    return pm;\n}}\n",
        basis.lobes);
}

/// Declarations that the formulas of a model read, and these formulas. Coefficients that are arguments are in a `Pm`.
struct ModelText {
    std::string brdf, accessors = {}, kernel = {};
    int variates = 1, terms = 1;
    std::string handle = "struct Pm { };\n";
};
ModelText print_model(const Model& model, CodeLanguage language, ParameterStorage storage, Program& program) {
    ModelText text{.brdf = brdf_of(model, language, storage, program)};
    if (const auto* pm = std::get_if<PmModel>(&model.model)) {
        text.accessors = numbers_code(*pm, storage, program);
        text.kernel = k_pm_text;
        text.variates = pm->variates;
        text.terms = std::max(features(pm->form), 1);
        if (storage == ParameterStorage::arguments) {
            text.handle = coefficients_of(*pm);
            text.brdf += look_up_text(*pm);
        }
    } else if (const auto* su = std::get_if<SuModel>(&model.model)) {
        text.accessors = numbers_code(*su, program);
        text.kernel = k_su_text;
    }
    return text;
}

/// Replaces the body of a function by its definition in the printed language.
void set_native(Program& program, std::string_view name, std::string native) {
    syntax::Function& function = *std::ranges::find(program.functions, name, &syntax::Function::name);
    function.body.clear();
    function.native = std::move(native);
}

/// albedo.glsl, in which C recognises a NaN by its bits.
std::string albedo_text(CodeLanguage language) {
    std::string text = k_albedo_text;
    if (language == CodeLanguage::c)
        text.insert(text.find("Real(0.0) < cosine"),
                    syntax::are_finite(language, {"Vec3(cosine, cosine, cosine)"}) + " && ");
    return text;
}

}  // namespace

Program program_of(const Model& model, const CodeOptions& options, const std::vector<std::string>& roots,
                   const AddedCode& added, ParameterStorage storage) {
    Program program;
    const ModelText model_text = print_model(model, options.language, storage, program);
    std::map<std::string, std::string> defines{{"SRBF_MAX_VARIATES", std::to_string(model_text.variates)},
                                               {"SRBF_TERMS", std::to_string(model_text.terms)},
                                               {"MIXTURE_NODES", std::to_string(MixtureProposal::k_nodes)},
                                               {"ALBEDO_NODES", std::to_string(k_albedo_nodes)}};
    const bool has_albedo = options.albedo || added.albedo, needs_mixture = options.sampling || has_albedo;
    const MixtureProposal proposal = mixture_of(model, options);
    std::string mixture_text = needs_mixture ? mixture_numbers_text(proposal, options, program, defines) : "";
    mixture_text += k_mixture_text + std::string(k_value_pdf_text);
    mixture_text +=
        added.albedo_node.empty() ? albedo_node_text(model, storage, has_albedo, program) : added.albedo_node;
    mixture_text += albedo_text(options.language);
    if (added.text) mixture_text += added.text(model, storage == ParameterStorage::arguments, program, defines);
    syntax::parse(model_text.handle + model_text.accessors, program, defines, syntax::FunctionKind::accessor);
    syntax::parse(k_common_text + model_text.kernel + model_text.brdf, program, defines);
    if (needs_mixture) syntax::parse(mixture_text, program, defines);
    if (options.language == CodeLanguage::c && storage == ParameterStorage::constants) {
        if (const auto* pm = std::get_if<PmModel>(&model.model)) set_native(program, "pm_value", value_in_c(*pm));
        if (options.sampling) {
            set_native(program, "sample_light", mixture_in_c(proposal) + k_sample_in_c);
            set_native(program, "light_pdf", k_pdf_in_c);
        }
    }
    syntax::specialise(program, roots);
    if (added.rewrite) added.rewrite(program, roots);
    return program;
}

std::vector<float> shading_data(const SuModel& model) {
    std::vector<float> data;
    const auto J = std::size_t(model.lobes);
    for (std::size_t i = 0; i < model.direction.size(); ++i) {
        const Vec3f w = model.direction[i];
        data.insert(data.end(), {w.x, w.y, w.z});
        for (std::size_t j = i * J; j < (i + 1) * J; ++j) {
            const Rgb& beta = model.coefficient[j];
            const Vec3f xi = model.centre[j];
            data.insert(data.end(), {beta.r, beta.g, beta.b, model.bandwidth[j], xi.x, xi.y, xi.z});
        }
    }
    return data;
}

Rgb albedo_of_node(const PreparedBrdf& brdf, double cosine) { return albedo(brdf, std::max(float(cosine), 1e-30f)); }

}  // namespace
