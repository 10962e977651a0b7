// The options of a fit by name, for interfaces that receive texts: the command line, Python and pages.
#pragma once
#include <functional>
#include <map>
#include <span>

#include "base/errors.h"
#include "srbf/fit.h"

SRBF_BEGIN

/// An option of a fit. Models that read different texts of an option have rows of their own.
struct FitOptionRow {
    std::string_view name;                      ///< '_' separates words: "max_theta"
    std::vector<std::string_view> models = {};  ///< the names of the models that read it; empty: all
    std::string_view type = {};                 ///< the name of its type in help; empty: a flag, "true" or "false"
    std::string about = {};                     ///< lines of help
    /// The text of the default; empty for a flag that is off, or if the default depends on others.
    std::string preset = {};
    std::string expected = {};              ///< a description of accepted texts: "1 to 8"
    std::vector<std::string> choices = {};  ///< the texts, if they can be listed
    std::string_view negation = {};         ///< the name of the flag's opposite on command lines, or empty
    /// Sets the option in a request for one of `models`. Returns false if the text is invalid.
    std::function<bool(FitRequest&, std::string_view text)> set = {};
    /// The text under the option's name in a model's provenance; null: none.
    std::function<std::string(const FitRequest&)> state = {};
    /// A fit to patches of directions reads the option only with this in the request; empty or null: always.
    std::function<std::string_view(const FitRequest&)> needed_for_patches = {};
};
/// All options in the order of help. The first is "model".
std::span<const FitOptionRow> fit_options();
/// The first row with this name, which must exist.
const FitOptionRow& fit_option(std::string_view name);

/// The texts of the options that are given, by name.
using FitTexts = std::map<std::string, std::string, std::less<>>;
/// The spelling of an option in an interface, such as "--max-theta".
using Spelling = std::function<std::string(std::string_view name)>;

/// The request of these options. Returns an error, one line with names in the interface's spelling, if a name is
/// unknown, a text invalid, an option not read by the model, or if two options exclude each other.
Result<FitRequest> fit_request(const FitTexts& texts, const Spelling& spelled = {});
/// Returns an error if the fit of this measurement does not read one of the options.
Result<Done> check_read(const Measured& measured, const FitRequest& request, const FitTexts& texts,
                        const Spelling& spelled);

SRBF_END
