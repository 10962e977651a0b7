// Radiance in pictures by one light, as weights of pairs by their phase: the angle between light and viewer.
#pragma once
#include <limits>
#include <span>
#include <vector>

#include "observe/observations.h"

namespace srbf {

/// With these weights Σ w |f−f̂|² over the pairs of a phase is, for pictures of a sphere at that phase, the mean of the
/// squared error of radiance relative to that of the picture; but for a factor that all have. `measure`: of solid angles of
/// both directions, for each pair [sr²].
std::vector<double> point_light_weights(std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<const Rgb> f,
                                        std::span<const double> measure);

/// Adds the observations' `point_light_weight`, which then is empty, to the weights: each phase's by the reciprocal of its
/// root mean square for what is fitted, so that a step lowers the sum of the roots, and all of them such that they cost
/// k_point_lights times as much as the sum does so far, or as `most_loss` if that is less.
void add_point_lights(Observations& observations, const Evaluate& fitted,
                      double most_loss = std::numeric_limits<double>::infinity());

}  // namespace srbf
