// Fits of multivariate models whose searches run together on a device.
#pragma once
#include <span>
#include <vector>

#include "fit/cuda/batched_search.h"

namespace srbf {

/// `fit_pm` of each of the observations, all with views or all without; the search runs in batches, the rest on
/// threads. Errors: those of `fit_pm`, for one of them; no device.
Result<std::vector<PmFit>> fit_pm_in_batches(std::span<const Observations* const> observations,
                                             const FitOptions& options, Batches::Where where,
                                             const ProgressToken& progress = {});

}  // namespace srbf
