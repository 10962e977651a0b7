#include "samples/observe_samples.h"

#include <algorithm>
#include <array>
#include <functional>
#include <set>

#include "base/errors.h"
#include "base/floating_point.h"
#include "errors/measures.h"
#include "measured/tables.h"
#include "observe/pair_weights.h"
#include "observe/pairs.h"
#include "samples/facets.h"
#include "samples/folds.h"
#include "srbf/metrics.h"

namespace SRBF_NAMESPACE {
namespace {

/// Bound pairs around the mirror direction: a quarter of a table's number, because each one takes an interpolation.
constexpr std::size_t k_sampled_mirror_pairs = k_mirror_pairs / 4;
/// Gap-filled samples are interpolated too, and are less certain than a table.
constexpr std::size_t k_gap_filled_pairs = 16384, k_fewer_of_gap_filled = 2;
/// Pairs near the horizon (both directions beyond 66°) in each band of elevation: enough to cover the highlight.
constexpr std::size_t k_grazing_bands = 8, k_pairs_of_band = 64, k_grazing_tried = 65536;
constexpr double k_grazing_cos = 0.4;
/// Fraction of Σ w |f|² for all bands. With less, lobes follow the values less closely; with more, they look worse
/// elsewhere.
constexpr double k_grazing_share = 0.6;
/// The gap-filled samples are constant at the level of the largest sample, except for rounding.
constexpr double k_level = 0.999;
/// Number of pairs of the grid, which has ten thousand, that also constrain lobes.
constexpr std::size_t k_most_between_samples = 4096;
/// Values extrapolated beyond θmax get a smaller weight than values of a table.
constexpr double k_extrapolated_share = 0.1;

/// Chooses pairs of one band of elevation: the first ones at which the gap-filled samples reach the largest sample,
/// or, if there are too few, those with the largest values. Σ w |f|² = 1.
Observations choose_largest(const Observations& candidates, double level) {
    Observations largest;
    std::vector<double> size;  // f A
    for (std::size_t i = 0; i < candidates.f.size(); ++i)
        size.push_back(largest_of(candidates.f[i]) * cosines(candidates.wl[i], candidates.wv[i]));
    if (size.size() < k_pairs_of_band) return largest;
    std::vector<double> sorted = size;
    std::ranges::nth_element(sorted, sorted.begin() + std::ptrdiff_t(k_pairs_of_band) - 1, std::greater());
    const double least = std::min(k_level * level, sorted[k_pairs_of_band - 1]);
    for (std::size_t i = 0; i < size.size() && largest.f.size() < k_pairs_of_band; ++i)
        if (size[i] >= least) largest.add(candidates.wl[i], candidates.wv[i], candidates.f[i], candidates.weight[i]);
    largest.normalise();
    return largest;
}

/// Adds pairs near the horizon where the gap-filled samples are largest, with the fraction `k_grazing_share` of Σ w
/// |f|². A table has few pairs there, so that lobes could exceed the values unnoticed.
void add_grazing(Observations& observations, const GapFilledSamples& filled, double max_theta, std::uint64_t seed) {
    const MirrorMixture lights(max_theta);
    std::mt19937_64 random(seed);
    RSequence<6> points = random_sequence(random);
    std::array<Observations, k_grazing_bands> candidates;
    for (std::size_t i = 0; i < k_grazing_tried; ++i) {
        const auto pair = pair_within(lights, points.next());
        const double highest = pair ? double(std::max(pair->wl.z, pair->wv.z)) : 1;
        if (!(highest < k_grazing_cos)) continue;
        const auto band = std::size_t(highest / k_grazing_cos * double(k_grazing_bands));
        const double area = cosines(pair->wl, pair->wv);
        candidates[band].add(pair->wl, pair->wv, value(filled, pair->wl, pair->wv), area * area);
    }
    Observations grazing;  // f A rises towards the horizon: without equal weights the lowest band would dominate
    for (const Observations& band : candidates) grazing.append(choose_largest(band, filled.least_bound));
    grazing.normalise();
    for (double& weight : grazing.weight) weight *= k_grazing_share;
    observations.append(grazing);
}

/// Observes the gap-filled samples within θmax like a table. Adds the samples themselves with the same Σ w |f|²,
/// unless they are matte and replaced by Lambert, and pairs near the horizon.
Result<Observations> observe_gap_filled(const GapFilledSamples& filled, const Observations& observed,
                                        const ObserveSamplesOptions& options, const ProgressToken& progress) {
    const bool is_quick = options.only_gap_filled > 0;
    const auto table = observe(evaluator(filled),
                               {.objective = options.objective,
                                .max_theta = options.max_theta,
                                .count = is_quick ? options.only_gap_filled : k_gap_filled_pairs,
                                .seed = options.seed,
                                .threads = options.threads,
                                .horizon_albedos = false,
                                .fewer = is_quick ? 1 : k_fewer_of_gap_filled},
                               progress);
    if (!table) return table.error();
    Observations observations = *table;
    if (is_quick) observations.views.clear();
    observations.resize(table->fitted_count());
    // Where Lambert replaces the samples, lobes would follow the samples' noise between the pairs.
    if (filled.continuation.from > 0) observations.append(observed);
    if (!is_quick) add_grazing(observations, filled, options.max_theta, options.seed);
    std::mt19937_64 random(options.seed);
    observations.shuffle(random);
    for (std::size_t i = table->fitted_count(); i < table->f.size(); ++i)
        observations.add(table->wl[i], table->wv[i], table->f[i], 0);
    return observations;
}

/// The value expected between the samples: R, G and B at a pair of directions, and f at each wavelength of the
/// spectra.
using ExpectedBetween = std::function<Rgb(const DirectionPair&, std::span<float> spectrum)>;

ExpectedBetween from_neighbours(const ScatteredSamples& samples) {
    return [&samples](const DirectionPair& pair, std::span<float> spectrum) {
        if (!spectrum.empty()) signed_spectrum(samples, pair.wl, pair.wv, spectrum);
        clamp_negative(spectrum);
        return value(samples, pair.wl, pair.wv);
    };
}
ExpectedBetween from_facets(FacetMixture mixture) {
    return [mixture = std::move(mixture)](const DirectionPair& pair, std::span<float> spectrum) {
        std::vector<float> f(3 + spectrum.size());
        evaluate(mixture, pair.wl, pair.wv, f);
        std::ranges::copy(std::span(f).subspan(3), spectrum.begin());
        return Rgb{f[0], f[1], f[2]};
    };
}

void add_expected(Observations& observations, const ExpectedBetween& expected, const DirectionPair& pair,
                  double weight) {
    std::vector<float> spectrum(observations.wavelengths.size());
    const Rgb f = expected(pair, spectrum);
    observations.add(pair.wl, pair.wv, f, weight, spectrum);
}

/// Pairs around the mirror direction and elsewhere.
std::vector<DirectionPair> mirror_pairs(std::size_t count, double max_theta, std::mt19937_64& random) {
    std::vector<DirectionPair> pairs;
    const MirrorMixture lights(max_theta);
    for (RSequence<6> points = random_sequence(random); pairs.size() < count;)
        if (const auto pair = pair_within(lights, points.next())) pairs.push_back(*pair);
    return pairs;
}

/// Errors when each sample is interpolated from the samples of the other folds. No value: cancelled.
std::optional<Measures> interpolation_errors(const ScatteredSamples& samples, const std::vector<std::size_t>& within,
                                             std::span<const int> fold, double max_theta,
                                             const ProgressToken& progress) {
    std::vector<Rgb> interpolated(samples.wl.size());
    for (int left_out = 0; left_out < k_folds; ++left_out) {
        if (!progress.report("interpolating", double(left_out) / k_folds)) return {};
        const ScatteredSamples others = without_fold(samples, fold, left_out);
        for (const std::size_t i : within)
            if (fold[i] == left_out) interpolated[i] = value(others, samples.wl[i], samples.wv[i]);
    }
    return measure_samples(samples.wl, samples.wv, samples.colour, interpolated, max_theta);
}

/// Errors of the expected values at the samples.
Measures errors_of(const ExpectedBetween& expected, const ScatteredSamples& samples, double max_theta) {
    std::vector<Rgb> f;
    for (std::size_t i = 0; i < samples.wl.size(); ++i) f.push_back(expected({samples.wl[i], samples.wv[i]}, {}));
    return measure_samples(samples.wl, samples.wv, samples.colour, f, max_theta);
}

/// Observes the expected values. `between` gets pairs within θmax: nodes of the grid, or for scatter pairs around
/// the mirror direction. `samples` gets horizon pairs and bound pairs. `largest` is the largest square of the
/// samples. Returns false if cancelled.
bool observe_between(SampleObservations& observed, const ExpectedBetween& expected, double largest,
                     const ProgressToken& progress) {
    std::mt19937_64 random(observed.options.seed);
    const float cos_max = sample_cap(observed.options.max_theta);
    const bool is_scatter = traits(observed.options.objective).of_scatter;
    std::vector<DirectionPair> within, beyond;
    if (!progress.report("interpolating", 0)) return false;
    for (const DirectionPair& pair : horizon_grid())
        (std::min(pair.wl.z, pair.wv.z) < cos_max ? beyond : within).push_back(pair);
    if (is_scatter) within = mirror_pairs(k_most_between_samples, observed.options.max_theta, random);
    for (const DirectionPair& pair : within) add_expected(observed.between, expected, pair, 1);
    observed.between.shuffle(random);
    observed.between.resize(std::min(observed.between.f.size(), k_most_between_samples));
    for (const DirectionPair& pair : beyond)
        add_expected(
            observed.samples, expected, pair,
            horizon_weight(pair.wl, pair.wv, k_extrapolated_share * k_horizon_importance, beyond.size(), largest));
    observed.samples.shuffle(random);

    if (!progress.report("interpolating", 0.5)) return false;
    const std::size_t fitted = observed.samples.f.size();
    for (const auto& pairs : {horizon_grid(), mirror_pairs(k_sampled_mirror_pairs, k_horizon_theta, random)})
        for (const DirectionPair& pair : pairs) add_expected(observed.samples, expected, pair, 0);
    observed.samples.bound_pairs = observed.samples.f.size() - fitted;
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
    Observations observations;
    if (spectral) observations.wavelengths = samples.wavelengths;
    const std::size_t C = observations.wavelengths.size();
    for (const std::size_t i : which) {
        Rgb f = samples.colour[i];
        const auto measured = samples.spectrum.begin() + std::ptrdiff_t(i * C);
        std::vector<float> spectrum(measured, measured + std::ptrdiff_t(C));
        const int of_colour = clamp_negative(f), of_spectrum = clamp_negative(spectrum);
        observations.clamped += std::uint64_t(spectral ? of_spectrum : of_colour);
        const double weight = samples.weight.empty() ? 1 : double(samples.weight[i]);
        observations.add(samples.wl[i], samples.wv[i], f, weight, spectrum);
        if (both_ways) observations.add(samples.wv[i], samples.wl[i], f, weight, spectrum);
    }
    observations.least_roughness = least_roughness(observations.wl, observations.wv);
    return observations;
}

namespace {

/// Multiplies the weights by those of the observations' objective, and normalises them.
void weigh_all(Observations& observations, int threads) {
    weigh(observations.objective, observations.typical, observations.wl, observations.wv, observations.f,
          observations.weight, threads);
    observations.normalise();
}

/// Sets `gap_filled`, with the continuation that predicts left-out folds best.
Result<Done> fill_gaps(SampleObservations& observed, const ScatteredSamples& samples, const SampleGroups& groups) {
    const ObserveSamplesOptions& options = observed.options;
    if (options.gap_filled) {
        observed.gap_filled = *options.gap_filled;
        return Done{};
    }
    const auto fold = assign_folds(samples, groups, options.max_theta, options.seed);
    if (!fold) return fold.error();
    auto filled = fill_gaps(samples, options.max_theta, options.threads, options.only_gap_filled > 0);
    if (!filled) return filled.error();
    observed.gap_filled = *std::move(filled);
    if (options.only_gap_filled > 0) return Done{};
    auto without = fill_gaps_without_folds(samples, *fold, options.max_theta, options.threads);
    if (!without) return without.error();
    observed.without_fold = *std::move(without);
    observed.gap_filled->continuation = observed.without_fold.front().continuation;
    return Done{};
}

/// Adds the values expected between the samples, and their errors at left-out samples. Returns false if cancelled.
bool interpolate(SampleObservations& observed, const ScatteredSamples& samples, const std::vector<std::size_t>& within,
                 const std::vector<int>& fold, const ProgressToken& progress) {
    const ObserveSamplesOptions& options = observed.options;
    ExpectedBetween expected = from_neighbours(samples);
    if (traits(options.objective).of_scatter) {
        expected = from_facets(fit_facets(observed.samples));
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
    for (const std::size_t i : within) groups_within.insert(groups.group_of[i]);
    observed.groups = groups_within.size();

    const Observations once = observations_of(samples, within, false, options.spectral);
    observed.samples = observations_of(samples, within, true, options.spectral);
    observed.samples.masked = samples.masked;
    observed.samples.objective = options.objective;
    observed.samples.typical = typical_value(options.objective, once.wl, once.wv, once.f, once.weight);
    if (!(observed.samples.typical > 0)) return no_data_error("samples", "values", "some above 0");
    weigh_all(observed.samples, options.threads);

    if (options.fill_gaps && traits(options.objective).of_pictures) {
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
