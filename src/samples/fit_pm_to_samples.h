// The fit of a multivariate model to scattered samples.
#pragma once
#include "models/pm/search/fit_pm.h"
#include "samples/observe_samples.h"

namespace SRBF_NAMESPACE {

/// Fits parameterized multivariate SRBFs to the gap-filled samples, and coefficients of wavelengths to the samples.
/// Returns an error as the `fit_pm` of fit_pm.h does, and if the samples have fewer values than the model has
/// parameters.
Result<PmFit> fit_pm(const SampleObservations& observations, const PmFitOptions& options,
                     const ProgressToken& progress = {});

}  // namespace
