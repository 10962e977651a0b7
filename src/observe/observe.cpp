#include <cmath>

#include "base/errors.h"
#include "base/parallel.h"
#include "base/reporter.h"
#include "observe/observations.h"
#include "observe/pair_weights.h"
#include "observe/pairs.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

constexpr double k_min_theta = k_degree;
constexpr std::size_t k_min_count = 1024, k_max_count = std::size_t(1) << 24;
/// One horizon pair follows this many other pairs.
constexpr std::size_t k_pairs_per_horizon_pair = 7;
/// The pool of pairs is this many times as large as the observations, at most k_max_pairs.
constexpr std::size_t k_pool_factor = 8, k_max_pairs = std::size_t(1) << 20;
/// This fraction is chosen with probability proportional to Σ w |f|², the rest uniformly (docs/fitting.md, Pairs).
constexpr double k_energy_fraction = 0.5;
/// Number of pairs that one task evaluates.
constexpr std::size_t k_task_pairs = 4096;

/// Evaluates f at the pairs `draw(i)`, i < count, and keeps those that exist and have a value, in order.
template <typename DrawAt>
Observations evaluate_pairs(const Evaluate& f, std::size_t count, int threads, const DrawAt& draw, Reporter& reporter) {
    std::vector<Observations> parts(chunk_count(count, k_task_pairs));
    parallel_for_chunks(count, k_task_pairs, threads, [&](std::size_t begin, std::size_t end) {
        if (!reporter.advance("observing", double(k_task_pairs))) return;
        std::vector<Vec3f> wl, wv;
        std::vector<double> weight;
        for (std::size_t i = begin; i < end; ++i)
            if (const std::optional<DrawnPair> drawn = draw(i)) {
                wl.push_back(drawn->pair.wl);
                wv.push_back(drawn->pair.wv);
                weight.push_back(drawn->weight);
            }
        std::vector<Rgb> values(wl.size());
        f(wl, wv, values);
        Observations& kept = parts[begin / k_task_pairs];
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (!is_finite(values[i])) {
                ++kept.masked;
                continue;
            }
            for (int c = 0; c < 3; ++c) kept.clamped += values[i][c] < 0;
            kept.add(wl[i], wv[i], values[i], weight[i]);
        }
    });
    Observations observations;
    for (const Observations& part : parts) {
        observations.append(part);
        observations.masked += part.masked;
        observations.clamped += part.clamped;
    }
    return observations;
}

/// Returns the smoothed values with negative ones set to 0, and raises f as much, so that its noise keeps its mean.
std::vector<Rgb> raise(std::span<Rgb> f, std::span<const Vec3f> wl, std::span<const Vec3f> wv,
                       const Evaluate& smoothed) {
    std::vector<Rgb> level(f.begin(), f.end());
    if (smoothed) smoothed(wl, wv, level);
    for (std::size_t i = 0; i < level.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            f[i][c] -= std::min(level[i][c], 0.f);
            level[i][c] = std::max(level[i][c], 0.f);
        }
    return level;
}

/// Measured values at pairs of each kind. The observations are chosen from the pool.
struct MeasuredPairs {
    std::size_t count;  ///< number of observations to choose
    Observations pool, horizon, bound;
    std::vector<Rgb> level;  ///< the smoothed values of the pool, which determine the weights
};
Result<MeasuredPairs> measure_pairs(const Evaluate& f, double theta_max, const ObserveOptions& options,
                                    const ProgressToken& progress) {
    const PairDraws draws(theta_max, traits(options.objective).uses_pictures, k_mirror_pairs / options.fewer,
                          std::mt19937_64(options.seed));
    const std::size_t horizon_count = options.count / (k_pairs_per_horizon_pair + 1);
    const std::size_t count = options.count - horizon_count,
                      pool_count = std::max(count, std::min(k_pool_factor * count, k_max_pairs) / options.fewer);
    // Twice as many horizon pairs as needed, because not every draw is a pair with a measurement.
    Reporter reporter(progress, double(pool_count + 2 * horizon_count + draws.bound_pairs()));
    const auto evaluate = [&](std::size_t number, auto kind) {
        return evaluate_pairs(
            f, number, options.threads, [&](std::size_t i) { return (draws.*kind)(i); }, reporter);
    };
    MeasuredPairs pairs{count,
                        evaluate(pool_count, &PairDraws::fitted),
                        evaluate(2 * horizon_count, &PairDraws::horizon),
                        evaluate(draws.bound_pairs(), &PairDraws::bound),
                        {}};
    if (reporter.cancelled()) return cancelled_error("observe");
    const auto raise_values = [&](Observations& observations) {
        return raise(observations.f, observations.wl, observations.wv, options.smoothed);
    };
    pairs.level = raise_values(pairs.pool);
    raise_values(pairs.horizon);
    pairs.bound.f = raise_values(pairs.bound);  // bounds are compared with values, not with their noise
    return pairs;
}

