// The costs of the terms of a loss, for fits of tables. See "The objective" in docs/fitting.md.
#pragma once
#include <algorithm>

namespace SRBF_NAMESPACE {

// Weights of pairs: the loss of a 100 % error everywhere under each term, as a fraction of the same loss under the
// objective's own weights.
inline constexpr double k_highlights = 1;  ///< appearance: cube roots, for values that a display clips
inline constexpr double k_peaks = 0.3;     ///< appearance: squares
/// Cosine: cube roots. Without it the diffuse base under a highlight has almost no weight.
inline constexpr double k_diffuse_base = 5e-3;
/// Cost of an error at all horizon pairs (beyond θmax) as large as the largest measured f cosθl cosθv.
inline constexpr double k_horizon_importance = 1e-2;

/// Pixels, as a multiple of the loss of the fit without them.
inline constexpr double k_pixels = 3.5;

/// A relative error of this size in every albedo costs as much as the fit's loss without albedos; the two values
/// are for fits without and with pixels. The cost is proportional to 1 over the square: with half the value it is
/// four times as large.
inline constexpr double k_albedo_error = 0.1, k_albedo_error_with_pixels = 0.02;
/// The error of albedos of noisy tables. An albedo is the sum of thousands of values, and more certain than any of
/// them. The error falls with the fourth power of the noise; it is least where the noise is at least this fraction
/// of a channel's dark values (docs/notes/noise.md).
inline constexpr double k_albedo_error_of_noise = 0.003, k_noise_of_least_albedo_error = 0.5;
inline double albedo_error_of_noise(double noise) {
    const double ratio = k_noise_of_least_albedo_error / noise, square = ratio * ratio;
    return std::clamp(square * square * k_albedo_error_of_noise, k_albedo_error_of_noise, k_albedo_error_with_pixels);
}
/// Upper limit of the loss that scales the cost of albedos: a fit that cannot follow the data gains nothing from an
/// albedo that is right by chance.
inline constexpr double k_most_albedo_loss = 0.004;
/// Errors of albedos near the horizon are relative to at least this value: few pixels show them. With smaller
/// values (0.3 to 0.5) ΔE_ITP rose.
inline constexpr double k_horizon_albedo = 1;

/// View by view: an error of 1 % in the radiances under all four lights of a view costs 1e-4 times this value in
/// each of three channels.
inline constexpr double k_lights_of_view = 12;
/// View by view: the cost per solid angle of directions between those of the matrix, relative to those of the
/// matrix.
inline constexpr double k_between_views_directions = 0.1;

}  // namespace srbf
