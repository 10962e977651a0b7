// Iteratively reweighted least squares, for fits whose errors are large.
#pragma once
#include "observe/observations.h"

namespace srbf {

/// A model with so few parameters as Lambert and GGX have makes large errors: its weights are adapted to them in so many
/// rounds, each by at most this factor.
inline constexpr int k_facet_rounds = 8;
inline constexpr double k_most_facet_change = 100;

/// Multiplies the weights of the fitted observations by their `large_error_weight` for what is fitted; of those alone
/// whose cosines are at least `least_cos`.
void weigh_large_errors(Observations& observations, const Evaluate& fitted, double most, float least_cos = 0);

}  // namespace srbf
