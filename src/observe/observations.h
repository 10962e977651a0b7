// The observations of a measurement that a fit matches.
#pragma once
#include <array>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "brdf/values.h"
#include "observe/costs.h"
#include "srbf/objective.h"

namespace srbf {

/// An integral of f, as a quadrature: Σ_i weight_i f(wl_i, wv_i). With one wv, and solid angles times cosθl as weights,
/// it is the directional albedo; times the radiance of a light, what that light shows.
struct ObservedIntegral {
    std::vector<Vec3f> wl, wv;
    std::vector<Rgb> f;           ///< [1/sr]
    std::vector<double> weight;   ///< measure of the integral, ≥ 0
    std::vector<float> spectrum;  ///< of spectral observations: f at each wavelength, ≥ 0
    bool in_search = true;        ///< whether a search with few pairs has it too
    double cost = 1;              ///< of its relative error, beside the other integrals' costs
    double least_unit = 0;        ///< its errors are relative to its luminance, but to no less than this
    double noise_unit = 0;        ///< nor to less than this, which by every n-th direction is 1/√n of it
};
inline double luminance(const ObservedIntegral& of) {
    double sum = 0;
    for (std::size_t i = 0; i < of.wl.size(); ++i) sum += of.weight[i] * double(luminance(of.f[i]));
    return sum;
}

/// A pixel of a displayed picture, where 1 is white: Σ_i weight_i f(wl_i, wv), over the directions of its view from
/// `first` on.
struct ObservedPixel {
    std::size_t lighting = 0;  ///< index of the picture
    std::size_t first = 0;
    std::vector<float> weight;  ///< solid angle times cosθl, radiance and exposure [sr]
};
/// A point of a surface in pictures under several lights.
struct ObservedView {
    Vec3f wv;
    std::vector<Vec3f> wl;  ///< at most a block of the loops
    std::vector<Rgb> f;     ///< [1/sr], ≥ 0
    std::vector<ObservedPixel> pixels;
};

/// Weighted samples of a BRDF, in an order such that every prefix is a representative subset.
struct Observations {
    std::vector<Vec3f> wl, wv;
    std::vector<Rgb> f;          ///< [1/sr], ≥ 0
    std::vector<double> weight;  ///< w ≥ 0; a fit minimises Σ w |f−f̂|², scaled so that Σ w |f|² = 1
    /// For the objective appearance, and all but the bound pairs, otherwise empty: the weight w ≥ 0 of radiance in
    /// pictures by one light, up to a factor. A fit adds it to `weight` in its last stages.
    std::vector<double> point_light_weight;
    /// The last `bound_pairs` pairs only bound a fit from above: they are not part of Σ unless it exceeds them by far.
    std::size_t bound_pairs = 0;
    Objective objective = Objective::raw;     ///< that the weights are of
    double typical = 0;                       ///< the value of f or f cosθl to which they are relative
    std::vector<ObservedIntegral> integrals;  ///< that a fit also matches, from its first perturbation on
    double integral_error =
        k_albedo_error;  ///< an error of this share in every integral costs as much as the loss of the pairs
    std::vector<ObservedView> views;  ///< of pictures that a fit also matches, in its last stages
    std::uint64_t masked = 0;         ///< number of sampled pairs where nothing was measured
    std::uint64_t clamped = 0;        ///< number of negative channel values at sampled pairs
    /// No microfacet lobe has a smaller roughness; 0: samples are dense, as those of a table. See `least_roughness`.
    double least_roughness = 0;
    std::vector<float> wavelengths;  ///< C [nm] of spectral observations; otherwise empty
    std::vector<float> spectrum;     ///< f at each wavelength: observations × C [1/sr], ≥ 0

