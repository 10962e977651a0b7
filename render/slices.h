// Plots of BRDFs in the plane of incidence: level 6.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "srbf/brdf.h"

namespace srbf {

/// Luminances of f_r(wl, wv) [1/sr] with wl fixed and wv in the plane of incidence.
struct LuminanceSlice {
    std::vector<double>
        degrees;  ///< of wv: from −89 (on the light's side) to 89, in steps of ½, or 0.1 around the mirror direction
    std::vector<double> luminance;  ///< NaN: not measured
};
/// The slice for light at polar angle `theta_l` [rad].
LuminanceSlice luminance_slice(const Evaluate& brdf, double theta_l);

/// A curve of a plot.
struct SliceCurve {
    std::string name;
    std::string colour;  ///< CSS colour
    Evaluate brdf;
};

/// A drawing (SVG) of slices over the angle, with a logarithmic scale. The scale includes the largest value and, at
/// most `k_slice_decades` below it, the smallest. Smaller values are drawn at the lower border. A curve is interrupted
/// where its value is NaN. The first curve is drawn widest and below the others.
std::string slice_drawing(std::span<const SliceCurve> curves, double theta_l);
inline constexpr int k_slice_decades = 6;

enum class LobeScale { linear, logarithmic };
/// The same in polar coordinates: the distance from the point of incidence is the value in that direction. The first
/// curve's values within 85° determine the scale, a logarithmic one with at most `k_lobe_decades`; larger values are
/// drawn just outside of it.
std::string lobe_drawing(std::span<const SliceCurve> curves, double theta_l, LobeScale scale);
inline constexpr int k_lobe_decades = 4;

}  // namespace srbf
