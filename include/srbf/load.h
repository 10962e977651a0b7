// Loading of any BRDF from a file: level 4.
#pragma once
#include <string>
#include <variant>

#include "srbf/measured.h"
#include "srbf/model.h"

namespace srbf {

/// A measurement or a model.
using AnyBrdf = std::variant<Measured, Model>;
/// Reads a measurement or a model, recognised by its content. Errors: those of load_measured and load_model.
Result<AnyBrdf> load_brdf(const std::string& path);

}  // namespace srbf
