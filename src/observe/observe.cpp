#include <algorithm>
#include <cmath>
#include <optional>

#include "base/errors.h"
#include "base/parallel.h"
#include "base/reporter.h"
#include "observe/albedos.h"
#include "observe/costs.h"
#include "observe/observations.h"
#include "observe/observe_pictures.h"
#include "observe/pair_weights.h"
#include "observe/pairs.h"
#include "observe/point_lights.h"
#include "srbf/elementary.h"

namespace srbf {
namespace {

constexpr double k_least_theta = k_degree;
constexpr std::size_t k_least_count = 1024, k_most_count = std::size_t(1) << 24;
/// One horizon pair follows so many others.
constexpr std::size_t k_pairs_a_horizon_pair = 7;
/// The pool of pairs is this many times as large as the observations, at most k_most_pairs.
constexpr std::size_t k_pool = 8, k_most_pairs = std::size_t(1) << 20;
/// This share is chosen with probability proportional to Σ w |f|², the rest uniformly (docs/fitting.md, Selection).
constexpr double k_by_energy = 0.5;
/// Pairs that one thread evaluates at once.
constexpr std::size_t k_part = 4096;

/// Evaluates f at `draw(i)`, i < count. Keeps the pairs that exist and have a value, in order.
template <typename DrawAt>
Observations measured(const Evaluate& f, std::size_t count, int threads, const DrawAt& draw, Reporter& reporter) {
    std::vector<Observations> parts(part_count(count, k_part));
    parallel_for_parts(count, k_part, threads, [&](std::size_t begin, std::size_t end) {
        if (!reporter.advance("observing", double(k_part))) return;
        std::vector<Vec3f> wl, wv;
        std::vector<double> weight;
        for (std::size_t i = begin; i < end; ++i)
            if (const std::optional<DrawnPair> one = draw(i))
                wl.push_back(one->pair.wl), wv.push_back(one->pair.wv), weight.push_back(one->weight);
        std::vector<Rgb> values(wl.size());
        f(wl, wv, values);
        Observations& kept = parts[begin / k_part];
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (!is_finite(values[i])) {
                ++kept.masked;
                continue;
            }
            for (int c = 0; c < 3; ++c) kept.clamped += values[i][c] < 0;
            kept.add(wl[i], wv[i], values[i], weight[i]);
        }
    });
    Observations all;
    for (const Observations& part : parts) {
        all.append(part);
        all.masked += part.masked, all.clamped += part.clamped;
    }
    return all;
}

/// The smoothed values, those below 0 set to 0. Adds to f what these lacked: noise about a value above 0 keeps its mean.
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

/// Measured values at the pairs of each kind. Observations are chosen from the pool.
struct MeasuredPairs {
    std::size_t count;  ///< of observations to choose
    Observations pool, horizon, bound;
    std::vector<Rgb> level;  ///< of the pool, smoothed: what weights are made of
};
Result<MeasuredPairs> measured_pairs(const Evaluate& f, double theta_max, const ObserveOptions& options,
                                     const ProgressToken& progress) {
    const PairDraws draws(theta_max, traits(options.objective).of_pictures, k_mirror_pairs / options.fewer,
                          std::mt19937_64(options.seed));
    const std::size_t horizon_count = options.count / (k_pairs_a_horizon_pair + 1);
    const std::size_t count = options.count - horizon_count,
                      pool_count = std::max(count, std::min(k_pool * count, k_most_pairs) / options.fewer);
    // Twice as many horizon pairs as needed, since not each draw is a pair with a measurement.
    Reporter reporter(progress, double(pool_count + 2 * horizon_count + draws.bound_pairs()));
    const auto drawn = [&](std::size_t number, auto kind) {
        return measured(
            f, number, options.threads, [&](std::size_t i) { return (draws.*kind)(i); }, reporter);
    };
    MeasuredPairs all{count,
                      drawn(pool_count, &PairDraws::fitted),
                      drawn(2 * horizon_count, &PairDraws::horizon),
                      drawn(draws.bound_pairs(), &PairDraws::bound),
                      {}};
    if (reporter.cancelled()) return cancelled_error("observe");
    const auto raised = [&](Observations& of) { return raise(of.f, of.wl, of.wv, options.smoothed); };
    all.level = raised(all.pool);
    raised(all.horizon);
    all.bound.f = raised(all.bound);  // a bound is exceeded by values, not by their noise
    return all;
}

/// Pairs chosen of the pool.
struct ChosenPairs {
    Observations pairs;  ///< with Σ w |f|² = 1
    std::vector<Rgb> level;
    std::vector<double> solid_angle;  ///< that each stands for [sr²]
};
/// Chooses about `count` of the pairs, in order: half by their share of Σ w |f|², half uniformly. Sums over the chosen
/// pairs, their weights divided by the expected number of times that they are chosen, are unbiased; pairs that are
/// chosen several times are merged.
ChosenPairs chosen_pairs(const Observations& pool, std::span<const Rgb> level, std::span<const double> weight,
                         std::size_t count) {
    const double energy = energy_of(level, weight), size = double(pool.f.size());
    ChosenPairs chosen;
    double sum = 0.5;  // so that the number of chosen pairs is rounded to nearest
    for (std::size_t i = 0; i < pool.f.size(); ++i) {
        const double by_energy = weight[i] * square_of(level[i]) / energy, alike = 1 / size;
        const double expected = double(count) * (k_by_energy * by_energy + (1 - k_by_energy) * alike);
        const double number = std::floor(sum + expected) - std::floor(sum);
        sum += expected;
        if (!(number > 0)) continue;
        const double times = number / expected;
        chosen.pairs.add(pool.wl[i], pool.wv[i], pool.f[i], weight[i] * times);
        chosen.level.push_back(level[i]);
        chosen.solid_angle.push_back(pool.weight[i] * times / size);
    }
    chosen.pairs.normalise();
    return chosen;
}

/// Adds pairs chosen of the pool and a horizon pair after every seventh, with their weights.
void add_fitted(Observations& to, const MeasuredPairs& measured, const ObserveOptions& options) {
    const auto& [count, pool, horizon, bound, level] = measured;
    std::vector<double> weight = pool.weight;
    weigh(options.objective, to.typical, pool.wl, pool.wv, level, weight, options.threads);
    const auto [chosen, chosen_level, solid_angle] = chosen_pairs(pool, level, weight, count);
    const std::size_t horizon_count = std::min(horizon.f.size(), chosen.f.size() / k_pairs_a_horizon_pair);
    const double largest = std::max({largest_square(pool), largest_square(horizon), largest_square(bound)});
    std::vector<double> angle;
    std::vector<Rgb> seen;
    for (std::size_t k = 0; k < chosen.f.size(); ++k) {
        to.add(chosen.wl[k], chosen.wv[k], chosen.f[k], chosen.weight[k]);
        angle.push_back(solid_angle[k]), seen.push_back(chosen_level[k]);
        const std::size_t h = k / k_pairs_a_horizon_pair;
        if (k % k_pairs_a_horizon_pair + 1 < k_pairs_a_horizon_pair || h >= horizon_count) continue;
        to.add(horizon.wl[h], horizon.wv[h], horizon.f[h],
               horizon_weight(horizon.wl[h], horizon.wv[h], k_horizon_importance, horizon_count, largest));
        angle.push_back(0), seen.push_back(horizon.f[h]);
    }
    if (traits(options.objective).of_pictures) to.point_light_weight = point_light_weights(to.wl, to.wv, seen, angle);
}

}  // namespace

