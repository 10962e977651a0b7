// The search for lobes on a sample of the observations.
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

/// Starts and kicks where none are asked for: fewer of more lobes, of which each takes longer and matters less.
inline int starts_of(const FitOptions& options) {
    return options.starts.value_or(std::clamp(128 / std::max(options.lobes, 1), 16, 20));
}
inline int kicks_of(const FitOptions& options) {
    return options.kicks.value_or(std::clamp(1600 / std::max(options.lobes * options.lobes, 1), 25, 45));
}

/// The same fit with no more starts and kicks than these: for a look at what it will come to.
inline FitOptions in_short(FitOptions options, int starts, int kicks) {
    options.starts = std::min(starts_of(options), starts);
    options.kicks = std::min(kicks_of(options), kicks);
    return options;
}

/// Numbers that a fit is free to choose.
inline std::size_t parameter_count(const FitOptions& options) {
    return std::size_t(options.lobes * (3 + shape_of(options).width()) + 2 * options.variates);
}

/// The random numbers of a stage of a start.
std::mt19937_64 generator(std::uint64_t seed, int start, int stage);

/// The parameterizations to start from: half-way vector, light, view (Tsai 2009), the half-way vector once more, since a peak
/// sharper than a half's largest bandwidth takes two, further ones at random. In every other start those of light and view are turned by up to a
/// radian, since some optima lie far from both, and of three the last is the half-way vector.
Lobes without_lobes(const LobeShape& shape, int start, std::mt19937_64& random);

/// A lobe drawn at random: weights of either sign, even in the logarithm, some of them 0; or one of `lobes`
/// disturbed. Half of the centres that are free to are at a pole all the same, the others even over the sphere.
std::vector<double> random_lobe(std::mt19937_64& random, const Lobes& lobes);

/// A fit on its way.
struct Candidate {
    int start = 0;  ///< which of the starts it grew from; chooses its random numbers, beside the seed
    Lobes lobes;
    double loss = std::numeric_limits<double>::infinity();  ///< the one last known
    int kicks = 0;                                          ///< attempts to replace a lobe or a variate so far
};

/// Grows J lobes one by one.
Candidate grow(const Rows& rows, const FitOptions& options, double log_peak_limit, int start, Reporter& reporter);

/// Goes on from where it was, maybe with other rows; then again and again drops the lobe that costs least, adds another, and keeps what is better, until the candidate has had so many kicks.
/// Every fourth is of a variate instead.
void improve(const Rows& rows, const FitOptions& options, double log_peak_limit, int until, Candidate& candidate,
             Reporter& reporter);

/// Goes on with more rows; lobes that turn out to be of no use are replaced.
void polish(const Rows& rows, const FitOptions& options, double log_peak_limit, Candidate& candidate);

}  // namespace srbf
