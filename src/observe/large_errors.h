// Iteratively reweighted least squares, for fits with large residuals.
#pragma once
#include "observe/observations.h"

namespace SRBF_NAMESPACE {

/// Models with few parameters, such as Lambert and GGX, leave large residuals. Their weights adapt to them in this
/// many rounds, each by at most this factor.
inline constexpr int k_facet_rounds = 8;
inline constexpr double k_most_facet_change = 100;

/// Multiplies the weights of the fitted observations by `large_error_weight`, given the values of the fit. Applies
/// only to observations both of whose cosines are at least `least_cos`.
void weigh_large_errors(Observations& observations, const Evaluate& fitted, double most, float least_cos = 0);

}  // namespace srbf
