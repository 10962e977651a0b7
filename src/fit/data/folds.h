// Places: groups of close samples, for cross-validation.
#pragma once
#include <vector>

#include "srbf/fit_samples.h"

namespace srbf {

/// Samples within `k_same_place` of each other have the same number, from 0 on; so do samples that are close to them
/// with wl and wv exchanged.
struct Places {
    std::vector<int> of;  ///< the place of each sample
    int count = 0;
    double spacing = 0;  ///< see `spacing`
};
Places find_places(const ScatteredSamples& samples);
/// `assign_folds` for known places.
Result<std::vector<int>> assign_folds(const ScatteredSamples& samples, const Places& places, double max_theta,
                                      std::uint64_t seed);

}  // namespace srbf
