// Slices of BRDFs through the plane of incidence, as plots: level 6.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "srbf/brdf.h"

namespace srbf {

/// Luminances of f_r(wl, wv) [1/sr] with wl fixed and wv in the plane of incidence.
struct LuminanceSlice {
    std::vector<double>
        degrees;  ///< of wv: from −89 (on the light's side) to 89, in steps of ½, of a tenth around the mirror direction
    std::vector<double> luminance;  ///< NaN: not measured
};
/// The slice for light at polar angle `theta_l` [rad].
LuminanceSlice luminance_slice(const Evaluate& brdf, double theta_l);

/// A line of a plot.
struct SliceCurve {
    std::string name;
    std::string colour;  ///< of CSS
    Evaluate brdf;
};

/// A drawing (SVG) of slices, logarithmic over the angle.
/// The scale holds the largest value and, `k_slice_decades` below it at most, the smallest; smaller ones lie on its lower border, and
/// where a value is NaN the line is broken. The first curve is drawn widest and below the others.
std::string slice_drawing(std::span<const SliceCurve> curves, double theta_l);
inline constexpr int k_slice_decades = 6;

enum class LobeScale { linear, logarithmic };
/// The same in polar coordinates: lobes as far from the point of incidence as the surface is bright from there. The first curve's values
/// within 85° set the scale, of logarithmic ones `k_lobe_decades` at most; larger ones are drawn just outside of it.
std::string lobe_drawing(std::span<const SliceCurve> curves, double theta_l, LobeScale scale);
inline constexpr int k_lobe_decades = 4;

}  // namespace srbf
