// Slices of BRDFs through the plane of incidence, as plots: level 6.
#pragma once
#include <span>
#include <string>

#include "srbf/brdf.h"

namespace srbf {

/// A line of a plot.
struct SliceCurve {
    std::string name;
    std::string colour;  ///< of CSS
    Evaluate brdf;
};

/// A drawing (SVG) of the luminance of f_r(wl, wv) [1/sr], logarithmic, with wl fixed at polar angle `theta_l` [rad] and wv in the plane of
/// incidence: polar angle from −89° (on the light's side) to 89°, in steps of half a degree, of a tenth around the mirror direction.
/// The scale holds the largest value and, `k_slice_decades` below it at most, the smallest; smaller ones lie on its lower border, and
/// where a value is NaN the line is broken. The first curve is drawn widest and below the others.
std::string slice_drawing(std::span<const SliceCurve> curves, double theta_l);
inline constexpr int k_slice_decades = 6;

}  // namespace srbf
