// The search for lobes on subsets of the observations.
#pragma once
#include <limits>
#include <random>

#include "fit/lobes.h"
#include "reporter.h"

namespace srbf {

inline LobeShape shape_of(const FitOptions& options) {
    return {options.form, options.variates / (options.reciprocal ? 2 : 1), options.axial, options.reciprocal,
            options.finest};
}

/// Default numbers of starts and perturbations. Fits of more lobes have fewer, since each takes longer and matters
/// less.
inline int starts_of(const FitOptions& options) {
    return options.starts.value_or(std::clamp(128 / std::max(options.lobes, 1), 16, 20));
}
inline int perturbations_of(const FitOptions& options) {
    return options.perturbations.value_or(std::clamp(1600 / std::max(options.lobes * options.lobes, 1), 25, 45));
}

/// The same options with at most this many starts and perturbations: a short fit that estimates what a full one will
/// reach.
inline FitOptions in_short(FitOptions options, int starts, int perturbations) {
    options.starts = std::min(starts_of(options), starts);
    options.perturbations = std::min(perturbations_of(options), perturbations);
    return options;
}

/// Number of free parameters of a fit.
inline std::size_t parameter_count(const FitOptions& options) {
    return std::size_t(options.lobes * (3 + shape_of(options).width()) + 2 * options.variates);
}

/// The random generator of one stage of one start.
std::mt19937_64 generator(std::uint64_t seed, int start, int stage);

/// Initial parameterizations: half vector, light, view (Tsai 2009), the half vector again (a peak narrower than the
/// largest bandwidth in 16 bits needs two), further ones at random. In every other start those of light and view are
/// rotated by up to a radian, since some optima are far from both, and of three the last is the half vector.
Lobes without_lobes(const LobeShape& shape, int start, std::mt19937_64& random);

/// A random lobe: weights of either sign, log-uniform, some of them 0; or a perturbed copy of one of `lobes`. Half of
/// the general centres are poles, the others uniform on the sphere.
std::vector<double> random_lobe(std::mt19937_64& random, const Lobes& lobes);

/// A candidate of the search.
struct Candidate {
    int start = 0;  ///< index of its start, which determines its random numbers together with the seed
    Lobes lobes;
    double loss = std::numeric_limits<double>::infinity();  ///< most recent value
    int perturbations = 0;                                  ///< number of perturbations so far
};

/// Numbers of the search, on every device.
inline constexpr int k_candidates = 256;
/// Number of steps after each lobe that is grown except the last, and after the last.
inline constexpr int k_growth_steps = 6, k_grown_steps = 12;
inline constexpr int k_first_steps = 6, k_perturbation_steps = 12, k_polish_steps = 25, k_polish_attempts = 3;
/// Number of lobe perturbations per variate perturbation.
inline constexpr int k_lobe_perturbations = 3;
/// A lobe whose absence would cost less than this share of the loss is useless.
inline constexpr double k_useless = 1e-4;

/// Random lobes to choose an additional one from.
std::vector<std::vector<double>> random_candidates(std::mt19937_64& random, const Lobes& lobes);
/// The lobes with another one: `lobe`, or one of weights 0 if it is empty.
Lobes with_lobe(Lobes lobes, const std::vector<double>& lobe);
Lobes without_lobe(Lobes lobes, std::ptrdiff_t j);
/// The lobes with the weights of variate n set to 0.
Lobes without_variate(Lobes lobes, int n);

/// Grows J lobes one by one.
Candidate grow(const Rows& rows, const FitOptions& options, double log_peak_limit, int start, Reporter& reporter);

/// Optimises the candidate on the problem, possibly on other rows than before. Then applies perturbations until the
/// candidate has had `until` of them: each drops the least useful lobe and adds another, and is kept if the loss falls.
/// Every fourth one replaces a variate instead.
void improve(const Rows& rows, const FitOptions& options, double log_peak_limit, int until, Candidate& candidate,
             Reporter& reporter);

/// Optimises on more rows; lobes that become useless there are replaced.
void polish(const Rows& rows, const FitOptions& options, double log_peak_limit, Candidate& candidate);

/// Optimises on rows with views. The candidate's loss becomes the mean ΔE_ITP of their pixels.
void see(const Rows& rows, const FitOptions& options, double log_peak_limit, int steps, Candidate& candidate);

}  // namespace srbf
