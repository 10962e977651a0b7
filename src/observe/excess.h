// Overshoots (docs/fitting.md): fits that exceed the measurement between the observations.
#pragma once
#include "observe/observations.h"
#include "srbf/models/pm.h"

namespace SRBF_NAMESPACE {

/// Between the stages, f cosθl cosθv of a fit may reach this multiple of the largest measured value. The documented
/// limit after rounding is twice that value.
inline constexpr double k_max_excess = 1.6;
/// Initial cost, relative to the loss, of exceeding the bound by the largest measured value.
inline constexpr double k_excess_weight = 0.005;
/// The cost grows by this factor where the fit still exceeds the bound after another round.
inline constexpr double k_bound_growth = 4;

/// cosθl cosθv, where each cosine is at least the cosine at the end of the grid. Beyond the grid f itself may not
/// exceed the value that is allowed at its end.
double bound_cosines(Vec3f wl, Vec3f wv);

/// The largest measured f cosθl cosθv.
double largest_measured(const Observations& observations);

/// Indices, in ascending order, of the observations from `first` on, including bound pairs, at which f of `model`
/// times `bound_cosines` exceeds `k_max_excess` times `largest`.
std::vector<std::size_t> exceeded_pairs(const Observations& observations, std::size_t first, const PmModel& model,
                                        double largest);

/// A model whose other lobes are 0 in R, G, B.
PmModel only_lobe(PmModel model, int lobe);

/// The weight that bound pair i gets when it becomes an observation, for a fit with this loss.
double bound_weight(const Observations& observations, std::size_t i, double loss, double largest);

/// Turns bound pairs that `model` exceeds into observations, and raises the weight of earlier ones that it still
/// exceeds. `first` is the index of the first of them. Returns their number.
std::size_t promote_exceeded_pairs(Observations& observations, std::size_t first, const PmModel& model, double loss);

}  // namespace
