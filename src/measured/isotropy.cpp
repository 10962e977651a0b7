#include <complex>

#include "base/floating_point.h"
#include "base/k_d_tree.h"
#include "brdf/directions.h"
#include "brdf/values.h"
#include "measured/angles.h"
#include "measured/tables.h"
#include "srbf/elementary.h"
#include "srbf/kernel.h"
#include "srbf/measured.h"

namespace SRBF_NAMESPACE {
namespace {

constexpr std::size_t k_pairs = 16384;
constexpr double k_small_rotation = 15 * k_degree;
/// Tolerances of relative mean squares of f(Rωl, Rωv) − f(ωl, ωv), for rounding alone and for noise.
constexpr double k_rounding = 1e-6, k_noise = 0.02;
/// Noise changes as much under a small rotation as under any other; a brushed surface changes far less.
constexpr double k_max_growth = 2.5;
/// The growth for samples, of which each counts the same, and the least change of pairs that are exactly rotated.
constexpr double k_min_growth = 1.5, k_weakest = 1e-4;
/// Known noise changes the sum by its variance, which is known to a tenth, and by at most k_deviations standard
/// deviations.
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

using Complex = std::complex<double>;
Complex in_plane(const Vec3f& w) { return {double(w.x), double(w.y)}; }
/// The product of their lengths in the plane of the surface, times e^iδ of the rotation from a to b.
Complex between(const Vec3f& a, const Vec3f& b) { return std::conj(in_plane(a)) * in_plane(b); }

/// e^iδ of the rotation about the normal that brings one sample nearest to another; 0 if both are along the normal, or
/// if one is rather a mirror image.
Complex rotation_between(const ScatteredSamples& samples, std::size_t i, std::size_t k) {
    const auto &wl = samples.wl, &wv = samples.wv;
    const Complex sum = between(wl[i], wl[k]) + between(wv[i], wv[k]);
    const double length = elementary::hypot(sum.real(), sum.imag());
    const bool is_mirrored = between(wl[i], wv[i]).imag() * between(wl[k], wv[k]).imag() < -1e-6;
    return length > 1e-8 && !is_mirrored ? sum / length : 0;
}

/// True if rotation changes no more than its halves: all directions lie in one plane, or lights or viewers are off the
/// normal and have one azimuth, within half a degree.
bool lacks_rotations(const ScatteredSamples& samples) {
    constexpr double k_max = 1e-4;  // bound on sin² and on products of sines
    const auto sine2 = [](const Vec3f& w) { return between(w, w).real(); };
    const auto farthest = [&](const std::vector<Vec3f>& w) { return *std::ranges::max_element(w, {}, sine2); };
    const auto lie_in_plane = [](const Vec3f& axis, const std::vector<Vec3f>& all, double min) {
        return std::ranges::all_of(
            all, [&](const Vec3f& w) { return is_in_plane(axis, w) && between(axis, w).real() >= min; });
    };
    const Vec3f l = farthest(samples.wl), v = farthest(samples.wv), axis = sine2(l) > sine2(v) ? l : v;
    return (sine2(l) > k_max && lie_in_plane(l, samples.wl, -k_max)) ||
           (sine2(v) > k_max && lie_in_plane(v, samples.wv, -k_max)) ||
           (lie_in_plane(axis, samples.wl, -1) && lie_in_plane(axis, samples.wv, -1));
}

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
    return change <= k_rounding * squares || (change <= k_noise * squares && change <= k_max_growth * small_change);
}

double change_by_azimuth(const ScatteredSamples& samples) {
    // At most `k_max` samples are indexed, since a search among coincident points visits all of them.
    constexpr std::size_t k_max = 65536, k_searches = 1024, k_near = 9, k_min_pairs = 32;
    const StandardArithmetic mode;
    if (samples.wl.empty() || lacks_rotations(samples)) return 0;
    const std::size_t step = 1 + samples.wl.size() / k_max;
    using Points = PointCloud<float, 3>;
    Points points;
    std::vector<std::size_t> sample;
    for (std::size_t i = 0; i < samples.wl.size(); i += step) {
        const Vec3f &l = samples.wl[i], &v = samples.wv[i];
        points.coordinates.push_back({polar_angle(l + v), polar_angle(l), polar_angle(v)});
        sample.push_back(i);
    }
    const std::size_t count = sample.size();
    const KdTree<float, 3> tree(3, points, nanoflann::KDTreeSingleIndexAdaptorParams(16));
    struct Change {
        double squares = 0, squared_changes = 0, relative = 0;
        std::size_t pairs = 0;
        double ratio() const { return squares > 0 ? squared_changes / squares : 0; }
        double mean_relative() const { return relative / double(pairs); }  // a bright sample counts no more than others
    };
    // Changes under small rotations are compared with the others: of exact pairs, which may lack them; also of exact
    // pairs, those near 0 and 180°, since many surfaces are symmetric by half a turn; and of pairs within 10°, where
    // values also change with the distance.
    struct Test {
        double reach, max_sine, min;
        bool needs_small;
        Change small = {}, any = {};
    };
    std::array tests{Test{0.1 * k_degree, 0, k_noise, false}, Test{0.1 * k_degree, 0.51, k_weakest, true},
                     Test{10 * k_degree, 0, k_noise, true}};
    const auto value = [&](std::size_t i, int c) {
        return cosines(samples.wl[i], samples.wv[i]) * double(samples.colour[i][c]);
    };
    for (std::size_t point = 0; point < count; point += 1 + count / k_searches) {
        const std::size_t i = sample[point];
        std::array<std::uint32_t, k_near> near;
        std::array<float, k_near> distance2;
        const std::size_t found =
            tree.knnSearch(points.coordinates[point].data(), k_near, near.data(), distance2.data());
        for (std::size_t n = 0; n < found; ++n) {
            const std::size_t k = sample[near[n]];
            const Complex rotation = rotation_between(samples, i, k);
            if (near[n] == point || rotation == 0.0) continue;
            double squares = 0, other_squares = 0, squared_change = 0;
            for (int c = 0; c < 3; ++c) {
                squares += elementary::square(value(i, c)), other_squares += elementary::square(value(k, c));
                squared_change += elementary::square(value(i, c) - value(k, c));
            }
            for (Test& test : tests) {
                if (double(distance2[n]) > test.reach * test.reach) continue;
                const bool is_small =
                    rotation.real() >= elementary::cos(k_small_rotation) || std::abs(rotation.imag()) <= test.max_sine;
                Change& change = is_small ? test.small : test.any;
                change.squares += squares;
                change.squared_changes += squared_change;
                ++change.pairs;
                if (squared_change > 0) change.relative += squared_change / (squares + other_squares);
            }
        }
    }
    for (const auto& [reach, max_sine, min, needs_small, small, any] : tests) {
        const bool has_small = small.pairs >= k_min_pairs;
        if (any.pairs < k_min_pairs || (needs_small && !has_small)) continue;
        const bool is_noise = has_small && (any.ratio() <= k_max_growth * small.ratio() ||
                                            any.mean_relative() <= k_min_growth * small.mean_relative());
        if (any.ratio() > min && !is_noise) return std::sqrt(any.ratio());
        if (max_sine > 0) break;  // exact pairs tell more than others
    }
    return 0;
}

}  // namespace
