// Lambert and GGX as tensors of a model file.
#pragma once
#include <map>
#include <string>

#include "model/safetensors.h"
#include "srbf/ggx.h"

namespace srbf {

/// The tensors of a model: its numbers, rounded to halves; see `write_model`.
std::map<std::string, Tensor16> encode_ggx(const GgxModel& model);

/// The model of these tensors, or what is wrong with them.
Result<GgxModel> decode_ggx(const std::map<std::string, Tensor16>& tensors, const std::string& source);

}  // namespace srbf