/// Chooses approximately `count` of the pairs, in order: half by their fraction of Σ w |f|², half uniformly.
/// Weights are divided by the expected number of times that a pair is chosen, so that sums over the chosen pairs
/// are unbiased, and scaled so that Σ w |f|² = 1. Pairs chosen several times are merged.
Observations choose_pairs(const Observations& pool, std::span<const Rgb> level, std::span<const double> weight,
                          std::size_t count) {
    const double energy = energy_of(level, weight), size = double(pool.f.size());
    Observations chosen;
    double sum = 0.5;  // rounds the number of chosen pairs to the nearest integer
    for (std::size_t i = 0; i < pool.f.size(); ++i) {
        const double energy_fraction = weight[i] * square_of(level[i]) / energy, uniform = 1 / size;
        const double expected =
            double(count) * (k_energy_fraction * energy_fraction + (1 - k_energy_fraction) * uniform);
        const double number = std::floor(sum + expected) - std::floor(sum);
        sum += expected;
        if (!(number > 0)) continue;
        chosen.add(pool.wl[i], pool.wv[i], pool.f[i], weight[i] * number / expected);
    }
    chosen.normalise();
    return chosen;
}

/// Adds the pairs chosen from the pool, and a horizon pair after every seventh, with their weights.
void add_fitted(Observations& observations, const MeasuredPairs& measured, const ObserveOptions& options) {
    const auto& [count, pool, horizon, bound, level] = measured;
    std::vector<double> weight = pool.weight;
    weigh(options.objective, observations.typical, pool.wl, pool.wv, level, weight, options.threads);
    const Observations chosen = choose_pairs(pool, level, weight, count);
    const std::size_t horizon_count = std::min(horizon.f.size(), chosen.f.size() / k_pairs_per_horizon_pair);
    const double largest = std::max({largest_square(pool), largest_square(horizon), largest_square(bound)});
    for (std::size_t k = 0; k < chosen.f.size(); ++k) {
        observations.add(chosen.wl[k], chosen.wv[k], chosen.f[k], chosen.weight[k]);
        const std::size_t h = k / k_pairs_per_horizon_pair;
        if (k % k_pairs_per_horizon_pair + 1 < k_pairs_per_horizon_pair || h >= horizon_count) continue;
        observations.add(horizon.wl[h], horizon.wv[h], horizon.f[h],
                         horizon_weight(horizon.wl[h], horizon.wv[h], k_horizon_importance, horizon_count, largest));
    }
}

}  // namespace

Result<double> valid_theta(Objective objective, double max_theta) {
    const double theta = max_theta == 0 ? default_max_theta(objective) : max_theta;
    if (theta >= k_min_theta && theta <= k_horizon_theta) return theta;
    return argument_error("observe", "max_theta",
                          fmt::format("{:g} to {:g} degrees", k_min_theta / k_degree, k_horizon_theta / k_degree),
                          fmt::format("{:g}", theta / k_degree));
}

Result<Observations> observe(const Evaluate& f, const ObserveOptions& options, const ProgressToken& progress) {
    const StandardArithmetic mode;
    const auto theta_max = valid_theta(options.objective, options.max_theta);
    if (!theta_max) return theta_max.error();
    if (const auto valid = require_range("observe", "count", options.count, k_min_count, k_max_count); !valid)
        return valid.error();
    const auto measured = measure_pairs(f, *theta_max, options, progress);
    if (!measured) return measured.error();
    const auto& [count, pool, horizon, bound, level] = *measured;
    if (pool.f.size() + horizon.f.size() == 0) return no_data_error("observe", "pairs with a measurement");

    Observations observations;
    observations.masked = pool.masked + horizon.masked + bound.masked;
    observations.clamped = pool.clamped + horizon.clamped + bound.clamped;
    observations.objective = options.objective;
    observations.typical = typical_value(options.objective, pool.wl, pool.wv, level, pool.weight);
    if (!(observations.typical > 0)) return no_data_error("observe", "values", "some above 0");
    add_fitted(observations, *measured, options);
    observations.append(bound);
    observations.bound_pairs = bound.f.size();
    observations.integrals = observe_albedos(f, options, *theta_max);
    if (traits(options.objective).uses_pictures) {
        observations.views = observe_views(options.smoothed ? options.smoothed : f, *theta_max, options.threads);
        observations.integral_error =
            options.smoothed ? albedo_error_of_noise(options.noise) : k_albedo_error_with_pixels;
    }
    return observations;
}

void observe_spectra(Observations& observations, const Channels& spectra) {
    const StandardArithmetic mode;
    observations.wavelengths = spectra.wavelengths;
    observations.spectrum.resize(spectra.count() * observations.f.size());
    spectra.evaluate(observations.wl, observations.wv, observations.spectrum);
    observations.clamped = std::uint64_t(clamp_negative(observations.spectrum));
}

}  // namespace
