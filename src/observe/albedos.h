// Albedos: integrals of a measurement that a fit also matches.
#pragma once
#include "observe/observations.h"

namespace SRBF_NAMESPACE {

/// The albedos that `observe` lists, up to θmax [rad]. Every second one takes part in a search.
std::vector<ObservedIntegral> observe_albedos(const Evaluate& f, const ObserveOptions& options, double theta_max);

}  // namespace srbf
