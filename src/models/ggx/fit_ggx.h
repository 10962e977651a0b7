// The fit of Lambert and GGX to what was observed.
#pragma once
#include "observe/observations.h"
#include "srbf/models/ggx.h"
#include "srbf/progress.h"
#include "srbf/result.h"

namespace srbf {

struct GgxFitOptions {
    int lobes = 1;    ///< 1..k_most_ggx_lobes
    int threads = 0;  ///< 0: as many as the machine has; the result does not depend on it
};

struct GgxFit {
    GgxModel model;             ///< every number rounded to a 16-bit float
    GgxModel unrounded;         ///< before rounding
    double loss = 0;            ///< Σ w |f−f̂|² over the observations, before the linear parameters are rounded
    double unrounded_loss = 0;  ///< loss of `unrounded`
};

/// Fits Lambert and GGX, with no roughness below the observations' least. For given roughness all other parameters
/// solve a non-negative linear problem. Roughness is optimised by pattern search, from the best value on a grid of half
/// octaves, evaluated on a subset. Albedos and bound pairs are not used.
/// Errors: options out of range, fewer observations than parameters, values that are not finite; cancelled.
Result<GgxFit> fit_ggx(const Observations& observations, const GgxFitOptions& options,
                       const ProgressToken& progress = {});

}  // namespace srbf
