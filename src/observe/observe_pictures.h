// The pictures of a measurement that a fit matches.
#pragma once
#include <vector>

#include "observe/observations.h"

namespace srbf {

/// Views over the disc that a sphere shows, each of the same area, under extended and single lights; none of them is
/// one of `standard_lightings`. Pairs with a direction beyond θmax [rad] or without a measurement are dark.
std::vector<ObservedView> observe_views(const Evaluate& f, double theta_max, int threads);

}  // namespace srbf
