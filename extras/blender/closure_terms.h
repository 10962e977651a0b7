// A term of a sum of closures, for its values and its fit.
#pragma once
#include <array>
#include <cstddef>

#include "extras/blender/closures.h"

namespace srbf {

/// Slope, roughness and anisotropy of a closure.
using ClosureShape = std::array<double, 3>;

/// D / (4 (N'·wv) (1 + Λ(wv) + Λ(wl))) in the frame in which the viewer is (−sin θv, 0, cos θv) and T = (1, 0, 0). D is
/// blurred over `blur` [sr] about wl.
double closure_value(const ClosureShape& shape, Vec3d wl, Vec3d wv, double blur = 0);

/// Colour j ≤ `count` of a diffuse ramp, as a share of π f cosθl: 1 at cosθl = j / count, 0 from its neighbours on.
double ramp_share(std::size_t j, std::size_t count, double cos_light);

/// The knot below an angle, and the share of the next one.
struct KnotPosition {
    std::size_t knot;
    double share;
    KnotPosition(double theta_v, std::size_t knots);
};

}  // namespace srbf
