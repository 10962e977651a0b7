// The highlight of a model with another roughness.

#include "brdf/values.h"
#include "edit/lobes.h"
#include "srbf/kernel.h"

namespace SRBF_NAMESPACE {
namespace kernel {
namespace {

struct Roughening {
    using Real = double;
    using Vec3 = Triple<double>;
#define SRBF_FN static
#include "srbf/kernel/roughen.glsl"
#undef SRBF_FN
};

}  // namespace
}  // namespace kernel

double roughness_of(const Evaluate& highlight) {
    constexpr int k_steps = 512;
    constexpr double k_steepest = 80 * k_degree, k_half_angle = 30 * k_degree;
    std::vector<Vec3f> wl, wv;
    std::vector<Rgb> f(k_steps);
    std::vector<double> slope, area;  // slopes, and the facets' projected area up to them
    for (int i = 0; i < k_steps; ++i) {
        const double theta = k_steepest * elementary::square((i + 0.5) / k_steps);
        const Vec3d h = spherical(theta, 0.0), across{0, elementary::sin(k_half_angle), 0};
        const Vec3d centre = elementary::cos(k_half_angle) * h;
        wl.push_back(to_float(centre + across));
        wv.push_back(to_float(centre - across));
        slope.push_back(elementary::sin(theta) / h.z);
    }
    highlight(wl, wv, f);
    double sum = 0;
    for (std::size_t i = 0; i < f.size(); ++i) {
        // f cosθl cosθv is D up to a factor, and D cosθh sinθh dθh the projected area. dθh grows with i.
        const double step = (double(i) + 0.5) * slope[i] / (1 + slope[i] * slope[i]);
        sum += luminance(f[i]) * cosines(wl[i], wv[i]) * step;
        area.push_back(sum);
    }
    if (!(sum > 0)) return 0;
    return slope[std::size_t(std::ranges::lower_bound(area, 0.5 * sum) - area.begin())];
}

Evaluate apply_roughening(Evaluate highlight, double factor, double roughness) {
    return
        [=, highlight = std::move(highlight)](std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
            std::vector<Vec3f> from_l(wl.size()), from_v(wl.size());
            std::vector<double> gain(wl.size());
            for (std::size_t i = 0; i < wl.size(); ++i) {
                const Vec3d l = to_double(wl[i]), v = to_double(wv[i]);
                const auto [light, viewer] = kernel::Roughening::with_slope_over(factor, l, v);
                from_l[i] = to_float(light);
                from_v[i] = to_float(viewer);
                gain[i] = Kernel<double>::ggx_facets(l, v, factor * roughness) /
                          Kernel<double>::ggx_facets(light, viewer, roughness);
            }
            highlight(from_l, from_v, f);
            for (std::size_t i = 0; i < f.size(); ++i) {
                const auto factor_of_f = above_horizon(wl[i], wv[i]) ? float(gain[i]) : 0;
                f[i] = scaled(factor_of_f, f[i]);
            }
        };
}

}  // namespace
