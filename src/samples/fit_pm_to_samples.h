// The fit of a multivariate model to scattered samples.
#pragma once
#include "models/pm/search/fit_pm.h"
#include "samples/observe_samples.h"

namespace SRBF_NAMESPACE {

struct SampleFitOptions {
    PmFitOptions pm;
    /// If true, a fit without gap-filled samples also follows the values expected between the samples. A quick fit
    /// without them estimates the remaining error; their weight is the ratio of that error to their own error, at
    /// most 1. They constrain lobes where samples are sparse, but do harm where a fit is better than they are.
    /// Cross-validation decides; fits to scatter always follow them.
    bool fill = false;
};

/// Fits parameterized multivariate SRBFs to the gap-filled samples if they were observed, otherwise to the samples
/// and the interpolated values, with no lobe narrower than the samples' spacing.
/// Errors: those of `fit_pm`; fewer groups than a third of the parameters (a group has three values).
Result<PmFit> fit_pm(const SampleObservations& observations, const SampleFitOptions& options,
                     const ProgressToken& progress = {});

}  // namespace srbf
