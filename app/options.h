// The command line: a thin interface to CLI11, so that only one file compiles it. Level 7.
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

/// Accepts `names` alone.
Check one_of(const std::vector<std::string>& names);

/// An option of a subcommand.
class Option {
  public:
    explicit Option(CLI::Option* option = nullptr) : option_(option) {}

    Option type_name(std::string_view name) const;
    Option required() const;
    /// `choices`: texts that a shell offers.
    Option check(const Check& check, const std::vector<std::string>& choices = {}) const;
    /// Accepts these texts alone, which a shell offers.
    Option one_of(const std::vector<std::string>& names) const;
    Option capture_default_str() const;
    Option default_text(const std::string& text) const;            ///< for --help and `settings`
    Option offers(const std::vector<std::string>& choices) const;  ///< texts for a shell
    Option hidden() const;                                         ///< from --help
    Option one_at_a_time() const;  ///< for a list: the option takes one text each time it is given

    /// True if it was on the command line.
    bool given() const;
    /// Ends the parsing with a usage error that names the option.
    [[noreturn]] void fail(const std::string& what) const;

    friend bool operator==(const Option&, const Option&) = default;

  private:
    CLI::Option* option_;
};

/// A row of a subcommand's table of what its modes read. To give one of `options` where `are_read()` is false is a
/// usage error that says `where` they are read, as in "only with --pairs". It is asked once all options are read.
struct Reading {
    std::vector<Option> options;
    std::string where;
    std::function<bool()> are_read;
};

class Subcommand {
  public:
    explicit Subcommand(CLI::App* app) : app_(app) {}

    Option add_option(const std::string& names, std::string& to, const std::string& about) const;
    Option add_option(const std::string& names, std::vector<std::string>& to, const std::string& about) const;
    Option add_option(const std::string& names, int& to, const std::string& about) const;
    Option add_option(const std::string& names, std::uint64_t& to, const std::string& about) const;
    Option add_option(const std::string& names, double& to, const std::string& about) const;
    /// An option whose text is passed to `take`.
    Option add_option(const std::string& names, std::function<void(const std::string&)> take,
                      const std::string& about) const;
    /// An option whose text is only passed to its check.
    Option add_option(const std::string& names, const std::string& about) const;
    Option add_flag(const std::string& names, bool& to, const std::string& about) const;
    /// Names are followed by their values, as in --yes{1},--no{-1}.
    Option add_flag(const std::string& names, std::function<void(int)> take, const std::string& about) const;
    Option add_flag(const std::string& names, std::function<void()> when_given, const std::string& about) const;

    /// Former options, not in --help: to give one is a usage error that says what is used `instead`.
    void add_former(const std::vector<std::string>& names, const std::string& instead) const;

    /// The options of the command line, by their longest names.
    std::vector<std::string> given() const;

    /// The settings that a result depends on: the options of the command line and their texts, without those of
    /// `besides` and those that have their default.
    std::string settings(const std::vector<Option>& besides) const;

    void footer(const std::string& text) const;
    /// Ends the parsing with a usage error.
    [[noreturn]] void fail(const std::string& what) const;
    /// The action of the subcommand, once all its options are read. Before it are refused empty arguments, names of
    /// options in their place, and options that the chosen mode does not read.
    void callback(std::function<void()> run, std::vector<Reading> readings = {}) const;

  private:
    CLI::App* app_;
};

/// The content of --help, for the shells.
struct OptionHelp {
    std::vector<std::string> names;  ///< with their dashes; of a positional argument its name
    std::string type;  ///< of its text, and its default, as in NAME=pm; empty: a flag or a positional argument
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

    /// An option before the subcommand, whose text is passed to `take` before that runs.
    Option add_option(const std::string& names, std::function<void(const std::string&)> take, const std::string& about);
    Subcommand add_subcommand(const std::string& name, const std::string& about);
    Help help() const;
    /// Runs the subcommand of the arguments, or shows help. Returns an error message if the arguments are invalid.
    std::optional<std::string> parse(int argc, char** argv);

  private:
    /// Prints the help of all subcommands, with headings of which help2man makes sections.
    void print_all_help() const;

    std::unique_ptr<CLI::App> app_;
};

}  // namespace srbf
