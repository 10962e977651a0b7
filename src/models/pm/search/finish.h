// The last stage of a multivariate fit.
#pragma once
#include "base/reporter.h"
#include "models/pm/search/fit_pm.h"
#include "models/pm/solve/lobes.h"

namespace srbf {

/// Factors of the terms beside that of pairs, see RowOptions.
struct TermFactors {
    double integrals = 0, pictures = 0;
    bool has_directional_lights = false;  ///< whether the weights of pairs have those of point lights
};

/// Optimises on all observations, for spectral ones with the spectra, and rounds. Bound pairs that the rounded model exceeds
/// become observations for the next round, until none is exceeded.
PmFit finish(Lobes lobes, Observations all, const TermFactors& factors, const FitOptions& options,
             double log_peak_limit, const Reporter& reporter);

}  // namespace srbf
