// BRDFs of closed form.
#pragma once
#include <limits>

#include "srbf/vec.h"

namespace srbf::analytic_brdfs {

struct Lambert {
    Rgb albedo;
};
inline Rgb value(const Lambert& b, Vec3f wl, Vec3f wv) {
    if (wl.z <= 0 || wv.z <= 0) return {};
    return {float(b.albedo.r / k_pi), float(b.albedo.g / k_pi), float(b.albedo.b / k_pi)};
}

/// A sharp, glossy BRDF, far from symmetric, without values where `hole` is true.
struct Glossy {
    float scale = 1;
    bool (*hole)(Vec3f wl, Vec3f wv) = [](Vec3f, Vec3f) { return false; };
};
inline Rgb value(const Glossy& b, Vec3f wl, Vec3f wv) {
    constexpr float none = std::numeric_limits<float>::quiet_NaN();
    if (b.hole(wl, wv)) return {none, none, none};
    if (wl.z <= 0 || wv.z <= 0) return {};
    const Vec3f h = normalize(wl + wv);
    const float peak = std::exp(-300 * (1 - h.z)), brushed = std::exp(-40 * h.x * h.x);
    return {b.scale * (0.05f + 9 * peak), b.scale * (0.02f + 8 * peak), b.scale * (0.2f * brushed + 7 * peak)};
}

}  // namespace srbf::analytic_brdfs
