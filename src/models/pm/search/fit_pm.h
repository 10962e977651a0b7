// The fit of a multivariate model to observations.
#pragma once
#include <cmath>

#include "models/kind/kind.h"
#include "models/pm/solve/lobes.h"
#include "observe/observations.h"
#include "srbf/metrics.h"
#include "srbf/models/pm.h"
#include "srbf/progress.h"
#include "srbf/result.h"

namespace SRBF_NAMESPACE {

/// Options of `fit_pm`. Form, lobes and variates come from the request by `pm_options` (fit/requests.h).
struct PmFitOptions {
    PmForm form = PmForm::extended;
    bool axial = true;  ///< only centres at +z or −z, sufficient for isotropic data
    int lobes = 8;      ///< J, 1..k_max_fitted_lobes
    int variates = 4;   ///< N, 1..k_max_variates
    /// Upper bound 1/finest² on bandwidths, and 1/finest [1/rad] on other exponents; 0: the range of 16-bit floats.
    double finest = 0;
    /// Number of starts: independent growths of J lobes. The stages in fit_pm.cpp say how many of them continue. None:
    /// `starts_of`.
    std::optional<int> starts = {};
    /// Maximum number of perturbations of a candidate. Each replaces the least useful lobe; every fourth one replaces
    /// the least useful variate instead. The tables of `Perturbations` in fit_pm.cpp distribute them. None:
    /// `perturbations_of`.
    std::optional<int> perturbations = {};
    /// A factor of the numbers of starts and perturbations; at least one start remains.
    double effort = 1;
    /// Limit on the directional albedo in every channel, to cosθv = 0.001; infinity: there is none. None: 1 in a
    /// reciprocal form, infinity in others.
    std::optional<double> albedo_limit = {};
    std::uint64_t seed = 0;
    int threads = 0;  ///< number of threads; 0: all of the machine. The result does not depend on it
};

/// `loss` is the sum L of docs/fitting.md: Σ w |f−f̂|² over pairs, including horizon pairs and exceeded bound pairs,
/// the errors of integrals and, if views are observed, of pixels.
struct PmFit : Fitted<PmModel> {
    StopReason stop = StopReason::converged;
    double delta_e = 0;  ///< mean ΔE_ITP of the pixels of views, if there are any
};

/// Fits parameterized multivariate SRBFs by separable least squares. For given centres, bandwidths and
/// parameterizations the coefficients solve a non-negative linear problem. Levenberg-Marquardt minimises the remaining
/// residual over the other parameters (Kaufman 1975). Lobes are grown one by one. Spectral observations are first
/// fitted by their colours; these lobes and colours remain, and the lobes then get spectra. Details: docs/fitting.md.
/// If `initial_model` is given, there is no search: its lobes are polished, after it has grown to `lobes` of them. It
/// must have this form and number of variates, and no more lobes. Returns an error if options are out of range,
/// observations fewer than parameters, or values not finite.
Result<PmFit> fit_pm(const Observations& observations, const PmFitOptions& options, const ProgressToken& progress = {},
                     const PmModel* initial_model = nullptr);

/// Fits spectra to the observations for the lobes of `fit`, a fit to their colours or to the gap-filled table. Lobes
/// and colours remain.
PmFit with_spectra(PmFit fit, const Observations& observations, const PmFitOptions& options);

inline LobeShape shape_of(const PmFitOptions& options) {
    return {options.form, options.variates, options.axial, options.finest};
}

inline constexpr int k_max_starts = 1000;
inline constexpr int k_many_starts = 12;  ///< the fewest of a default fit

/// Default numbers of starts and perturbations. Fits with more lobes use fewer, because each takes longer and
/// matters less.
inline int starts_of(const PmFitOptions& options) {
    const int lobes = std::max(options.lobes, 1);
    const int starts = options.starts.value_or(is_reciprocal(options.form) ? std::clamp(96 / lobes, k_many_starts, 16)
                                                                           : std::clamp(128 / lobes, 16, 20));
    return std::clamp(int(std::lround(options.effort * starts)), 1, k_max_starts);
}
inline int perturbations_of(const PmFitOptions& options) {
    const int perturbations =
        options.perturbations.value_or(std::clamp(1600 / std::max(options.lobes * options.lobes, 1), 25, 45));
    return int(std::lround(options.effort * perturbations));
}

/// True if each start of the search gets half of the random lobes and pairs. Forms that are not reciprocal have more
/// local minima, and a fit with few starts depends more on each.
inline bool has_short_search(const PmFitOptions& options) {
    return is_reciprocal(options.form) && starts_of(options) >= k_many_starts;
}

/// `options` with at most this many starts and perturbations, for a quick fit that estimates the result of a full one.
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

}  // namespace
