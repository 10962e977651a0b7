// Radiance in pictures under one directional light, as weights of pairs by their phase: the angle between light and
// viewer.
#pragma once
#include <limits>
#include <span>
#include <vector>

#include "observe/observations.h"

namespace SRBF_NAMESPACE {

/// With these weights, Σ w |f−f̂|² over the pairs of a phase is the mean squared error of the radiance of a
/// sphere's picture at that phase, relative to the picture's own, up to a common factor. `solid_angle` is the
/// product of the solid angles of both directions, for each pair [sr²].
std::vector<double> directional_light_weights(std::span<const Vec3f> wl, std::span<const Vec3f> wv,
                                              std::span<const Rgb> f, std::span<const double> solid_angle);

/// Adds `directional_light_weight` to the weights of the observations, and clears it. The weights of each phase are
/// divided by the root mean square of the current errors, so that a step lowers the sum of the roots. In total they
/// cost k_directional_lights times as much as the current loss, or `most_loss` if that is less.
void add_directional_lights(Observations& observations, const Evaluate& fitted,
                            double most_loss = std::numeric_limits<double>::infinity());

}  // namespace srbf
