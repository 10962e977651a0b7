#include "samples/observe_samples.h"

#include <algorithm>

#include "base/errors.h"
#include "base/floating_point.h"
#include "errors/measures.h"
#include "measured/tables.h"
#include "observe/excess.h"
#include "observe/pair_weights.h"
#include "observe/pairs.h"
#include "samples/facets.h"
#include "samples/folds.h"
#include "srbf/metrics.h"

namespace SRBF_NAMESPACE {
namespace {

/// Gap-filled samples are interpolated too, and are less certain than a table.
constexpr std::size_t k_gap_filled_pairs = 16384, k_fewer_of_gap_filled = 2;
/// Pairs near the horizon (both directions beyond 66°) in each band of elevation: enough to cover the highlight.
constexpr std::size_t k_grazing_bands = 8, k_pairs_of_band = 64, k_grazing_tried = 65536;
constexpr double k_grazing_cos = 0.4;
/// Fraction of Σ w |f|² for all bands. With less, lobes follow the values less closely; with more, others look worse.
constexpr double k_grazing_fraction = 0.6;
/// The gap-filled samples are constant at the level of the largest sample, except for rounding.
constexpr double k_level = 0.999;
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
    const double min = std::min(k_level * level, sorted[k_pairs_of_band - 1]);
    for (std::size_t i = 0; i < size.size() && largest.f.size() < k_pairs_of_band; ++i)
        if (size[i] >= min) largest.add(candidates.wl[i], candidates.wv[i], candidates.f[i], candidates.weight[i]);
    largest.normalise();
    return largest;
}

/// Adds pairs near the horizon where the gap-filled samples are largest, with the fraction `k_grazing_fraction` of Σ w
/// |f|². A table has few pairs there, so that lobes could exceed the values unnoticed.
void add_grazing(Observations& observations, const Evaluate& filled, double level,
                 const ObserveSamplesOptions& options) {
    const MirrorMixture lights(options.max_theta);
    std::mt19937_64 random(options.seed);
    RSequence<6> points = random_sequence(random);
    std::array<Observations, k_grazing_bands> candidates;
    for (std::size_t i = 0; i < k_grazing_tried; ++i) {
        const auto pair = pair_within(lights, points.next());
        const double highest = pair ? double(std::max(pair->wl.z, pair->wv.z)) : 1;
        if (!(highest < k_grazing_cos)) continue;
        const double area = cosines(pair->wl, pair->wv);
        Rgb f;
        filled({&pair->wl, 1}, {&pair->wv, 1}, {&f, 1});
        candidates[std::size_t(highest / k_grazing_cos * double(k_grazing_bands))].add(pair->wl, pair->wv, f,
                                                                                       area * area);
    }
    Observations grazing;  // f A rises towards the horizon: without equal weights the lowest band would dominate
    for (const Observations& band : candidates) grazing.append(choose_largest(band, level));
    grazing.normalise();
    for (double& weight : grazing.weight) weight *= k_grazing_fraction;
    observations.append(grazing);
}

/// Observes the gap-filled samples within θmax like a table, and adds the samples themselves with the same Σ w |f|².
Result<Observations> observe_gap_filled(const Evaluate& filled, const Observations& observed,
                                        const ObserveSamplesOptions& options, const ProgressToken& progress) {
    const bool is_quick = options.only_gap_filled > 0;
    const auto table = observe(filled,
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
    observations.append(observed);
    if (!is_quick && traits(options.objective).uses_pictures)
        add_grazing(observations, filled, largest_measured(observed), options);
    std::mt19937_64 random(options.seed);
    observations.shuffle(random);
    for (std::size_t i = table->fitted_count(); i < table->f.size(); ++i)
        observations.add(table->wl[i], table->wv[i], table->f[i], 0);
    return observations;
}

}  // namespace

std::vector<std::size_t> samples_within(const ScatteredSamples& samples, double max_theta) {
    std::vector<std::size_t> which;
    for (std::size_t i = 0; i < samples.wl.size(); ++i)
        if (!(std::min(samples.wl[i].z, samples.wv[i].z) < sample_cap(max_theta))) which.push_back(i);
    return which;
}

double min_roughness(std::span<const Vec3f> wl, std::span<const Vec3f> wv) {
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

Observations observations_of(const ScatteredSamples& samples, std::span<const std::size_t> which,
                             ExchangedSamples exchanged, bool spectral) {
    Observations observations;
    if (spectral) observations.wavelengths = samples.wavelengths;
    const std::size_t C = observations.wavelengths.size();
    for (const std::size_t i : which) {
        Rgb f = samples.colour[i];
        const auto measured = samples.spectrum.begin() + std::ptrdiff_t(i * C);
        std::vector<float> spectrum(measured, measured + std::ptrdiff_t(C));
        const int clamped_colours = clamp_negative(f), clamped_spectrum = clamp_negative(spectrum);
        observations.clamped += std::uint64_t(spectral ? clamped_spectrum : clamped_colours);
        const double weight = samples.weight.empty() ? 1 : double(samples.weight[i]);
        observations.add(samples.wl[i], samples.wv[i], f, weight, spectrum);
        if (exchanged == ExchangedSamples::added) observations.add(samples.wv[i], samples.wl[i], f, weight, spectrum);
    }
    observations.min_roughness = min_roughness(observations.wl, observations.wv);
    return observations;
}

namespace {

/// Multiplies the weights by the weights of the observations' objective, and normalises them.
void weigh_all(Observations& observations, int threads) {
    weigh(observations.objective, observations.typical, observations.wl, observations.wv, observations.f,
          observations.weight, threads);
    observations.normalise();
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
    const Observations once = observations_of(samples, within, ExchangedSamples::omitted, options.spectral);
    observed.samples = observations_of(samples, within, ExchangedSamples::added, options.spectral);
    observed.samples.masked = samples.masked;
    observed.samples.objective = options.objective;
    observed.samples.typical = typical_value(options.objective, once.wl, once.wv, once.f, once.weight);
    if (!(observed.samples.typical > 0)) return no_data_error("samples", "values", "some above 0");
    weigh_all(observed.samples, options.threads);
    if (!options.fill_gaps) return observed;

    Evaluate expected;
    if (traits(options.objective).is_for_scatter) {
        expected = evaluator(fit_facets(observed.samples));
    } else {
        auto filled = fill_gaps(samples, *theta_max, options.threads, options.only_gap_filled > 0);
        if (!filled) return filled.error();
        observed.gap_filled = *std::move(filled);
        expected = evaluator(*observed.gap_filled);
    }
    auto filled = observe_gap_filled(expected, observed.samples, observed.options, progress);
    if (!filled) return filled.error();
    observed.gap_filled_table = *std::move(filled);
    return observed;
}

Result<PmFit> fit_pm(const SampleObservations& observations, const PmFitOptions& options,
                     const ProgressToken& progress) {
    const StandardArithmetic mode;
    // Each sample is observed twice: as it is, and exchanged.
    const std::size_t parameters = parameter_count(options), values = 3 * observations.samples.f.size() / 2;
    if (values < parameters)
        return Error{"fit", {}, "samples", fmt::format("at least {} values", parameters), fmt::format("{}", values)};
    auto fit = fit_pm(observations.gap_filled_table, options, progress);
    if (!fit || observations.samples.wavelengths.empty()) return fit;
    return with_spectra(*std::move(fit), observations.samples, options);
}

}  // namespace
