#include "extras/blender/closures.h"

#include <algorithm>
#include <cmath>

#include "extras/blender/closure_terms.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

constexpr double k_min_cosine = 1e-3;  ///< the N'·wv at which a term ends
constexpr double k_max_exponent = 60;  ///< D is 0 if its exponent is larger

/// Smith's Λ of Beckmann's distribution for a direction w, by x = (α tan θ)², and its derivatives by the angle of N'
/// and the squares of α along and across.
struct SmithLambda {
    double value = 0, by_angle = 0, by_along = 0, by_across = 0;
    SmithLambda(double along, double across, double nw, double tw, double bw) {
        const double tan = tw / nw, side = bw / nw, x = along * tan * tan + across * side * side;
        if (x < 0.39) return;
        const double v = 1 / std::sqrt(x), above = (0.396 * v - 1.259) * v + 1, below = (2.181 * v + 3.535) * v;
        value = above / below;
        const double by_x = -0.5 * v * v * v * (0.792 * v - 1.259 - value * (4.362 * v + 3.535)) / below;
        by_angle = -2 * tan * (along + x) * by_x;
        by_along = tan * tan * by_x;
        by_across = side * side * by_x;
    }
};

}  // namespace

ClosureLight::ClosureLight(Vec3d towards, Vec3d wv, double blur)
    : wl(towards),
      h(normalize(towards + wv)),
      // A disc of solid angle A has the variance A / 4π along each axis, and α² is twice a variance; dω_h = dω_l / (4
      // h·wl).
      added(blur / (8 * k_pi * dot(h, wl))) {}

ClosureTerm::ClosureTerm(const ClosureShape& shape, Vec3d wv) : wv_(wv) {
    const auto [slope, roughness, anisotropy] = shape;
    const double alpha = roughness * roughness, ratio = 1 - std::abs(anisotropy);
    along_ = elementary::square(anisotropy < 0 ? alpha / ratio : alpha * ratio);
    across_ = elementary::square(anisotropy < 0 ? alpha * ratio : alpha / ratio);
    const double cosine = 1 / std::sqrt(1 + slope * slope);
    normal_ = {slope * cosine, 0, cosine}, tangent_ = {cosine, 0, -slope * cosine};
    chain_ = {cosine * cosine, 4 / roughness, 2 / ratio};
}

double ClosureTerm::value(const ClosureLight& light, ClosureShape* derivatives) const {
    if (derivatives) *derivatives = {};
    const double nv = dot(normal_, wv_), nl = dot(normal_, light.wl);
    if (nv <= k_min_cosine || nl <= 0) return 0;
    const double nh = dot(normal_, light.h), tan = dot(tangent_, light.h) / nh, side = light.h.y / nh,
                 ax = along_ + light.added, ay = across_ + light.added;
    const double exponent = tan * tan / ax + side * side / ay;
    if (exponent > k_max_exponent) return 0;
    const double D = elementary::exp(-exponent) / (k_pi * std::sqrt(ax * ay) * nh * nh * nh * nh),
                 tv = dot(tangent_, wv_);
    const SmithLambda viewer_lambda(ax, ay, nv, tv, wv_.y),
        light_lambda(ax, ay, nl, dot(tangent_, light.wl), light.wl.y);
    const double masking = 1 + viewer_lambda.value + light_lambda.value, value = D / (4 * nv * masking);
    if (derivatives) {
        // of the logarithm
        const double by_angle =
            2 * tan * (1 / ax + exponent - 2) - tv / nv - (viewer_lambda.by_angle + light_lambda.by_angle) / masking;
        const double by_along =
            (tan * tan / ax - 0.5) / ax - (viewer_lambda.by_along + light_lambda.by_along) / masking;
        const double by_across =
            (side * side / ay - 0.5) / ay - (viewer_lambda.by_across + light_lambda.by_across) / masking;
        *derivatives = {value * chain_[0] * by_angle, value * chain_[1] * (along_ * by_along + across_ * by_across),
                        value * chain_[2] * (across_ * by_across - along_ * by_along)};
    }
    return value;
}

double ramp_fraction(std::size_t j, std::size_t count, double cos_light) {
    return std::max(1 - std::abs(double(count) * cos_light - double(j)), 0.0);
}

KnotPosition::KnotPosition(double theta_v, std::size_t knots) {
    const double x = std::clamp(theta_v / (k_pi / 2), 0.0, 1.0) * double(knots - 1);
    knot = std::min(std::size_t(x), knots - 2);
    fraction = x - double(knot);
}

Rgb value(const ClosureSum& sum, Vec3f wl, Vec3f wv) {
    if (!above_horizon(wl, wv)) return {};
    const double sine = elementary::hypot(double(wv.x), double(wv.y)), cosine = double(wv.z);
    const double x = sine > 0 ? -double(wv.x) / sine : 1, y = sine > 0 ? -double(wv.y) / sine : 0;
    const Vec3d light{x * double(wl.x) + y * double(wl.y), x * double(wl.y) - y * double(wl.x), double(wl.z)},
        viewer{-sine, 0, cosine};
    const KnotPosition at(elementary::atan2(sine, cosine), sum.knots());
    const auto between = [&](float a, float b) { return double(a) + at.fraction * (double(b) - double(a)); };
    std::array<double, 3> f{};
    for (std::size_t j = 0; j < sum.ramp; ++j) {
        const Rgb &a = sum.diffuse[at.knot * sum.ramp + j], &b = sum.diffuse[(at.knot + 1) * sum.ramp + j];
        const double term = ramp_fraction(j + 1, sum.ramp, light.z) / (k_pi * light.z);
        for (std::size_t c = 0; c < 3; ++c) f[c] += between(a[int(c)], b[int(c)]) * term;
    }
    for (std::size_t k = 0; k < sum.terms; ++k) {
        const Closure &a = sum.closures[at.knot * sum.terms + k], &b = sum.closures[(at.knot + 1) * sum.terms + k];
        const ClosureShape shape{between(a.slope, b.slope), between(a.roughness, b.roughness),
                                 between(a.anisotropy, b.anisotropy)};
        const double term = ClosureTerm(shape, viewer).value({light, viewer}) / light.z;
        for (std::size_t c = 0; c < 3; ++c) f[c] += between(a.weight[int(c)], b.weight[int(c)]) * term;
    }
    return {float(f[0]), float(f[1]), float(f[2])};
}

}  // namespace
