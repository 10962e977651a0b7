#include "code/lanes_code.h"

#include <fmt/format.h>

#include <span>

#include "code/print.h"
#include "generated/code/texts.h"
#include "sampling/mixture.h"
#include "srbf/kernel.h"
#include "srbf/models/exponent_terms.h"

namespace SRBF_NAMESPACE {
namespace {

/// kernel.glsl reads models by these functions, which runtime_host.h defines.
constexpr const char* k_supplied = R"(
int pm_lobes(Pm pm); int pm_variates(Pm pm); int pm_features(Pm pm); bool pm_axial(Pm pm); bool pm_reciprocal(Pm pm);
bool pm_down(Pm pm, int j, int n); Real pm_weight_l(Pm pm, int n); Real pm_weight_v(Pm pm, int n);
Real pm_log2_scale(Pm pm, int j); Real pm_log2_falloff(Pm pm, int j, int n); Real pm_exponent(Pm pm, int j, int k);
Vec3 pm_coefficient(Pm pm, int j); Vec3 pm_centre(Pm pm, int j, int n); int su_lobes(Su su); int su_views(Su su);
Vec3 su_direction(Su su, int view); Vec3 su_centre(Su su, int view, int j); Real su_bandwidth(Su su, int view, int j);
Vec3 su_coefficient(Su su, int view, int j); int su_nearest(SuNearest nearest, int k);
)";

/// kernel.glsl, preceded by declarations of the functions that the host defines.
struct KernelProgram {
    syntax::Program program;
    std::vector<std::string> supplied;
    KernelProgram() {
        std::map<std::string, std::string> defines{{"SRBF_MAX_VARIATES", std::to_string(k_max_variates)},
                                                   {"SRBF_TERMS", std::to_string(k_terms.size())}};
        syntax::parse(k_supplied, program, defines);
        for (const syntax::Function& function : program.functions) supplied.push_back(function.name);
        const std::string albedo = k_albedo_text;  // only its coordinate is used
        for (const char* text : {k_common_text, k_pm_text, k_su_text}) syntax::parse(text, program, defines);
        syntax::parse(albedo.substr(0, albedo.find("// The integral")), program, defines);
    }
};

/// Numbers of an array in C, eight in a line.
std::string rows_in_c(std::span<const float> numbers) {
    std::string text;
    for (std::size_t i = 0; i < numbers.size(); ++i)
        text += fmt::format("{}{}f{}", i % 8 ? " " : "        ", syntax::digits(numbers[i]), i % 8 < 7 ? "," : ",\n");
    return text;
}

/// The columns of `LobeTable`.
std::string slots_in_c() {
    const LobeTable& table = lobe_table();
    std::vector<float> numbers;
    for (const LobeTable::Row* row : {&table.bandwidth, &table.width, &table.scale, &table.rest, &table.constant,
                                      &table.linear, &table.square, &table.half_bandwidth})
        numbers.insert(numbers.end(), row->begin(), row->end());
    return fmt::format(
        "SRBF_FN const float* srbf_slots(void) {{\n"
        "    static const float numbers[{}] = {{\n{}    }};\n    return numbers;\n}}\n",
        numbers.size(), rows_in_c(numbers));
}

}  // namespace

std::string kernel_in_c(const std::vector<std::string>& functions, CNumbers numbers, std::set<std::string>& known) {
    const bool has_lanes = numbers == CNumbers::vectors;
    const std::string prefix = has_lanes ? "srbf_x_" : "srbf_";
    static const KernelProgram kernel;
    syntax::Program program = kernel.program;
    std::vector<std::string> roots = functions;
    std::map<std::string, std::string> names{
        {"Pm", "srbf_pm"}, {"Su", "srbf_su"}, {"SuNearest", "srbf_su_nearest_views"}};
    roots.insert(roots.end(), kernel.supplied.begin(), kernel.supplied.end());
    for (const std::string& supplied : kernel.supplied) names[supplied] = "srbf_" + supplied;
    syntax::specialise(program, roots);
    for (const auto& structure : program.structures) names[structure.name] = prefix + structure.name;
    for (const auto& function : program.functions) names.try_emplace(function.name, prefix + function.name);
    auto printer = has_lanes ? syntax::Printer::for_lanes(names) : syntax::Printer(CodeLanguage::c, names);
    std::string text;
    const auto add = [&](auto& definition) {
        definition.comment.clear();
        if (known.insert(names.at(definition.name)).second) text += printer.text(definition);
    };
    for (auto& structure : program.structures) add(structure);
    for (auto& function : program.functions)
        if (!function.body.empty()) add(function);
    return text + "\n";
}

std::string lobes_in_c(std::set<std::string>& known) {
    return std::string("#ifndef SRBF_LANES\n") + k_runtime_lanes_text +
           kernel_in_c({"pm_further_features"}, CNumbers::single, known) +
           kernel_in_c({"psi", "axial_psi", "squared_distance", "pm_power", "squared_distance_from_pole"},
                       CNumbers::vectors, known) +
           k_runtime_values_text + "#endif\n\n";
}

