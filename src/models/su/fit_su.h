// The fit of a view-by-view model to a matrix of directions.
#pragma once
#include "observe/raw_matrix.h"
#include "srbf/metrics.h"
#include "srbf/models/su.h"
#include "srbf/progress.h"
#include "srbf/result.h"

namespace SRBF_NAMESPACE {

struct SuFitOptions {
    int lobes = 8;  ///< J, 1..k_max_view_lobes
    Objective objective = k_default_objective;
    double max_theta = 0;  ///< 1° to 89.9° [rad]; 0 for the objective's default. Pairs beyond it have small weights
    SuInterpolation interpolation = SuInterpolation::rotated;  ///< stored in the model; the fit does not depend on it
    int neighbours = 3;                                        ///< K of plain interpolation, 1..k_max_neighbours
    std::uint64_t seed = 0;                                    ///< seed of the random numbers
    int threads = 0;  ///< number of threads; 0: all of the machine. The result does not depend on it
};

struct SuFit {
    SuModel model;      ///< every number rounded to its stored precision
    SuModel unrounded;  ///< before rounding
    int empty = 0;      ///< number of views without data or black within θmax, whose coefficients are 0
    StopReason stop = StopReason::converged;  ///< `iterations` if some view's last search reached its limit
};

/// Fits scattered univariate SRBFs: for each sampled direction of `matrix`, including those beyond θmax, a sum of J
/// lobes with general centres, by separable least squares as in `fit_pm`. The fit of a view begins with the lobes of
/// the previous view; the first of every 32 views is fitted from scratch (docs/fitting.md). Returns an error if options
/// are out of range, the matrix has another size, or a view has data at fewer than J directions within θmax.
Result<SuFit> fit_su(const RawMatrix& matrix, const SuFitOptions& options, const ProgressToken& progress = {});

}  // namespace
