// Options of the stages of a fit from a request, and outcomes from their fits.
#pragma once
#include <fmt/ranges.h>

#include <chrono>

#include "models/kind/parameters.h"
#include "models/model_files.h"
#include "models/pm/search/fit_pm.h"
#include "models/su/fit_su.h"
#include "samples/observe_samples.h"
#include "srbf/fit.h"

namespace SRBF_NAMESPACE {

/// The size of f at all pairs of n directions in 32-bit floats [bytes].
constexpr std::uint64_t raw_bytes(std::uint64_t n, std::uint64_t channels = 3) {
    return n * n * channels * sizeof(float);
}

inline double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// The requested number of lobes; none: it is chosen by the fit.
inline std::optional<int> lobes_of(const PmRequest& pm) {
    const auto* count = pm.size ? std::get_if<LobeCount>(&*pm.size) : nullptr;
    return count ? std::optional(count->lobes) : std::nullopt;
}

/// `form` is used if the request has none; it depends on the measurement (`PmRequest::form`).
inline PmFitOptions pm_options(const FitRequest& request, bool axial, PmForm form) {
    const PmRequest& pm = std::get<PmRequest>(request.model);
    const FormRow& row = row_of(pm.form.value_or(form));
    return {.form = row.form,
            .axial = axial,
            .lobes = lobes_of(pm).value_or(row.lobes),
            .variates = pm.variates.value_or(row.variates),
            .effort = pm.effort,
            .albedo_limit = pm.albedo_limit,
            .seed = request.seed,
            .threads = request.threads};
}

inline SuFitOptions su_options(const FitRequest& request) {
    const SuRequest& su = std::get<SuRequest>(request.model);
    return {.lobes = su.lobes,
            .objective = request.objective,
            .max_theta = request.theta(),
            .interpolation = su.interpolation,
            .neighbours = su.neighbours,
            .seed = request.seed,
            .threads = request.threads};
}

/// Everything in a request that observations depend on. A `Fitter` keeps observations for each key.
struct ObservationKey {
    Objective objective;
    double max_theta;  ///< [rad]
    std::uint64_t seed;
    bool is_spectral;
    bool fills_gaps;  ///< whether samples are also observed with gaps filled
    bool is_mean;     ///< whether a reciprocal model is fitted, to the mean of a table and of its exchange
    auto operator<=>(const ObservationKey&) const = default;
};
inline ObservationKey observation_key(const FitRequest& request, bool is_of_samples) {
    const auto* pm = std::get_if<PmRequest>(&request.model);
    return {.objective = request.objective,
            .max_theta = request.theta(),
            .seed = request.seed,
            .is_spectral = request.spectral,
            .fills_gaps = pm && is_of_samples,
            .is_mean = pm && is_reciprocal(pm->form.value_or(is_of_samples ? PmForm::extended : k_default_form))};
}

inline ObserveSamplesOptions observe_samples_options(const FitRequest& request) {
    constexpr bool k_is_of_samples = true;
    const ObservationKey key = observation_key(request, k_is_of_samples);
    return {.objective = key.objective,
            .max_theta = key.max_theta,
            .seed = key.seed,
            .spectral = key.is_spectral,
            .fill_gaps = key.fills_gaps,
            .threads = request.threads};
}

/// The model of a fit, and why its search stopped. Returns the error of the fit, or of a number too large for a file.
template <typename Fit> Result<FitOutcome> outcome_of(Result<Fit> fit) {
    if (!fit) return fit.error();
    FitOutcome outcome;
    outcome.model.model = std::move(fit->unrounded);
    if (const auto within = check_range(outcome.model, "fit"); !within) return within.error();
    outcome.model.model = std::move(fit->model);
    if constexpr (requires { fit->stop; }) outcome.stop = fit->stop;
    return outcome;
}

/// Writes into a model's provenance the file of its measurement, an exchange of light and viewer, and the aperture.
inline void name_source(Model& model, const Measured& measured) {
    if (!measured.source.empty())
        model.provenance["source"] = measured.source.substr(measured.source.find_last_of('/') + 1);
    if (measured.is_exchanged) model.provenance["exchanged"] = k_exchanged;
    if (const auto* samples = std::get_if<ScatteredSamples>(&measured.table); samples && !samples->receiver.empty())
        model.provenance["receiver [nm, sr]"] = fmt::format("{}", samples->receiver);
}
/// `error` with the file of the measurement as its source.
inline Error with_source(Error error, const Measured& measured) {
    if (!measured.source.empty()) error.source = measured.source;
    return error;
}

/// A fit to observations alone, of a kind that has a `fit`.
Result<FitOutcome> fit_by_kind(const FitRequest& request, const Observations& observations, bool is_isotropic,
                               const ProgressToken& progress);
/// A view-by-view fit, which observes all pairs of directions itself.
Result<FitOutcome> fit_view_by_view(const Evaluate& f, const FitRequest& request, const ProgressToken& progress);

}  // namespace
