#include "app/options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

namespace srbf {

namespace {

constexpr char k_between_choices = '|';

OptionHelp help_of(CLI::Option& option) {
    OptionHelp help{
        {}, {}, option.get_description(), {}, option.get_positional(), option.get_items_expected_max() == 0};
    if (help.positional) help.names.push_back(option.get_name(true));
    for (const std::string& name : option.get_snames()) help.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) help.names.push_back("--" + name);
    if (!help.positional && !help.flag) {
        help.type = option.get_type_name();
        if (!option.get_default_str().empty()) help.type += "=" + option.get_default_str();
    }
    try {
        help.choices = CLI::detail::split(option.get_validator()->get_name(), k_between_choices);
        if (help.choices.front().empty()) help.choices.clear();
    } catch (const CLI::OptionNotFound&) {  // it has no check
    }
    return help;
}

/// Refuses empty arguments, and option names where an argument is expected.
void refuse_missing(const CLI::App& sub) {
    const auto is_option = [&](const std::string& text) {
        return text.starts_with('-') && sub.get_option_no_throw(text.substr(0, text.find('='))) != nullptr;
    };
    for (const CLI::Option* option : sub.get_options())
        for (const std::string& text : option->results()) {
            if (text.empty()) throw CLI::ValidationError(option->get_name(), "expected a text, found an empty one");
            if (is_option(text))
                throw CLI::ValidationError(option->get_name(), "expected a text, found the option " + text);
        }
}

void refuse_unread(const std::vector<AllowedWhen>& allowed) {
    for (const AllowedWhen& row : allowed)
        for (const Option& option : row.options)
            if (option.given() && !row.are_read()) option.fail(row.where);
}

}  // namespace

Check one_of(const std::vector<std::string>& names) {
    return [names](const std::string& text) -> std::string {
        if (std::find(names.begin(), names.end(), text) != names.end()) return {};
        return fmt::format("expected {}, found {}", fmt::join(names, " or "), text);
    };
}

Option Option::type_name(std::string_view name) const { return Option(option_->type_name(std::string(name))); }
Option Option::required() const { return Option(option_->required()); }
Option Option::check(const Check& check, const std::vector<std::string>& choices) const {
    const std::string between(1, k_between_choices);
    return Option(option_->check(CLI::Validator(check, "", CLI::detail::join(choices, between))));
}
Option Option::one_of(const std::vector<std::string>& names) const { return check(srbf::one_of(names), names); }
Option Option::capture_default_str() const { return Option(option_->capture_default_str()); }
Option Option::default_text(const std::string& text) const { return Option(option_->default_str(text)); }
Option Option::offers(const std::vector<std::string>& choices) const {
    return choices.empty() ? *this : check([](std::string&) { return std::string(); }, choices);
}
Option Option::hidden() const { return group(""); }
Option Option::group(const std::string& title) const { return Option(option_->group(title)); }
Option Option::one_at_a_time() const { return Option(option_->allow_extra_args(false)); }
bool Option::given() const { return option_->count() > 0; }
void Option::fail(const std::string& what) const { throw CLI::ValidationError(option_->get_name(), what); }

template <typename Value>
Option Subcommand::add_option(const std::string& names, Value& value, const std::string& about) const {
    return Option(app_->add_option(names, value, about));
}
template Option Subcommand::add_option(const std::string&, std::string&, const std::string&) const;
template Option Subcommand::add_option(const std::string&, std::vector<std::string>&, const std::string&) const;
template Option Subcommand::add_option(const std::string&, int&, const std::string&) const;
template Option Subcommand::add_option(const std::string&, std::uint64_t&, const std::string&) const;
template Option Subcommand::add_option(const std::string&, double&, const std::string&) const;
Option Subcommand::add_option(const std::string& names, std::function<void(const std::string&)> take,
                              const std::string& about) const {
    return Option(app_->add_option_function<std::string>(names, std::move(take), about));
}
Option Subcommand::add_option(const std::string& names, const std::string& about) const {
    return Option(app_->add_option(names, about));
}
Option Subcommand::add_flag(const std::string& names, bool& value, const std::string& about) const {
    return Option(app_->add_flag(names, value, about)->disable_flag_override());
}
Option Subcommand::add_flag(const std::string& names, std::function<void(int)> take, const std::string& about) const {
    // CLI11 2.2 and later count a flag that is bound to a variable as given even where it is not, hence a function.
    return Option(app_->add_flag_function(
                          names, [take](std::int64_t value) { take(int(value)); }, about)
                      ->multi_option_policy(CLI::MultiOptionPolicy::Throw)
                      ->disable_flag_override());
}
Option Subcommand::add_flag(const std::string& names, std::function<void()> when_given,
                            const std::string& about) const {
    return Option(app_->add_flag_callback(names, std::move(when_given), about)->disable_flag_override());
}
std::string Subcommand::settings(const std::vector<Option>& besides) const {
    std::string text;
    for (CLI::Option* option : app_->get_options()) {
        const std::vector<std::string>& results = option->results();
        const bool is_default = results.size() == 1 && results[0] == option->get_default_str();
        if (results.empty() || is_default || std::ranges::count(besides, Option(option)) > 0) continue;
        text += option->get_name();
        for (const std::string& result : results) text += '\0' + result;
        text += '\n';
    }
    return text;
}
void Subcommand::fail(const std::string& what) const { throw CLI::ValidationError("", what); }
void Subcommand::footer(const std::string& text) const { app_->footer(text); }
void Subcommand::callback(std::function<void()> run, std::vector<AllowedWhen> allowed) const {
    app_->parse_complete_callback([app = app_, allowed = std::move(allowed)] {
        refuse_missing(*app);
        refuse_unread(allowed);
    });
    app_->final_callback(std::move(run));
}

