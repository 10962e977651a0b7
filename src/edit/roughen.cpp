// The highlight of a model with another roughness.
#include <algorithm>
#include <cmath>

#include "brdf/values.h"
#include "edit/reshape.h"
#include "srbf/kernel.h"

namespace srbf {
namespace {

/// Light and viewer, or in (h, d) their half vector and half of their difference.
struct Pair {
    Vec3d l, v;
};

/// The pair about the half vector h₀ with the slope of the pair's half vector h over `factor`.
Pair with_slope_over(double factor, Vec3d wl, Vec3d wv) {
    constexpr double k_most_tilt = 0.9;  // of d: above the horizon remains a tenth of the cosine of an upright d
    const Vec3d sum = wl + wv;
    const double length = std::max(std::sqrt(dot(sum, sum)), 1e-9);
    const Vec3d h = (1 / length) * sum, d = 0.5 * (wl - wv);
    const Vec3d to = normalize(Vec3d{h.x / factor, h.y / factor, h.z});
    const double tilt = elementary::hypot(h.x, h.y);
    if (tilt < 1e-9) return {wl, wv};
    // d in the frames of h and h₀: along their steepest descent, and across it.
    const Vec3d across{-h.y / tilt, h.x / tilt, 0};
    const double cosine = 0.5 * length, of_d = dot(d, d), side = dot(d, across);
    const Vec3d down = cross(across, h), down_of_to = cross(across, to);
    const double steepest = std::sqrt(std::max(1 - to.z * to.z, 1e-18));
    const double most = k_most_tilt * to.z * cosine / steepest;
    const double along = std::clamp(dot(d, down), -most, most);
    const double rest = std::copysign(std::sqrt(std::max(of_d - along * along, 0.0)), side);
    const Vec3d of_pair = along * down_of_to + rest * across;
    return {cosine * to + of_pair, cosine * to - of_pair};
}

}  // namespace

double roughness_of(const Evaluate& highlight) {
    constexpr int k_steps = 512;
    constexpr double k_steepest = 80 * k_degree, k_apart = 30 * k_degree;
    std::vector<Vec3f> wl, wv;
    std::vector<Rgb> f(k_steps);
    std::vector<double> slope, share;  // of the projected area of facets, from the least slope on
    for (int i = 0; i < k_steps; ++i) {
        const double theta = k_steepest * elementary::square((i + 0.5) / k_steps);
        const Vec3d h = spherical(theta, 0.0), across{0, elementary::sin(k_apart), 0};
        const Vec3d middle = elementary::cos(k_apart) * h;
        wl.push_back(to_float(middle + across)), wv.push_back(to_float(middle - across));
        slope.push_back(elementary::sin(theta) / h.z);
    }
    highlight(wl, wv, f);
    double sum = 0;
    for (std::size_t i = 0; i < f.size(); ++i) {
        // f cosθl cosθv is D up to a factor, and D cosθh sinθh dθh the projected area. dθh grows with i.
        const double step = (double(i) + 0.5) * slope[i] / (1 + slope[i] * slope[i]);
        sum += luminance(f[i]) * cosines(wl[i], wv[i]) * step;
        share.push_back(sum);
    }
    if (!(sum > 0)) return 0;
    return slope[std::size_t(std::ranges::lower_bound(share, 0.5 * sum) - share.begin())];
}

Evaluate roughened(Evaluate highlight, double factor, double roughness) {
    return
        [=, highlight = std::move(highlight)](std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
            std::vector<Vec3f> from_l(wl.size()), from_v(wl.size());
            std::vector<double> gain(wl.size());
            for (std::size_t i = 0; i < wl.size(); ++i) {
                const Vec3d l = to_double(wl[i]), v = to_double(wv[i]);
                const Pair from = with_slope_over(factor, l, v);
                from_l[i] = to_float(from.l), from_v[i] = to_float(from.v);
                gain[i] = Kernel<double>::ggx_facets(l, v, factor * roughness) /
                          Kernel<double>::ggx_facets(from.l, from.v, roughness);
            }
            highlight(from_l, from_v, f);
            for (std::size_t i = 0; i < f.size(); ++i) {
                const auto by = above_horizon(wl[i], wv[i]) ? float(gain[i]) : 0;
                f[i] = {by * f[i].r, by * f[i].g, by * f[i].b};
            }
        };
}

}  // namespace srbf
