// Fits to scattered samples, selected by cross-validation.
#pragma once
#include <functional>
#include <span>

#include "samples/observe_samples.h"
#include "srbf/fit.h"

namespace SRBF_NAMESPACE {

/// The options by which a fit of the request observes samples.
ObserveSamplesOptions observe_options(const FitRequest& request);

/// The requested fit to samples. If the request has no number of lobes, several are tried; whether to follow
/// interpolated values between the samples, if these are not filled, is determined too. `observed` holds all
/// samples, for the request's objective; it is required for PM and GGX.
Result<FitOutcome> fit_to_samples(const ScatteredSamples& samples, const SampleObservations* observed,
                                  const FitRequest& request, const ProgressToken& progress);

/// A fit without cross-validation that follows filled or interpolated values.
Result<FitOutcome> draft_of_samples(const ScatteredSamples& samples, const SampleObservations& observed,
                                    const FitRequest& request, const ProgressToken& progress);

/// Fits models to `training`, the samples of all folds but one: the same number of models each time. It is called from
/// several threads at once.
using FitToSamples = std::function<Result<std::vector<Model>>(const ScatteredSamples& training, std::size_t left_out)>;
/// The value f̂ of each model at every sample, from the fit to the other folds: [model][sample C + c], with the models'
/// `channels`.
Result<std::vector<std::vector<float>>> cross_validate(const ScatteredSamples& samples, std::span<const int> fold,
                                                       const FitToSamples& fit);

}  // namespace srbf
