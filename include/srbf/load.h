// Reading of any BRDF, and writing of any as a table.
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "srbf/formats.h"
#include "srbf/model.h"

namespace [[gnu::visibility("default")]] srbf {

/// A measurement or a model.
using AnyBrdf = std::variant<Measured, Model>;
/// True if it is a BSDF, which answers on the front and the back (bsdf.h).
bool is_two_sided(const AnyBrdf& brdf);
/// True if a part of it is known, or answered by its counterpart; of a BRDF the front reflection alone.
bool has_part(const AnyBrdf& brdf, Part part);
/// Reads a measurement or a model, recognised by its content. "FILE#T" is texel T of a stack of models (model.h), unless
/// there is a file of that name. Errors: those of load_measured and load_model.
/// `options` are for measurements.
Result<AnyBrdf> load_brdf(const std::string& path, const ReadOptions& options = {});

/// The measurement or model that `load` and `fit` of srbf.h hold.
const AnyBrdf& content(const LoadedBrdf& brdf);
LoadedBrdf loaded_brdf(AnyBrdf content);

/// The bytes of a file of a format that is written (formats.h), with the values of `brdf`. Scattered samples become CSV as they are.
/// An MBSDF file of a BSDF has the parts of light from the front. Errors: an anisotropic measurement or a BSDF that files of the
/// format do not hold; it was cancelled.
Result<std::vector<std::byte>> table_file(const AnyBrdf& brdf, const Format& format, const TableOptions& options = {});

}  // namespace srbf
