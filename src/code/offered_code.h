// Languages of code by name, functions and texts that extras add.
#pragma once
#include <optional>

#include "srbf/shading_code.h"

SRBF_BEGIN

/// A language and its name for users.
struct CodeLanguageRow {
    CodeLanguage language;
    std::string_view name;
};
inline constexpr CodeLanguageRow k_code_languages[] = {{CodeLanguage::glsl, "glsl"},
                                                       {CodeLanguage::hlsl, "hlsl"},
                                                       {CodeLanguage::wgsl, "wgsl"},
                                                       {CodeLanguage::msl, "msl"},
                                                       {CodeLanguage::c, "c"}};

/// The language of this name, if there is one; and all names, as "glsl, hlsl, ...".
std::optional<CodeLanguage> code_language_named(std::string_view name);
std::string code_language_names();

/// Functions that an extra adds to code, as NAME_environment: a name for `CodeOptions::with`, and a summary of them.
struct CodeFeature {
    std::string_view name, summary;
};
std::span<const CodeFeature> code_features();

/// A text of whole materials that an extra prints, beside the languages.
struct CodeModule {
    std::string_view name, summary;
    bool by_part = true;  ///< each part of a BSDF is a material of its own
    /// The text of models, with the parts of BSDFs if `by_part`. Returns an error if `shading_code` does.
    Result<std::string> (*text)(std::span<const NamedModel> models, std::string_view prefix, int threads);
    /// The text of a map, whose coefficients are in the KTX 2 file `file` beside it. Returns an error if `map_code`
    /// does. Null if the module has no maps.
    Result<std::string> (*map_text)(const TexelMap& map, const std::string& name, std::string_view file,
                                    int threads) = nullptr;
};
std::span<const CodeModule> code_modules();

SRBF_END
