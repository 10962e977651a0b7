#include "samples/observe_samples.h"
#include "errors/measures.h"

#include <algorithm>
#include <array>
#include <functional>
#include <set>

#include "base/errors.h"
#include "base/floating_point.h"
#include "observe/pair_weights.h"
#include "observe/pairs.h"
#include "samples/facets.h"
#include "samples/folds.h"
#include "srbf/metrics.h"

namespace srbf {
namespace {

/// Bound pairs about the mirror direction: a quarter of those of a table, as they are interpolated one by one.
constexpr std::size_t k_sampled_mirror_pairs = k_mirror_pairs / 4;
/// Gap-filled samples are interpolated too, and known less well than a table.
constexpr std::size_t k_gap_filled_pairs = 16384, k_fewer_of_gap_filled = 2;
/// Pairs near the horizon, where both directions are beyond 66°, of each band of elevation: enough to cover the highlight.
constexpr std::size_t k_grazing_bands = 8, k_pairs_of_band = 64, k_grazing_tried = 65536;
constexpr double k_grazing_cos = 0.4;
/// Share of Σ w |f|² for all bands. With less, lobes follow less closely; with more, they look worse elsewhere.
constexpr double k_grazing_share = 0.6;
/// The gap-filled samples are level at the largest sample but for rounding.
constexpr double k_level = 0.999;
/// Number of pairs of the grid (of ten thousand) that also constrain lobes.
constexpr std::size_t k_most_between_samples = 4096;
/// Extrapolation beyond θmax gets a smaller weight than values of a table.
constexpr double k_extrapolated_share = 0.1;

/// The first pairs where the gap-filled samples are at least as large as every sample, or the largest, of those of a band
/// that were tried. Σ w |f|² = 1.
Observations largest_of_band(const Observations& tried, double level) {
    Observations largest;
    std::vector<double> size;  // f A
    for (std::size_t i = 0; i < tried.f.size(); ++i)
        size.push_back(largest_of(tried.f[i]) * cosines(tried.wl[i], tried.wv[i]));
    if (size.size() < k_pairs_of_band) return largest;
    std::vector<double> sorted = size;
    std::ranges::nth_element(sorted, sorted.begin() + std::ptrdiff_t(k_pairs_of_band) - 1, std::greater());
    const double least = std::min(k_level * level, sorted[k_pairs_of_band - 1]);
    for (std::size_t i = 0; i < size.size() && largest.f.size() < k_pairs_of_band; ++i)
        if (size[i] >= least) largest.add(tried.wl[i], tried.wv[i], tried.f[i], tried.weight[i]);
    largest.normalise();
    return largest;
}

/// Adds pairs of directions near the horizon where the gap-filled samples are largest, with `k_grazing_share` of Σ w |f|². A
/// table's pairs are few there, so that lobes are free to exceed what they follow.
void add_grazing(Observations& to, const GapFilledSamples& filled, double max_theta, std::uint64_t seed) {
    const MirrorMixture lights(max_theta);
    std::mt19937_64 random(seed);
    RSequence<6> points = random_sequence(random);
    std::array<Observations, k_grazing_bands> tried;
    for (std::size_t i = 0; i < k_grazing_tried; ++i) {
        const auto pair = pair_within(lights, points.next());
        const double highest = pair ? double(std::max(pair->wl.z, pair->wv.z)) : 1;
        if (!(highest < k_grazing_cos)) continue;
        const auto band = std::size_t(highest / k_grazing_cos * double(k_grazing_bands));
        const double area = cosines(pair->wl, pair->wv);
        tried[band].add(pair->wl, pair->wv, value(filled, pair->wl, pair->wv), area * area);
    }
    Observations grazing;  // f A rises towards the horizon: without equal shares the lowest band would count most
    for (const Observations& band : tried) grazing.append(largest_of_band(band, filled.allowed));
    grazing.normalise();
    for (double& weight : grazing.weight) weight *= k_grazing_share;
    to.append(grazing);
}

/// The gap-filled samples within θmax observed like a table, as much Σ w |f|² of the samples themselves unless they are matte
/// and Lambert takes their place, and pairs near the horizon.
Result<Observations> observe_gap_filled(const GapFilledSamples& filled, const Observations& observed,
                                        const ObserveSamplesOptions& options, const ProgressToken& progress) {
    const bool is_short = options.only_gap_filled > 0;
    const auto table = observe(evaluator(filled),
                               {.objective = options.objective,
                                .max_theta = options.max_theta,
                                .count = is_short ? options.only_gap_filled : k_gap_filled_pairs,
                                .seed = options.seed,
                                .threads = options.threads,
                                .horizon_albedos = false,
                                .fewer = is_short ? 1 : k_fewer_of_gap_filled},
                               progress);
    if (!table) return table.error();
    Observations all = *table;
    all.point_light_weight.clear();
    if (is_short) all.views.clear();
    all.resize(table->fitted());
    // Where Lambert takes the place of all, lobes would follow the samples' noise between the pairs.
    if (filled.continuation.from > 0) all.append(observed);
    if (!is_short) add_grazing(all, filled, options.max_theta, options.seed);
    std::mt19937_64 random(options.seed);
    all.shuffle(random);
    for (std::size_t i = table->fitted(); i < table->f.size(); ++i) all.add(table->wl[i], table->wv[i], table->f[i], 0);
    return all;
}

/// The value expected between the samples: R, G and B at a pair of directions, and f at each wavelength of spectra.
using ExpectedBetween = std::function<Rgb(const DirectionPair&, std::span<float> spectrum)>;

ExpectedBetween interpolated(const ScatteredSamples& samples) {
    return [&samples](const DirectionPair& pair, std::span<float> spectrum) {
        if (!spectrum.empty()) signed_spectrum(samples, pair.wl, pair.wv, spectrum);
        clamp_negative(spectrum);
        return value(samples, pair.wl, pair.wv);
    };
}
ExpectedBetween of_facets(FacetMixture mixture) {
    return [mixture = std::move(mixture)](const DirectionPair& pair, std::span<float> spectrum) {
        std::vector<float> f(3 + spectrum.size());
        evaluate(mixture, pair.wl, pair.wv, f);
        std::ranges::copy(std::span(f).subspan(3), spectrum.begin());
        return Rgb{f[0], f[1], f[2]};
    };
}

void add_expected(Observations& to, const ExpectedBetween& expected, const DirectionPair& pair, double weight) {
    std::vector<float> spectrum(to.wavelengths.size());
    const Rgb f = expected(pair, spectrum);
    to.add(pair.wl, pair.wv, f, weight, spectrum);
}

/// Pairs about the mirror direction and elsewhere.
std::vector<DirectionPair> mirror_pairs(std::size_t count, double max_theta, std::mt19937_64& random) {
    std::vector<DirectionPair> pairs;
    const MirrorMixture lights(max_theta);
    for (RSequence<6> points = random_sequence(random); pairs.size() < count;)
        if (const auto pair = pair_within(lights, points.next())) pairs.push_back(*pair);
    return pairs;
}

/// Errors of the interpolation of each sample from those of the other folds. None: cancelled.
std::optional<Measures> interpolation_errors(const ScatteredSamples& samples, const std::vector<std::size_t>& within,
                                             std::span<const int> fold, double max_theta,
                                             const ProgressToken& progress) {
    std::vector<Rgb> interpolated(samples.wl.size());
    for (int left_out = 0; left_out < k_folds; ++left_out) {
        if (!progress.report("interpolating", double(left_out) / k_folds)) return {};
        const ScatteredSamples rest = without_fold(samples, fold, left_out);
        for (const std::size_t i : within)
            if (fold[i] == left_out) interpolated[i] = value(rest, samples.wl[i], samples.wv[i]);
    }
    return measure_samples(samples.wl, samples.wv, samples.colour, interpolated, max_theta);
}

/// Errors at the samples.
Measures errors_of(const ExpectedBetween& expected, const ScatteredSamples& samples, double max_theta) {
    std::vector<Rgb> f;
    for (std::size_t i = 0; i < samples.wl.size(); ++i) f.push_back(expected({samples.wl[i], samples.wv[i]}, {}));
    return measure_samples(samples.wl, samples.wv, samples.colour, f, max_theta);
}

/// Adds what is expected: to `between` pairs within θmax, of the grid or of scatter about the mirror direction, to `samples`
/// horizon pairs and bound pairs. `largest`: the largest square of the samples. False: cancelled.
bool observe_between(SampleObservations& to, const ExpectedBetween& expected, double largest,
                     const ProgressToken& progress) {
    std::mt19937_64 random(to.options.seed);
    const float cos_max = sample_cap(to.options.max_theta);
    const bool of_scatter = traits(to.options.objective).of_scatter;
    std::vector<DirectionPair> within, beyond;
    if (!progress.report("interpolating", 0)) return false;
    for (const DirectionPair& pair : horizon_grid())
        (std::min(pair.wl.z, pair.wv.z) < cos_max ? beyond : within).push_back(pair);
    if (of_scatter) within = mirror_pairs(k_most_between_samples, to.options.max_theta, random);
    for (const DirectionPair& pair : within) add_expected(to.between, expected, pair, 1);
    to.between.shuffle(random);
    to.between.resize(std::min(to.between.f.size(), k_most_between_samples));
    for (const DirectionPair& pair : beyond)
        add_expected(
            to.samples, expected, pair,
            horizon_weight(pair.wl, pair.wv, k_extrapolated_share * k_horizon_importance, beyond.size(), largest));
    to.samples.shuffle(random);

    if (!progress.report("interpolating", 0.5)) return false;
    const std::size_t fitted = to.samples.f.size();
    for (const auto& pairs : {horizon_grid(), mirror_pairs(k_sampled_mirror_pairs, k_horizon_theta, random)})
        for (const DirectionPair& pair : pairs) add_expected(to.samples, expected, pair, 0);
    to.samples.bound_pairs = to.samples.f.size() - fitted;
    return true;
}

}  // namespace

std::vector<std::size_t> samples_within(const ScatteredSamples& samples, double max_theta) {
    std::vector<std::size_t> which;
    for (std::size_t i = 0; i < samples.wl.size(); ++i)
        if (!(std::min(samples.wl[i].z, samples.wv[i].z) < sample_cap(max_theta))) which.push_back(i);
    return which;
}

double least_roughness(std::span<const Vec3f> wl, std::span<const Vec3f> wv) {
    std::vector<double> slopes;
    for (std::size_t i = 0; i < wl.size(); ++i) {
        const Vec3d sum = to_double(wl[i]) + to_double(wv[i]);
        slopes.push_back(elementary::hypot(sum.x, sum.y) / sum.z);
    }
    if (slopes.empty()) return 0;
    const double first = *std::ranges::min_element(slopes);
    double second = std::numeric_limits<double>::infinity();
    for (const double slope : slopes)
        if (slope > first + k_group_distance / 2) second = std::min(second, slope);
    return std::max(first, std::isfinite(second) ? second / 4 : 0);
}

Observations observations_of(const ScatteredSamples& samples, std::span<const std::size_t> which, bool both_ways,
                             bool spectral) {
    Observations all;
    if (spectral) all.wavelengths = samples.wavelengths;
    const std::size_t C = all.wavelengths.size();
    for (const std::size_t i : which) {
        Rgb f = samples.colour[i];
        const auto measured = samples.spectrum.begin() + std::ptrdiff_t(i * C);
        std::vector<float> spectrum(measured, measured + std::ptrdiff_t(C));
        const int of_colour = clamp_negative(f), of_spectrum = clamp_negative(spectrum);
        all.clamped += std::uint64_t(spectral ? of_spectrum : of_colour);
        const double weight = samples.weight.empty() ? 1 : double(samples.weight[i]);
        all.add(samples.wl[i], samples.wv[i], f, weight, spectrum);
        if (both_ways) all.add(samples.wv[i], samples.wl[i], f, weight, spectrum);
    }
    all.least_roughness = least_roughness(all.wl, all.wv);
    return all;
}

namespace {

/// Weights of pairs of the same weight, by their objective.
void weigh_all(Observations& of, int threads) {
    weigh(of.objective, of.typical, of.wl, of.wv, of.f, of.weight, threads);
    of.normalise();
}

/// Sets `gap_filled`, continued as folds find best.
Result<Done> fill_gaps(SampleObservations& observed, const ScatteredSamples& samples, const SampleGroups& groups) {
    const ObserveSamplesOptions& options = observed.options;
    if (options.gap_filled) {
        observed.gap_filled = *options.gap_filled;
        return Done{};
    }
    const auto fold = assign_folds(samples, groups, options.max_theta, options.seed);
    if (!fold) return fold.error();
    auto all = fill_gaps(samples, options.max_theta, options.threads, options.only_gap_filled > 0);
    if (!all) return all.error();
    observed.gap_filled = *std::move(all);
    if (options.only_gap_filled > 0) return Done{};
    auto without = fill_gaps_without_folds(samples, *fold, options.max_theta, options.threads);
    if (!without) return without.error();
    observed.without_fold = *std::move(without);
    observed.gap_filled->continuation = observed.without_fold.front().continuation;
    return Done{};
}

/// Sets what is expected between the samples, and its errors at samples that were left out. False: cancelled.
bool interpolate(SampleObservations& observed, const ScatteredSamples& samples, const std::vector<std::size_t>& within,
                 const std::vector<int>& fold, const ProgressToken& progress) {
    const ObserveSamplesOptions& options = observed.options;
    ExpectedBetween expected = interpolated(samples);
    if (traits(options.objective).of_scatter) {
        expected = of_facets(fit_facets(observed.samples));
        observed.interpolation = errors_of(expected, samples, options.max_theta);
    } else {
        const auto errors = interpolation_errors(samples, within, fold, options.max_theta, progress.part(0, 0.5));
        if (!errors) return false;
        observed.interpolation = *errors;
    }
    observed.between.wavelengths = observed.samples.wavelengths;
    observed.between.objective = options.objective, observed.between.typical = observed.samples.typical;
    if (!observe_between(observed, expected, largest_square(observed.samples), progress.part(0.5, 1))) return false;
    weigh_all(observed.between, options.threads);
    return true;
}

}  // namespace

Result<SampleObservations> observe(const ScatteredSamples& samples, const ObserveSamplesOptions& options,
                                   const ProgressToken& progress) {
    const StandardArithmetic mode;
    const auto theta_max = valid_theta(options.objective, options.max_theta);
    if (!theta_max) return theta_max.error();
    if (options.spectral && samples.wavelengths.empty())
        return argument_error("samples", "spectral samples", "wavelengths", "none");
    const std::vector<std::size_t> within = samples_within(samples, *theta_max);
    if (within.empty()) return no_data_error("samples", "samples within the largest angle");

    SampleObservations observed;
    observed.options = options;
    observed.options.max_theta = *theta_max;
    const SampleGroups groups = group_samples(samples);
    observed.finest = groups.spacing;
    std::set<int> groups_within;
    for (const std::size_t i : within) groups_within.insert(groups.of[i]);
    observed.groups = groups_within.size();

    const Observations once = observations_of(samples, within, false, options.spectral);
    observed.samples = observations_of(samples, within, true, options.spectral);
    observed.samples.masked = samples.masked;
    observed.samples.objective = options.objective;
    observed.samples.typical = typical_value(options.objective, once.wl, once.wv, once.f, once.weight);
    if (!(observed.samples.typical > 0)) return no_data_error("samples", "values", "some above 0");
    weigh_all(observed.samples, options.threads);

    if (options.fill_gaps && traits(options.objective).of_pictures && !options.spectral) {
        if (const auto done = fill_gaps(observed, samples, groups); !done) return done.error();
        auto filled = observe_gap_filled(*observed.gap_filled, observed.samples, observed.options, progress);
        if (!filled) return filled.error();
        observed.gap_filled_table = *std::move(filled);
        return observed;  // fits follow nothing else
    }
    const auto fold = assign_folds(samples, groups, *theta_max, options.seed);
    if (!fold) return fold.error();
    if (!interpolate(observed, samples, within, *fold, progress)) return cancelled_error("observe");
    return observed;
}

}  // namespace srbf
