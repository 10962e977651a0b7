#include "measured/isotropy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "base/floating_point.h"
#include "base/k_d_tree.h"
#include "brdf/directions.h"
#include "brdf/values.h"
#include "measured/angles.h"
#include "measured/tables.h"
#include "srbf/elementary.h"
#include "srbf/kernel.h"
#include "srbf/measured.h"

namespace srbf {
namespace {

constexpr std::size_t k_pairs = 16384;
constexpr double k_small_rotation = 15 * k_degree;
/// Tolerances of relative mean squares of f(Rωl, Rωv) − f(ωl, ωv), for rounding alone and for noise.
constexpr double k_rounding = 1e-6, k_noise = 0.02;
/// Noise changes as much under a small rotation as under any other; a brushed surface changes far less.
constexpr double k_most_growth = 2.5;
/// Known noise changes the sum by as much as its variance, which is known to a tenth, and by so many deviations of it.
constexpr double k_noise_margin = 1.1, k_deviations = 3;

struct ValuesAtPairs {
    std::vector<Vec3f> wl, wv;
    std::vector<Rgb> f;

    void add(Vec3f l, Vec3f v) { wl.push_back(l), wv.push_back(v); }
    void add_rotated(Vec3f l, Vec3f v, double angle) {
        const float c = float(elementary::cos(angle)), s = float(elementary::sin(angle));
        add(Kernel<float>::turned(l, c, s), Kernel<float>::turned(v, c, s));
    }
    void evaluate(const Evaluate& brdf) { f.resize(wl.size()), brdf(wl, wv, f); }
};

}  // namespace

bool is_isotropic(const Evaluate& f, double max_theta, const Rgb& noise) {
    const StandardArithmetic mode;
    std::mt19937_64 random(0);
    const MirrorMixture mixture(max_theta);
    ValuesAtPairs original, slightly_rotated, rotated;
    std::vector<double> weight;
    while (weight.size() < k_pairs) {
        const double u1 = uniform(random), u2 = uniform(random), u3 = uniform(random), u4 = uniform(random),
                     u5 = uniform(random), angle = 2 * k_pi * uniform(random);
        const Vec3d v = mixture.sample_cap(u1, u2), l = mixture.sample(v, u3, u4, u5);
        if (!mixture.contains(l)) continue;
        const Vec3f wl = to_float(l), wv = to_float(v);
        original.add(wl, wv);
        slightly_rotated.add_rotated(wl, wv, k_small_rotation);
        rotated.add_rotated(wl, wv, angle);
        weight.push_back(1 / mixture.pdf(l, v));
    }
    for (ValuesAtPairs* pairs : {&original, &slightly_rotated, &rotated}) pairs->evaluate(f);
    // The cosines compensate for the growth of f, and of its noise, towards the horizon.
    double squares = 0, small_change = 0, change = 0, by_noise = 0, by_noise2 = 0;
    for (std::size_t i = 0; i < k_pairs; ++i) {
        const Rgb &value = original.f[i], &small = slightly_rotated.f[i], &any = rotated.f[i];
        if (!is_finite(value) || !is_finite(small) || !is_finite(any)) continue;
        const double w = weight[i] * elementary::square(cosines(original.wl[i], original.wv[i]));
        squares += w * square_of(value);
        small_change += w * squared_distance(small, value);
        change += w * squared_distance(any, value);
        const double noise_change = w * 2 * square_of(noise);
        by_noise += noise_change, by_noise2 += elementary::square(noise_change);
    }
    change -= k_noise_margin * by_noise + k_deviations * std::sqrt(2 * by_noise2);
    return change <= k_rounding * squares || (change <= k_noise * squares && change <= k_most_growth * small_change);
}

namespace {

/// The smaller cosine of the rotations about the normal that take wl and wv of one sample to those of another. A
/// direction near the normal does not count.
double cos_rotation(const ScatteredSamples& samples, std::size_t i, std::size_t k) {
    const auto cosine = [](const Vec3f& a, const Vec3f& b) {
        const double product = double(a.x) * double(b.x) + double(a.y) * double(b.y),
                     lengths = std::sqrt(double(a.x * a.x + a.y * a.y) * double(b.x * b.x + b.y * b.y));
        return lengths > 1e-4 ? product / lengths : 1;
    };
    return std::min(cosine(samples.wl[i], samples.wl[k]), cosine(samples.wv[i], samples.wv[k]));
}

}  // namespace

double change_by_azimuth(const ScatteredSamples& samples) {
    // At most `k_most` samples are indexed, since a search among coincident points visits all of them.
    constexpr std::size_t k_most = 65536, k_searches = 1024, k_near = 9, k_least_pairs = 32;
    const StandardArithmetic mode;
    const std::size_t step = 1 + samples.wl.size() / k_most;
    using Points = PointCloud<float, 3>;
    Points points;
    std::vector<std::size_t> sample;
    for (std::size_t i = 0; i < samples.wl.size(); i += step) {
        const Vec3f &l = samples.wl[i], &v = samples.wv[i];
        points.coordinates.push_back({polar_angle(l + v), polar_angle(l), polar_angle(v)});
        sample.push_back(i);
    }
    const std::size_t count = sample.size();
    if (count == 0) return 0;
    const KdTree<float, 3> tree(3, points, nanoflann::KDTreeSingleIndexAdaptorParams(16));
    struct Change {
        double squares = 0, squared_changes = 0;
        std::size_t pairs = 0;
        double ratio() const { return squares > 0 ? squared_changes / squares : 0; }
    };
    const auto value = [&](std::size_t i, int c) {
        return cosines(samples.wl[i], samples.wv[i]) * double(samples.colour[i][c]);
    };
    for (const double reach : {0.1 * k_degree, 10 * k_degree}) {
        Change small, any;
        for (std::size_t point = 0; point < count; point += 1 + count / k_searches) {
            const std::size_t i = sample[point];
            std::array<std::uint32_t, k_near> near;
            std::array<float, k_near> distance2;
            const std::size_t found =
                tree.knnSearch(points.coordinates[point].data(), k_near, near.data(), distance2.data());
            for (std::size_t n = 0; n < found; ++n) {
                if (near[n] == point || double(distance2[n]) > reach * reach) continue;
                const std::size_t k = sample[near[n]];
                Change& change = cos_rotation(samples, i, k) >= elementary::cos(k_small_rotation) ? small : any;
                ++change.pairs;
                for (int c = 0; c < 3; ++c) {
                    change.squares += elementary::square(value(i, c));
                    change.squared_changes += elementary::square(value(i, c) - value(k, c));
                }
            }
        }
        if (any.pairs < k_least_pairs) continue;
        // Within 10° values also change with the distance, so that pairs without rotation are needed for comparison.
        if (reach > k_degree && small.pairs < k_least_pairs) return 0;
        const bool is_noise = small.pairs >= k_least_pairs && any.ratio() <= k_most_growth * small.ratio();
        return any.ratio() > k_noise && !is_noise ? std::sqrt(any.ratio()) : 0;
    }
    return 0;
}

}  // namespace srbf
