#include "srbf/metrics.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

#include "parallel.h"
#include "reporter.h"
#include "srbf/directions.h"

namespace srbf {
namespace {

/// ∛x within 1e-13, faster than std::cbrt by far: Halley's iteration from a third of the exponent.
double cube_root(float x) {
    const double a = std::abs(double(x));
    double y = double(std::bit_cast<float>(std::bit_cast<std::uint32_t>(std::abs(x)) / 3 + 0x2a508935u));
    for (int i = 0; i < 2; ++i) y *= (y * y * y + 2 * a) / (2 * y * y * y + a);
    return x == 0 || !std::isfinite(x) ? double(x) : std::copysign(y, double(x));
}

/// A value as the measures other than squares see it.
struct Seen {
    float logarithm;
    double root, sixth_root;
};
/// `root_l`: the cube root of cos_l.
Seen seen(float f, float cos_l, double root_l) {
    const double root = cube_root(f);
    return {std::log1p(f * cos_l), root, std::sqrt(root * root_l)};
}
/// Of the channels of each pair.
void see(std::span<const float> f, std::span<const Vec3f> wl, std::span<Seen> out) {
    const std::size_t C = f.size() / wl.size();
    for (std::size_t i = 0; i < wl.size(); ++i) {
        const double root_l = cube_root(wl[i].z);
        for (std::size_t k = i * C; k < (i + 1) * C; ++k) out[k] = seen(f[k], wl[i].z, root_l);
    }
}

/// The sums of which the measures consist.
struct Sums {
    double squared = 0, squared_whole = 0, cosine = 0, cosine_whole = 0, logarithm = 0, log_weight = 0, root = 0,
           root_whole = 0, sixth = 0, sixth_whole = 0;
    std::uint64_t pairs = 0, masked = 0;

