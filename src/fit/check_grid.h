// Pairs where a fit may run away unseen.
#pragma once
#include <utility>
#include <vector>

#include "srbf/vec.h"

namespace srbf {

/// A grid of pairs (wl, wv) to 89.9°, in-plane ones and the horizon among them: where a sum of exponentials can run
/// away unseen, it does so towards an edge.
std::vector<std::pair<Vec3d, Vec3d>> check_grid();

}  // namespace srbf
