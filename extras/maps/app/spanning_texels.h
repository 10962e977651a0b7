// Texels that stand for all of a map.
#pragma once
#include <vector>

#include "extras/maps/app/texels.h"
#include "srbf/fit_batch.h"

namespace SRBF_NAMESPACE {

/// The values [T, pairs] of at most `most` texels that span the map: of equally spaced ones each is the one farthest from
/// those chosen before, by cube roots. Values that no other texel is near are NaN. Errors: those of reading.
Result<std::vector<Rgb>> spanning_values(const Texels& texels, const SharedPairs& pairs, std::size_t most);

}  // namespace srbf
