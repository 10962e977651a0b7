#include "app/options.h"

#include <CLI/CLI.hpp>

namespace srbf {

Option Option::type_name(const std::string& name) const { return Option(option_->type_name(name)); }
Option Option::required() const { return Option(option_->required()); }
Option Option::check(const Check& check) const { return Option(option_->check(CLI::Validator(check, ""))); }
Option Option::capture_default_str() const { return Option(option_->capture_default_str()); }
Option Option::hidden() const { return Option(option_->group("")); }
Option Option::one_at_a_time() const { return Option(option_->allow_extra_args(false)); }
bool Option::given() const { return option_->count() > 0; }
void Option::fail(const std::string& what) const { throw CLI::ValidationError(option_->get_name(), what); }

Option Subcommand::add_option(const std::string& names, std::string& to, const std::string& about) const {
    return Option(app_->add_option(names, to, about));
}
Option Subcommand::add_option(const std::string& names, std::vector<std::string>& to, const std::string& about) const {
    return Option(app_->add_option(names, to, about));
}
Option Subcommand::add_option(const std::string& names, int& to, const std::string& about) const {
    return Option(app_->add_option(names, to, about));
}
Option Subcommand::add_option(const std::string& names, std::uint64_t& to, const std::string& about) const {
    return Option(app_->add_option(names, to, about));
}
Option Subcommand::add_option(const std::string& names, double& to, const std::string& about) const {
    return Option(app_->add_option(names, to, about));
}
Option Subcommand::add_option(const std::string& names, std::function<void(const std::string&)> take,
                              const std::string& about) const {
    return Option(app_->add_option_function<std::string>(names, std::move(take), about));
}
Option Subcommand::add_option(const std::string& names, const std::string& about) const {
    return Option(app_->add_option(names, about));
}
Option Subcommand::add_flag(const std::string& names, bool& to, const std::string& about) const {
    return Option(app_->add_flag(names, to, about));
}
Option Subcommand::add_flag(const std::string& names, int& to, const std::string& about) const {
    return Option(app_->add_flag(names, to, about));
}
Option Subcommand::add_flag(const std::string& names, std::function<void()> when_given,
                            const std::string& about) const {
    return Option(app_->add_flag_callback(names, std::move(when_given), about));
}
void Subcommand::footer(const std::string& text) const { app_->footer(text); }
void Subcommand::callback(std::function<void()> run) const { app_->callback(std::move(run)); }

CommandLine::CommandLine(const std::string& name, const std::string& version, const std::string& about,
                         const std::string& footer)
    : app_(std::make_unique<CLI::App>(about)) {
    app_->name(name);
    app_->set_version_flag("--version", version);
    app_->require_subcommand(1);
    app_->footer(footer);
}
CommandLine::~CommandLine() = default;

Subcommand CommandLine::add_subcommand(const std::string& name, const std::string& about) {
    return Subcommand(app_->add_subcommand(name, about));
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
        return is_missing && !unknown.empty() ? "no such subcommand or option: " + unknown[0] : error.what();
    }
    return std::nullopt;
}

}  // namespace srbf
