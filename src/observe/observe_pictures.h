// The pictures of a measurement that a fit matches.
#pragma once
#include "observe/observations.h"

namespace SRBF_NAMESPACE {

/// Views at points of equal area over the disc of a sphere, under extended and directional lights, none of which is
/// one of `standard_lightings`. Pairs with a direction beyond θmax [rad] or without a measurement are dark.
std::vector<ObservedView> observe_views(const Evaluate& f, double theta_max, int threads);

}  // namespace srbf
