// Angles of vectors without arc functions of the C library, which take half the time of a look-up: private to
// the tables.
#pragma once
#include <algorithm>
#include <cmath>

#include "srbf/vec.h"

namespace srbf {

/// θ = atan2(s, c) [rad] of s = √sine2 ≥ 0 and c ≥ 0, of any length; 0 for the null vector. Relative error ≤
/// 4e-7, also at the ends, where an arc cosine loses half the digits. With t = sin²(θ/2): θ² = 4 t
/// (arcsin(√t) / √t)², the factor a polynomial of t on [0, ½] by Chebyshev interpolation.
inline float polar_angle(float sine2, float c) {
    const float length = std::sqrt(sine2 + c * c);
    const float twice = length * (length + c);
    const float t = twice > 0 ? 0.5f * sine2 / twice : 0;
    float p = 0.319542848f;
    p = p * t - 0.265949534f;
    p = p * t + 0.217428188f;
    p = p * t + 0.0412315376f;
    p = p * t + 0.119678547f;
    p = p * t + 0.177428973f;
    p = p * t + 0.333341786f;
    p = p * t + 0.999999967f;
    return 2 * std::sqrt(t * p);
}

/// The angle from the normal of a vector of the upper half space, of any length.
inline float polar_angle(Vec3f w) { return polar_angle(w.x * w.x + w.y * w.y, w.z); }

/// φ = atan2(y, x) [rad], in [−π, π]; 0 for the null vector. Absolute error ≤ 4e-7.
/// With q = min(|x|,|y|)/max(|x|,|y|): arctan q = q P(q²), P by Chebyshev interpolation on [0, 1].
inline float azimuth(float y, float x) {
    const float a = std::abs(x), b = std::abs(y), larger = std::max(a, b);
    const float q = larger > 0 ? std::min(a, b) / larger : 0, t = q * q;
    float p = 0.0027662835f;
    p = p * t - 0.0157312491f;
    p = p * t + 0.0421376236f;
    p = p * t - 0.0745685483f;
    p = p * t + 0.106183706f;
    p = p * t - 0.141977978f;
    p = p * t + 0.19991872f;
    p = p * t - 0.333330367f;
    p = p * t + 0.999999982f;
    float phi = q * p;
    phi = b > a ? float(k_pi / 2) - phi : phi;
    phi = x < 0 ? float(k_pi) - phi : phi;
    return std::copysign(phi, y);
}

}  // namespace srbf
