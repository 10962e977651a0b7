#include "errors/measures.h"

#include <cassert>
#include <limits>

#include "base/parallel.h"
#include "base/reporter.h"
#include "brdf/directions.h"
#include "brdf/values.h"
#include "errors/measure_sums.h"
#include "errors/picture_errors.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

/// Pairs of directions with weights; a pair of weight 0 is ignored.
struct WeightedPairs {
    std::vector<Vec3f> wl, wv;
    std::vector<double> weight;
    explicit WeightedPairs(std::size_t count) : wl(count), wv(count), weight(count) {}
    std::size_t size() const { return wl.size(); }
};

/// The measures of one BRDF against the reference, from its sums.
Measures measures_of(const ErrorSums& sums) {
    Measures all;
    for (std::size_t m = 0; m < k_measures.size(); ++m) {
        const auto [error, reference] = sums.measures[m];
        const double ratio = reference > 0 ? error / reference
                             : error == 0  ? 0
                                           : std::numeric_limits<double>::infinity();
        all.*k_measures[m].member = k_measures[m].is_ratio ? ratio : std::sqrt(ratio) / k_measures[m].unit;
    }
    all.pairs = sums.pairs, all.masked = sums.masked;
    return all;
}

/// Adds the errors of each of `others` against f to its sums. The channels of a pair are contiguous.
void add_errors(const WeightedPairs& pairs, std::span<const float> f, std::span<const std::vector<float>> others,
                std::span<ErrorSums> sums) {
    if (pairs.size() == 0) return;
    const std::size_t C = f.size() / pairs.size();
    PairCosines cosines{};
    TransformedValues transformed{}, transformed_other{};
    std::vector<PairColumn> weight(others.size());
    for (std::size_t first = 0; first < pairs.size(); first += k_pair_block) {
        const std::size_t count = std::min(k_pair_block, pairs.size() - first);
        const auto is_measured = [&](std::span<const float> values, std::size_t i) {
            const auto channels = values.subspan((first + i) * C, C);
            return std::ranges::none_of(channels, [](float x) { return std::isnan(x); });
        };
        for (PairColumn& column : weight) column.fill(0);
        for (std::size_t i = 0; i < count; ++i) {
            cosines.light[i] = pairs.wl[first + i].z, cosines.viewer[i] = pairs.wv[first + i].z;
            if (!(pairs.weight[first + i] > 0)) continue;
            const bool in_reference = is_measured(f, i);
            for (std::size_t k = 0; k < others.size(); ++k) {
                const bool in_both = in_reference && is_measured(others[k], i);
                ++(in_both ? sums[k].pairs : sums[k].masked);
                if (in_both) weight[k][i] = float(pairs.weight[first + i]);
            }
        }
        for (std::size_t c = 0; c < C; ++c) {
            const auto transform_channel = [&](std::span<const float> values, TransformedValues& result) {
                for (std::size_t i = 0; i < count; ++i) result.f[i] = values[(first + i) * C + c];
                transform(cosines, result);
            };
            transform_channel(f, transformed);
            for (std::size_t k = 0; k < others.size(); ++k) {
                transform_channel(others[k], transformed_other);
                sums[k] += error_sums(cosines, weight[k], transformed, transformed_other);
            }
        }
    }
}

/// Sums over blocks of pairs, each filled by `fill(block, pairs)`, added in the order of the blocks.
template <typename Fill>
std::vector<Measures> measure(const Channels& reference, std::span<const Channels> others, std::size_t blocks,
                              std::size_t block_size, const MeasureOptions& options, const Fill& fill) {
    std::vector<std::vector<ErrorSums>> parts(blocks, std::vector<ErrorSums>(others.size()));
    Reporter reporter(options.progress, double(blocks));
    parallel_for(blocks, options.threads, [&](std::size_t block) {
        if (!reporter.advance("measuring the error", 1)) return;
        WeightedPairs pairs(block_size);
        fill(block, pairs);
        const auto values = [&](const Channels& brdf) {
            assert(brdf.count() == reference.count());
            std::vector<float> f(brdf.count() * block_size);
            brdf.evaluate(pairs.wl, pairs.wv, f);
            return f;
        };
        std::vector<std::vector<float>> other_values;
        for (const Channels& other : others) other_values.push_back(values(other));
        add_errors(pairs, values(reference), other_values, parts[block]);
    });
    std::vector<Measures> measures;
    for (std::size_t k = 0; k < others.size(); ++k) {
        ErrorSums sums;
        for (const auto& part : parts) sums += part[k];
        measures.push_back(measures_of(sums));
    }
    return measures;
}

