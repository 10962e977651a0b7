// srbf_runtime.h: kernel.glsl in C, twice (of a number, and of vectors), between texts that read files and call it.
#include <fmt/format.h>

#include <ranges>

#include "brdf/colour.h"
#include "code/print.h"
#include "code/texts.h"
#include "models/openpbr/openpbr_parameters.h"
#include "srbf/kernel.h"
#include "srbf/shading_code.h"

namespace srbf {
namespace {

using syntax::Program;

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

const std::vector<std::string> k_functions{"su_rotated_value",
                                           "su_plain_value",
                                           "ggx_value",
                                           "openpbr_value",
                                           "openpbr_anisotropic_value",
                                           "openpbr_roughness",
                                           "alpha_of",
                                           "roughened",
                                           "facets_along",
                                           "facets_pdf",
                                           "sample_facets",
                                           "sample_sharp_vmf",
                                           "below_power_cosine",
                                           "light_of",
                                           "grown_along",
                                           "reflected_up",
                                           "elevation_coordinate",
                                           "pm_further_features"};
const std::vector<std::string> k_functions_of_lanes{
    "psi",           "axial_psi", "squared_distance", "pm_power",    "squared_distance_from_pole",
    "stretch_along", "stretched", "half_vector_lobe", "half_vector", "reflected_pdf"};

/// The definitions that these functions need, printed with this prefix.
std::string printed(const std::vector<std::string>& functions, const std::string& prefix, bool has_lanes) {
    Program program;
    std::map<std::string, std::string> defines{{"SRBF_MAX_VARIATES", std::to_string(k_most_variates)},
                                               {"SRBF_TERMS", std::to_string(k_terms.size())}};
    syntax::parse(k_supplied, program, defines);
    std::vector<std::string> roots = functions;
    std::map<std::string, std::string> names{
        {"Pm", "srbf_pm"}, {"Su", "srbf_su"}, {"SuNearest", "srbf_su_nearest_views"}};
    for (const syntax::Function& supplied : program.functions)
        roots.push_back(supplied.name), names[supplied.name] = "srbf_" + supplied.name;
    std::string albedo = k_albedo_text;  // of which only the coordinate is used
    syntax::parse(k_kernel_text, program, defines);
    syntax::parse(albedo.substr(0, albedo.find("// The integral")), program, defines);
    syntax::specialise(program, roots);
    for (const auto& structure : program.structures) names[structure.name] = prefix + structure.name;
    for (const auto& function : program.functions) names.try_emplace(function.name, prefix + function.name);
    auto printer = has_lanes ? syntax::Printer::of_lanes(names) : syntax::Printer(CodeLanguage::c, names);
    std::string text;
    for (auto& structure : program.structures) {
        structure.comment.clear();
        text += printer.text(structure);
    }
    for (auto& function : program.functions) {
        if (function.body.empty()) continue;
        function.comment.clear();
        text += printer.text(function);
    }
    return text + "\n";
}

std::string table_text(const syntax::Table& table) {
    return syntax::Printer(CodeLanguage::c, {{table.name, "srbf_" + table.name}}).text(table) + "\n";
}

/// R, G, B of the spectrum that is 1 at one whole wavelength, every 5 nm: between them these are linear. Beyond, less
/// than 2e-5 of the sums is left.
std::string observer_text() {
    constexpr int first = 360, last = 780;
    std::vector<float> wavelengths;
    for (int nm = 360; nm <= 830; ++nm) wavelengths.push_back(float(nm));
    syntax::Table table{"R, G, B of a spectrum that is 1 within 1 nm, every 5 nm.", "observer", {}, 9};
    const std::vector<Rgb> weights = rgb_weights(wavelengths);
    for (int nm = first; nm <= last; nm += 5)
        for (int c = 0; c < 3; ++c)
            table.numbers.push_back(std::stof(fmt::format("{:.4e}", weights[std::size_t(nm - 360)][c])));
    return fmt::format("#define SRBF_FIRST_NM {}\n#define SRBF_LAST_NM {}\n", first, last) + table_text(table);
}

/// The lobes of the proposal, by their slots in runtime_densities.h: components 2 to 7, two empty slots, then 8 to 15.
std::string components_text() {
    using K = Kernel<float>;
    syntax::Table table{
        "Lobes of directions: bandwidth and scale; of half vectors: bandwidth, and 1 if weighted by their "
        "visibility.",
        "component",
        {},
        8};
    for (int slot = 0; slot < SRBF_PROPOSAL_LOBES; ++slot) {
        const int k = slot < SRBF_FIRST_HALF_VECTOR_LOBE ? slot + 2 : slot;
        const bool is_half = slot >= SRBF_FIRST_HALF_VECTOR_LOBE, is_lobe = is_half || k < SRBF_FIRST_HALF_VECTOR_LOBE;
        const float bandwidth = K::proposal_bandwidth(k);
        table.numbers.push_back(is_lobe ? bandwidth : 0);
        table.numbers.push_back(is_half   ? K::proposal_power(k, 1)
                                : is_lobe ? K::mirror_lobe({0, 0, 1}, bandwidth).scale
                                          : 0);
    }
    return table_text(table);
}

std::string parameters_text() {
    std::string rows;
    const OpenPbrModel defaults;
    for (const OpenPbrParameter& of : k_openpbr_parameters)
        rows += fmt::format("    {{\"{}\", {}f, {}f, {}f, {}}},\n", of.name, syntax::digits(of.least),
                            syntax::digits(of.most), syntax::digits(number(defaults, of, 0)), of.count());
    return fmt::format(
        "// The parameters of surfaces: name, range, default and count of numbers.\n"
        "#define SRBF_PARAMETERS {}\n"
        "typedef struct {{\n    const char* name;\n    float least, most, by_default;\n    int count;\n}} "
        "srbf_parameter;\n"
        "static const srbf_parameter srbf_parameters[SRBF_PARAMETERS] = {{\n{}}};\n\n",
        k_openpbr_parameters.size(), rows);
}

}  // namespace

std::string runtime_code() {
    return k_runtime_interface_text + syntax::definitions_of_c() +
           fmt::format("#define SRBF_MOST_VARIATES {}\n\n", k_most_variates) + k_runtime_host_text +
           printed(k_functions, "srbf_", false) + printed(k_functions_of_lanes, "srbf_x_", true) + observer_text() +
           components_text() + parameters_text() + k_runtime_files_text + k_runtime_models_text +
           k_runtime_densities_text + k_runtime_preparation_text + k_runtime_functions_text;
}

}  // namespace srbf
