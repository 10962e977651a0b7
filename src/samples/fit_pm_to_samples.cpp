// Fits of multivariate models to scattered samples.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/floating_point.h"
#include "errors/measure_names.h"
#include "errors/measures.h"
#include "models/pm/search/search.h"
#include "observe/pair_weights.h"
#include "samples/fit_pm_to_samples.h"
#include "srbf/metrics.h"

namespace SRBF_NAMESPACE {
namespace {

// The quick fit: its error is needed within a factor of about two.
constexpr int k_quick_starts = 4, k_quick_perturbations = 10;
/// The largest factor by which a weight adapts to a residual.
constexpr double k_most_change = 3;
/// The narrowest lobe for scatter, as a fraction of the spacing of the samples. For scans with 1° steps of a peak
/// that falls to a hundredth within 2°, the RMS of log10 f is 0.06; with a fraction of 1 it is 0.19.
constexpr double k_finest_of_scatter = 0.25;

/// The observations of a fit: the samples, and the pairs between them with the given weight.
Observations combine(const SampleObservations& observed, double weight_between, std::uint64_t seed) {
    const Observations &samples = observed.samples, &between = observed.between;
    const std::size_t fitted = samples.fitted_count();
    Observations observations;
    observations.wavelengths = samples.wavelengths;
    const auto add_pair = [&](const Observations& source, std::size_t i, double importance) {
        observations.add(source.wl[i], source.wv[i], source.f[i], importance * source.weight[i], source.spectrum_of(i));
    };
    for (std::size_t i = 0; i < fitted; ++i) add_pair(samples, i, 1);
    for (std::size_t i = 0; i < between.f.size() && weight_between > 0; ++i) add_pair(between, i, weight_between);
    std::mt19937_64 random(seed);
    observations.shuffle(random);
    for (std::size_t i = fitted; i < samples.f.size(); ++i) add_pair(samples, i, 1);
    observations.bound_pairs = samples.bound_pairs;
    return observations;
}

/// True if the measure of an objective is a root mean square rather than a ratio of sums of squares.
bool is_root(Objective objective) {
    return !std::ranges::find(k_measures, measure_of(objective), &MeasureName::member)->is_ratio;
}

}  // namespace

Result<PmFit> fit_pm(const SampleObservations& observations, const SampleFitOptions& options,
                     const ProgressToken& progress) {
    const StandardArithmetic mode;
    const Objective objective = observations.options.objective;
    const double max_theta = observations.options.max_theta;
    const std::uint64_t seed = observations.options.seed;
    const bool is_filled = !observations.gap_filled_table.f.empty();
    PmFitOptions bounded = options.pm;
    const double finest = observations.finest * (traits(objective).of_scatter ? k_finest_of_scatter : 1);
    if (!is_filled) bounded.finest = std::max(bounded.finest, finest);
    const std::size_t parameters = parameter_count(bounded), values = 3 * observations.groups;
    if (values < parameters)
        return Error{"fit", {}, "samples", fmt::format("at least {} values", parameters), fmt::format("{}", values)};
    if (is_filled) {
        auto fit = fit_pm(observations.gap_filled_table, bounded, progress);
        if (!fit || observations.samples.wavelengths.empty()) return fit;
        return with_spectra(*std::move(fit), observations.samples, bounded);
    }
    if (!options.fill) return fit_pm(combine(observations, 0, seed), bounded, progress);

    const Observations alone = combine(observations, 0, seed);
    const auto quick =
        fit_pm(alone, quick_options(bounded, k_quick_starts, k_quick_perturbations), progress.part(0, 0.3));
    if (!quick) return quick;
    const std::size_t fitted = observations.samples.fitted_count();
    const auto first_fitted = [&](const auto& column) { return std::span(column).first(fitted); };
    const Measures remaining = measure_samples(first_fitted(alone.wl), first_fitted(alone.wv), first_fitted(alone.f),
                                               evaluator(quick->unrounded), max_theta);
    SampleObservations weighed = observations;
    for (Observations* part : {&weighed.samples, &weighed.between})
        weigh_large_errors(*part, evaluator(quick->unrounded), k_most_change, sample_cap(max_theta));
    double reliability =
        std::min(error_of(remaining, objective) / error_of(observations.interpolation, objective), 1.0);
    if (is_root(objective)) reliability *= reliability;
    return fit_pm(combine(weighed, std::isfinite(reliability) ? reliability : 1, seed), bounded, progress.part(0.3, 1));
}

}  // namespace srbf
