// The view-by-view model as tensors of a model file.
#pragma once
#include <map>
#include <string>

#include "base/safetensors.h"
#include "srbf/models/su.h"

namespace srbf {

/// The metadata of the file that describe the model.
struct SuHeader {
    Discretise discretise;
    SuInterpolation interpolation;
    int neighbours;
};

/// The tensors of a model, with its numbers rounded to 16-bit floats; see `write_model`.
std::map<std::string, Tensor16> encode_su(const SuModel& model);

/// The model of these tensors, or an error.
Result<SuModel> decode_su(const std::map<std::string, Tensor16>& tensors, const SuHeader& header,
                          const std::string& file_name);

}  // namespace srbf
