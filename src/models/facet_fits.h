// Fits of models of microfacets to what was observed.
#pragma once
#include "observe/observations.h"
#include "srbf/fit.h"
#include "srbf/model.h"
#include "srbf/progress.h"
#include "srbf/result.h"

namespace srbf {

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

struct PbrFit {
    PbrModel model;      ///< every number rounded to a 16-bit float
    PbrModel unrounded;  ///< before rounding
    double loss = 0;     ///< the mean over pixels of ρ(ΔE_ITP), or without pictures Σ w |f−f̂|², of `model`
    double unrounded_loss = 0;  ///< of `unrounded`
};

/// Fits a surface of renderers' parameters by Levenberg-Marquardt from those of some two thousand surfaces that come
/// nearest, and from the best under films: to the pixels of the observed pictures, or where there are none to the pairs,
/// whose weights are adapted to large errors. Parts without which the loss, once the others have adapted, rises by less
/// than 1 % are left at their defaults.
/// Errors: fewer observations than parameters, values that are not finite; cancelled.
Result<PbrFit> fit_pbr(const Observations& observations, const PbrFitOptions& options,
                       const ProgressToken& progress = {});

}  // namespace srbf
