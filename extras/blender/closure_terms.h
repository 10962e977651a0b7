// A term of a sum of closures, for its values and its fit.
#pragma once
#include <array>
#include <cstddef>

#include "extras/blender/closures.h"

namespace SRBF_NAMESPACE {

/// Slope, roughness and anisotropy of a closure.
using ClosureShape = std::array<double, 3>;

/// A direction to the light, with numbers that closures of all shapes use. Their D is blurred over `blur` [sr] about
/// it.
struct ClosureLight {
    Vec3d wl, h;   ///< the direction to the light, and the half vector
    double added;  ///< the blur, a term of αx² and αy²
    ClosureLight(Vec3d towards, Vec3d wv, double blur = 0);
};

/// A closure seen from wv, in the frame in which the viewer is (−sin θv, 0, cos θv) and T = (1, 0, 0).
class ClosureTerm {
  public:
    ClosureTerm(const ClosureShape& shape, Vec3d wv);

    /// D / (4 (N'·wv) (1 + Λ(wv) + Λ(wl))), and its derivatives by the shape if they are wanted.
    double value(const ClosureLight& light, ClosureShape* derivatives = nullptr) const;

  private:
    Vec3d wv_, normal_, tangent_;
    double along_, across_;  ///< αx², αy²
    /// Derivatives of the angle of N' by the slope, of log αx² by the roughness, and of log αy² by the anisotropy.
    ClosureShape chain_;
};

/// Colour j ≤ `count` of a diffuse ramp, as a fraction of π f cosθl: 1 at cosθl = j / count, 0 from its neighbours on.
double ramp_fraction(std::size_t j, std::size_t count, double cos_light);

/// The knot below an angle, and the fraction of the next one.
struct KnotPosition {
    std::size_t knot;
    double fraction;
    KnotPosition(double theta_v, std::size_t knots);
};

}  // namespace
