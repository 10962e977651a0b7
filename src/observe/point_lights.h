// Radiance in pictures by one light, as weights of pairs by their phase: the angle between light and viewer.
#pragma once
#include <limits>
#include <span>
#include <vector>

#include "observe/observations.h"

namespace srbf {

/// The energies of pictures of a sphere by one light, by its phase.
class PhaseEnergies {
  public:
    PhaseEnergies() = default;
    /// `measure`: of solid angles of both directions, for each pair [sr²].
    PhaseEnergies(std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<const Rgb> f,
                  std::span<const double> measure);
    /// With these weights Σ w |f−f̂|² over the pairs of a phase is, for pictures at that phase, the mean of the squared
    /// error of radiance relative to that of the picture; but for a factor that all have.
    double weight(Vec3f wl, Vec3f wv, const Rgb& f, double measure) const;

  private:
    std::vector<double> others_;  ///< of each interval of phases, but for a pair's own
};

/// The weights of all these pairs.
std::vector<double> point_light_weights(std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<const Rgb> f,
                                        std::span<const double> measure);

/// Adds the observations' `point_light_weight`, which then is empty, to the weights: each phase's by the reciprocal of its
/// root mean square for what is fitted, so that a step lowers the sum of the roots, and all of them such that they cost
/// k_point_lights times as much as the sum does so far, or as `most_loss` if that is less.
void add_point_lights(Observations& observations, const Evaluate& fitted,
                      double most_loss = std::numeric_limits<double>::infinity());

}  // namespace srbf
