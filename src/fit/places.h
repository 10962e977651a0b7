// Where pairs of directions lie among each other.
#pragma once
#include <array>
#include <vector>

#include "srbf/measured.h"

namespace srbf {

/// A point for each pair, such that distances between points are, to first order, √(|Δωl|² + |Δωv|²), of isotropic samples the least over
/// all turns about the normal and mirrored ones.
using Place = std::array<double, 6>;
Place place_of(Vec3f wl, Vec3f wv, bool isotropic);

/// Samples within `k_same_place` of each other have one number, from 0 on; places as they are and with wl and wv exchanged.
struct Places {
    std::vector<int> of;  ///< the number of each sample
    int count = 0;
    double spacing = 0;  ///< see `spacing`
};
Places find_places(const Scattered& samples);

}  // namespace srbf
