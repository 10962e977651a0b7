// Angles of vectors by polynomials: the C library's arc functions would take half the time of a look-up in a table.
#pragma once
#include <algorithm>

#include "srbf/elementary.h"
#include "srbf/vec.h"

namespace SRBF_NAMESPACE {

/// Bounds denominators, so that the zero vector has the angle 0.
inline constexpr double k_min_length = 1e-37;

namespace scalar {
using std::abs, std::copysign, std::max, std::min, std::sqrt;
inline float select(bool condition, float a, float b) { return condition ? a : b; }
#include "measured/angles.inl"
}  // namespace scalar
using scalar::azimuth, scalar::polar_angle;

/// The angle between the normal and a vector of any length in the upper half space.
inline float polar_angle(Vec3f w) { return polar_angle(w.x * w.x + w.y * w.y, w.z); }
/// The angle between the normal and any vector, in double precision.
inline double polar_angle(const Vec3d& w) { return elementary::atan2(elementary::hypot(w.x, w.y), w.z); }

}  // namespace
