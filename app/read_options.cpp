#include "app/read_options.h"

#include "base/text.h"
#include "measured/readers.h"

namespace srbf {

std::vector<Option> add_read_options(const Subcommand& sub, ReadOptions& options) {
    const Option columns =
        sub.add_option(
               "--columns", options.columns,
               "Rows of numbers only: the name of each column, as in the header of a CSV, and constant angles;\n"
               "other names are ignored: theta_l_deg,theta_v_deg,phi_v_deg,532nm,phi_l_deg=180")
            .type_name("NAMES");
    const Option quantity =
        sub.add_option(
               "--quantity", [&options](const std::string& name) { options.quantity = quantity_named(name); },
               "The values of samples: bsdf, f in 1/sr; factor, the reflectance factor pi f; or cosine, f times the\n"
               "cosine of the viewer")
            .type_name("NAME")
            .one_of({k_quantities.begin(), k_quantities.end()});
    const Option floor =
        sub.add_option(
               "--floor", [&options](const std::string& text) { options.floor = to_number<float>(text).value_or(0); },
               "Samples only: ignore values up to F, which are bounds by noise rather than measurements")
            .type_name("F")
            .check([](std::string& text) -> std::string {
                const auto value = to_number<float>(text);
                return value && *value > 0 && *value <= 1e12f ? "" : "expected a number above 0, found " + text;
            });
    return {columns, quantity, floor};
}

}  // namespace srbf
