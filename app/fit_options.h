// The options of fits on the command line, from their table (fit/fit_options.h), and the options for reading samples.
#pragma once
#include "app/options.h"
#include "fit/fit_options.h"

namespace srbf {

/// The option of a name: "--max-theta" for "max_theta".
std::string dashed(std::string_view name);

using OptionsByName = std::map<std::string_view, Option>;
/// Adds the options with these names, in this order. `texts` receives the texts that are given, and outlives the parsing.
OptionsByName add_fit_options(const Subcommand& sub, FitTexts& texts, const std::vector<std::string_view>& names);
/// Adds all options of fits.
OptionsByName add_fit_options(const Subcommand& sub, FitTexts& texts);
/// The request that the parsed texts describe. Ends the parsing with a usage error if they contradict each other.
FitRequest parse_request_or_exit(const Subcommand& sub, const FitTexts& texts);

/// True if an output is an existing folder or ends in a slash.
bool is_folder(const std::string& output);

/// Adds --columns, --quantity and --floor, which set `options`. It must outlive the parsing of the command line.
std::vector<Option> add_read_options(const Subcommand& sub, ReadOptions& options);

}  // namespace srbf
