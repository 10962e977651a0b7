// The fit of a multivariate model to what was observed.
#pragma once
#include <cstdint>
#include <optional>

#include "observe/observations.h"
#include "srbf/models/pm.h"
#include "srbf/objective.h"
#include "srbf/progress.h"
#include "srbf/result.h"

namespace srbf {

struct FitOptions {
    PmForm form = PmForm::extended;
    bool axial = true;  ///< only centres at +z or −z, sufficient for isotropic data
    /// f(ωl,ωv) = f(ωv,ωl) up to rounding: variates in pairs (a, b), (b, a) with the same centre and bandwidth
    bool reciprocal = false;
    int lobes = k_default_lobes;        ///< J, 1..k_most_fitted_lobes
    int variates = k_default_variates;  ///< N, 1..8, even for a reciprocal model
    /// Upper bound 1/finest² on bandwidths, and 1/finest [1/rad] on the other weights; 0: the range of 16-bit floats.
    double finest = 0;
    /// form gaussian: true stores a log scale per lobe where β leaves the range of 16-bit floats; false bounds β
    bool log_scale = true;
    /// Number of starts: independent growths of J lobes. The best four are polished, one to three of them finished;
    /// of appearance pictures choose among all of them, and one is finished. Default: 20, or 16 for 8 lobes and more.
    std::optional<int> starts = {};
    /// Maximum number of perturbations of a candidate, replacements of the least useful lobe, or every fourth time of
    /// the least useful variate. All starts get a fifth of them, the better half another three tenths, the best quarter
    /// the remaining half; of appearance all of them get 0.28 of these. Default: 45 for up to 5 lobes, falling to 25
    /// for 8 and more.
    std::optional<int> perturbations = {};
    std::uint64_t seed = 0;  ///< of the random numbers
    int threads = 0;         ///< 0: as many as the machine has; the result does not depend on it
};

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

}  // namespace srbf
