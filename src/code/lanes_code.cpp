#include "code/lanes_code.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <span>

#include "code/print.h"
#include "code/texts.h"
#include "srbf/kernel.h"
#include "srbf/models/exponent_terms.h"

namespace SRBF_NAMESPACE {
namespace {

/// kernel.glsl reads models by these functions, which runtime_host.h defines.
constexpr const char* k_supplied = R"(
int pm_lobes(Pm pm);
int pm_variates(Pm pm);
int pm_features(Pm pm);
bool pm_axial(Pm pm);
bool pm_reciprocal(Pm pm);
bool pm_down(Pm pm, int j, int n);
Real pm_weight_l(Pm pm, int n);
Real pm_weight_v(Pm pm, int n);
Real pm_log2_scale(Pm pm, int j);
Real pm_log2_falloff(Pm pm, int j, int n);
Real pm_exponent(Pm pm, int j, int k);
Vec3 pm_coefficient(Pm pm, int j);
Vec3 pm_centre(Pm pm, int j, int n);
int su_lobes(Su su);
int su_views(Su su);
Vec3 su_direction(Su su, int view);
Vec3 su_centre(Su su, int view, int j);
Real su_bandwidth(Su su, int view, int j);
Vec3 su_coefficient(Su su, int view, int j);
Real su_shape(Su su, int view, int j);
int su_nearest(SuNearest nearest, int k);
)";

/// kernel.glsl, preceded by declarations of the functions that the host defines.
struct KernelProgram {
    syntax::Program program;
    std::vector<std::string> supplied;
    KernelProgram() {
        std::map<std::string, std::string> defines{{"SRBF_MAX_VARIATES", std::to_string(k_most_variates)},
                                                   {"SRBF_TERMS", std::to_string(k_terms.size())}};
        syntax::parse(k_supplied, program, defines);
        for (const syntax::Function& function : program.functions) supplied.push_back(function.name);
        const std::string albedo = k_albedo_text;  // of which only the coordinate is used
        for (const char* text : {k_common_text, k_pm_text, k_su_text}) syntax::parse(text, program, defines);
        syntax::parse(albedo.substr(0, albedo.find("// The integral")), program, defines);
    }
};

/// The numbers of a mixture by their slots in runtime_densities.h. Of the kernel's components, 0 and 1 are the cosines.
constexpr std::size_t k_slots = SRBF_FIRST_HALF_VECTOR_LOBE, k_facet_slot = 2 * k_slots, k_slot_numbers = 3 * k_slots;
using SlotNumbers = std::array<float, k_slot_numbers>;
SlotNumbers slots_of(const MixtureProposal& mixture, std::size_t node) {
    SlotNumbers numbers{};
    const MixtureProposal::Row& weight = mixture.weight(node);
    std::copy(weight.begin() + 2, weight.begin() + k_slots, numbers.begin());
    std::copy(weight.begin() + k_slots, weight.end(), numbers.begin() + k_slots);
    const float others[] = {mixture.facet_weight[node][0],
                            mixture.facet_weight[node][1],
                            weight[0],
                            weight[1],
                            mixture.shape[node][0].stretch,
                            mixture.shape[node][0].power,
                            mixture.shape[node][1].stretch,
                            mixture.shape[node][1].power};
    std::ranges::copy(others, numbers.begin() + k_facet_slot);
    return numbers;
}

/// Numbers of an array in C, eight in a line.
std::string rows_in_c(std::span<const float> numbers) {
    std::string text;
    for (std::size_t i = 0; i < numbers.size(); ++i)
        text += fmt::format("{}{}f{}", i % 8 ? " " : "        ", syntax::digits(numbers[i]), i % 8 < 7 ? "," : ",\n");
    return text;
}

/// A row has a number of each of eight slots: bandwidth, width, scale and rest of lobes of directions, then bandwidth of
/// half-vector lobes, and 1 for those with an odd number. Empty slots are 0.
std::string slots_in_c() {
    using K = Kernel<float>;
    std::vector<float> numbers(6 * k_slots);
    for (std::size_t slot = 0; slot < k_slots; ++slot) {
        const auto set = [&](std::size_t row, float number) { numbers[row * k_slots + slot] = number; };
        const int half = int(slot + k_slots);
        set(4, K::proposal_bandwidth(half)), set(5, float(half % 2));
        if (slot + 2 >= k_slots) continue;  // the kernel's first two components are the cosines
        const auto lobe = K::mirror_lobe({0, 0, 1}, K::proposal_bandwidth(int(slot + 2)));
        set(0, lobe.bandwidth), set(1, lobe.width), set(2, lobe.scale), set(3, lobe.rest);
    }
    return fmt::format(
        "SRBF_FN const float* srbf_slots(void) {{\n"
        "    static const float numbers[{}] = {{\n{}    }};\n    return numbers;\n}}\n",
        numbers.size(), rows_in_c(numbers));
}

}  // namespace

