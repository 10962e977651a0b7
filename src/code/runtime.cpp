// srbf_runtime.h: kernel.glsl in C, twice (of a number, and of vectors), between texts that read files and call it.
#include <fmt/format.h>

#include <cmath>

#include "brdf/colour.h"
#include "code/lanes_code.h"
#include "code/print.h"
#include "generated/code/texts.h"
#include "models/openpbr/openpbr_parameters.h"
#include "srbf/shading_code.h"

namespace SRBF_NAMESPACE {
namespace {

/// The items of a list in C, with commas, in indented lines.
std::string join_rows(const std::vector<std::string>& items) {
    constexpr std::size_t k_columns_of_items = 114;
    std::string rows, row;
    for (const std::string& item : items) {
        if (row.size() + item.size() > k_columns_of_items) {
            rows += "    " + row + "\n";
            row.clear();
        }
        row += (row.empty() ? "" : " ") + item + ",";
    }
    return rows + "    " + row + "\n";
}

/// R, G, B of the spectrum that is 1 at one whole wavelength, every 5 nm: between them these are linear. Beyond, and by
/// rounding, 2e-5 of the sums is lost.
std::string observer_text() {
    constexpr int first = 360, last = 780;
    std::vector<float> wavelengths;
    for (int nm = first; nm <= 830; ++nm) wavelengths.push_back(float(nm));
    const std::vector<Rgb> weights = rgb_weights(wavelengths);
    std::vector<std::string> numbers;
    for (int nm = first; nm <= last; nm += 5)
        for (int c = 0; c < 3; ++c)
            numbers.push_back(fmt::format("{}", std::lround(1e6 * double(weights[std::size_t(nm - first)][c]))));
    return fmt::format(
        "#define SRBF_FIRST_NM {}\n#define SRBF_LAST_NM {}\n"
        "// R, G, B of a spectrum that is 1 within 1 nm, every 5 nm, in millionths.\n"
        "static const short srbf_observer[{}] = {{\n{}}};\n\n",
        first, last, numbers.size(), join_rows(numbers));
}

std::string parameters_text() {
    std::vector<std::string> rows;
    const OpenPbrModel defaults;
    for (const OpenPbrParameter& row : k_openpbr_parameters)
        rows.push_back(fmt::format("{{\"{}\", {}f, {}f, {}f, {}}}", row.name, syntax::digits(row.min),
                                   syntax::digits(row.max), syntax::digits(number(defaults, row, 0)), row.count()));
    return fmt::format(
        "// The parameters of surfaces: name, range, default and count of numbers.\n"
        "#define SRBF_PARAMETERS {}\n"
        "typedef struct {{\n    const char* name;\n    float least, most, by_default;\n    int count;\n}} "
        "srbf_parameter;\n"
        "static const srbf_parameter srbf_parameters[SRBF_PARAMETERS] = {{\n{}}};\n\n",
        k_openpbr_parameters.size(), join_rows(rows));
}

}  // namespace

std::string runtime_code() {
    const std::vector<std::string> functions{
        "su_rotated_value",  "su_plain_value", "ggx_value", "openpbr_value", "openpbr_anisotropic_value",
        "openpbr_roughness", "alpha_of",       "roughened", "facets_along",  "mixture_cosine"};
    std::set<std::string> known;
    const std::string lobes = lobes_in_c(known), mixtures = mixtures_in_c(known);
    return k_runtime_interface_text + syntax::definitions_of_c() +
           fmt::format("#define SRBF_MOST_VARIATES {}\n\n", k_max_variates) + lobes + mixtures + k_runtime_host_text +
           kernel_in_c(functions, CNumbers::single, known) + observer_text() + parameters_text() +
           k_runtime_files_text + k_runtime_models_text + k_runtime_preparation_text + k_runtime_functions_text;
}

}  // namespace
