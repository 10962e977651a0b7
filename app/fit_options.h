// The options of fits on command lines, from their table (fit/fit_options.h).
#pragma once
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "app/options.h"
#include "fit/fit_options.h"

namespace srbf {

using OptionsByName = std::map<std::string_view, Option>;
/// Adds the options of these names, in their order. The texts of those that are given go into `to`, which must outlive
/// the parsing.
OptionsByName add_fit_options(const Subcommand& sub, FitTexts& to, const std::vector<std::string_view>& names);
/// Adds all of them.
OptionsByName add_fit_options(const Subcommand& sub, FitTexts& to);
/// The request of these texts, once they are parsed. Ends the parsing with a usage error if they do not fit together.
FitRequest requested(const Subcommand& sub, const FitTexts& texts);

/// True if an output is a folder, or is to be one.
bool is_folder(const std::string& output);

}  // namespace srbf