std::string mixtures_in_c(std::set<std::string>& known) {
    return std::string("#ifndef SRBF_NODES\n") +
           kernel_in_c({"facets_pdf", "sample_facets", "sample_sharp_vmf", "below_power_cosine", "light_of",
                        "grown_along", "reflected_up", "mixture_position"},
                       CNumbers::single, known) +
           kernel_in_c({"stretch_along", "stretched", "half_vector_lobe", "half_vector", "reflected_pdf"},
                       CNumbers::vectors, known) +
           slots_in_c() + k_runtime_densities_text + "#endif\n\n";
}

std::string value_in_c(const PmModel& model) {
    using K = Kernel<float>;
    const int variates = model.variates, terms = features(model.form), columns = model.axial ? 2 : 4,
              rows = 4 + terms + variates * columns;
    // The weights a and b of up to 16 variates stand before the lobes, each of which has one lane of its rows.
    constexpr int k_lanes = 8, k_max_weights = 16, k_first_lobe = 2 * k_max_weights;
    const int sides = is_reciprocal(model.form) ? 2 : 1;
    std::vector<float> numbers(std::size_t(k_first_lobe + (model.lobes + k_lanes - 1) / k_lanes * k_lanes * rows));
    for (int n = 0; n < sides * variates; ++n) {
        const auto [a, b] = model.parameterization[std::size_t(n % variates)];
        numbers[std::size_t(n)] = n < variates ? a : b;
        numbers[std::size_t(k_max_weights + n)] = n < variates ? b : a;
    }
    for (int j = 0; j < model.lobes; ++j) {
        std::size_t next = std::size_t(k_first_lobe + j / k_lanes * k_lanes * rows + j % k_lanes);
        const auto add = [&](auto... row) {
            for (const float number : {float(row)...}) {
                numbers[next] = number;
                next += k_lanes;
            }
        };
        add(K::pm_log2_scale(model, j));
        for (int c = 0; c < 3; ++c) add(model.coefficient[std::size_t(j)][c]);
        for (int k = 0; k < terms; ++k) add(K::pm_exponent(model, j, k));
        for (int n = 0; n < variates; ++n) {
            const double falloff = -K::pm_log2_falloff(model, j, n);
            const Vec3f xi = K::pm_centre(model, j, n);
            if (model.axial)
                add(xi.z < 0 ? 0 : falloff, xi.z < 0 ? falloff : 0);
            else
                add(falloff, xi.x, xi.y, xi.z);
        }
    }
    return fmt::format(
        "SRBF_FN srbf_vec3 @pm_value@(srbf_vec3 wl, srbf_vec3 wv) {{\n"
        "    static const float numbers[{}] = {{\n{}    }};\n"
        "    const srbf_form form = {{{}, {}, {}, {:d}, {:d}}};\n"
        "    return srbf_lobes_value(form, numbers, wl, wv);\n}}\n",
        numbers.size(), rows_in_c(numbers), model.lobes, variates, terms, model.axial, is_reciprocal(model.form));
}

std::string mixture_in_c(const MixtureProposal& mixture) {
    std::string nodes;
    for (std::size_t node = 0; node < MixtureProposal::k_nodes; ++node) {
        std::vector<float> numbers = node_numbers(mixture, node, true);
        numbers.resize(MixtureProposal::k_components + k_shape_numbers);
        nodes += "        {\n" + rows_in_c(numbers) + "        },\n";
    }
    const FacetTerms facets = mixture.facets.value_or(FacetTerms{});
    const auto list = [](const auto&... numbers) {
        std::string text;
        ((text += (text.empty() ? "{" : ", ") + syntax::digits(numbers) + "f"), ...);
        return text + "}";
    };
    const auto matrix = [&](const Facets& shape) { return list(shape.xx, shape.xy, shape.yy); };
    return fmt::format(
        "SRBF_FN const srbf_mixture* @sample_light@_mixture(void) {{\n"
        "    static const srbf_mixture mixture = {{{}, {}, {{{}, {}}}, {{\n{}    }}}};\n"
        "    return &mixture;\n}}\n",
        list(mixture.cosine, mixture.sine), mixture.facets ? facets.size() : 0, matrix(facets[0]), matrix(facets[1]),
        nodes);
}

const char* const k_sample_in_c =
    R"(SRBF_FN srbf_vec3 @sample_light@(srbf_vec3 wv, float u1, float u2, float selector) {
    srbf_view view;
    if (!srbf_is_finite(wv)) return srbf_vec3_of(0.0f, 0.0f, 0.0f);
    srbf_view_of(&view, @sample_light@_mixture(), wv);
    return srbf_view_sample(&view, u1, u2, selector);
}
)";
const char* const k_pdf_in_c = R"(SRBF_FN float @light_pdf@(srbf_vec3 wl, srbf_vec3 wv) {
    srbf_view view;
    if (!(0.0f < wl.z && 0.0f < wv.z && srbf_is_finite(wl) && srbf_is_finite(wv))) return 0.0f;
    srbf_view_of(&view, @sample_light@_mixture(), wv);
    return srbf_view_pdf(&view, wl, 0);
}
)";

}  // namespace
