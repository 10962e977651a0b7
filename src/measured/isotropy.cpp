#include "measured/isotropy.h"

#include <cmath>
#include <random>

#include "floating_point.h"
#include "srbf/directions.h"
#include "srbf/elementary.h"
#include "srbf/kernel.h"
#include "values.h"

namespace srbf {
namespace {

constexpr std::size_t k_pairs = 16384;
constexpr double k_small_turn = 15 * k_degree;
/// Relative mean squares of f(Rωl, Rωv) − f(ωl, ωv): tolerance for rounding alone, and for noise.
constexpr double k_rounding = 1e-6, k_noise = 0.02;
/// Noise changes as much under a small rotation as under any; a brushed surface changes far less.
constexpr double k_most_growth = 2.5;

/// Pairs, and f there.
struct ValuesAtPairs {
    std::vector<Vec3f> wl, wv;
    std::vector<Rgb> f;

    void add(Vec3f l, Vec3f v) { wl.push_back(l), wv.push_back(v); }
    void add_turned(Vec3f l, Vec3f v, double angle) {
        const float c = float(elementary::cos(angle)), s = float(elementary::sin(angle));
        add(Kernel<float>::turned(l, c, s), Kernel<float>::turned(v, c, s));
    }
    void evaluate(const Evaluate& brdf) { f.resize(wl.size()), brdf(wl, wv, f); }
};

}  // namespace

bool is_isotropic(const Evaluate& f, double max_theta) {
    const StandardArithmetic mode;
    std::mt19937_64 random(0);
    const MirrorMixture mixture(max_theta);
    ValuesAtPairs at, slightly_turned, turned;
    std::vector<double> weight;
    while (weight.size() < k_pairs) {
        const double u1 = uniform(random), u2 = uniform(random), u3 = uniform(random), u4 = uniform(random),
                     u5 = uniform(random), angle = 2 * k_pi * uniform(random);
        const Vec3d v = mixture.sample_cap(u1, u2), l = mixture.sample(v, u3, u4, u5);
        if (!mixture.contains(l)) continue;
        const Vec3f wl = to_float(l), wv = to_float(v);
        at.add(wl, wv), slightly_turned.add_turned(wl, wv, k_small_turn), turned.add_turned(wl, wv, angle);
        weight.push_back(1 / mixture.pdf(l, v));
    }
    for (ValuesAtPairs* pairs : {&at, &slightly_turned, &turned}) pairs->evaluate(f);
    // For f cosθl cosθv: towards the horizon f grows, and so does its noise.
    double whole = 0, by_small = 0, by_any = 0;
    for (std::size_t i = 0; i < k_pairs; ++i) {
        const Rgb &value = at.f[i], &small = slightly_turned.f[i], &any = turned.f[i];
        if (!is_finite(value) || !is_finite(small) || !is_finite(any)) continue;
        const double w = weight[i] * elementary::square(cosines(at.wl[i], at.wv[i]));
        whole += w * square_of(value);
        by_small += w * squared_distance(small, value);
        by_any += w * squared_distance(any, value);
    }
    return by_any <= k_rounding * whole || (by_any <= k_noise * whole && by_any <= k_most_growth * by_small);
}

}  // namespace srbf
