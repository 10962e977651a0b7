#include "fit/fit_errors.h"

#include "base/errors.h"
#include "brdf/values.h"
#include "errors/measures.h"
#include "errors/picture_errors.h"
#include "fit/request_traits.h"
#include "models/model_files.h"

namespace SRBF_NAMESPACE {
namespace {

/// Approximate fractions of the time until these are measured.
constexpr double k_matrix_measured = 0.75, k_heldout_measured = 0.9, k_albedo_measured = 0.95;

/// Writes the main errors into the model's provenance.
void record(const Comparison& errors, Model& model) {
    const auto set = [&](const char* name, double value) { model.provenance[name] = fmt::format("{:.4g}", value); };
    set("squared_error_ratio", errors.matrix.squared_error_ratio);
    set("heldout_squared_error_ratio", errors.heldout.squared_error_ratio);
    set("heldout_squared_error_ratio_cosine", errors.heldout.squared_error_ratio_cosine);
    set("albedo_error", errors.albedo_error);
    for (const PictureErrorName& error : k_picture_errors) set(error.name, errors.appearance.mean.*error.member);
    if (errors.heldout_appearance) set("heldout_delta_e_itp", errors.heldout_appearance->mean.delta_e);
}

/// The errors over pairs of directions of a fit to a table.
Comparison pair_errors(const Model& model, const FittedData& data, const FitRequest& request,
                       const ProgressToken& progress) {
    const Channels f = request.spectral ? spectra(*data.measured()) : rgb_channels(data.values()),
                   others[] = {channels(model)};
    const auto options = [&](double begin, double end) {
        return MeasureOptions{request.theta(), request.threads, progress.subrange(begin, end)};
    };
    return {
        measure_matrix(f, others, options(0, k_matrix_measured), matrix_directions(model, request.theta()))[0],
        measure_heldout(f, others, options(k_matrix_measured, k_heldout_measured))[0],
        0,
    };
}

/// Measures the errors of albedo and of pictures. All pictures show the same pairs of directions.
void measure_appearance(FitOutcome& outcome, const FittedData& data, const Evaluate& reference,
                        const FitRequest& request, const ProgressToken& progress) {
    const bool is_table = !data.samples();
    const Evaluate fitted = evaluator(outcome.model);
    outcome.errors->albedo_error =
        albedo_errors(reference, {&fitted, 1}, {request.theta(), request.threads, progress})[0];

    constexpr std::size_t k_reference = 0, k_fitted = 1;
    std::vector<Evaluate> brdfs{reference, fitted};
    std::vector<ComparedPair> pairs{{k_reference, k_fitted}};
    const auto add = [&](Evaluate brdf) {
        brdfs.push_back(std::move(brdf));
        return brdfs.size() - 1;
    };
    std::vector<std::optional<Appearance>*> results{nullptr};  // of each pair
    const auto compare = [&](std::optional<Appearance>& result, ComparedPair pair) {
        results.push_back(&result);
        pairs.push_back(pair);
    };
    if (is_table) compare(outcome.exchanged_errors, {k_reference, add(exchanged(reference))});
    if (data.smoothed_values()) compare(outcome.against_smoothed, {add(data.smoothed_values()), k_fitted});
    if (is_table && data.fits_mean(request)) compare(outcome.against_mean, {add(reciprocal_mean(reference)), k_fitted});
    const std::size_t folds = pairs.size();
    for (const Model& without_fold : outcome.without_fold) pairs.push_back({k_reference, add(evaluator(without_fold))});

    const auto errors = compare_pictures(brdfs, pairs,
                                         {.threads = request.threads,
                                          .is_isotropic = data.is_isotropic_with(outcome.model),
                                          .progress = progress.subrange(k_albedo_measured, 1)});
    outcome.errors->appearance = errors[0];
    for (std::size_t pair = 1; pair < folds; ++pair) *results[pair] = errors[pair];
    if (outcome.exchanged_errors && !(outcome.exchanged_errors->mean.delta_e > 0)) outcome.exchanged_errors.reset();
    if (folds < pairs.size()) outcome.errors->heldout_appearance = mean_of(std::span(errors).subspan(folds));
}

}  // namespace

Result<Done> measure_errors(FitOutcome& outcome, const FittedData& data, const FitRequest& request,
                            const ProgressToken& progress) {
    if (data.samples() && outcome.errors) {
        const auto reference = data.gap_filled(request);
        if (!reference) return reference.error();
        if (!progress.cancelled()) measure_appearance(outcome, data, *reference, request, progress);
    } else if (!data.samples()) {
        outcome.errors = pair_errors(outcome.model, data, request, progress);
        if (!progress.cancelled()) measure_appearance(outcome, data, data.values(), request, progress);
    }
    if (!progress.report("measuring the error", 1)) {
        outcome.errors.reset();
        return cancelled_error("measure");
    }
    if (outcome.errors) record(*outcome.errors, outcome.model);
    return Done{};
}

}  // namespace
