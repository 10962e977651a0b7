#include "brdf/values.h"
#include "errors/sphere.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

/// 0 for x ≤ a, 1 for x ≥ b, and smooth between.
double smooth_step(double a, double b, double x) {
    x = std::clamp((x - a) / (b - a), 0.0, 1.0);
    return x * x * (3 - 2 * x);
}

constexpr double k_horizon_height = 0.1;  ///< sky and ground blend within this height above and below the horizon
constexpr double k_soft_edge = 0.1;       ///< the soft edge of a source, as a fraction of the cosine's range over it

/// How far the sky in a direction of this height is from horizon to zenith, and the fraction of the sky beside the
/// ground.
struct SkyBlend {
    double towards_zenith, sky;
    explicit SkyBlend(double height)
        : towards_zenith(smooth_step(0, 1, height)), sky(smooth_step(-k_horizon_height, k_horizon_height, height)) {}
};

}  // namespace

Vec3d sky_fractions(double height) {
    const SkyBlend blend(height);
    return {blend.sky * blend.towards_zenith, blend.sky * (1 - blend.towards_zenith), 1 - blend.sky};
}

Rgb radiance(const Lighting& lighting, Vec3d w) {
    const SkyBlend blend(w.y);
    const Rgb sky = mixed(lighting.horizon, lighting.zenith, float(blend.towards_zenith));
    Rgb sum = mixed(lighting.ground, sky, float(blend.sky));
    for (const Lighting::Source& source : lighting.sources) {
        if (source.radius == 0) continue;
        const double cosine = dot(w, source.direction), radius = source.radius * k_degree;
        if (cosine <= 1 - radius * radius / 2) continue;  // a fast bound: 1 − r²/2 < cos r
        const double edge = elementary::cos(radius);
        if (cosine <= edge) continue;
        const double fraction = smooth_step(edge, edge + k_soft_edge * (1 - edge), cosine);
        for (int c = 0; c < 3; ++c) sum[c] += float(fraction) * source.power[c];
    }
    return sum;
}

std::span<const Lighting> standard_lightings() {
    static const std::vector<Lighting> all = [] {
        const auto towards = [](double x, double y, double z) { return normalize(Vec3d{x, y, z}); };
        const auto light = [&](std::string_view name, Vec3d direction) {
            constexpr auto pi = float(k_pi);
            return Lighting{name, {}, {}, {}, {{direction, 0, {pi, pi, pi}}}};
        };
        constexpr Rgb dark{0.03f, 0.03f, 0.03f};
        return std::vector<Lighting>{
            {"overcast", {1, 1.05f, 1.1f}, {0.7f, 0.75f, 0.8f}, {0.25f, 0.23f, 0.2f}, {}},
            {"window",
             {0.1f, 0.09f, 0.08f},
             {0.06f, 0.06f, 0.06f},
             {0.05f, 0.04f, 0.03f},
             {{towards(-0.8, 0.35, 0.45), 22, {9, 9.5f, 10}}, {towards(0.6, 0.5, -0.2), 4, {12, 9, 6}}}},
            {"sunset",
             {0.25f, 0.35f, 0.6f},
             {0.9f, 0.5f, 0.3f},
             {0.12f, 0.1f, 0.08f},
             {{towards(0.75, 0.18, 0.4), 2.5, {180, 110, 60}}}},
            {"studio",
             dark,
             dark,
             dark,
             {{towards(-0.5, 0.7, 0.5), 14, {20, 20, 20}},
              {towards(0.85, 0.1, 0.5), 18, {5, 5, 5}},
              {towards(0.3, 0.4, -0.85), 10, {25, 25, 25}}}},
            light("flash", towards(0, 0.1, 1)),
            light("lamp", towards(-0.35, 0.45, 0.82)),
            light("side", towards(0.9, 0.25, 0.35)),
            light("back", towards(-0.55, 0.35, -0.75)),
        };
    }();
    return all;
}

}  // namespace
