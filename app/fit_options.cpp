#include "app/fit_options.h"

#include "base/paths.h"
#include "base/text.h"
#include "measured/readers.h"

namespace srbf {
namespace {

Option add_fit_option(const Subcommand& sub, FitTexts& texts, const FitOptionRow& row) {
    const std::string name(row.name), names = dashed(name);
    if (row.type.empty() && row.negation.empty())
        return sub.add_flag(
            names, [&texts, name] { texts[name] = "true"; }, row.about);
    if (row.type.empty())
        return sub.add_flag(
            names + "{1}," + dashed(row.negation) + "{-1}",
            [&texts, name](int sign) { texts[name] = sign > 0 ? "true" : "false"; }, row.about);
    const Option option = sub.add_option(
                                 names, [&texts, name](const std::string& text) { texts[name] = text; }, row.about)
                              .type_name(row.type);
    if (row.models == std::vector<std::string_view>{"su"}) option.group("View-by-view models, --model su");
    return option.default_text(row.preset).offers(row.choices);
}

}  // namespace

std::string dashed(std::string_view name) {
    std::string text = "--" + std::string(name);
    std::ranges::replace(text, '_', '-');
    return text;
}

OptionsByName add_fit_options(const Subcommand& sub, FitTexts& texts, const std::vector<std::string_view>& names) {
    OptionsByName options;
    for (const std::string_view name : names)
        if (!options.contains(name)) options[name] = add_fit_option(sub, texts, fit_option(name));
    return options;
}

OptionsByName add_fit_options(const Subcommand& sub, FitTexts& texts) {
    std::vector<std::string_view> names;
    for (const FitOptionRow& option : fit_options()) names.push_back(option.name);
    return add_fit_options(sub, texts, names);
}

FitRequest parse_request_or_exit(const Subcommand& sub, const FitTexts& texts) {
    const auto request = fit_request(texts, dashed);
    if (!request) sub.fail(message(request.error()));
    return *request;
}

bool is_folder(const std::string& output) {
    std::error_code ignored;
    return output.ends_with('/') || std::filesystem::is_directory(system_files::path_of(output), ignored);
}

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
