#include "app/fit_options.h"

#include <algorithm>

#include "base/paths.h"

namespace srbf {
namespace {

/// The option of a name: "--max-theta" for "max_theta".
std::string dashed(std::string_view name) {
    std::string text = "--" + std::string(name);
    std::ranges::replace(text, '_', '-');
    return text;
}

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

FitRequest requested(const Subcommand& sub, const FitTexts& texts) {
    const auto request = fit_request(texts, dashed);
    if (!request) sub.fail(message(request.error()));
    return *request;
}

bool is_folder(const std::string& output) {
    std::error_code ignored;
    return output.ends_with('/') || std::filesystem::is_directory(system_files::path_of(output), ignored);
}

}  // namespace srbf
