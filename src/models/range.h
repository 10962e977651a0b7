// The range of what is stored.
#pragma once
#include "srbf/model.h"
#include "srbf/result.h"

namespace SRBF_NAMESPACE {

/// An error if a coefficient of the model, or a reflectance of its facets, is above the largest 16-bit float, 65504,
/// which `write_model` stores instead. `source` is that of the error.
Result<Done> check_range(const Model& model, const std::string& source);

}  // namespace srbf
