// Fits of multivariate models, of one material or of many together.
#pragma once
#include <span>
#include <vector>

#include "fit/cuda/device_solver.h"
#include "fit/fits.h"

namespace srbf {

/// `fit_pm` of each of the observations, all with views or all without. On a device the search takes the candidates of
/// all of them forward together; the rest runs on threads. Errors: those of `fit_pm`, for one of them; no device.
Result<std::vector<PmFit>> fit_pm(std::span<const Observations* const> observations, const FitOptions& options,
                                  Where where, const ProgressToken& progress = {}, const PmModel* begin = nullptr);

}  // namespace srbf
