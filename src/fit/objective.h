// What an observation weighs.
#pragma once
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "srbf/fit.h"

namespace srbf {

/// What an objective is: a row of the table in objective.cpp.
struct ObjectiveTraits {
    Objective objective;
    std::string_view name;
    double Measures::*measure;  ///< that it minimises
    double max_theta;           ///< θmax by default [degrees]
    /// The weight of (f−f̂)² per solid angle of both directions, where the channels of f have mean `f`; `mean` is that of all
    /// f over both caps.
    double (*weight)(double f, double mean, double cos_l, double cos_v);
    bool
        of_small_errors;  ///< the weights hold for small errors; where errors stay large, `large_error_weight` corrects them
};
const ObjectiveTraits& traits(Objective objective);

/// Where a highlight holds nearly all of Σ w |f|², nothing asks for the body under it, which is what one sees wherever the light is not reflected.
/// The objective cosine does so by weights of the cube root times cosθl cosθv: off by all of f everywhere costs this much of Σ w |f|² besides.
inline constexpr double k_body_importance = 5e-3;

/// Multiplies the weights of pairs, their solid angles, by what the objective asks for there; `mean` as above.
void weigh(Objective objective, double mean, std::span<const Vec3f> wl, std::span<const Vec3f> wv,
           std::span<const Rgb> f, std::span<double> weight);

/// Negative channels become 0; returns how many.
inline int clamp_negative(Rgb& f) {
    int clamped = 0;
    for (int c = 0; c < 3; ++c) {
        clamped += f[c] < 0;
        f[c] = std::max(f[c], 0.f);
    }
    return clamped;
}

inline int clamp_negative(std::span<float> f) {
    int clamped = 0;
    for (float& x : f) {
        clamped += x < 0;
        x = std::max(x, 0.f);
    }
    return clamped;
}

/// Two observations in each other's place.
inline void exchange(Observations& observations, std::size_t i, std::size_t k) {
    if (i == k) return;
    std::swap(observations.wl[i], observations.wl[k]);
    std::swap(observations.wv[i], observations.wv[k]);
    std::swap(observations.f[i], observations.f[k]);
    std::swap(observations.weight[i], observations.weight[k]);
    const std::size_t C = observations.wavelengths.size();
    const auto spectrum = observations.spectrum.begin();
    std::swap_ranges(spectrum + std::ptrdiff_t(i * C), spectrum + std::ptrdiff_t((i + 1) * C),
                     spectrum + std::ptrdiff_t(k * C));
}

inline double square_of(const Rgb& f) { return double(f.r) * f.r + double(f.g) * f.g + double(f.b) * f.b; }
inline double mean_of(const Rgb& f) { return (double(f.r) + double(f.g) + double(f.b)) / 3; }

/// Σ w |f|².
inline double energy_of(std::span<const Rgb> f, std::span<const double> weight) {
    double energy = 0;
    for (std::size_t i = 0; i < f.size(); ++i) energy += weight[i] * square_of(f[i]);
    return energy;
}

/// w so that Σ w |f|² = 1; where it is 0 they stay.
inline void normalise(Observations& observations) {
    const double energy = energy_of(observations.f, observations.weight);
    if (energy > 0)
        for (double& weight : observations.weight) weight /= energy;
}

/// Whether the measure of an objective is the root of a mean square, not a ratio of sums of squares.
bool is_root(Objective objective);

/// The cube root's weights are those of small errors. Where f̂ = g errs by much, this is what they are to be multiplied by, to make the weighted
/// square what the error is: Σ_c (∛f−∛g)² / Σ_c (f−g)² over the weight of a small one; as far as a factor `most`.
inline double large_error_weight(const Rgb& f, const Rgb& g, double mean, double most) {
    double roots = 0;
    for (int c = 0; c < 3; ++c) roots += std::pow(std::cbrt(double(f[c])) - std::cbrt(double(g[c])), 2);
    const double squares = square_of({f.r - g.r, f.g - g.g, f.b - g.b});
    const double small = std::pow(std::max(mean_of(f), 0.01 * mean), -4.0 / 3) / 9;
    return squares > 0 ? std::clamp(roots / squares / small, 1 / most, most) : 1;
}

/// Σ over the guards, the observations beyond θmax, relative to Σ w |f|², if the fit were off by the largest measured
/// f cosθl cosθv at each of them.
inline constexpr double k_guard_importance = 1e-2;

}  // namespace srbf
