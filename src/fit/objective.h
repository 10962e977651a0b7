// Weights of observations.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "srbf/elementary.h"
#include "srbf/fit.h"

namespace srbf {

/// Definition of an objective: a row of the table in objective.cpp.
struct ObjectiveTraits {
    Objective objective;
    std::string_view name, summary;
    double Measures::*measure;  ///< that it minimises
    double max_theta;           ///< default θmax [degrees]
    /// The weight of (f−f̂)² per solid angle of both directions, for a pair with mean `f` over its channels; `typical`
    /// is their `typical_value`.
    double (*weight)(double f, double typical, double cos_l, double cos_v);
    /// Weights that are added for pairs which `weight` alone neglects: an error of 100 % everywhere adds to Σ w |f|²
    /// the share `importance` of it.
    struct Further {
        double (*weight)(double f, double typical, double cos_l, double cos_v) = nullptr;
        double importance = 0;
    };
    std::array<Further, 2> further{};  ///< null: none
    /// The g of an objective Σ (g(f) − g(f̂))² whose weights, squares of its slope, hold for small errors only;
    /// `large_error_weight` corrects them elsewhere. null: weights hold for errors of any size.
    double (*seen)(double f, double typical, double cos_l) = nullptr;
    double (*slope)(double f, double typical, double cos_l) = nullptr;
    bool of_pictures = false;  ///< relative to f cosθl, the radiance seen under a light; also observes extended lights
};
const ObjectiveTraits& traits(Objective objective);

/// The value to which an objective's weights are relative: the mean f, or for an objective of pictures the upper
/// quartile of f cosθl, weighted by cosθv, which a display exposed for the picture shows as bright. f by its mean over
/// the channels; `weight`: solid angles of the pairs. 0 if all of f is 0.
double typical_value(Objective objective, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<const Rgb> f,
                     std::span<const double> weight);

/// Multiplies the weights of pairs (their solid angles) by the weights of the objective.
void weigh(Objective objective, double typical, std::span<const Vec3f> wl, std::span<const Vec3f> wv,
           std::span<const Rgb> f, std::span<double> weight, int threads);

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
inline double squared_distance(const Rgb& a, const Rgb& b) { return square_of({a.r - b.r, a.g - b.g, a.b - b.b}); }
inline double largest_of(const Rgb& f) { return double(std::max({f.r, f.g, f.b})); }
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

/// For an objective whose weights hold for small errors, and a fitted value `fitted`: the factor that makes the
/// weighted square the actual error, Σ_c (g(f_c) − g(f̂_c))² / Σ_c (f_c−f̂_c)² over the square of g's slope; clamped to
/// a factor of `most`. 1 for the other objectives.
inline double large_error_weight(Objective objective, const Rgb& f, const Rgb& fitted, double typical, double cos_l,
                                 double most) {
    const ObjectiveTraits& of = traits(objective);
    if (!of.seen) return 1;
    double seen = 0;
    for (int c = 0; c < 3; ++c)
        seen += elementary::square(of.seen(double(f[c]), typical, cos_l) - of.seen(double(fitted[c]), typical, cos_l));
    const double squares = squared_distance(f, fitted);
    const double small = elementary::square(of.slope(mean_of(f), typical, cos_l));
    return squares > 0 ? std::clamp(seen / squares / small, 1 / most, most) : 1;
}

/// Multiplies the weights of the first `count` observations by their `large_error_weight` for what is fitted.
void weigh_large_errors(Observations& observations, std::size_t count, const Evaluate& fitted, double most);

/// Σ over the guards (observations beyond θmax) if the fit were off by the largest measured f cosθl cosθv at each of
/// them, relative to Σ w |f|².
inline constexpr double k_guard_importance = 1e-2;

}  // namespace srbf