    std::size_t fitted() const { return f.size() - bound_pairs; }
    /// True if integrals are of noisy values.
    bool is_noisy() const;
    std::span<const float> spectrum_of(std::size_t i) const {
        return std::span(spectrum).subspan(i * wavelengths.size(), wavelengths.size());
    }
    void add(Vec3f l, Vec3f v, const Rgb& value, double its_weight, std::span<const float> its_spectrum = {});
    void append(const Observations& more);        ///< adds all pairs of `more` with their weights
    void exchange(std::size_t i, std::size_t k);  ///< swaps two of them
    void shuffle(std::mt19937_64& random);
    void resize(std::size_t count);  ///< to the first `count`
    /// Makes Σ w |f|² = 1; no change if it is 0.
    void normalise();
};

/// Σ w |f−f̂|² of what is fitted, without the bound pairs, against `fitted`.
double loss_of(const Observations& observations, const Evaluate& fitted);

/// Σ w f / Σ w of what is fitted; 0 without weight.
std::array<double, 3> mean_value(const Observations& observations);

/// The largest |f|² (cosθl cosθv)² of the pairs.
double largest_square(const Observations& observations);

/// The first `count` observations, without bound pairs, integrals and views: for searches and short fits.
Observations beginning(const Observations& observations, std::size_t count);

/// Returns an error unless there are at least as many values as `parameters` of the model, values and weights are finite,
/// and weights are at least 0, one of them above it.
Result<Done> validate(const Observations& observations, std::size_t parameters);

struct ObserveOptions {
    Objective objective = k_default_objective;
    double max_theta = 0;       ///< [rad], 1 to 89.9°; 0: the objective's default
    std::size_t count = 65536;  ///< maximum number of pairs, 1024..2^24; an eighth of them are horizon pairs
    std::uint64_t seed = 0;
    int threads = 0;  ///< 0: as many as the machine has; the result does not depend on it
    /// The measurement smoothed to its noise, see `smoothed`; null: the measurement itself.
    Evaluate smoothed = nullptr;
    double noise = 0;             ///< of a measurement that is smoothed, relative to dark values: `largest_share`
    bool horizon_albedos = true;  ///< of appearance: not for values that nobody measured
    /// The pool of pairs, the bound pairs about the mirror direction and the points of albedos are this many times fewer: for
    /// values interpolated between few samples, each of which takes a search.
    std::size_t fewer = 1;
};

/// θmax, or where it is 0 the objective's default. Errors: not within 1° to `k_horizon_theta`.
Result<double> valid_theta(Objective objective, double max_theta);

/// Samples eight times as many pairs as requested from a mixture that covers the features of a BRDF. Of these it
/// chooses half with probability proportional to their share of Σ w |f|² and half uniformly, weighted so that sums over
/// them estimate the objective's integrals over both caps. A pair that is chosen several times becomes one observation.
/// An eighth are *horizon pairs*: pairs between θmax and 89.9°, and of the grid to that angle, with small weights
/// proportional to (cosθl cosθv)². They keep the fit at the measurement's order of magnitude where it is not fitted.
/// After these follow the *bound pairs*: the grid, which includes the edges of the hemisphere, 32,768 pairs about the
/// mirror direction, and for appearance `brink_grid`. Integrals are the albedos at those of 0, 15, 30, 45, 60, 70, 75,
/// 80 and 85° that lie within θmax; for appearance to its default θmax also where cosθv is 0.03,
/// 0.01 and, unless the table diverges there, 0.003, over light to 89.9°. For appearance 100 views of a sphere follow,
/// under four extended and eleven single white lights of which none is one of `standard_lightings`. `f` may be negative
/// (see signed_value) or NaN.
/// Errors: no pair has a value; all values are 0; cancelled.
Result<Observations> observe(const Evaluate& f, const ObserveOptions& options, const ProgressToken& progress = {});

/// The weight of one of `count` horizon pairs. Errors of √`largest_square` at all of them would cost `importance`.
double horizon_weight(Vec3f wl, Vec3f wv, double importance, std::size_t count, double largest_square);

/// Makes `observations` spectral: adds the spectra whose colours they have, with negative values set to 0. `clamped`
/// then counts these instead of those of the colours.
void observe_spectra(Observations& observations, const Channels& spectra);

}  // namespace srbf