Result<double> valid_theta(Objective objective, double max_theta) {
    const double theta = max_theta == 0 ? default_max_theta(objective) : max_theta;
    if (theta >= k_least_theta && theta <= k_horizon_theta) return theta;
    return argument_error("observe", "max_theta",
                          fmt::format("{:g} to {:g} degrees", k_least_theta / k_degree, k_horizon_theta / k_degree),
                          fmt::format("{:g}", theta / k_degree));
}

Result<Observations> observe(const Evaluate& f, const ObserveOptions& options, const ProgressToken& progress) {
    const StandardArithmetic mode;
    const auto theta_max = valid_theta(options.objective, options.max_theta);
    if (!theta_max) return theta_max.error();
    if (const auto valid = require_range("observe", "count", options.count, k_least_count, k_most_count); !valid)
        return valid.error();
    const auto measured = measured_pairs(f, *theta_max, options, progress);
    if (!measured) return measured.error();
    const auto& [count, pool, horizon, bound, level] = *measured;
    if (pool.f.size() + horizon.f.size() == 0) return no_data_error("observe", "pairs with a measurement");

    Observations all;
    all.masked = pool.masked + horizon.masked + bound.masked;
    all.clamped = pool.clamped + horizon.clamped + bound.clamped;
    all.objective = options.objective;
    all.typical = typical_value(options.objective, pool.wl, pool.wv, level, pool.weight);
    if (!(all.typical > 0)) return no_data_error("observe", "values", "some above 0");
    add_fitted(all, *measured, options);
    all.append(bound);
    all.bound_pairs = bound.f.size();
    all.integrals = observe_albedos(f, options, *theta_max);
    if (traits(options.objective).of_pictures) {
        all.views = observe_views(options.smoothed ? options.smoothed : f, *theta_max, options.threads);
        all.integral_error = options.smoothed ? albedo_error_of_noise(options.noise) : k_albedo_error_with_pixels;
    }
    return all;
}

void observe_spectra(Observations& observations, const Channels& spectra) {
    const StandardArithmetic mode;
    observations.wavelengths = spectra.wavelengths;
    const std::size_t C = spectra.count();
    observations.spectrum.resize(C * observations.f.size());
    spectra.evaluate(observations.wl, observations.wv, observations.spectrum);
    observations.clamped = std::uint64_t(clamp_negative(observations.spectrum));
    for (ObservedIntegral& of : observations.integrals) {
        of.spectrum.resize(C * of.wl.size());
        spectra.evaluate(of.wl, of.wv, of.spectrum);
        clamp_negative(of.spectrum);
    }
}

}  // namespace srbf
