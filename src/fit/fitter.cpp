// All stages of `srbf fit` between reading a measurement and writing a model.

#include "base/errors.h"
#include "base/files.h"
#include "base/floating_point.h"
#include "brdf/directions.h"
#include "errors/measures.h"
#include "errors/picture_errors.h"
#include "fit/cross_validated_fits.h"
#include "fit/fit_errors.h"
#include "fit/fit_options.h"
#include "fit/request_traits.h"
#include "fit/requests.h"
#include "generated/models/kinds.h"
#include "measured/tables.h"
#include "models/pm/pm_functions.h"
#include "models/su/su_functions.h"
#include "observe/albedo_bound.h"
#include "observe/pair_weights.h"
#include "samples/folds.h"

namespace SRBF_NAMESPACE {
namespace {

/// The draft of a table uses the first observations, and is not perturbed.
constexpr std::size_t k_draft_pairs = 4096;
constexpr int k_draft_starts = 3;

/// Approximate fractions of the time of a fit until something is observed or fitted.
constexpr double k_observed = 0.1, k_samples_observed = 0.05, k_drafts_observed = 0.3, k_fitted = 0.75;

Result<FitOutcome> fit_and_measure(Fitter fitter, const FitRequest& request, const ProgressToken& progress) {
    auto outcome = fitter.fit(request, progress.subrange(0, k_fitted));
    if (!outcome) return outcome;
    const auto measured = fitter.measure(*outcome, request, progress.subrange(k_fitted, 1));
    return measured ? std::move(outcome) : measured.error();
}

}  // namespace

// ---- Stages common to tables and samples ----

Result<FitOutcome> fit_view_by_view(const Evaluate& f, const FitRequest& request, const ProgressToken& progress) {
    const SuRequest& su = std::get<SuRequest>(request.model);
    const auto matrix =
        tabulate(f, {.directions = su.directions, .discretise = su.discretise, .threads = request.threads},
                 progress.subrange(0, k_observed));
    if (!matrix) return matrix.error();
    auto fitted = fit_su(*matrix, su_options(request), progress.subrange(k_observed, 1));
    if (!fitted) return fitted.error();
    if (progress.cancelled()) return cancelled_error("fit");
    if (fitted->empty == su.directions) return no_data_error("fit", "values", "some above 0");
    if (su.index) fitted->model.index = index_texture(fitted->model, *su.index);
    const int empty = fitted->empty;
    auto outcome = outcome_of(std::move(fitted));
    if (!outcome) return outcome;
    outcome->masked = matrix->masked;
    outcome->clamped = matrix->clamped;
    outcome->raw_bytes = raw_bytes(std::uint64_t(su.directions));
    outcome->empty_directions = empty;
    return outcome;
}

Result<FitOutcome> fit_by_kind(const FitRequest& request, const Observations& observations, bool is_isotropic,
                               const ProgressToken& progress) {
    return std::visit(
        [&]<typename R>(const R& kind) -> Result<FitOutcome> {
            using K = Kind<typename R::Model>;
            if constexpr (requires { &K::fit; })
                return outcome_of(K::fit(observations, kind, {is_isotropic, request.threads}, progress));
            misused("a fit to observations alone");
        },
        request.model);
}

// ---- Fits to tables and functions ----

namespace {

PmFitOptions lobe_options(FittedData& data, const FitRequest& request) {
    const PmRequest& pm = std::get<PmRequest>(request.model);
    return pm_options(request, pm.axial ? *pm.axial : data.looks_isotropic(request), k_default_form);
}

/// Fits one size after the other, until the mean ΔE_ITP against the fitted function reaches the target.
Result<FitOutcome> fit_first_size(const FittedData& data, const Observations& observations, PmFitOptions options,
                                  const FitRequest& request, const ProgressToken& progress) {
    const double target = target_of(request).value_or(k_default_delta_e);
    const Evaluate reference = data.fits_mean(request) ? reciprocal_mean(data.values()) : data.values();
    FitOutcome outcome;
    std::vector<Trial> path;
    double done = 0;
    for (const int lobes : k_tried_lobes) {
        options.lobes = lobes;
        const double next = done + (1 - done) / 2;  // each takes about as long as all smaller ones
        auto fitted = outcome_of(fit_pm(observations, options, progress.subrange(done, next)));
        if (!fitted) return fitted.error();
        if (progress.cancelled()) return cancelled_error("fit");
        done = next;
        outcome = *std::move(fitted);
        const Evaluate others[] = {evaluator(outcome.model)};
        const double error =
            compare_pictures(reference, others,
                             {.threads = request.threads, .is_isotropic = data.is_isotropic_with(outcome.model)})[0]
                .mean.delta_e;
        path.push_back({lobes, payload_bytes(outcome.model), error});
        outcome.reached = error <= target;
        if (outcome.reached) break;
    }
    outcome.path = std::move(path);
    return outcome;
}

Result<FitOutcome> fit_lobes(FittedData& data, const Observations& observations, const FitRequest& request,
                             const ProgressToken& progress) {
    const PmRequest& pm = std::get<PmRequest>(request.model);
    const PmFitOptions options = lobe_options(data, request);
    if (pm.size && std::holds_alternative<AutomaticLobes>(*pm.size))
        return fit_first_size(data, observations, options, request, progress);
    return outcome_of(fit_pm(observations, options, progress));
}

/// Adds statistics of the observations.
void describe(const Observations& observations, FitOutcome& outcome) {
    outcome.masked = observations.masked;
    outcome.clamped = observations.clamped;
    outcome.largest_albedo = std::max(1.0, max_measured_albedo(observations));
    outcome.raw_bytes = raw_bytes(k_matrix_directions, channels(outcome.model).count());
}

Result<FitOutcome> fit_table(FittedData& data, const FitRequest& request, const ProgressToken& progress) {
    const auto remaining = data.smooth(request, progress);
    if (!remaining) return remaining.error();
    if (std::holds_alternative<SuRequest>(request.model))
        return fit_view_by_view(data.smoothed_values() ? data.smoothed_values() : data.signed_values(), request,
                                *remaining);
    const auto observed = data.observations(request, remaining->subrange(0, k_observed));
    if (!observed) return observed.error();
    const ProgressToken fitting = remaining->subrange(k_observed, 1);
    auto outcome = std::holds_alternative<PmRequest>(request.model)
                       ? fit_lobes(data, **observed, request, fitting)
                       : fit_by_kind(request, **observed, data.looks_isotropic(request), fitting);
    if (outcome) describe(**observed, *outcome);
    return outcome;
}

Result<FitOutcome> draft_of_table(FittedData& data, const FitRequest& request, const ProgressToken& progress) {
    const auto remaining = data.smooth(request, progress);
    if (!remaining) return remaining.error();
    const auto observed = data.observations(request, remaining->subrange(0, k_drafts_observed));
    if (!observed) return observed.error();
    PmFitOptions options = lobe_options(data, request);
    options.starts = k_draft_starts;
    options.perturbations = 0;
    auto outcome =
        outcome_of(fit_pm(first_pairs(**observed, k_draft_pairs), options, remaining->subrange(k_drafts_observed, 1)));
    if (outcome) describe(**observed, *outcome);
    return outcome;
}

// ---- Fits to samples ----

Result<FitOutcome> fit_samples(FittedData& data, const FitRequest& request, const ProgressToken& progress) {
    const ScatteredSamples& samples = *data.samples();
    const auto fold = assign_folds(samples, request.theta(), request.seed);
    if (!fold) return fold.error();
    if (std::holds_alternative<SuRequest>(request.model))
        return fit_to_samples(samples, *fold, nullptr, request, progress);
    const auto observed = data.sample_observations(request, progress.subrange(0, k_samples_observed));
    if (!observed) return observed.error();
    return fit_to_samples(samples, *fold, *observed, request, progress.subrange(k_samples_observed, 1));
}

Result<FitOutcome> draft_of_samples(FittedData& data, const FitRequest& request, const ProgressToken& progress) {
    const auto observed = data.sample_observations(request, progress.subrange(0, k_drafts_observed));
    if (!observed) return observed.error();
    return draft_of_samples(*data.samples(), **observed, request, progress.subrange(k_drafts_observed, 1));
}

// ---- Both ----

Result<Done> validate(const FittedData& data, const FitRequest& request) {
    const Measured* measured = data.measured();
    if (measured && std::holds_alternative<BsdfTable>(measured->table))
        return argument_error("fit", "measurement", "a BRDF", "reflection and transmission, for fit_bsdf");
    const auto refused = [](const char* expected, std::string_view found) {
        return argument_error("fit", "spectral channels", expected, std::string(found));
    };
    if (request.spectral && (!measured || wavelengths(*measured).empty()))
        return refused("a measurement at wavelengths", "one of colours");
    if (request.spectral && !std::holds_alternative<PmRequest>(request.model))
        return refused("the model pm", model_name(request));
    const auto target = target_of(request);
    if (target && data.samples())
        return argument_error("fit", "target delta E", "a measured table", "scattered samples");
    if (target && !(*target > 0 && *target <= k_max_delta_e))
        return argument_error("fit", "target delta E", fmt::format("above 0, at most {}", k_max_delta_e),
                              fmt::format("{}", *target));
    return Done{};
}

using Stage = Result<FitOutcome>(FittedData&, const FitRequest&, const ProgressToken&);
/// Fits a valid request by one of the two stages, and adds what all outcomes have.
Result<FitOutcome> fit_by(Stage* for_table, Stage* for_samples, FittedData& data, const FitRequest& request,
                          const ProgressToken& progress) {
    const auto start = std::chrono::steady_clock::now();
    if (const auto valid = validate(data, request); !valid) return valid.error();
    auto outcome = (data.samples() ? for_samples : for_table)(data, request, progress);
    if (progress.cancelled()) return cancelled_error("fit");
    if (!outcome) return outcome;
    outcome->fit_seconds = seconds_since(start);
    outcome->max_theta = request.theta();
    outcome->noise = data.noise();
    outcome->model.provenance = {{"generator", "srbf " SRBF_VERSION}};
    for (const FitOptionRow& option : fit_options())
        if (option.state) outcome->model.provenance[std::string(option.name)] = option.state(request);
    if (const auto* openpbr = std::get_if<OpenPbrRequest>(&request.model))
        outcome->model.provenance["surface"] = name(openpbr->surface);
    if (const auto* pm = std::get_if<PmRequest>(&request.model); pm && pm->effort != 1)
        outcome->model.provenance["effort"] = fmt::format("{:.6g}", pm->effort);
    if (data.measured()) name_source(outcome->model, *data.measured());
    return outcome;
}

}  // namespace

// ---- The fitter ----

struct Fitter::State {
    FittedData data;
};

Fitter::Fitter(const Measured& measured) : state_(new State{FittedData(signed_evaluator(measured), &measured)}) {}
Fitter::Fitter(Evaluate f) : state_(new State{FittedData(std::move(f))}) {}
Fitter::Fitter(Fitter&&) noexcept = default;
Fitter& Fitter::operator=(Fitter&&) noexcept = default;
Fitter::~Fitter() = default;

Result<FitOutcome> Fitter::fit(const FitRequest& request, const ProgressToken& progress) {
    return fit_by(fit_table, fit_samples, state_->data, request, progress);
}

Result<FitOutcome> Fitter::draft(const FitRequest& request, const ProgressToken& progress) {
    if (!std::holds_alternative<PmRequest>(request.model))
        return argument_error("fit", "draft", "the model pm", std::string(model_name(request)));
    return fit_by(draft_of_table, draft_of_samples, state_->data, request, progress);
}

Result<Done> Fitter::measure(FitOutcome& outcome, const FitRequest& request, const ProgressToken& progress) const {
    const StandardArithmetic mode;
    return measure_errors(outcome, state_->data, request, progress);
}

Result<FitOutcome> fit(const Measured& measured, const FitRequest& request, const ProgressToken& progress) {
    try {
        auto outcome = fit_and_measure(Fitter(measured), request, progress);
        return outcome ? std::move(outcome) : with_source(outcome.error(), measured);
    } catch (const std::bad_alloc&) {
        return out_of_memory_error(measured.source);
    }
}
Result<FitOutcome> fit(Evaluate f, const FitRequest& request, const ProgressToken& progress) {
    return fit_and_measure(Fitter(std::move(f)), request, progress);
}

std::vector<Vec3f> matrix_directions(const Model& model, double theta_max) {
    if (const auto* su = std::get_if<SuModel>(&model.model)) return su->direction;
    return fibonacci_directions(k_matrix_directions, theta_max);
}

}  // namespace