    void add(std::span<const float> f, std::span<const Seen> f_seen, std::span<const float> g, Vec3f wl, Vec3f wv,
             double weight) {
        const auto is_nan = [](std::span<const float> x) {
            return std::ranges::any_of(x, [](float channel) { return std::isnan(channel); });
        };
        if (is_nan(f) || is_nan(g)) {
            ++masked;
            return;
        }
        ++pairs;
        const auto square = [](double x) { return x * x; };
        const double cos_l = double(wl.z), root_l = cube_root(wl.z), area = weight * double(wv.z);
        for (std::size_t c = 0; c < f.size(); ++c) {
            const double a = double(f[c]), b = double(g[c]);
            squared += weight * square(a - b);
            squared_whole += weight * square(a);
            cosine += area * square((a - b) * cos_l);
            cosine_whole += area * square(a * cos_l);
            const Seen of_f = f_seen[c], of_g = seen(g[c], wl.z, root_l);
            logarithm += area * square(double(of_f.logarithm - of_g.logarithm));
            log_weight += area;
            root += weight * square(of_f.root - of_g.root);
            root_whole += weight * square(of_f.root);
            sixth += area * square(of_f.sixth_root - of_g.sixth_root);
            sixth_whole += area * square(of_f.sixth_root);
        }
    }
    Sums& operator+=(const Sums& s) {
        squared += s.squared, squared_whole += s.squared_whole;
        cosine += s.cosine, cosine_whole += s.cosine_whole;
        logarithm += s.logarithm, log_weight += s.log_weight;
        root += s.root, root_whole += s.root_whole;
        sixth += s.sixth, sixth_whole += s.sixth_whole;
        pairs += s.pairs, masked += s.masked;
        return *this;
    }
    Measures measures() const {
        const auto ratio = [](double part, double whole) {
            return whole > 0 ? part / whole : part == 0 ? 0 : std::numeric_limits<double>::infinity();
        };
        return {ratio(squared, squared_whole),
                ratio(cosine, cosine_whole),
                std::sqrt(ratio(logarithm, log_weight)),
                ratio(root, root_whole),
                ratio(sixth, sixth_whole),
                pairs,
                masked};
    }
};

/// Sums over blocks of pairs, each filled by `fill(block, wl, wv, weight)`, added in the order of the blocks.
template <typename Fill>
std::vector<Measures> measure(const Channels& reference, std::span<const Channels> others, std::size_t blocks,
                              std::size_t block_size, const MeasureOptions& options, const Fill& fill) {
    std::vector<std::vector<Sums>> parts(blocks, std::vector<Sums>(others.size()));
    Reporter reporter(options.progress, double(blocks));
    parallel_for(blocks, options.threads, [&](std::size_t block) {
        if (!reporter.advance("measuring the error", 1)) return;
        std::vector<Vec3f> wl(block_size), wv(block_size);
        std::vector<double> weight(block_size);
        fill(block, wl, wv, weight);
        const std::size_t C = reference.count();
        std::vector<float> f(C * block_size), g(f.size());
        reference.evaluate(wl, wv, f);
        std::vector<Seen> f_seen(f.size());
        see(f, wl, f_seen);
        for (std::size_t k = 0; k < others.size(); ++k) {
            assert(others[k].count() == C);
            others[k].evaluate(wl, wv, g);
            for (std::size_t i = 0; i < block_size; ++i)
                if (weight[i] > 0)
                    parts[block][k].add({&f[i * C], C}, {&f_seen[i * C], C}, {&g[i * C], C}, wl[i], wv[i], weight[i]);
        }
    });
    std::vector<Measures> measures;
    for (std::size_t k = 0; k < others.size(); ++k) {
        Sums sums;
        for (const auto& part : parts) sums += part[k];
        measures.push_back(sums.measures());
    }
    return measures;
}

std::vector<Channels> rgb_channels(std::span<const Evaluate> brdfs) {
    std::vector<Channels> all;
    for (const Evaluate& brdf : brdfs) all.push_back(srbf::rgb_channels(brdf));
    return all;
}

std::vector<float> flat(std::span<const Rgb> colours) {
    std::vector<float> numbers;
    for (const Rgb& c : colours) numbers.insert(numbers.end(), {c.r, c.g, c.b});
    return numbers;
}

constexpr int k_albedo_points = 1 << 16;

}  // namespace

std::vector<Measures> measure_matrix(const Evaluate& reference, std::span<const Evaluate> others,
                                     const MeasureOptions& options, std::span<const Vec3f> directions) {
    return measure_matrix(rgb_channels(reference), rgb_channels(others), options, directions);
}

std::vector<Measures> measure_matrix(const Channels& reference, std::span<const Channels> others,
                                     const MeasureOptions& options, std::span<const Vec3f> directions) {
    const FlushSubnormals mode;
    std::vector<Vec3f> within;
    const auto cos_max = float(std::cos(options.max_theta));
    std::copy_if(directions.begin(), directions.end(), std::back_inserter(within),
                 [&](Vec3f w) { return w.z >= cos_max; });
    return measure(reference, others, within.size(), within.size(), options,
                   [&](std::size_t block, auto& wl, auto& wv, auto& weight) {
                       wl = within;
                       std::fill(wv.begin(), wv.end(), within[block]);
                       std::fill(weight.begin(), weight.end(), 1.0);
                   });
}

std::vector<Measures> measure_matrix(const Evaluate& reference, std::span<const Evaluate> others,
                                     const MeasureOptions& options, int n) {
    const FlushSubnormals mode;
    return measure_matrix(reference, others, options, fibonacci_directions(n, options.max_theta));
}

std::vector<Measures> measure_heldout(const Evaluate& reference, std::span<const Evaluate> others,
                                      const MeasureOptions& options, std::uint64_t count, std::uint64_t seed) {
    return measure_heldout(rgb_channels(reference), rgb_channels(others), options, count, seed);
}

std::vector<Measures> measure_heldout(const Channels& reference, std::span<const Channels> others,
                                      const MeasureOptions& options, std::uint64_t count, std::uint64_t seed) {
    const FlushSubnormals mode;
    constexpr std::size_t block_size = 1000;
    const MirrorMixture mixture(options.max_theta);
    return measure(reference, others, std::size_t((count + block_size - 1) / block_size), block_size, options,
                   [&](std::size_t block, auto& wl, auto& wv, auto& weight) {
                       std::seed_seq seeds{std::uint32_t(seed), std::uint32_t(seed >> 32), std::uint32_t(block)};
                       std::mt19937_64 random(seeds);
                       for (std::size_t i = 0; i < block_size;) {
                           const double u1 = uniform(random), u2 = uniform(random);
                           const Vec3d v = mixture.sample_cap(u1, u2);
                           const double u3 = uniform(random), u4 = uniform(random), u5 = uniform(random);
                           const Vec3d l = mixture.sample(v, u3, u4, u5);
                           if (!mixture.contains(l)) continue;
                           wl[i] = to_float(l);
                           wv[i] = to_float(v);
                           weight[i] = block * block_size + i < count ? 1 / mixture.pdf(l, v) : 0;
                           ++i;
                       }
                   });
}

Measures measure_samples(std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<const float> f,
                         std::span<const float> g, double max_theta) {
    const FlushSubnormals mode;
    const float cos_max = sample_cap(max_theta);
    const std::size_t C = wl.empty() ? 0 : f.size() / wl.size();
    assert(f.size() == C * wl.size() && g.size() == f.size());
    std::vector<float> clamped(C);
    std::vector<Seen> clamped_seen(C);
    Sums sums;
    for (std::size_t i = 0; i < wl.size(); ++i) {
        if (std::min(wl[i].z, wv[i].z) < cos_max) continue;
        for (std::size_t c = 0; c < C; ++c) clamped[c] = std::max(f[i * C + c], 0.f);
        see(clamped, wl.subspan(i, 1), clamped_seen);
        sums.add(clamped, clamped_seen, g.subspan(i * C, C), wl[i], wv[i], 1);
    }
    return sums.measures();
}

Measures measure_samples(std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<const Rgb> f,
                         std::span<const Rgb> g, double max_theta) {
    return measure_samples(wl, wv, flat(f), flat(g), max_theta);
}

Measures measure_samples(std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<const Rgb> f,
                         const Evaluate& other, double max_theta) {
    std::vector<Rgb> g(f.size());
    other(wl, wv, g);
    return measure_samples(wl, wv, f, g, max_theta);
}

Rgb albedo(const Evaluate& brdf, double theta_v, double max_theta) {
    const FlushSubnormals mode;
    const Vec3d wv = spherical(theta_v, 0.0);
    const Quadrature points = MirrorMixture(max_theta).quadrature(wv, k_albedo_points);
    std::vector<Rgb> f(points.w.size());
    brdf(points.w, std::vector<Vec3f>(f.size(), to_float(wv)), f);
    std::array<double, 3> sum{};
    for (std::size_t i = 0; i < f.size(); ++i)
        for (int c = 0; c < 3; ++c)
            if (!std::isnan(f[i][c])) sum[std::size_t(c)] += points.weight[i] * double(points.w[i].z) * double(f[i][c]);
    return {float(sum[0]), float(sum[1]), float(sum[2])};
}

double albedo_error(const Evaluate& reference, const Evaluate& other, double max_theta) {
    double error = 0;
    for (const double theta : k_albedo_theta) {
        if (theta * k_degree > max_theta) continue;
        const double a = luminance(albedo(reference, theta * k_degree, max_theta));
        const double b = luminance(albedo(other, theta * k_degree, max_theta));
        if (a != b) error = std::max(error, std::abs(b - a) / a);
    }
    return error;
}

std::vector<Comparison> compare(const Evaluate& reference, std::span<const Evaluate> others,
                                const MeasureOptions& options, std::span<const Vec3f> directions) {
    const auto matrix = measure_matrix(reference, others, options, directions),
               heldout = measure_heldout(reference, others, options);
    const auto appearance = compare_pictures(reference, others, options.threads, options.progress);
    std::vector<Comparison> comparisons;
    for (std::size_t k = 0; k < others.size(); ++k)
        comparisons.push_back(
            {matrix[k], heldout[k], albedo_error(reference, others[k], options.max_theta), appearance[k]});
    return comparisons;
}

}  // namespace srbf
