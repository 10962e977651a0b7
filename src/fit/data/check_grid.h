// Pairs at which a fit is checked for excess between the observations.
#pragma once
#include <utility>
#include <vector>

#include "srbf/vec.h"

namespace srbf {

/// The angle from the normal up to which a fit is guarded against excess, whatever its θmax.
inline constexpr double k_guard_theta = 89.9 * k_degree;

/// A grid of pairs (wl, wv) to that angle, including in-plane pairs and the horizon. A sum of exponentials that
/// diverges between observations does so towards an edge.
std::vector<std::pair<Vec3d, Vec3d>> check_grid();

}  // namespace srbf