CommandLine::CommandLine(const std::string& name, const std::string& version, const std::string& about,
                         const std::string& footer)
    : app_(std::make_unique<CLI::App>(about)) {
    app_->name(name);
    app_->set_version_flag("--version", version)->disable_flag_override();
    app_->get_help_ptr()->disable_flag_override();
    app_->add_flag_callback(
            "--help-all", [this] { print_all_help(); }, "Print the help of all subcommands and exit")
        ->disable_flag_override()
        ->trigger_on_parse();
    app_->require_subcommand(1);
    app_->footer(footer);
}
CommandLine::~CommandLine() = default;

Option CommandLine::add_option(const std::string& names, std::function<void(const std::string&)> take,
                               const std::string& about) {
    return Subcommand(app_.get()).add_option(names, std::move(take), about);
}

Subcommand CommandLine::add_subcommand(const std::string& name, const std::string& about) {
    CLI::App* const sub = app_->add_subcommand(name, about);
    sub->get_help_ptr()->disable_flag_override();
    return Subcommand(sub);
}

void CommandLine::print_all_help() const {
    std::string text = app_->help();
    const auto replace = [](std::string& help, const std::string& from, const std::string& to) {
        for (auto position = help.find(from); position != help.npos; position = help.find(from, position + to.size()))
            help.replace(position, from.size(), to);
    };
    for (const CLI::App* sub : app_->get_subcommands([](CLI::App*) { return true; })) {
        std::string help = sub->help(app_->get_name());
        replace(help, "\nUsage", "\n\nUsage");
        replace(help, "\nPositionals", "\nIts arguments");
        replace(help, "\nOptions", "\nIts options");
        replace(help, "\nExample", "\nIts example");
        text += fmt::format("\n*{} {}*\n\n{}", app_->get_name(), sub->get_name(), help);
    }
    replace(text, "\n  srbf ", "\n  $ srbf ");  // help2man keeps these lines verbatim
    fmt::print("{}", text);
    throw CLI::Success();
}

Help CommandLine::help() const {
    const auto options_of = [](CLI::App& app) {
        std::vector<OptionHelp> options;
        for (CLI::Option* option : app.get_options())
            if (!option->get_group().empty()) options.push_back(help_of(*option));
        return options;
    };
    Help help{app_->get_name(), app_->get_description(), app_->get_footer(), options_of(*app_), {}};
    for (CLI::App* sub : app_->get_subcommands([](CLI::App*) { return true; }))
        help.subcommands.push_back({sub->get_name(), sub->get_description(), sub->get_footer(), options_of(*sub)});
    return help;
}

std::optional<std::string> CommandLine::parse(int argc, char** argv) {
    try {
        app_->parse(argc, argv);
    } catch (const CLI::Success& done) {  // --help, --version
        app_->exit(done);
    } catch (const CLI::ParseError& error) {
        // CLI11 reports missing options before unknown ones.
        const auto unknown = app_->remaining(true);
        const bool is_missing = error.get_exit_code() == int(CLI::ExitCodes::RequiredError);
        const bool is_before = std::ranges::any_of(app_->get_options(), [&](const CLI::Option* option) {
            return std::string_view(error.what()).starts_with(option->get_name() + ":");
        });
        std::string problem = error.what();
        if (problem.starts_with(": ")) problem.erase(0, 2);  // a hidden option has no name
        const auto chosen = is_before ? std::vector<CLI::App*>() : app_->get_subcommands();
        if (const auto end = problem.find(" was given a disallowed flag override"); end != problem.npos)
            problem = "--" + problem.substr(0, end) + ": expected no value, found one";
        return fmt::format("{} (see srbf{} --help)",
                           is_missing && !unknown.empty() ? "no such subcommand or option: " + unknown[0] : problem,
                           chosen.empty() ? "" : " " + chosen[0]->get_name());
    }
    return std::nullopt;
}

}  // namespace srbf
