// The fit of a multivariate model to scattered samples.
#pragma once
#include "models/pm/search/fit_pm.h"
#include "samples/observe_samples.h"

namespace srbf {

struct SampleFitOptions {
    FitOptions pm;
    /// Whether a fit without completed samples also follows what is expected between the samples. A short fit
    /// without it estimates the remaining error; its weight is the ratio of that error to the error of
    /// what is expected, at most 1. It constrains lobes where samples are sparse, but is harmful where a fit is
    /// better than it. Cross-validation decides; of scatter it is always followed.
    bool fill = false;
};

/// Fits parameterized multivariate SRBFs: to the completed samples if they are observed, otherwise to the samples and
/// the interpolated values, with no lobe narrower than the samples' spacing.
/// Errors: those of `fit_pm`; fewer groups than a third of the parameters (a group has three values).
Result<PmFit> fit_pm(const SampleObservations& observations, const SampleFitOptions& options,
                     const ProgressToken& progress = {});

}  // namespace srbf
