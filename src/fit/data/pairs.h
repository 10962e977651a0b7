// Pairs of directions at which a measurement is observed.
#pragma once
#include <array>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include "r_sequence.h"
#include "srbf/directions.h"

namespace srbf {

/// The angle from the normal up to which a fit is bounded, whatever its θmax: near 90°, where f cosθl cosθv vanishes.
inline constexpr double k_horizon_theta = 89.9 * k_degree;

/// The golden angle π(3 − √5) [rad], rounded: multiples of it spread over all azimuths, however many there are.
inline constexpr double k_golden_angle = 2.4;

struct DirectionPair {
    Vec3f wl, wv;
};

/// A grid of pairs to `k_horizon_theta`, including in-plane pairs and the horizon. A sum of exponentials that diverges
/// between observations does so towards an edge.
std::vector<DirectionPair> horizon_grid();
/// Pairs beyond it: light, viewer or both at 89.99 or 89.999°.
std::vector<DirectionPair> brink_grid();
/// cos 89.95°, between the two.
inline constexpr double k_brink_cosine = 8.7e-4;

/// Points of the cube from a random one on.
RSequence<6> random_sequence(std::mt19937_64& random);

/// A pair within the cap, from the last five coordinates of a point: wv is uniform, wl often near its mirror direction.
/// None if wl is outside of the cap.
std::optional<DirectionPair> pair_within(const MirrorMixture& cap, const std::array<double, 6>& point);

}  // namespace srbf
