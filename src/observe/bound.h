// Detection of fits that exceed the measurement between the observations.
#pragma once
#include <vector>

#include "observe/observations.h"
#include "srbf/models/pm.h"

namespace srbf {

/// The fitted f cosθl cosθv may reach this multiple of the largest measured value between the stages; what is promised
/// is twice, after rounding.
inline constexpr double k_most_excess = 1.6;
/// Initial cost, relative to the loss, of exceeding that by the largest measured value.
inline constexpr double k_excess_weight = 0.005;
/// The cost grows by this factor where a round later the fit still exceeds it.
inline constexpr double k_bound_growth = 4;

/// cosθl cosθv, but no less than where the grid ends: beyond that f itself may not rise above what is allowed there.
double bound_cosines(Vec3f wl, Vec3f wv);

/// The largest measured f cosθl cosθv.
double largest_measured(const Observations& observations);

/// Indices, in order, of the observations from `first` on, including bound pairs, at which f of `model` times
/// `bound_cosines` is more than `k_most_excess` times `largest`.
std::vector<std::size_t> exceeded(const Observations& observations, std::size_t first, const PmModel& model,
                                  double largest);

/// Indices of the lobes of `model` that exceed it by themselves.
std::vector<int> exceeding_lobes(const Observations& observations, std::size_t first, const PmModel& model);

/// The weight of bound pair i when it becomes an observation, for a fit with this loss.
double bound_weight(const Observations& observations, std::size_t i, double loss, double largest);

/// Turns bound pairs that `model` exceeds into observations, and raises the weight of former ones that it still exceeds.
/// Returns how many. `first` is the index of the first of them.
std::size_t take_exceeded(Observations& observations, std::size_t first, const PmModel& model, double loss);

/// Gives the observations that were bound pairs the weight again that they began with, for a fit with this loss.
void reset_bound_weights(Observations& observations, std::size_t first, double loss);

}  // namespace srbf
