// Fits to scattered samples, with cross-validated errors.
#pragma once
#include <span>

#include "samples/observe_samples.h"
#include "srbf/fit.h"

namespace SRBF_NAMESPACE {

/// The requested fit to samples, with errors cross-validated over these folds. If the request has no number of lobes,
/// it has the largest number of `k_tried_lobes` that the samples determine. `observed` holds all samples, for the
/// request's objective; it is required unless the model is view by view.
Result<FitOutcome> fit_to_samples(const ScatteredSamples& samples, std::span<const int> fold,
                                  const SampleObservations* observed, const FitRequest& request,
                                  const ProgressToken& progress);

/// A fit of a multivariate model without cross-validation.
Result<FitOutcome> draft_of_samples(const ScatteredSamples& samples, const SampleObservations& observed,
                                    const FitRequest& request, const ProgressToken& progress);

}  // namespace