constexpr int k_single_albedo_points = 1 << 16;    ///< of `albedo`
constexpr int k_compared_albedo_points = 1 << 14;  ///< of each view whose albedos are compared

/// The albedos [angle][BRDF] at the given angles [rad], over the pairs at which the first BRDF was measured.
std::vector<std::vector<Rgb>> albedos(std::span<const Evaluate> brdfs, std::span<const double> theta_v,
                                      const MeasureOptions& options) {
    using Sum = std::array<double, 3>;
    constexpr std::size_t parts = MirrorMixture::k_parts;
    const MirrorMixture mixture(options.max_theta);
    std::vector<std::vector<Sum>> sums(theta_v.size() * parts, std::vector<Sum>(brdfs.size()));
    parallel_for(sums.size(), options.threads, [&](std::size_t task) {
        if (options.progress.cancelled()) return;
        const Vec3d wv = spherical(theta_v[task / parts], 0.0);
        const Quadrature points = mixture.quadrature_of_part(int(task % parts), wv, k_compared_albedo_points);
        const std::vector<Vec3f> viewer(points.w.size(), to_float(wv));
        std::vector<Rgb> f(points.w.size()), first;
        for (std::size_t k = 0; k < brdfs.size(); ++k) {
            brdfs[k](points.w, viewer, f);
            if (k == 0) first = f;
            for (std::size_t i = 0; i < f.size(); ++i)
                for (std::size_t c = 0; c < 3; ++c)
                    if (const float value = f[i][int(c)]; !std::isnan(value) && !std::isnan(first[i][int(c)]))
                        sums[task][k][c] += points.weight[i] * double(points.w[i].z) * double(value);
        }
    });
    std::vector<std::vector<Rgb>> all(theta_v.size(), std::vector<Rgb>(brdfs.size()));
    for (std::size_t angle = 0; angle < theta_v.size(); ++angle)
        for (std::size_t k = 0; k < brdfs.size(); ++k)
            for (std::size_t c = 0; c < 3; ++c) {
                double sum = 0;
                for (std::size_t part = 0; part < parts; ++part) sum += sums[angle * parts + part][k][c];
                all[angle][k][int(c)] = float(sum);
            }
    return all;
}

}  // namespace

std::vector<Measures> measure_matrix(const Channels& reference, std::span<const Channels> others,
                                     const MeasureOptions& options, std::span<const Vec3f> directions) {
    const StandardArithmetic mode;
    std::vector<Vec3f> within;
    const auto cos_max = float(elementary::cos(options.max_theta));
    std::copy_if(directions.begin(), directions.end(), std::back_inserter(within),
                 [&](Vec3f w) { return w.z >= cos_max; });
    return measure(reference, others, within.size(), within.size(), options,
                   [&](std::size_t block, WeightedPairs& pairs) {
                       pairs.wl = within;
                       std::ranges::fill(pairs.wv, within[block]);
                       std::ranges::fill(pairs.weight, 1.0);
                   });
}

