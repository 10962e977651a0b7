// Shading code of materials that a mask mixes.
#pragma once
#include "code/defined_names.h"
#include "srbf/shading_code.h"

namespace SRBF_NAMESPACE {

inline constexpr std::size_t k_max_blended = 3;

/// The functions of `CodeOptions::blend`, which follow the functions of the models. Returns an error unless there are
/// two or three models, all of them BRDFs, or if `defined` has one of the names.
Result<std::string> blend_code(std::span<const NamedModel> models, std::string_view prefix, const CodeOptions& options,
                               DefinedNames& defined);
std::vector<std::string> blend_functions(std::string_view prefix, const CodeOptions& options);

}  // namespace
