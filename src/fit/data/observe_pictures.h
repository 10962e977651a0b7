// What a fit for pictures observes of a measurement.
#pragma once
#include <cstddef>
#include <vector>

#include "fit/data/observations.h"

namespace srbf {

inline constexpr std::size_t k_views = 100;
/// So many views over the disc that a sphere shows, each of the same area, under extended and single lights; none of them is
/// one of `standard_lightings`. Pairs with a direction beyond θmax [rad] or without a measurement are dark.
std::vector<ObservedView> observe_views(const Evaluate& f, double theta_max, std::size_t count, int threads);

}  // namespace srbf
