// What terms of a loss cost: a row for each that multivariate and view-by-view fits share.
#pragma once
#include <cstddef>

namespace srbf {

/// Relative to the loss of the pairs, Σ w |f|² or what is left of it; measured (docs/fitting.md), no theory behind it.
/// A view has five lobes for its highlight and its body, the whole of a multivariate model eight for all views: views
/// can afford to follow highlights, and need less weight to follow radiance.
struct Importance {
    double multivariate, view;
};
/// Weights of highlights: of an error of 100 % of all pairs, beside an equal error by the objective's own weights.
inline constexpr Importance k_highlights{1, 3};
/// Radiance in pictures by single lights of all phase angles. Of a multivariate fit its present loss; of a view, which
/// is not reweighted by its errors, an error of 100 %.
inline constexpr Importance k_point_lights{5, 0.3};
/// Pixels, of the loss of the fit without them.
inline constexpr Importance k_pixels{3.5, 4};
/// Intervals of the phase angle [0, π], in which energies of pictures (16) or the exposures of pixels (36, of 5°) are
/// known.
inline constexpr std::size_t k_energy_intervals = 16, k_exposure_intervals = 36;

}  // namespace srbf
