// The options of a fit by their names, for fronts that are given texts: the command line, Python and pages.
#pragma once
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "srbf/fit.h"

SRBF_BEGIN

inline constexpr int k_most_threads = 1024;

/// An option of a fit. Models that read different texts of an option have rows of their own.
struct FitOptionRow {
    std::string_view name;                      ///< '_' separates words: "max_theta"
    std::vector<std::string_view> models = {};  ///< the names of the models that read it; empty: all
    std::string_view type = {};                 ///< of its text, as help names it; empty: a flag, "true" or "false"
    std::string about = {};                     ///< what help says, in lines
    std::string preset = {};                ///< the text of the default; empty: a flag that is not given, or it depends
    std::string expected = {};              ///< the texts that are accepted, in words: "1 to 8"
    std::vector<std::string> choices = {};  ///< the texts, if they can be listed
    std::string_view negation = {};         ///< how command lines name a flag that is "false"; empty: they need not
    /// Sets it in a request for one of `models`. False: the text is not accepted.
    std::function<bool(FitRequest&, std::string_view text)> set = {};
};
/// In the order of help. The first is "model".
std::span<const FitOptionRow> fit_options();
/// The first row of that name, which must exist.
const FitOptionRow& fit_option(std::string_view name);

/// The texts of the options that are given, by name.
using FitTexts = std::map<std::string, std::string, std::less<>>;
/// How a front spells the name of an option, as in "--max-theta".
using Spelling = std::function<std::string(std::string_view name)>;

/// The request of these options. Errors, of one line with names in the front's spelling: a name that is none; a text
/// that is not accepted; an option that the model does not read; options that exclude each other.
Result<FitRequest> fit_request(const FitTexts& texts, const Spelling& spelled = {});

SRBF_END
