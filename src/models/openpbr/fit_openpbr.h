// The fit of a surface of renderers' parameters to what was observed.
#pragma once
#include "observe/observations.h"
#include "srbf/models/openpbr.h"
#include "srbf/progress.h"
#include "srbf/result.h"

namespace srbf {

struct OpenPbrFitOptions {
    OpenPbrSurfaceKind surface =
        OpenPbrSurfaceKind::openpbr;  ///< whose parameters are fitted; others keep their defaults
    bool is_isotropic = true;         ///< no anisotropy is fitted
    int threads = 0;                  ///< 0: as many as the machine has; the result does not depend on it
};

struct OpenPbrFit {
    OpenPbrModel model;      ///< every number rounded to a 16-bit float
    OpenPbrModel unrounded;  ///< before rounding
    double loss = 0;         ///< the mean over pixels of ρ(ΔE_ITP), or without pictures Σ w |f−f̂|², of `model`
    double unrounded_loss = 0;  ///< of `unrounded`
};

/// Fits a surface of renderers' parameters by Levenberg-Marquardt from those of some two thousand surfaces that come
/// nearest, and from the best under films: to the pixels of the observed pictures, or where there are none to the pairs,
/// whose weights are adapted to large errors. Parts without which the loss, once the others have adapted, rises by less
/// than 1 % are left at their defaults.
/// Errors: fewer observations than parameters, values that are not finite; cancelled.
Result<OpenPbrFit> fit_openpbr(const Observations& observations, const OpenPbrFitOptions& options,
                               const ProgressToken& progress = {});

}  // namespace srbf
