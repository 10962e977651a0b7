// From scattered samples to models, and what these are worth away from the samples: level 4.
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "srbf/fit.h"
#include "srbf/measured.h"
#include "srbf/metrics.h"

namespace srbf {

/// The fold, 0..k_folds−1, that each sample is left out with. Samples within `k_same_place` of each other are left out together, be it that one
/// is the other with light and viewer exchanged, or, of isotropic samples, turned or mirrored. Places within max_theta [rad] that are next in
/// brightness go to different folds, at random otherwise: a highlight is not left out as a whole.
/// Errors: fewer than k_folds places.
Result<std::vector<int>> draw_folds(const Scattered& samples, double max_theta, std::uint64_t seed);
inline constexpr int k_folds = 5;
inline constexpr double k_same_place = 0.5 * k_degree;  ///< √(|Δωl|² + |Δωv|²), to first order
/// The samples of all folds but this one.
Scattered without_fold(const Scattered& samples, std::span<const int> fold, int left_out);

/// How far apart samples are where they are densest [rad]: of the distances of places to their nearest neighbours, as in
/// `draw_folds`, that which a twentieth of them are below. 0 where there is one place.
double spacing(const Scattered& samples);

struct ObserveSamplesOptions {
    Objective objective = Objective::cosine;
    double max_theta = 0;  ///< [rad], in (0, π/2); 0: the objective's default
    std::uint64_t seed = 0;
    bool spectral = false;  ///< the spectra of spectral samples as well, not their colours alone
};

/// Samples made ready for fits. Each counts once as it is and once with light and viewer exchanged.
struct SampleObservations {
    ObserveSamplesOptions options;
    Observations samples;    ///< within θmax, and guards and checks beyond
    Observations between;    ///< interpolated values on a grid of pairs within θmax, their Σ w |f|² = 1
    Measures interpolation;  ///< of interpolation, at samples left out
    double finest = 0;       ///< a lobe may not be narrower [rad]: the samples' spacing
    std::size_t places = 0;  ///< within θmax where samples are
};
/// Errors: no sample within θmax, all of them 0; fewer than k_folds places; spectra asked of samples without;
/// cancelled.
Result<SampleObservations> observe(const Scattered& samples, const ObserveSamplesOptions& options,
                                   const ProgressToken& progress = {});

struct SampleFitOptions {
    FitOptions pm;
    /// Whether the fit also follows what is interpolated between the samples. A short fit without tells what error remains; the grid then
    /// weighs as that error to the one of interpolation, at most 1. It holds lobes where samples are wide apart, and misleads where
    /// a fit knows better: cross-validation tells.
    bool fill = false;
};

/// Fits parameterized multivariate SRBFs, of no lobe narrower than the samples' spacing. Errors: those of `fit_pm`; at fewer places
/// than a third of the parameters, each being three values.
Result<PmFit> fit_pm(const SampleObservations& observations, const SampleFitOptions& options,
                     const ProgressToken& progress = {});

/// Models fitted to samples, as many each time; it may be called from several threads at once.
using FitToSamples = std::function<Result<std::vector<Model>>(const Scattered& training)>;
/// f̂ of each of the models at every sample, fitted to the other folds: [model][sample C + c], of the models' `channels`.
Result<std::vector<std::vector<float>>> cross_validate(const Scattered& samples, std::span<const int> fold,
                                                       const FitToSamples& fit);

}  // namespace srbf
