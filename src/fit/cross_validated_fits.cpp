#include "fit/cross_validated_fits.h"

#include <atomic>

#include "base/errors.h"
#include "base/floating_point.h"
#include "base/parallel.h"
#include "brdf/values.h"
#include "errors/measures.h"
#include "errors/picture_errors.h"
#include "errors/sphere.h"
#include "fit/request_traits.h"
#include "fit/requests.h"
#include "measured/tables.h"
#include "models/pm/pm_functions.h"
#include "observe/pair_weights.h"
#include "samples/folds.h"

namespace SRBF_NAMESPACE {
namespace {

/// A few thousand samples need a shorter search than a table, and there are six fits of them.
constexpr int k_sample_starts = 6, k_sample_perturbations = 14;
/// The fits to folds, which only estimate the error of the fit to all samples, have fewer starts.
constexpr int k_fold_starts = 3;
/// Approximate fraction of observing in the time of the fits to a fold's samples.
constexpr double k_observed_of_fold = 0.2;

/// The largest number of lobes for these samples. Three values of each sample outside a fold are at least twice as many
/// as the numbers to find, of two bytes each.
int max_lobes(const ScatteredSamples& samples, const PmFitOptions& options) {
    const std::size_t max = 3 * samples.wl.size() * (k_folds - 1) / k_folds;
    int lobes = 1;
    for (const int j : k_tried_lobes)
        if (j <= k_max_sample_lobes &&
            payload_bytes(options.form, options.axial, features(options.form) > 0, j, options.variates) <= max)
            lobes = j;
    return lobes;
}
PmFitOptions sample_options(const ScatteredSamples& samples, const FitRequest& request) {
    const PmRequest& pm = std::get<PmRequest>(request.model);
    PmFitOptions options = pm_options(request, pm.axial.value_or(samples.isotropic), PmForm::extended);
    options.starts = k_sample_starts;
    options.perturbations = k_sample_perturbations;
    return options;
}

/// The fit to samples, which have these observations, or null for a view-by-view model.
Result<FitOutcome> fit_observed_samples(const ScatteredSamples& samples, const SampleObservations* observed,
                                        const FitRequest& request, const PmFitOptions& pm,
                                        const ProgressToken& progress) {
    if (!observed) {
        const Measured measured{"", "", 0, samples};
        return fit_view_by_view(signed_evaluator(measured), request, progress);
    }
    auto outcome = std::holds_alternative<PmRequest>(request.model)
                       ? outcome_of(fit_pm(*observed, pm, progress))
                       : fit_by_kind(request, observed->samples, samples.isotropic, progress);
    if (progress.cancelled()) return cancelled_error("fit");
    if (!outcome) return outcome;
    outcome->masked = observed->samples.masked;
    outcome->clamped = observed->samples.clamped;
    return outcome;
}

/// The mean ΔE_ITP at the samples within θmax (`Comparison::samples_delta_e`).
double shown_error(const ScatteredSamples& samples, const Model& model, double max_theta) {
    Image lit, fitted;
    for (const std::size_t i : samples_within(samples, max_theta)) {
        const Vec3f &wl = samples.wl[i], &wv = samples.wv[i];
        lit.pixels.push_back(scaled(wl.z, samples.colour[i]));
        fitted.pixels.push_back(scaled(wl.z, value(model, wl, wv)));
    }
    const float exposure = exposure_to(lit, k_exposed_value);
    double sum = 0;
    for (std::size_t i = 0; i < lit.pixels.size(); ++i)
        sum += delta_e_itp(exposed(lit.pixels[i], exposure), exposed(fitted.pixels[i], exposure));
    return sum / double(lit.pixels.size());
}

/// The value f̂ at every sample, by the model that was fitted without its fold: [sample C + c].
std::vector<float> heldout_values(const ScatteredSamples& samples, std::span<const int> fold,
                                  std::span<const Result<FitOutcome>> fits) {
    std::vector<float> predicted;
    for (std::size_t left_out = 0; left_out < fits.size(); ++left_out) {
        // Colours come from `value`, which is the same on any machine.
        const Model& fitted = fits[left_out]->model;
        const Channels f_of = wavelengths(fitted).empty() ? rgb_channels(evaluator<Model>(fitted)) : channels(fitted);
        const std::size_t C = f_of.count();
        std::vector<float> f(C * samples.wl.size());
        f_of.evaluate(samples.wl, samples.wv, f);
        predicted.resize(f.size());
        for (std::size_t i = 0; i < fold.size(); ++i)
            if (fold[i] == int(left_out)) std::copy_n(&f[i * C], C, &predicted[i * C]);
    }
    return predicted;
}

/// The errors of a model at the samples, and the errors of the predictions by fits to other folds.
Comparison compared(const ScatteredSamples& samples, const FitRequest& request, const Model& model,
                    std::span<const float> predicted) {
    const std::span<const float> measured =
        request.spectral ? std::span(samples.spectrum) : std::span(&samples.colour[0].r, 3 * samples.colour.size());
    const auto measured_against = [&](std::span<const float> f) {
        return measure_samples(samples.wl, samples.wv, measured, f, request.theta());
    };
    std::vector<float> f(predicted.size());
    channels(model).evaluate(samples.wl, samples.wv, f);
    Comparison errors{measured_against(f), measured_against(predicted), 0};
    errors.samples_delta_e = shown_error(samples, model, request.theta());
    errors.measure = measure_of(request.objective);
    return errors;
}

}  // namespace

Result<FitOutcome> fit_to_samples(const ScatteredSamples& samples, std::span<const int> fold,
                                  const SampleObservations* observed, const FitRequest& request,
                                  const ProgressToken& progress) {
    PmFitOptions options;
    if (const auto* pm = std::get_if<PmRequest>(&request.model)) {
        options = sample_options(samples, request);
        if (!lobes_of(*pm)) options.lobes = max_lobes(samples, options);
    }
    std::atomic<int> begun = 0;
    const auto next_part = [&] {
        const int before = begun++;
        return progress.subrange(double(before) / (k_folds + 1), (before + 1.0) / (k_folds + 1));
    };
    const auto fit_fold = [&](const ScatteredSamples& training) -> Result<FitOutcome> {
        const ProgressToken part = next_part();
        PmFitOptions fewer = options;
        fewer.starts = k_fold_starts;
        if (!observed) return fit_observed_samples(training, nullptr, request, fewer, part);
        const auto fold_fit = observe(training, observe_samples_options(request), part.subrange(0, k_observed_of_fold));
        if (!fold_fit) return fold_fit.error();
        return fit_observed_samples(training, &*fold_fit, request, fewer, part.subrange(k_observed_of_fold, 1));
    };
    // Together with the folds, whose number is odd.
    Result<FitOutcome> outcome = FitOutcome{};
    std::vector<Result<FitOutcome>> folds(k_folds, FitOutcome{});
    parallel_for(2, request.threads, [&](std::size_t which) {
        if (which == 0)
            outcome = fit_observed_samples(samples, observed, request, options, next_part());
        else
            parallel_for(k_folds, [&](std::size_t k) { folds[k] = fit_fold(without_fold(samples, fold, int(k))); });
    });
    if (!outcome) return outcome;
    for (const Result<FitOutcome>& fold_fit : folds)
        if (!fold_fit) return fold_fit;
    outcome->errors = compared(samples, request, outcome->model, heldout_values(samples, fold, folds));
    outcome->samples = outcome->errors->matrix.pairs;
    outcome->raw_bytes = samples.wl.size() * channels(outcome->model).count() * sizeof(float);
    for (Result<FitOutcome>& fold_fit : folds) outcome->without_fold.push_back(std::move(fold_fit->model));
    return outcome;
}

Result<FitOutcome> draft_of_samples(const ScatteredSamples& samples, const SampleObservations& observed,
                                    const FitRequest& request, const ProgressToken& progress) {
    return fit_observed_samples(samples, &observed, request, sample_options(samples, request), progress);
}

}  // namespace
