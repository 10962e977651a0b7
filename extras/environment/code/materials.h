// Functions for templates of whole materials: modules for three.js, shaders for Unity.
#pragma once
#include "srbf/model.h"
#include "srbf/shading_code.h"

namespace SRBF_NAMESPACE {

/// "CcIbizaSunset" for "cc_ibiza_sunset".
std::string capitalised(const std::string& name);

void replace_all(std::string& text, std::string_view place, std::string_view replacement);

/// Returns an error for a view-by-view model and for a BSDF, which are no material by themselves.
Result<Done> check_materials(std::span<const NamedModel> models);

}  // namespace
