// Weights of observations.
#pragma once
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "srbf/fit.h"

namespace srbf {

/// Definition of an objective: a row of the table in objective.cpp.
struct ObjectiveTraits {
    Objective objective;
    std::string_view name;
    double Measures::*measure;  ///< that it minimises
    double max_theta;           ///< default θmax [degrees]
    /// The weight of (f−f̂)² per solid angle of both directions, for a pair with mean `f` over its channels; `mean` is
    /// the mean f over both caps.
    double (*weight)(double f, double mean, double cos_l, double cos_v);
    bool of_small_errors;  ///< weights are accurate for small errors only; `large_error_weight` corrects them elsewhere
};
const ObjectiveTraits& traits(Objective objective);

/// If a highlight contains nearly all of Σ w |f|², the body under it, which dominates away from the mirror direction,
/// has almost no weight. The objective cosine therefore adds cube-root weights times cosθl cosθv, so that an error of
/// 100 % everywhere adds this fraction of Σ w |f|².
inline constexpr double k_body_importance = 5e-3;

/// Multiplies the weights of pairs (their solid angles) by the weights of the objective; `mean` as above.
void weigh(Objective objective, double mean, std::span<const Vec3f> wl, std::span<const Vec3f> wv,
           std::span<const Rgb> f, std::span<double> weight);

/// Sets negative channels to 0; returns how many.
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

/// Swaps two observations.
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

/// Normalises w so that Σ w |f|² = 1; no change if it is 0.
inline void normalise(Observations& observations) {
    const double energy = energy_of(observations.f, observations.weight);
    if (energy > 0)
        for (double& weight : observations.weight) weight /= energy;
}

/// Whether the measure of an objective is a root mean square, as opposed to a ratio of sums of squares.
bool is_root(Objective objective);

/// The cube-root weights are accurate for small errors. For a large error, f̂ = g, this is the correction factor that
/// makes the weighted square the actual error, Σ_c (∛f−∛g)² / Σ_c (f−g)² over the small-error weight; clamped to a
/// factor of `most`.
inline double large_error_weight(const Rgb& f, const Rgb& g, double mean, double most) {
    double roots = 0;
    for (int c = 0; c < 3; ++c) roots += std::pow(std::cbrt(double(f[c])) - std::cbrt(double(g[c])), 2);
    const double squares = square_of({f.r - g.r, f.g - g.g, f.b - g.b});
    const double small = std::pow(std::max(mean_of(f), 0.01 * mean), -4.0 / 3) / 9;
    return squares > 0 ? std::clamp(roots / squares / small, 1 / most, most) : 1;
}

/// Σ over the guards (observations beyond θmax) if the fit were off by the largest measured f cosθl cosθv at each of
/// them, relative to Σ w |f|².
inline constexpr double k_guard_importance = 1e-2;

}  // namespace srbf
