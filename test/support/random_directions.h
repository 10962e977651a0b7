// Random directions.
#pragma once
#include "brdf/directions.h"
#include "srbf/vec.h"

namespace srbf {

/// A direction uniform on the sphere (for z ≥ z_min).
inline Vec3d random_direction(std::mt19937_64& random, double z_min = -1) {
    const double z = z_min + (1 - z_min) * uniform(random), phi = 2 * k_pi * uniform(random);
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    return {r * elementary::cos(phi), r * elementary::sin(phi), z};
}

/// A random direction. With probability ¼ it is within a degree of the horizon or of the normal.
inline Vec3f direction_with_extremes(std::mt19937_64& random) {
    const double pick = uniform(random);
    if (pick < 0.125) return to_float(spherical(k_pi / 2 - uniform(random) * k_degree, 7 * uniform(random)));
    if (pick < 0.25) return to_float(spherical(uniform(random) * k_degree, 7 * uniform(random)));
    return to_float(random_direction(random, 1e-4));
}

/// The direction at these polar and azimuth angles [°].
inline Vec3f direction_at(double theta, double phi) { return to_float(spherical(theta * k_degree, phi * k_degree)); }

/// A number of the standard normal distribution, nearly: the sum of twelve uniform ones.
inline double standard_normal(std::mt19937_64& random) {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += uniform(random);
    return sum;
}

/// ω rotated about the normal.
inline Vec3d rotate(Vec3d w, double phi) {
    const double c = std::cos(phi), s = std::sin(phi);
    return {c * w.x - s * w.y, s * w.x + c * w.y, w.z};
}
inline Vec3f rotate(Vec3f w, double phi) { return to_float(rotate(to_double(w), phi)); }

/// Three numbers that are below 1 as floats, too: a point of the unit square, and a selector.
inline Vec3f uniform_point(std::mt19937_64& random) {
    const auto below_1 = [&] { return std::min(float(uniform(random)), 0x1.fffffep-1f); };
    const float x = below_1(), y = below_1(), z = below_1();
    return {x, y, z};
}

}  // namespace srbf
