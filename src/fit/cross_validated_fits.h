// Fits to scattered samples, judged by cross-validation.
#pragma once
#include "srbf/fit_samples.h"
#include "srbf/fitting.h"

namespace srbf {

/// The fit to samples that a request asks for: where it does not say how many lobes, several numbers are tried, and whether to
/// follow what is interpolated between the samples is found out too. `observed` is of all samples, for the request's objective;
/// PM and GGX need it.
Result<FitOutcome> fit_to_samples(const Scattered& samples, const SampleObservations* observed,
                                  const FitRequest& request, const ProgressToken& progress);

/// A fit without cross-validation, which follows what is interpolated; `in_short`: of a short search.
Result<FitOutcome> draft_of_samples(const Scattered& samples, const SampleObservations& observed,
                                    const FitRequest& request, bool in_short, const ProgressToken& progress);

}  // namespace srbf
