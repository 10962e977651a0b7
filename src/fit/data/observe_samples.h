// What a fit sees of scattered samples.
#pragma once
#include "fit/data/observations.h"
#include "fit/fits.h"
#include "srbf/fit_samples.h"

namespace srbf {

struct ObserveSamplesOptions {
    Objective objective = k_default_objective;
    double max_theta = 0;  ///< [rad], in (0, π/2); 0: the objective's default
    std::uint64_t seed = 0;
    bool spectral = false;  ///< also observe the spectra of spectral samples, not only their colours
    /// Also observe the completed samples, for lobes; only for an objective of pictures, in colours.
    bool complete = true;
    int threads = 0;  ///< 0: as many as the machine has; the result does not depend on it
    /// If not 0, for fits of many: only the samples completed by one g, at this many pairs and without views.
    std::size_t only_completed = 0;
};

/// Samples prepared for fits. Each sample counts twice: as it is, and with light and viewer exchanged.
struct SampleObservations {
    ObserveSamplesOptions options;
    Observations samples;  ///< within θmax, followed by guards and checks beyond it
    Observations between;  ///< interpolated values on a grid of pairs within θmax, with Σ w |f|² = 1
    /// The completed samples observed like a table, with as much weight again on the samples themselves, and pairs near
    /// the horizon; or none. A fit uses either these or all the others.
    Observations completed;
    Measures interpolation;  ///< errors of interpolation at samples that were left out
    double finest = 0;       ///< lower bound on the width of a lobe [rad]: the spacing of the samples
    std::size_t places = 0;  ///< number of places within θmax
};
/// Errors: no sample within θmax, or all of them 0; fewer than k_folds places; spectra requested of samples without
/// spectra; cancelled.
Result<SampleObservations> observe(const ScatteredSamples& samples, const ObserveSamplesOptions& options,
                                   const ProgressToken& progress = {});

struct SampleFitOptions {
    FitOptions pm;
    /// Whether a fit without completed samples also follows values interpolated between the samples. A short fit
    /// without them estimates the remaining error; the grid's weight is the ratio of that error to the error of
    /// interpolation, at most 1. The grid constrains lobes where samples are sparse, but is harmful where a fit is
    /// better than interpolation. Cross-validation decides.
    bool fill = false;
};

/// Fits parameterized multivariate SRBFs: to the completed samples if they are observed, otherwise to the samples and
/// the interpolated values, with no lobe narrower than the samples' spacing.
/// Errors: those of `fit_pm`; fewer places than a third of the parameters (a place has three values).
Result<PmFit> fit_pm(const SampleObservations& observations, const SampleFitOptions& options,
                     const ProgressToken& progress = {});

}  // namespace srbf
