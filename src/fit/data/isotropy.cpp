#include <cmath>

#include "fit/data/observations.h"
#include "floating_point.h"
#include "srbf/directions.h"
#include "srbf/elementary.h"
#include "srbf/kernel.h"

namespace srbf {
namespace {

constexpr std::size_t k_pairs = 16384;
constexpr double k_small_turn = 15 * k_degree;
/// Relative mean squares of f(Rωl, Rωv) − f(ωl, ωv): tolerance for rounding alone, and for noise.
constexpr double k_rounding = 1e-6, k_noise = 0.02;
/// Noise changes as much under a small rotation as under any; a brushed surface changes far less.
constexpr double k_most_growth = 2.5;

Vec3f turned(Vec3f w, double angle) {
    return Kernel<float>::turned(w, float(elementary::cos(angle)), float(elementary::sin(angle)));
}

}  // namespace

bool is_isotropic(const Evaluate& f, double max_theta) {
    const FlushSubnormals mode;
    std::mt19937_64 random(0);
    const MirrorMixture mixture(max_theta);
    std::vector<Vec3f> wl, wv, wl_small, wv_small, wl_any, wv_any;
    std::vector<double> weight;
    while (wl.size() < k_pairs) {
        const double u1 = uniform(random), u2 = uniform(random), u3 = uniform(random), u4 = uniform(random),
                     u5 = uniform(random), any = 2 * k_pi * uniform(random);
        const Vec3d v = mixture.sample_cap(u1, u2), l = mixture.sample(v, u3, u4, u5);
        if (!mixture.contains(l)) continue;
        wl.push_back(to_float(l)), wv.push_back(to_float(v));
        wl_small.push_back(turned(wl.back(), k_small_turn)), wv_small.push_back(turned(wv.back(), k_small_turn));
        wl_any.push_back(turned(wl.back(), any)), wv_any.push_back(turned(wv.back(), any));
        weight.push_back(1 / mixture.pdf(l, v));
    }
    std::vector<Rgb> at(k_pairs), at_small(k_pairs), at_any(k_pairs);
    f(wl, wv, at);
    f(wl_small, wv_small, at_small);
    f(wl_any, wv_any, at_any);
    // For f cosθl cosθv: towards the horizon f grows, and so does its noise.
    double whole = 0, by_small = 0, by_any = 0;
    for (std::size_t i = 0; i < k_pairs; ++i) {
        if (!is_finite(at[i]) || !is_finite(at_small[i]) || !is_finite(at_any[i])) continue;
        const double area = double(wl[i].z) * double(wv[i].z), w = weight[i] * area * area;
        for (int c = 0; c < 3; ++c) {
            whole += w * elementary::square(double(at[i][c]));
            by_small += w * elementary::square(double(at_small[i][c] - at[i][c]));
            by_any += w * elementary::square(double(at_any[i][c] - at[i][c]));
        }
    }
    return by_any <= k_rounding * whole || (by_any <= k_noise * whole && by_any <= k_most_growth * by_small);
}

}  // namespace srbf
