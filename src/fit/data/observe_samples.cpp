#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "fit/data/check_grid.h"
#include "fit/data/folds.h"
#include "fit/data/observe_samples.h"
#include "fit/objective/objective.h"
#include "floating_point.h"
#include "r_sequence.h"
#include "srbf/directions.h"
#include "srbf/elementary.h"
#include "srbf/fit_samples.h"
#include "srbf/metrics.h"

namespace srbf {
namespace {

constexpr std::size_t k_sampled_mirror_checks = 8192;
constexpr std::size_t k_completed_pairs = 16384;
/// Pairs near the horizon, where both directions are beyond 66°: enough to cover the highlight there.
constexpr std::size_t k_grazing_pairs = 512, k_grazing_tried = 65536;
constexpr float k_grazing_cos = 0.4f;
/// Of Σ w |f|²: by less lobes follow less closely, by more they look worse elsewhere.
constexpr double k_grazing_share = 0.3;
/// The completed samples are level at the largest sample but for rounding.
constexpr double k_level = 0.999;
/// Number of pairs of the grid (of ten thousand) that also constrain lobes.
constexpr std::size_t k_most_between_samples = 4096;
/// Extrapolation beyond θmax gets a smaller weight than values of a table.
constexpr double k_guard_share = 0.1;
/// Points of the cube of which `pair_in` makes pairs.
RSequence<6> pair_points(std::mt19937_64& random) {
    std::array<double, 6> first;
    for (double& x : first) x = uniform(random);
    return RSequence<6>(first);
}
struct Pair {
    Vec3f wl, wv;
};
/// A pair of directions, many of them about each other's mirror direction; none where one is not within the cap.
std::optional<Pair> pair_in(const MirrorMixture& cap, const std::array<double, 6>& u) {
    const Vec3d v = cap.sample_cap(u[1], u[2]), l = cap.sample(v, u[3], u[4], u[5]);
    if (!cap.contains(l)) return std::nullopt;
    return Pair{to_float(l), to_float(v)};
}

/// Adds pairs of directions near the horizon where the completed samples are at least as large as every sample, with
/// `k_grazing_share` of Σ w |f|². A table's pairs are few there, so that lobes are free to exceed what they follow.
void add_grazing(Observations& to, const CompletedSamples& completed, double max_theta, std::uint64_t seed) {
    const MirrorMixture lights(max_theta);
    std::mt19937_64 random(seed);
    RSequence<6> points = pair_points(random);
    Observations grazing;
    for (std::size_t tried = 0; tried < k_grazing_tried && grazing.f.size() < k_grazing_pairs; ++tried) {
        const auto pair = pair_in(lights, points.next());
        if (!pair || std::max(pair->wl.z, pair->wv.z) > k_grazing_cos) continue;
        const Rgb f = value(completed, pair->wl, pair->wv);
        const double area = double(pair->wl.z) * double(pair->wv.z);
        if (largest_of(f) * area >= k_level * completed.allowed) grazing.add(pair->wl, pair->wv, f, area * area);
    }
    grazing.normalise();
    const double share = k_grazing_share * double(grazing.f.size()) / double(k_grazing_pairs);
    for (std::size_t i = 0; i < grazing.f.size(); ++i)
        to.add(grazing.wl[i], grazing.wv[i], grazing.f[i], share * grazing.weight[i]);
}

/// The completed samples within θmax observed like a table, as much Σ w |f|² of the samples themselves, and pairs near
/// the horizon.
Result<Observations> observe_completed(const ScatteredSamples& samples, const Observations& observed,
                                       const ObserveSamplesOptions& options, const ProgressToken& progress) {
    const auto completed = complete(samples, options.max_theta, options.threads, options.only_completed > 0);
    if (!completed) return completed.error();
    const auto table = observe(evaluator(*completed),
                               {.objective = options.objective,
                                .max_theta = options.max_theta,
                                .count = options.only_completed > 0 ? options.only_completed : k_completed_pairs,
                                .seed = options.seed,
                                .threads = options.threads},
                               progress);
    if (!table) return table.error();
    Observations all = *table;
    if (options.only_completed > 0) all.views.clear();
    all.point_light_weight.clear();
    const std::size_t pairs = all.fitted();
    all.resize(pairs);
    for (std::size_t i = 0; i < observed.f.size(); ++i)
        all.add(observed.wl[i], observed.wv[i], observed.f[i], observed.weight[i]);
    if (options.only_completed == 0) add_grazing(all, *completed, options.max_theta, options.seed);
    std::mt19937_64 random(options.seed);
    all.shuffle(random);
    for (std::size_t i = pairs; i < table->f.size(); ++i) all.add(table->wl[i], table->wv[i], table->f[i], 0);
    return all;
}

}  // namespace

Result<SampleObservations> observe(const ScatteredSamples& samples, const ObserveSamplesOptions& options,
                                   const ProgressToken& progress) {
    const FlushSubnormals mode;
    const double theta_max = options.max_theta == 0 ? default_max_theta(options.objective) : options.max_theta;
    if (!(theta_max >= k_degree && theta_max <= k_guard_theta))
        return Error{"observe",          {}, "max_theta", "1 to 89.9 degrees", std::to_string(theta_max / k_degree),
                     ErrorCode::argument};
    const float cos_max = sample_cap(theta_max);
    SampleObservations observed;
    observed.options = options;
    observed.options.max_theta = theta_max;
    const Places places = find_places(samples);
    observed.finest = places.spacing;

    const std::size_t C = options.spectral ? samples.wavelengths.size() : 0;
    if (options.spectral && C == 0)
        return Error{"samples", {}, "spectral samples", "wavelengths", "none", ErrorCode::argument};
    if (options.spectral) observed.samples.wavelengths = observed.between.wavelengths = samples.wavelengths;
    std::vector<float> spectrum(C);

    double peak = 0;
    std::vector<std::size_t> within;
    Observations inside;  // samples within θmax
    for (std::size_t i = 0; i < samples.wl.size(); ++i) {
        if (std::min(samples.wl[i].z, samples.wv[i].z) < cos_max) continue;
        within.push_back(i);
        Rgb f = samples.colour[i];
        for (std::size_t c = 0; c < C; ++c) observed.samples.clamped += samples.spectrum[i * C + c] < 0;
        const int clamped = clamp_negative(f);
        if (C == 0) observed.samples.clamped += std::uint64_t(clamped);
        inside.add(samples.wl[i], samples.wv[i], f, 1);
        peak = std::max(peak, square_of(f) * elementary::square(double(samples.wl[i].z) * double(samples.wv[i].z)));
    }
    if (within.empty())
        return Error{"samples", {}, "samples within the largest angle", "some", "none", ErrorCode::no_data};
    std::vector<bool> seen(std::size_t(places.count), false);
    for (const std::size_t i : within) {
        const auto place = std::size_t(places.of[i]);
        observed.places += !seen[place];
        seen[place] = true;
    }
    const auto weigh_all = [&](Observations& of) {
        weigh(options.objective, observed.samples.typical, of.wl, of.wv, of.f, of.weight, options.threads);
        of.normalise();
    };
    for (const std::size_t i : within) {
        Rgb f = samples.colour[i];
        clamp_negative(f);
        std::copy_n(samples.spectrum.begin() + std::ptrdiff_t(i * C), C, spectrum.begin());
        clamp_negative(spectrum);
        observed.samples.add(samples.wl[i], samples.wv[i], f, 1, spectrum);
        observed.samples.add(samples.wv[i], samples.wl[i], f, 1, spectrum);
    }
    observed.samples.objective = options.objective;
    observed.samples.typical = typical_value(options.objective, inside.wl, inside.wv, inside.f, inside.weight);
    if (!(observed.samples.typical > 0))
        return Error{"samples", {}, "values", "some above 0", "none", ErrorCode::no_data};
    weigh_all(observed.samples);

    const auto fold = assign_folds(samples, places, theta_max, options.seed);
    if (!fold) return fold.error();
    if (options.complete && traits(options.objective).of_pictures && C == 0) {
        auto completed = observe_completed(samples, observed.samples, observed.options, progress.part(0, 0.9));
        if (!completed) return completed.error();
        observed.completed = *std::move(completed);
        if (options.only_completed > 0) return observed;
    }
    // Errors of the interpolation of each sample from the others.
    const ProgressToken interpolating = progress.part(observed.completed.f.empty() ? 0 : 0.9, 1);
    std::vector<Rgb> interpolated(samples.wl.size());
    for (int left_out = 0; left_out < k_folds; ++left_out) {
        if (!interpolating.report("interpolating", 0.5 * left_out / k_folds)) return cancelled_error("observe");
        const ScatteredSamples rest = without_fold(samples, *fold, left_out);
        for (const std::size_t i : within)
            if ((*fold)[i] == left_out) interpolated[i] = value(rest, samples.wl[i], samples.wv[i]);
    }
    observed.interpolation = measure_samples(samples.wl, samples.wv, samples.colour, interpolated, theta_max);

    // Interpolated values at a pair: the colour, and the spectrum if requested.
    const auto foretold = [&](Vec3f wl, Vec3f wv) {
        if (C > 0) signed_spectrum(samples, wl, wv, spectrum);
        clamp_negative(spectrum);
        return value(samples, wl, wv);
    };
    // Pairs between the samples, beyond them, and for checks.
    if (!interpolating.report("interpolating", 0.5)) return cancelled_error("observe");
    std::mt19937_64 random(options.seed);
    const auto grid = check_grid();
    std::vector<std::pair<Vec3f, Vec3f>> beyond;
    for (const auto& [l, v] : grid) {
        const Vec3f wl = to_float(l), wv = to_float(v);
        if (std::min(wl.z, wv.z) < cos_max) {
            beyond.emplace_back(wl, wv);
            continue;
        }
        const Rgb f = foretold(wl, wv);
        observed.between.add(wl, wv, f, 1, spectrum);
    }
    observed.between.shuffle(random);
    Observations& between = observed.between;
    const std::size_t kept = std::min(between.f.size(), k_most_between_samples);
    between.resize(kept);
    weigh_all(between);
    for (const auto& [wl, wv] : beyond) {
        const double area = double(wl.z) * double(wv.z);
        const Rgb f = foretold(wl, wv);
        observed.samples.add(
            wl, wv, f, k_guard_share * k_guard_importance * area * area / (double(beyond.size()) * peak), spectrum);
    }
    observed.samples.shuffle(random);
    if (!interpolating.report("interpolating", 0.75)) return cancelled_error("observe");
    const std::size_t fitted = observed.samples.f.size();
    for (const auto& [l, v] : grid) {
        const Vec3f wl = to_float(l), wv = to_float(v);
        const Rgb f = foretold(wl, wv);
        observed.samples.add(wl, wv, f, 0, spectrum);
    }
    const MirrorMixture lights(k_guard_theta);
    for (RSequence<6> points = pair_points(random);
         observed.samples.f.size() < fitted + grid.size() + k_sampled_mirror_checks;) {
        const auto pair = pair_in(lights, points.next());
        if (!pair) continue;
        const Rgb f = foretold(pair->wl, pair->wv);
        observed.samples.add(pair->wl, pair->wv, f, 0, spectrum);
    }
    observed.samples.checks = observed.samples.f.size() - fitted;
    observed.samples.masked = samples.masked;
    return observed;
}

}  // namespace srbf
