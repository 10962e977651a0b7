// The command line: a thin interface to CLI11, so that only one file compiles it.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace srbf {

/// Validates the text of an option, which it may change; returns an error message, or an empty string.
using Check = std::function<std::string(std::string&)>;

/// Accepts only `names`.
Check one_of(const std::vector<std::string>& names);

/// An option of a subcommand.
class Option {
  public:
    explicit Option(CLI::Option* option = nullptr) : option_(option) {}

    Option type_name(std::string_view name) const;
    Option required() const;
    /// `choices`: texts that shell completion offers.
    Option check(const Check& check, const std::vector<std::string>& choices = {}) const;
    /// Accepts only these texts, which shell completion offers.
    Option one_of(const std::vector<std::string>& names) const;
    Option capture_default_str() const;
    Option default_text(const std::string& text) const;            ///< the default that --help and `settings` show
    Option offers(const std::vector<std::string>& choices) const;  ///< texts for shell completion
    Option hidden() const;                                         ///< left out of --help
    Option group(const std::string& title) const;                  ///< its heading in --help
    Option one_at_a_time() const;                                  ///< an option with a list takes one text per use

    /// True if the option was on the command line.
    bool given() const;
    /// Ends the parsing with a usage error that names the option.
    [[noreturn]] void fail(const std::string& what) const;

    friend bool operator==(const Option&, const Option&) = default;

  private:
    CLI::Option* option_;
};

/// A row of a subcommand's table of the options that its modes read. If one of `options` is given while
/// `are_read()` is false, parsing ends with a usage error that says `where` they are read, as in "only with
/// --pairs". `are_read` is called once all options are parsed.
struct AllowedWhen {
    std::vector<Option> options;
    std::string where;
    std::function<bool()> are_read;
};

class Subcommand {
  public:
    explicit Subcommand(CLI::App* app) : app_(app) {}

    /// An option that sets a std::string, std::vector<std::string>, int, std::uint64_t or double.
    template <typename Value> Option add_option(const std::string& names, Value& value, const std::string& about) const;
    /// An option whose text is passed to `take`.
    Option add_option(const std::string& names, std::function<void(const std::string&)> take,
                      const std::string& about) const;
    /// An option whose text is only passed to its check.
    Option add_option(const std::string& names, const std::string& about) const;
    Option add_flag(const std::string& names, bool& value, const std::string& about) const;
    /// Each name is followed by its value, as in --yes{1},--no{-1}.
    Option add_flag(const std::string& names, std::function<void(int)> take, const std::string& about) const;
    Option add_flag(const std::string& names, std::function<void()> when_given, const std::string& about) const;

    /// The settings that a result depends on: the options on the command line with their texts, except those in
    /// `besides` and those that equal their default.
    std::string settings(const std::vector<Option>& besides) const;

    void footer(const std::string& text) const;
    /// Ends the parsing with a usage error.
    [[noreturn]] void fail(const std::string& what) const;
    /// Sets the action of the subcommand, which runs once all options are parsed. Before it, parsing refuses empty
    /// arguments, option names in place of arguments, and options that the chosen mode does not read.
    void callback(std::function<void()> run, std::vector<AllowedWhen> allowed = {}) const;

  private:
    CLI::App* app_;
};

/// The content of --help, for shell completion.
struct OptionHelp {
    std::vector<std::string> names;  ///< names with their dashes, or the name of a positional argument
    std::string type;  ///< name and default of its text, as in NAME=pm; empty: a flag or a positional argument
    std::string about;
    std::vector<std::string> choices;  ///< the texts that it accepts, if they can be listed
    bool positional, flag;
};
struct SubcommandHelp {
    std::string name, about, footer;
    std::vector<OptionHelp> options;
};
struct Help {
    std::string name, about, footer;
    std::vector<OptionHelp> options;  ///< before the subcommand
    std::vector<SubcommandHelp> subcommands;
};

class CommandLine {
  public:
    CommandLine(const std::string& name, const std::string& version, const std::string& about,
                const std::string& footer);
    CommandLine(const CommandLine&) = delete;
    CommandLine& operator=(const CommandLine&) = delete;
    ~CommandLine();

    /// An option before the subcommand. Its text is passed to `take` before the subcommand runs.
    Option add_option(const std::string& names, std::function<void(const std::string&)> take, const std::string& about);
    Subcommand add_subcommand(const std::string& name, const std::string& about);
    Help help() const;
    /// Runs the subcommand in the arguments, or prints help. Returns an error message if the arguments are invalid.
    std::optional<std::string> parse(int argc, char** argv);

  private:
    /// Prints the help of all subcommands. help2man makes sections of its headings.
    void print_all_help() const;

    std::unique_ptr<CLI::App> app_;
};

}  // namespace srbf
