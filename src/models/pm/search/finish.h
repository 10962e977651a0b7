// The last stage of a multivariate fit.
#pragma once
#include "base/reporter.h"
#include "models/pm/search/fit_pm.h"
#include "models/pm/solve/lobes.h"

namespace SRBF_NAMESPACE {

/// Factors of the terms other than that of the pairs, see RowOptions.
struct TermFactors {
    double integrals = 0, pictures = 0;
};

/// Optimises the lobes on all observations and rounds them. Bound pairs that the rounded model exceeds become
/// observations for the next round, until the model exceeds none. With spectral observations the lobes then get
/// spectra.
PmFit finish(Lobes lobes, Observations observations, const TermFactors& factors, const PmFitOptions& options,
             const Reporter& reporter);

}  // namespace srbf
