#include "app/read_options.h"

#include "srbf/text.h"

namespace srbf {

std::vector<Option> add_read_options(const Subcommand& sub, ReadOptions& to) {
    const Option columns =
        sub.add_option(
               "--columns", to.columns,
               "Of rows of numbers without a header, what each column is, as the header of a CSV names it; others\n"
               "are ignored: theta_l_deg,phi_l_deg,theta_v_deg,phi_v_deg,532nm")
            .type_name("NAMES");
    const Option unit =
        sub.add_option(
               "--unit", [&to](const std::string& name) { to.factors = name == "factor"; },
               "Of samples: bsdf, in 1/sr, or factor, the reflectance factor, which is pi times as large")
            .type_name("NAME")
            .one_of({"bsdf", "factor"});
    const Option floor =
        sub.add_option(
               "--floor", [&to](const std::string& text) { to.floor = to_number<float>(text).value_or(0); },
               "Of samples: leaves out values of at most this, which are bounds by noise, not measurements")
            .type_name("F")
            .check([](std::string& text) -> std::string {
                const auto value = to_number<float>(text);
                return value && *value > 0 && *value <= 1e12f ? "" : "expected a number above 0, found " + text;
            });
    return {columns, unit, floor};
}

}  // namespace srbf
