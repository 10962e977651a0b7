#pragma once
#include <array>

#include "srbf/elementary.h"
#include "srbf/vec.h"

namespace SRBF_NAMESPACE {

/// The factors from numbers of the file to f_r [1/sr].
inline constexpr std::array<double, 3> k_merl_channel_scale{1.0 / 1500, 1.15 / 1500, 1.66 / 1500};

struct MerlPair {
    Vec3d wl, wv;
};

/// The directions at θ_h, θ_d, φ_d [rad], with the half vector at azimuth 0 and the light at (θ_d, φ_d) relative to it.
inline MerlPair merl_pair(double theta_h, double theta_d, double phi_d) {
    const double c = elementary::cos(theta_h), s = elementary::sin(theta_h);
    const auto rotate = [&](Vec3d w) { return Vec3d{c * w.x + s * w.z, w.y, c * w.z - s * w.x}; };
    const Vec3d difference = spherical(theta_d, phi_d);
    return {rotate(difference), rotate(mirror(difference))};
}

}  // namespace srbf
