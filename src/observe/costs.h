// The costs of the terms of a loss, for all fits of tables, which `srbf explain` prints. See "The objective" in
// docs/fitting.md.
#pragma once
#include <algorithm>
#include <cstddef>

namespace srbf {

// Weights of pairs: an error of 100 % of all pairs by these, relative to one by the objective's own weights.
inline constexpr double k_highlights = 1;  ///< appearance: cube roots, for what a display clips
inline constexpr double k_peaks = 0.03;    ///< appearance: squares; one seed of ten had a peak of its own without
/// Cosine: cube roots, without which the diffuse base under a highlight has hardly any weight.
inline constexpr double k_diffuse_base = 5e-3;
/// An error at all horizon pairs (beyond θmax) of the largest measured f cosθl cosθv.
inline constexpr double k_horizon_importance = 1e-2;

/// Radiance in pictures by single lights of all phase angles, of the fit's present loss.
inline constexpr double k_point_lights = 5;
/// Pixels, of the loss of the fit without them; and where there are no point lights, of scattered samples.
inline constexpr double k_pixels = 3.5;
inline constexpr double k_pixels_alone = 2;

/// An error of this share in every albedo costs as much as the fit's loss without them: by pairs alone, and with pixels. So
/// the cost is 1 over its square: half of it costs four times as much.
inline constexpr double k_albedo_error = 0.1, k_albedo_error_with_pixels = 0.02;
/// The error of albedos of noisy tables. An albedo is the sum of thousands of values, and known better than any of them.
/// The error falls with the fourth power of the noise, and is least where the noise is at least this share of a channel's
/// dark values (docs/notes/noise.md).
inline constexpr double k_albedo_error_of_noise = 0.003, k_noise_of_least_albedo_error = 0.5;
inline double albedo_error_of_noise(double noise) {
    const double times = k_noise_of_least_albedo_error / noise, square = times * times;
    return std::clamp(square * square * k_albedo_error_of_noise, k_albedo_error_of_noise, k_albedo_error_with_pixels);
}
/// But at most this: a fit that cannot follow the data gains nothing from an albedo that is right by chance.
inline constexpr double k_most_albedo_loss = 0.004;
/// Errors of albedos near the horizon are relative to at least this: few pixels see them. By 0.3 to 0.5 ΔE_ITP rose.
inline constexpr double k_horizon_albedo = 1;
/// The factor of the cost of albedos beside point lights, whose loss is several times that of the pairs, most of it in
/// highlights.
inline constexpr double k_albedos_beside_point_lights = 8;

/// View by view: an error of 1 % in the radiances under all four lights of a view costs three channels times 1e-4 times
/// this.
inline constexpr double k_lights_of_view = 12;
/// View by view: directions between those of the matrix, relative to those of the matrix, per solid angle.
inline constexpr double k_between_views_directions = 0.1;

}  // namespace srbf
