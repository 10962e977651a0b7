// Frames of three axes.
#pragma once
#include <cmath>

#include "srbf/vec.h"

SRBF_BEGIN

/// Three orthonormal axes.
struct Frame {
    Vec3d x, y, z;
    /// The vector with coordinates w in the frame.
    Vec3d from(Vec3d w) const { return w.x * x + w.y * y + w.z * z; }
    /// The coordinates of w in the frame.
    Vec3d to(Vec3d w) const { return {dot(w, x), dot(w, y), dot(w, z)}; }
};
/// The frame about the unit vector z with x perpendicular to `up`; with any x if they are parallel.
inline Frame frame_about(Vec3d z, Vec3d up) {
    Vec3d x = cross(up, z);
    if (dot(x, x) < 1e-12) x = cross(Vec3d{1, 0, 0}, z);
    x = normalize(x);
    return {x, cross(z, x), z};
}
/// The frame about the unit vector z with some x.
inline Frame frame_about(Vec3d z) { return frame_about(z, std::abs(z.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}); }

SRBF_END
