// The last stage of a multivariate fit.
#pragma once
#include "fit/fits.h"
#include "fit/model/lobes.h"
#include "reporter.h"

namespace srbf {

/// Factors of the terms beside that of pairs, see Extent.
struct Importances {
    double radiances = 0, pictures = 0;
    bool has_point_lights = false;  ///< whether the weights of pairs have those of point lights
};

/// Optimises on all observations, for spectral ones with the spectra. Checks that the fit exceeds become observations,
/// until none is exceeded. Then rounds.
PmFit finish(Lobes lobes, Observations all, const Importances& importance, const FitOptions& options,
             double log_peak_limit, const Reporter& reporter);

}  // namespace srbf
