#include "app/fit_options.h"

#include <algorithm>
#include <filesystem>

namespace srbf {
namespace {

/// "--max-theta" of "max_theta".
std::string dashed(std::string_view name) {
    std::string text = "--" + std::string(name);
    std::ranges::replace(text, '_', '-');
    return text;
}

Option add_fit_option(const Subcommand& sub, FitTexts& to, const FitOption& of) {
    const std::string name(of.name), names = dashed(name);
    if (of.type.empty() && of.negation.empty())
        return sub.add_flag(
            names, [&to, name] { to[name] = "true"; }, of.about);
    if (of.type.empty())
        return sub.add_flag(
            names + "{1}," + dashed(of.negation) + "{-1}",
            [&to, name](int sign) { to[name] = sign > 0 ? "true" : "false"; }, of.about);
    const Option option = sub.add_option(
                                 names, [&to, name](const std::string& text) { to[name] = text; }, of.about)
                              .type_name(of.type);
    return option.default_text(of.preset).offers(of.choices);
}

}  // namespace

OptionsByName add_fit_options(const Subcommand& sub, FitTexts& to, const std::vector<std::string_view>& names) {
    OptionsByName all;
    for (const std::string_view name : names)
        if (!all.contains(name)) all[name] = add_fit_option(sub, to, fit_option(name));
    return all;
}

OptionsByName add_fit_options(const Subcommand& sub, FitTexts& to) {
    std::vector<std::string_view> names;
    for (const FitOption& option : fit_options()) names.push_back(option.name);
    return add_fit_options(sub, to, names);
}

FitRequest requested(const Subcommand& sub, const FitTexts& texts) {
    const auto request = fit_request(texts, dashed);
    if (!request) sub.fail(message(request.error()));
    return *request;
}

bool is_folder(const std::string& output) {
    std::error_code ignored;
    return output.ends_with('/') || std::filesystem::is_directory(output, ignored);
}

}  // namespace srbf
