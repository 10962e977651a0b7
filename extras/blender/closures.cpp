#include "extras/blender/closures.h"

#include <algorithm>
#include <cmath>

#include "extras/blender/closure_terms.h"
#include "srbf/elementary.h"

namespace srbf {
namespace {

constexpr double k_least_cosine = 1e-3;  ///< of N'·wv, at which a term ends
constexpr double k_most_exponent = 60;   ///< of D that is not 0

/// Smith's Λ of Beckmann's distribution, by x = (α tan θ)².
double smith_lambda(double x) {
    if (x < 0.39) return 0;
    const double v = 1 / std::sqrt(x);
    return ((0.396 * v - 1.259) * v + 1) / ((2.181 * v + 3.535) * v);
}

}  // namespace

double closure_value(const ClosureShape& shape, Vec3d wl, Vec3d wv, double blur) {
    const auto [slope, roughness, anisotropy] = shape;
    const double alpha = roughness * roughness, ratio = 1 - std::abs(anisotropy),
                 along = anisotropy < 0 ? alpha / ratio : alpha * ratio,
                 across = anisotropy < 0 ? alpha * ratio : alpha / ratio;
    const double cosine = 1 / std::sqrt(1 + slope * slope);
    const Vec3d normal{slope * cosine, 0, cosine}, tangent{cosine, 0, -slope * cosine};
    const double nv = dot(normal, wv), nl = dot(normal, wl);
    if (nv <= k_least_cosine || nl <= 0) return 0;
    const Vec3d h = normalize(wl + wv);
    // A disc of solid angle A has the variance A / 4π along each axis, and α² is twice a variance; dω_h = dω_l / (4 h·wl).
    const double added = std::sqrt(blur / (8 * k_pi * dot(h, wl))), ax = elementary::hypot(along, added),
                 ay = elementary::hypot(across, added);
    const double nh = dot(normal, h), th = dot(tangent, h) / ax, bh = h.y / ay;
    const double exponent = (th * th + bh * bh) / (nh * nh);
    if (exponent > k_most_exponent) return 0;
    const double D = elementary::exp(-exponent) / (k_pi * ax * ay * nh * nh * nh * nh);
    const auto lambda = [&](Vec3d w, double nw) {
        const double x = ax * dot(tangent, w), y = ay * w.y;
        return smith_lambda((x * x + y * y) / (nw * nw));
    };
    return D / (4 * nv * (1 + lambda(wv, nv) + lambda(wl, nl)));
}

double ramp_share(std::size_t j, std::size_t count, double cos_light) {
    return std::max(1 - std::abs(double(count) * cos_light - double(j)), 0.0);
}

KnotPosition::KnotPosition(double theta_v, std::size_t knots) {
    const double x = std::clamp(theta_v / (k_pi / 2), 0.0, 1.0) * double(knots - 1);
    knot = std::min(std::size_t(x), knots - 2);
    share = x - double(knot);
}

Rgb value(const ClosureSum& sum, Vec3f wl, Vec3f wv) {
    if (!above_horizon(wl, wv)) return {};
    const double sine = elementary::hypot(double(wv.x), double(wv.y)), cosine = double(wv.z);
    const double x = sine > 0 ? -double(wv.x) / sine : 1, y = sine > 0 ? -double(wv.y) / sine : 0;
    const Vec3d light{x * double(wl.x) + y * double(wl.y), x * double(wl.y) - y * double(wl.x), double(wl.z)},
        viewer{-sine, 0, cosine};
    const KnotPosition at(elementary::atan2(sine, cosine), sum.knots());
    const auto between = [&](float a, float b) { return double(a) + at.share * (double(b) - double(a)); };
    std::array<double, 3> f{};
    for (std::size_t j = 0; j < sum.ramp; ++j) {
        const Rgb &a = sum.diffuse[at.knot * sum.ramp + j], &b = sum.diffuse[(at.knot + 1) * sum.ramp + j];
        const double term = ramp_share(j + 1, sum.ramp, light.z) / (k_pi * light.z);
        for (std::size_t c = 0; c < 3; ++c) f[c] += between(a[int(c)], b[int(c)]) * term;
    }
    for (std::size_t k = 0; k < sum.terms; ++k) {
        const Closure &a = sum.closures[at.knot * sum.terms + k], &b = sum.closures[(at.knot + 1) * sum.terms + k];
        const ClosureShape shape{between(a.slope, b.slope), between(a.roughness, b.roughness),
                                 between(a.anisotropy, b.anisotropy)};
        const double term = closure_value(shape, light, viewer) / light.z;
        for (std::size_t c = 0; c < 3; ++c) f[c] += between(a.weight[int(c)], b.weight[int(c)]) * term;
    }
    return {float(f[0]), float(f[1]), float(f[2])};
}

}  // namespace srbf
