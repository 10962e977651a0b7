// Numbers derived from the options of a multivariate fit.
#pragma once
#include <algorithm>
#include <cmath>

#include "models/pm/search/fit_pm.h"
#include "models/pm/solve/lobes.h"

namespace SRBF_NAMESPACE {

inline LobeShape shape_of(const PmFitOptions& options) {
    return {options.form, options.variates, options.axial, options.finest};
}

inline constexpr int k_most_starts = 1000;

/// Default numbers of starts and perturbations. Fits with more lobes use fewer, because each takes longer and
/// matters less.
inline int starts_of(const PmFitOptions& options) {
    const int starts = options.starts.value_or(std::clamp(128 / std::max(options.lobes, 1), 16, 20));
    return std::clamp(int(std::lround(options.effort * starts)), 1, k_most_starts);
}
inline int perturbations_of(const PmFitOptions& options) {
    const int perturbations =
        options.perturbations.value_or(std::clamp(1600 / std::max(options.lobes * options.lobes, 1), 25, 45));
    return int(std::lround(options.effort * perturbations));
}

/// `options` with at most this many starts and perturbations, for a quick fit that estimates the result of a full
/// one.
inline PmFitOptions quick_options(PmFitOptions options, int starts, int perturbations) {
    options.starts = std::min(starts_of(options), starts);
    options.perturbations = std::min(perturbations_of(options), perturbations);
    options.effort = 1;
    return options;
}

/// Number of free parameters of a fit.
inline std::size_t parameter_count(const PmFitOptions& options) {
    return std::size_t(options.lobes * (3 + shape_of(options).width()) + 2 * options.variates);
}

}  // namespace srbf
