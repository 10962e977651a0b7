// Fits of multivariate models to scattered samples.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/floating_point.h"
#include "errors/measures.h"
#include "models/pm/search/search.h"
#include "observe/large_errors.h"
#include "observe/pair_weights.h"
#include "samples/fit_pm_to_samples.h"
#include "srbf/metrics.h"

namespace srbf {
namespace {

// The short fit: its error is needed within a factor of about two.
constexpr int k_short_starts = 4, k_short_perturbations = 10;
/// The largest factor of a weight for an error that is not small.
constexpr double k_most_change = 3;
/// The narrowest lobe of scatter, as a share of the distance of its samples. Scans at every degree of a peak that falls to a
/// hundredth within two degrees are fitted with an RMS of log10 f of 0.06; by a share of 1 with 0.19.
constexpr double k_finest_of_scatter = 0.25;

/// The observations of a fit in which the grid between the samples has this weight.
Observations together(const SampleObservations& from, double weight_between, std::uint64_t seed) {
    const Observations &samples = from.samples, &between = from.between;
    const std::size_t fitted = samples.fitted();
    Observations all;
    all.wavelengths = samples.wavelengths;
    const auto add_from = [&](const Observations& some, std::size_t i, double importance) {
        all.add(some.wl[i], some.wv[i], some.f[i], importance * some.weight[i], some.spectrum_of(i));
    };
    for (std::size_t i = 0; i < fitted; ++i) add_from(samples, i, 1);
    for (std::size_t i = 0; i < between.f.size() && weight_between > 0; ++i) add_from(between, i, weight_between);
    std::mt19937_64 random(seed);
    all.shuffle(random);
    for (std::size_t i = fitted; i < samples.f.size(); ++i) add_from(samples, i, 1);
    all.bound_pairs = samples.bound_pairs;
    return all;
}

/// True if the measure of an objective is a root mean square instead of a ratio of sums of squares.
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
    const bool filled = !observations.gap_filled_table.f.empty();
    FitOptions bounded = options.pm;
    const double finest = observations.finest * (traits(objective).of_scatter ? k_finest_of_scatter : 1);
    if (!filled) bounded.finest = std::max(bounded.finest, finest);
    const std::size_t parameters = parameter_count(bounded), values = 3 * observations.groups;
    if (values < parameters)
        return Error{"fit", {}, "samples", fmt::format("at least {} values", parameters), fmt::format("{}", values)};
    if (filled) return fit_pm(observations.gap_filled_table, bounded, progress);
    if (!options.fill) return fit_pm(together(observations, 0, seed), bounded, progress);

    const Observations alone = together(observations, 0, seed);
    const auto first = fit_pm(alone, in_short(bounded, k_short_starts, k_short_perturbations), progress.part(0, 0.3));
    if (!first) return first;
    const std::size_t fitted = observations.samples.fitted();
    const auto beginning = [&](const auto& of) { return std::span(of).first(fitted); };
    const Measures remaining = measure_samples(beginning(alone.wl), beginning(alone.wv), beginning(alone.f),
                                               evaluator(first->unrounded), max_theta);
    SampleObservations weighed = observations;
    for (Observations* of : {&weighed.samples, &weighed.between})
        weigh_large_errors(*of, evaluator(first->unrounded), k_most_change, sample_cap(max_theta));
    double belief = std::min(error_of(remaining, objective) / error_of(observations.interpolation, objective), 1.0);
    if (is_root(objective)) belief *= belief;
    return fit_pm(together(weighed, std::isfinite(belief) ? belief : 1, seed), bounded, progress.part(0.3, 1));
}

}  // namespace srbf