std::vector<Measures> measure_heldout(const Channels& reference, std::span<const Channels> others,
                                      const MeasureOptions& options, std::uint64_t count, std::uint64_t seed) {
    const StandardArithmetic mode;
    constexpr std::size_t block_size = 1000;
    const MirrorMixture mixture(options.max_theta);
    return measure(reference, others, std::size_t((count + block_size - 1) / block_size), block_size, options,
                   [&](std::size_t block, WeightedPairs& pairs) {
                       std::seed_seq seeds{std::uint32_t(seed), std::uint32_t(seed >> 32), std::uint32_t(block)};
                       std::mt19937_64 random(seeds);
                       for (std::size_t i = 0; i < block_size;) {
                           const double u1 = uniform(random), u2 = uniform(random);
                           const Vec3d v = mixture.sample_cap(u1, u2);
                           const double u3 = uniform(random), u4 = uniform(random), u5 = uniform(random);
                           const Vec3d l = mixture.sample(v, u3, u4, u5);
                           if (!mixture.contains(l)) continue;
                           pairs.wl[i] = to_float(l);
                           pairs.wv[i] = to_float(v);
                           pairs.weight[i] = block * block_size + i < count ? 1 / mixture.pdf(l, v) : 0;
                           ++i;
                       }
                   });
}

Measures measure_samples(std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<const float> f,
                         std::span<const float> g, double max_theta) {
    const StandardArithmetic mode;
    const float cos_max = sample_cap(max_theta);
    assert(wv.size() == wl.size() && g.size() == f.size());
    WeightedPairs pairs(wl.size());
    std::vector<float> clamped(f.size());
    for (std::size_t i = 0; i < wl.size(); ++i) {
        pairs.wl[i] = wl[i], pairs.wv[i] = wv[i];
        pairs.weight[i] = std::min(wl[i].z, wv[i].z) < cos_max ? 0 : 1;
    }
    for (std::size_t i = 0; i < f.size(); ++i) clamped[i] = std::max(f[i], 0.f);
    const std::vector<float> others[] = {{g.begin(), g.end()}};
    ErrorSums sums[1];
    add_errors(pairs, clamped, others, sums);
    return measures_of(sums[0]);
}

Rgb albedo(const Evaluate& brdf, double theta_v, double max_theta) {
    const StandardArithmetic mode;
    const Vec3d wv = spherical(theta_v, 0.0);
    const Quadrature light = albedo_quadrature(wv, max_theta, k_single_albedo_points);
    const auto [r, g, b] = weighted_sum(values_towards(brdf, light.w, to_float(wv)), light.weight);
    return {float(r), float(g), float(b)};
}

std::vector<double> albedo_errors(const Evaluate& reference, std::span<const Evaluate> others,
                                  const MeasureOptions& options) {
    const StandardArithmetic mode;
    std::vector<Evaluate> brdfs{reference};
    brdfs.insert(brdfs.end(), others.begin(), others.end());
    std::vector<double> theta;
    for (const double degrees : k_albedo_theta)
        if (!(degrees * k_degree > options.max_theta)) theta.push_back(degrees * k_degree);
    std::vector<double> errors(others.size());
    for (const std::vector<Rgb>& albedo : albedos(brdfs, theta, options))
        for (std::size_t k = 0; k < others.size(); ++k) {
            const double a = luminance(albedo[0]), b = luminance(albedo[k + 1]);
            if (a != b) errors[k] = std::max(errors[k], std::abs(b - a) / a);
        }
    return errors;
}

std::vector<Comparison> compare(const Evaluate& reference, std::span<const Evaluate> others,
                                const MeasureOptions& options, std::span<const Vec3f> directions) {
    const Channels f = rgb_channels(reference);
    const std::vector<Channels> channels = rgb_channels(others);
    const auto matrix = measure_matrix(f, channels, options, directions),
               heldout = measure_heldout(f, channels, options);
    const auto albedo = albedo_errors(reference, others, options);
    std::vector<Appearance> appearance(others.size());
    if (options.pictures)
        appearance = compare_pictures(
            reference, others,
            {.threads = options.threads, .is_isotropic = options.isotropic, .progress = options.progress});
    std::vector<Comparison> comparisons;
    for (std::size_t k = 0; k < others.size(); ++k)
        comparisons.push_back({matrix[k], heldout[k], albedo[k], appearance[k]});
    return comparisons;
}

}  // namespace
