// Vectors of three components, colours, and the local frame.
#pragma once
#include <bit>
#include <cmath>
#include <cstdint>

#include "srbf/elementary.h"

SRBF_BEGIN

inline constexpr double k_pi = 3.14159265358979323846;
inline constexpr double k_degree = k_pi / 180;

#include "srbf/vec3.inl"

/// Directions are unit vectors in the local frame of the surface: the shading normal is +z, `wl` points to the light
/// and `wv` to the viewer.
using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;

constexpr Vec3f to_float(Vec3d w) { return {float(w.x), float(w.y), float(w.z)}; }
constexpr Vec3d to_double(Vec3f w) { return {double(w.x), double(w.y), double(w.z)}; }

/// A point of the unit square.
struct Vec2f {
    float x = 0, y = 0;
};

/// Componentwise.
template <typename Real> constexpr bool operator==(Vec3<Real> a, Vec3<Real> b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

/// Linear colour in sRGB/Rec.709 primaries; the perfect white reflector is (1,1,1).
struct Rgb {
    float r = 0, g = 0, b = 0;
    constexpr float& operator[](int c) { return c == 0 ? r : c == 1 ? g : b; }
    constexpr const float& operator[](int c) const { return c == 0 ? r : c == 1 ? g : b; }
    friend constexpr bool operator==(const Rgb&, const Rgb&) = default;
};

/// ω = (sin θ cos φ, sin θ sin φ, cos θ), angles in radians.
template <typename Real> Vec3<Real> spherical(Real theta, Real phi) {
    return {elementary::sin(theta) * elementary::cos(phi), elementary::sin(theta) * elementary::sin(phi),
            elementary::cos(theta)};
}

/// The angles of a direction, in radians.
template <typename Real> struct Angles {
    Real theta, phi;  ///< [0, π], [−π, π]
};
/// The inverse of `spherical`. 2 atan2 of the chords is accurate near the poles, where acos loses half of the digits.
template <typename Real> Angles<Real> angles(Vec3<Real> w) {
    return {2 * elementary::atan2(elementary::hypot(w.x, w.y, w.z - 1), elementary::hypot(w.x, w.y, w.z + 1)),
            elementary::atan2(w.y, w.x)};
}

/// The mirror direction of ω: ω rotated by 180° about the normal, (−x, −y, z).
template <typename Real> constexpr Vec3<Real> mirror(Vec3<Real> w) { return {-w.x, -w.y, w.z}; }

/// Rec.709 luminance 0.2126 R + 0.7152 G + 0.0722 B.
constexpr double luminance(const Rgb& c) { return 0.2126 * double(c.r) + 0.7152 * double(c.g) + 0.0722 * double(c.b); }

/// True if x is neither infinite nor a NaN: by its bits, since with -ffast-math std::isfinite is always true.
constexpr bool is_finite(float x) { return std::bit_cast<std::uint32_t>(x) << 1 < 0xff000000u; }
constexpr bool is_finite(const Rgb& c) { return is_finite(c.r) && is_finite(c.g) && is_finite(c.b); }

SRBF_END
