// Plots of BRDFs in the plane of incidence.
#pragma once
#include "srbf/brdf.h"
#include "srbf/measured.h"

namespace SRBF_NAMESPACE {

/// Luminances of f(wl, wv) [1/sr] with wl fixed and wv in the plane of incidence.
struct LuminanceSlice {
    /// The angles of wv: from −89 (on the light's side) to 89, in steps of ½, or 0.1 around the mirror direction.
    /// For a BSDF they continue from 91 to 269, where 180 is the normal of the back.
    std::vector<double> degrees;
    std::vector<double> luminance;  ///< NaN: not measured, or in the plane of the surface
};
/// The slice for light at polar angle `theta_l` [rad]; beyond π/2 the light is at the back.
LuminanceSlice luminance_slice(const Evaluate& f, double theta_l, bool both_sides = false);

/// A curve of a plot.
struct SliceCurve {
    std::string name;
    std::string colour;  ///< CSS colour
    Evaluate brdf;
    bool both_sides = false;  ///< true for a BSDF, for which `lobe_drawing` goes all around
};

/// A drawing (SVG) of slices over the angle, on a logarithmic scale. The scale includes the largest value and, at
/// most `k_slice_decades` below it, the smallest. Smaller values are drawn at the lower border. A curve is
/// interrupted where its value is NaN. The first curve is drawn widest and below the others.
std::string slice_drawing(std::span<const SliceCurve> curves, double theta_l);
inline constexpr int k_slice_decades = 6;

/// Samples with one angle of incidence, viewed in its plane.
struct Scan {
    double theta_l = 0;             ///< [degrees]
    std::vector<double> degrees;    ///< θv [degrees], positive on the side of the mirror direction
    std::vector<double> luminance;  ///< [1/sr]
};
/// The scans with eight samples or more, by ascending θl.
std::vector<Scan> scans_in_plane(const ScatteredSamples& samples);
/// A drawing (SVG) of log f over the angle from the mirror direction, θv − θl, as is usual for scatter: samples are
/// points, models are curves. The scale covers the samples and a decade more at either end.
std::string scan_drawing(const Scan& scan, std::span<const SliceCurve> models);

enum class LobeScale { linear, logarithmic };
/// The slice in polar coordinates: the distance from the point of incidence is the value in that direction. The
/// first curve's values within 85° of a normal determine the scale, which has at most `k_lobe_decades` if it is
/// logarithmic; larger values are drawn just outside it. If a curve shows a BSDF, the drawing is a full circle:
/// light that leaves at the front above, at the back below. Light is reflected to its own side.
std::string lobe_drawing(std::span<const SliceCurve> curves, double theta_l, LobeScale scale);
inline constexpr int k_lobe_decades = 4;

}  // namespace
