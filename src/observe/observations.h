// Observations of a measurement, which a fit matches.
#pragma once
#include <random>

#include "brdf/values.h"
#include "srbf/brdf.h"
#include "srbf/metrics.h"

namespace SRBF_NAMESPACE {

// ---- The costs of the terms of a loss, for fits of tables: "The objective" in docs/fitting.md ----

// Weights of pairs: the loss of a 100 % error everywhere under a term, as a fraction of that under the objective's own.
inline constexpr double k_highlights = 1;  ///< weight of cube roots in appearance, for values that a display clips
inline constexpr double k_peaks = 0.3;     ///< weight of squares in appearance
/// The weight of cube roots in objective cosine. Without it the diffuse base under a highlight has almost no weight.
inline constexpr double k_diffuse_base = 5e-3;
/// Cost of an error at all horizon pairs (beyond θmax) as large as the largest measured f cosθl cosθv.
inline constexpr double k_horizon_importance = 1e-2;

/// The cost of pixels, as a multiple of the loss of the fit without them.
inline constexpr double k_pixels = 3.5;

/// A relative error of this size in every albedo costs as much as the fit's loss without albedos; the two values
/// are for fits without and with pixels. The cost is proportional to 1 over the square of the value.
inline constexpr double k_albedo_error = 0.1, k_albedo_error_with_pixels = 0.02;
/// The error of albedos of noisy tables. An albedo is the sum of thousands of values, and more certain than any of
/// them. The error falls with the fourth power of the noise; it is least where the noise is at least this fraction
/// of a channel's dark values (docs/notes/noise.md).
inline constexpr double k_albedo_error_of_noise = 0.003, k_noise_of_least_albedo_error = 0.5;
inline double albedo_error_of_noise(double noise) {
    const double ratio = k_noise_of_least_albedo_error / noise, square = ratio * ratio;
    return std::clamp(square * square * k_albedo_error_of_noise, k_albedo_error_of_noise, k_albedo_error_with_pixels);
}
/// Upper limit of the loss that scales the cost of albedos: a bad fit gains nothing from an albedo right by chance.
inline constexpr double k_max_albedo_loss = 0.004;
/// Errors of albedos near the horizon are relative to at least this value: few pixels show them. With smaller
/// values (0.3 to 0.5) ΔE_ITP rose.
inline constexpr double k_horizon_albedo = 1;

/// View by view: an error of 1 % in the radiances under a view's four lights costs 1e-4 times this in each channel.
inline constexpr double k_lights_of_view = 12;
/// View by view: the cost per solid angle of directions between the matrix's directions, relative to the latter.
inline constexpr double k_between_views_directions = 0.1;

// ---- Observations ----

/// An integral of f, as a quadrature: Σ_i weight_i f(wl_i, wv_i). If all wv are equal and the weights are solid
/// angles times cosθl, it is the directional albedo. If the weights also contain the radiance of a light, it is the
/// radiance reflected under that light.
struct ObservedIntegral {
    std::vector<Vec3f> wl, wv;
    std::vector<Rgb> f;          ///< [1/sr]
    std::vector<double> weight;  ///< weights of the quadrature, ≥ 0
    bool in_search = true;       ///< also used by a search, which has few pairs
    double cost = 1;             ///< cost of its relative error, compared with the costs of other integrals
    bool is_bound = false;       ///< true for a bound that a fit exceeded, whose cost does not lower the others
    double min_unit = 0;         ///< its errors are relative to its luminance, or to this if this is larger
    /// for noisy values: errors are relative to at least noise_unit / √n if every n-th direction is kept
    double noise_unit = 0;
};
inline double luminance(const ObservedIntegral& integral) {
    double sum = 0;
    for (std::size_t i = 0; i < integral.wl.size(); ++i) sum += integral.weight[i] * double(luminance(integral.f[i]));
    return sum;
}

/// A pixel of a displayed picture, where 1 is white: Σ_i weight_i f(wl_i, wv_i) over its view's directions from `first`.
struct ObservedPixel {
    std::size_t lighting = 0;  ///< index of the picture
    std::size_t first = 0;
    std::vector<float> weight;  ///< solid angle times cosθl, radiance and exposure [sr]
};
/// A surface point in pictures under several lights.
struct ObservedView {
    Vec3f wv;
    std::vector<Vec3f> wl;  ///< no more than a block of the loops
    std::vector<Rgb> f;     ///< [1/sr], ≥ 0
    std::vector<ObservedPixel> pixels;
};

/// Weighted samples of a BRDF, in an order such that every prefix is a representative subset.
struct Observations {
    std::vector<Vec3f> wl, wv;
    std::vector<Rgb> f;          ///< [1/sr], ≥ 0
    std::vector<double> weight;  ///< w ≥ 0; a fit minimises Σ w |f−f̂|², scaled so that Σ w |f|² = 1
    /// The last `bound_pairs` pairs only bound a fit from above: they join the sum only if the fit exceeds them by far.
    std::size_t bound_pairs = 0;
    Objective objective = Objective::raw;     ///< the objective of the weights
    double typical = 0;                       ///< the value of f or f cosθl to which the weights are relative
    std::vector<ObservedIntegral> integrals;  ///< also matched by a fit, from its first perturbation on
    /// A relative error of this size in every integral costs as much as the loss of the pairs.
    double integral_error = k_albedo_error;
    std::vector<ObservedView> views;  ///< points of pictures, also matched by a fit in its last stages
    std::uint64_t masked = 0;         ///< number of sampled pairs where nothing was measured
    std::uint64_t clamped = 0;        ///< number of negative channel values at sampled pairs
    /// Lower bound on the roughness of microfacet lobes (`observe_samples.h`); 0: samples are as dense as a table's.
    double min_roughness = 0;
    std::vector<float> wavelengths;  ///< [nm] C wavelengths of spectral observations; otherwise empty
    std::vector<float> spectrum;     ///< f at each wavelength: observations × C [1/sr], ≥ 0

