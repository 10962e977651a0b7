// Fits of spherical radial basis functions to what was observed.
#pragma once
#include "observe/observations.h"
#include "observe/raw_matrix.h"
#include "srbf/fit.h"
#include "srbf/model.h"
#include "srbf/progress.h"
#include "srbf/result.h"

namespace srbf {

struct PmFit {
    PmModel model;      ///< every number rounded to a 16-bit float
    PmModel unrounded;  ///< before rounding
    double loss = 0;    ///< Σ w |f−f̂|² of `model` over the observations, including horizon pairs, exceeded bound
                        ///< pairs and integrals
    double unrounded_loss = 0;  ///< loss of `unrounded`
    StopReason stop = StopReason::converged;
};

/// Fits parameterized multivariate SRBFs by separable least squares: for given centres, bandwidths and
/// parameterizations the coefficients solve a non-negative linear problem; Levenberg-Marquardt minimises the remaining
/// residual (Kaufman 1975) over the others. Lobes are grown one by one. With spectral observations the search uses the
/// colours; its best lobes are polished with a coefficient per wavelength. Details: docs/fitting.md.
/// `begin`: a model of this size and form, whose lobes are polished instead of the search's.
/// Errors: options out of range, fewer observations than parameters, values that are not finite.
Result<PmFit> fit_pm(const Observations& observations, const FitOptions& options, const ProgressToken& progress = {},
                     const PmModel* begin = nullptr);

struct SuFit {
    SuModel model;      ///< every number rounded to its stored precision
    SuModel unrounded;  ///< before rounding
    int empty = 0;      ///< number of sampled views without data, or black within θmax: their coefficients are 0
    StopReason stop = StopReason::converged;  ///< iterations: some view's last search reached its limit
};

/// Fits scattered univariate SRBFs: for each sampled direction of `matrix`, including those beyond θmax, a sum of J
/// lobes with general centres, by separable least squares as in `fit_pm`. The initial lobes of a view are those of its
/// neighbour: for an objective of pictures along tracks through all views, of which each view takes one; otherwise from a
/// view to the next, of which the first of every 32 starts from nothing.
/// Details: docs/fitting.md.
/// Errors: options out of range; a matrix of another size; a view with data at fewer than J directions within θmax.
Result<SuFit> fit_su(const RawMatrix& matrix, const SuFitOptions& options, const ProgressToken& progress = {});

}  // namespace srbf
