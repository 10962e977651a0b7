// Lambert and GGX as tensors of a model file.
#pragma once
#include <map>
#include <string>

#include "base/safetensors.h"
#include "srbf/models/ggx.h"

namespace srbf {

/// The tensors of a model, with its numbers rounded to 16-bit floats; see `write_model`.
std::map<std::string, Tensor16> encode_ggx(const GgxModel& model);

/// The model of these tensors, or an error.
Result<GgxModel> decode_ggx(const std::map<std::string, Tensor16>& tensors, const std::string& file_name);

}  // namespace srbf