std::string kernel_in_c(const std::vector<std::string>& functions, const std::string& prefix, bool has_lanes,
                        std::set<std::string>& known) {
    static const KernelProgram kernel;
    syntax::Program program = kernel.program;
    std::vector<std::string> roots = functions;
    std::map<std::string, std::string> names{
        {"Pm", "srbf_pm"}, {"Su", "srbf_su"}, {"SuNearest", "srbf_su_nearest_views"}};
    for (const std::string& supplied : kernel.supplied) roots.push_back(supplied), names[supplied] = "srbf_" + supplied;
    syntax::specialise(program, roots);
    for (const auto& structure : program.structures) names[structure.name] = prefix + structure.name;
    for (const auto& function : program.functions) names.try_emplace(function.name, prefix + function.name);
    auto printer = has_lanes ? syntax::Printer::of_lanes(names) : syntax::Printer(CodeLanguage::c, names);
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
           kernel_in_c({"pm_further_features"}, "srbf_", false, known) +
           kernel_in_c({"psi", "axial_psi", "squared_distance", "pm_power", "squared_distance_from_pole"}, "srbf_x_",
                       true, known) +
           k_runtime_values_text + "#endif\n\n";
}

std::string mixtures_in_c(std::set<std::string>& known) {
    return std::string("#ifndef SRBF_NODES\n") +
           kernel_in_c({"facets_pdf", "sample_facets", "sample_sharp_vmf", "below_power_cosine", "light_of",
                        "grown_along", "reflected_up", "mixture_position"},
                       "srbf_", false, known) +
           kernel_in_c({"stretch_along", "stretched", "half_vector_lobe", "half_vector", "reflected_pdf"}, "srbf_x_",
                       true, known) +
           slots_in_c() + k_runtime_densities_text + "#endif\n\n";
}

std::string value_in_c(const PmModel& model) {
    const auto lobes = std::size_t(model.lobes), variates = std::size_t(model.variates),
               terms = std::size_t(features(model.form));
    const std::size_t first = 32, columns = model.axial ? 2 : 4, rows = 4 + terms + variates * columns;
    constexpr float log2_e = 1.44269504f;
    std::vector<float> numbers(first + (lobes + 7) / 8 * 8 * rows);
    for (std::size_t n = 0; n < variates; ++n) {
        const auto [a, b] = model.parameterization[n];
        numbers[n] = a, numbers[16 + n] = b;
        if (is_reciprocal(model.form)) numbers[variates + n] = b, numbers[16 + variates + n] = a;
    }
    for (std::size_t j = 0; j < lobes; ++j) {
        float* next = &numbers[first + j / 8 * 8 * rows + j % 8];
        const auto add = [&](float number) { *next = number, next += 8; };
        add(log2_e * model.log_scale[j]);
        for (int c = 0; c < 3; ++c) add(model.coefficient[j][c]);
        for (std::size_t k = 0; k < terms; ++k) add(log2_e * model.exponent[j * terms + k]);
        for (std::size_t i = j * variates; i < (j + 1) * variates; ++i) {
            const float falloff = -0.5f * log2_e * model.bandwidth[i];
            const Vec3f xi = model.centre[i];
            if (model.axial)
                add(xi.z < 0 ? 0 : falloff), add(xi.z < 0 ? falloff : 0);
            else
                add(falloff), add(xi.x), add(xi.y), add(xi.z);
        }
    }
    return fmt::format(
        "SRBF_FN srbf_vec3 @pm_value@(srbf_vec3 wl, srbf_vec3 wv) {{\n"
        "    static const float numbers[{}] = {{\n{}    }};\n"
        "    const srbf_form form = {{{}, {}, {}, {:d}, {:d}}};\n"
        "    return srbf_lobes_value(form, numbers, wl, wv);\n}}\n",
        numbers.size(), rows_in_c(numbers), lobes, variates, terms, model.axial, is_reciprocal(model.form));
}

std::string mixture_in_c(const MixtureProposal& mixture) {
    std::string nodes;
    for (std::size_t node = 0; node < MixtureProposal::k_nodes; ++node)
        nodes += "        {\n" + rows_in_c(slots_of(mixture, node)) + "        },\n";
    const FacetTerms facets = mixture.facets.value_or(FacetTerms{});
    const auto list = [](const auto&... numbers) {
        std::string text;
        ((text += (text.empty() ? "{" : ", ") + syntax::digits(numbers) + "f"), ...);
        return text + "}";
    };
    const auto matrix = [&](const Facets& of) { return list(of.xx, of.xy, of.yy); };
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

}  // namespace srbf
