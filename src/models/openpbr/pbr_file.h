// Surfaces of renderers' parameters as tensors of a model file.
#pragma once
#include <map>
#include <string>

#include "base/safetensors.h"
#include "srbf/models/openpbr.h"

namespace srbf {

/// The tensors of a model, with its numbers rounded to 16-bit floats; see `write_model`.
std::map<std::string, Tensor16> encode_pbr(const PbrModel& model);

/// The model of these tensors, or an error.
Result<PbrModel> decode_pbr(const std::map<std::string, Tensor16>& tensors, bool is_exchanged,
                            const std::string& file_name);

}  // namespace srbf
