// Where pairs of directions lie among each other.
#pragma once
#include <vector>

#include "srbf/fit_samples.h"

namespace srbf {

/// Samples within `k_same_place` of each other have one number, from 0 on; places as they are and with wl and wv exchanged.
struct Places {
    std::vector<int> of;  ///< the number of each sample
    int count = 0;
    double spacing = 0;  ///< see `spacing`
};
Places find_places(const Scattered& samples);
/// `draw_folds` of samples whose places are known.
Result<std::vector<int>> draw_folds(const Scattered& samples, const Places& places, double max_theta,
                                    std::uint64_t seed);

}  // namespace srbf
