// What the files of models and of libraries share.
#pragma once
#include <map>
#include <string>

#include "base/safetensors.h"
#include "srbf/model.h"

namespace srbf {

/// The tensors of a model with log scales, rounded to 16-bit floats, and the metadata that determine their meaning.
Safetensors lobes_content(const PmModel& model, std::string_view kind);
/// The model of such content; what it takes from the metadata is erased. Errors: those of `read_model`.
Result<PmModel> take_lobes(Safetensors& content, std::string_view kind, const std::string& file_name);

inline constexpr std::string_view k_library_kind = "pm-basis";

}  // namespace srbf
