// The view-by-view model as tensors of a model file.
#pragma once
#include <map>
#include <string>

#include "model/safetensors.h"
#include "srbf/su.h"

namespace srbf {

/// What the metadata of the file say of the model.
struct SuHeader {
    Discretise discretise;
    SuInterpolation interpolation;
    int neighbours;
};

/// The tensors of a model: its numbers, rounded to halves; see `write_model`.
std::map<std::string, Tensor16> encode_su(const SuModel& model);

/// The model of these tensors, or what is wrong with them.
Result<SuModel> decode_su(const std::map<std::string, Tensor16>& tensors, const SuHeader& header,
                          const std::string& source);

}  // namespace srbf