    std::size_t fitted_count() const { return f.size() - bound_pairs; }
    /// True if integrals are sums of noisy values.
    bool is_noisy() const;
    /// True if the channels of each colour are equal.
    bool is_grey() const;
    void add(Vec3f l, Vec3f v, const Rgb& value, double value_weight, std::span<const float> value_spectrum = {});
    void append(const Observations& added);  ///< appends its pairs; spectra if this has wavelengths
    void swap_rows(std::size_t i, std::size_t k);
    void shuffle(std::mt19937_64& random);
    void resize(std::size_t count);  ///< keeps the first `count`
    /// Makes Σ w |f|² = 1; no change if it is 0.
    void normalise();
};

/// Σ w |f−f̂|² of the observations without the bound pairs, f̂ the values of `fitted`.
double loss_of(const Observations& observations, const Evaluate& fitted);

/// Σ w f / Σ w over the observations without the bound pairs; 0 if all weights are 0.
std::array<double, 3> mean_value(const Observations& observations);

/// The largest |f|² (cosθl cosθv)² of the pairs.
double largest_square(const Observations& observations);

/// The first `count` observations, without bound pairs, integrals and views: for searches and quick fits.
Observations first_pairs(const Observations& observations, std::size_t count);

/// Checks the input of a fit. Returns an error if there are fewer values than `parameters` of the model, if values or
/// weights are not finite, or if weights are negative or all 0.
Result<Done> validate(const Observations& observations, std::size_t parameters);

struct ObserveOptions {
    Objective objective = k_default_objective;
    double max_theta = 0;       ///< [rad], from 1° to 89.9°; 0: the objective's default
    std::size_t count = 65536;  ///< maximum number of pairs, 1024..2^24; an eighth of them are horizon pairs
    std::uint64_t seed = 0;
    int threads = 0;  ///< number of threads; 0: all of the machine. The result does not depend on it
    /// The measurement, smoothed to its noise (see `smoothed`); null: use the measurement itself.
    Evaluate smoothed = nullptr;
    double noise = 0;             ///< noise of a smoothed measurement relative to its dark values, `largest_fraction`
    bool horizon_albedos = true;  ///< appearance: albedos near the horizon; false if values there were not measured
    /// Divides the sizes of the pool, of the bound pairs around the mirror direction and of the albedos'
    /// quadratures. It is above 1 for values interpolated between samples, each of which needs a search.
    std::size_t fewer = 1;
};

/// θmax, or the objective's default if it is 0. Returns an error if it is not between 1° and `k_horizon_theta`.
Result<double> valid_theta(Objective objective, double max_theta);

/// Chooses the observations of a table. `f` may be negative (see signed_value) or NaN.
///
/// Draws eight times as many pairs as requested from a mixture that covers the features of a BRDF. Half of the
/// observations are chosen from them with probability proportional to their fraction of Σ w |f|², half uniformly;
/// their weights make sums over them estimate the objective's integrals over both caps. A pair that is chosen
/// several times becomes one observation.
///
/// An eighth are *horizon pairs*: pairs between θmax and 89.9°, and of the grid up to that angle, with small weights
/// proportional to (cosθl cosθv)². They keep the fit at the measurement's order of magnitude where it is not fitted.
///
/// The *bound pairs* follow: the grid, which includes the edges of the hemisphere, 32,768 pairs around the mirror
/// direction, and for appearance `grazing_grid`.
///
/// The integrals are the albedos at 0, 15, 30, 45, 60, 70, 75, 80 and 85°, as far as these lie within θmax.
/// Appearance with its default θmax adds albedos where cosθv is 0.03, 0.01 and, unless the table diverges there,
/// 0.003, for light up to 89.9°.
///
/// Appearance adds 100 views of a sphere under four extended and eleven directional white lights, none of which is
/// one of `standard_lightings`.
///
/// Returns an error if no pair has a value above 0, or if it is cancelled.
Result<Observations> observe(const Evaluate& f, const ObserveOptions& options, const ProgressToken& progress = {});

/// The weight of one of `count` horizon pairs. An error of √`largest_square` at all of them costs `importance`.
double horizon_weight(Vec3f wl, Vec3f wv, double importance, std::size_t count, double largest_square);

/// Adds to `observations` the spectra that belong to their colours, with negative values set to 0. `clamped` then
/// counts negative values of spectra instead of colours.
void observe_spectra(Observations& observations, const Channels& spectra);

/// Views at points of equal area over the disc of a sphere, under extended and directional lights, none of which is
/// one of `standard_lightings`. Pairs with a direction beyond θmax [rad] or without a measurement are dark.
std::vector<ObservedView> observe_views(const Evaluate& f, double theta_max, int threads);

/// The albedos that `observe` lists, up to θmax [rad]. Every second one takes part in a search.
std::vector<ObservedIntegral> observe_albedos(const Evaluate& f, const ObserveOptions& options, double theta_max);

/// (cosθv f(ωl, ωv) + cosθl f(ωv, ωl)) / (cosθv + cosθl) [1/sr]. Instruments
/// measure f cosθ; this averages the measured signals, so the value with the larger cosine counts most.
/// Where only one of the two was measured, the mean is that one.
Evaluate reciprocal_mean(Evaluate f);
Channels reciprocal_mean(Channels f);

}  // namespace
