// Radiance in pictures by one light, as weights of pairs by their phase: the angle between light and viewer.
#pragma once
#include <span>
#include <vector>

#include "srbf/fit.h"

namespace srbf {

/// Weights with which Σ w |f−f̂|² over the pairs of a phase is, for pictures of a sphere by one light at that phase, the
/// mean of the squared error of radiance relative to that of the picture; but for a factor that all have. `measure`: of
/// solid angles of both directions, for each pair [sr²].
std::vector<double> phase_weights(std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<const Rgb> f,
                                  std::span<const double> measure);

/// Adds the observations' `phase_weight`, which then is empty, to the weights: each phase's by the reciprocal of its
/// root mean square for what is fitted, so that a step lowers the sum of the roots, and all of them such that they cost
/// k_phase_share times as much as the sum does so far.
void add_phase_weights(Observations& observations, const Evaluate& fitted);

}  // namespace srbf
