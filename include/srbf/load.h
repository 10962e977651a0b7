// Reading of any BRDF. `load_brdf` returns its content, a Measured or a Model; `load_brdf_or_map` also takes maps.
// `load` of srbf.h returns a LoadedBrdf, for evaluation and renderers. `load_measured` and `load_model` refuse others.
#pragma once
#include <string>
#include <variant>

#include "srbf/map.h"
#include "srbf/measured.h"
#include "srbf/model.h"

SRBF_BEGIN

/// A measurement or a model.
using AnyBrdf = std::variant<Measured, Model>;
/// True if it is a BSDF, which has values on the front and the back (brdf.h).
bool is_two_sided(const AnyBrdf& brdf);
/// Reads a measurement or a model, recognised by its content. "FILE#X,Y" and "FILE#T" are texels of a map (map.h),
/// unless there is a file of that name. `options` are for measurements. Returns an error if load_measured or load_model
/// does.
Result<AnyBrdf> load_brdf(const std::string& path, const ReadOptions& options = {});
/// Reads a map too.
Result<std::variant<Measured, Model, TexelMap>> load_brdf_or_map(const std::string& path,
                                                                 const ReadOptions& options = {});

/// The measurement or model that `load` and `fit` of srbf.h hold.
const AnyBrdf& content(const LoadedBrdf& brdf);
LoadedBrdf loaded_brdf(AnyBrdf content);

SRBF_END
