#include "fit/fitted_data.h"

#include "brdf/values.h"
#include "measured/tables.h"

namespace SRBF_NAMESPACE {
namespace {

constexpr double k_smoothed = 0.5;  ///< approximate fraction of the time of a fit to a noisy table until it is smoothed

}  // namespace

FittedData::FittedData(Evaluate f, const Measured* measured)
    : measured_(measured), signed_(std::move(f)), values_(non_negative(signed_)) {}

const ScatteredSamples* FittedData::samples() const {
    return measured_ ? std::get_if<ScatteredSamples>(&measured_->table) : nullptr;
}

bool FittedData::looks_isotropic(const FitRequest& request) {
    const auto [at, is_new] = isotropic_.try_emplace(request.theta());
    if (is_new) at->second = is_isotropic(signed_, request.theta(), noise_ ? noise_->deviation : Rgb{});
    return at->second;
}

bool FittedData::is_isotropic_with(const Model& fitted) const {
    return measured_ && is_isotropic(*measured_) && is_isotropic(fitted);
}

Result<ProgressToken> FittedData::smooth(const FitRequest& request, const ProgressToken& progress) {
    if (!noise_) noise_ = noise_of(signed_);
    if (!is_noisy(*noise_) || smoothed_) return progress;
    auto values =
        smoothed(signed_, *noise_, looks_isotropic(request), request.threads, progress.subrange(0, k_smoothed));
    if (!values) return values.error();
    smoothed_ = *std::move(values);
    return progress.subrange(k_smoothed, 1);
}

Result<const Observations*> FittedData::observations(const FitRequest& request, const ProgressToken& progress) {
    const ObservationKey observed_key = key(request);
    if (const auto kept = observations_.find(observed_key); kept != observations_.end()) return &kept->second;
    const auto fitted = [&](const Evaluate& f) { return f && observed_key.is_mean ? reciprocal_mean(f) : f; };
    auto observed = observe(fitted(signed_),
                            {.objective = observed_key.objective,
                             .max_theta = observed_key.max_theta,
                             .seed = observed_key.seed,
                             .threads = request.threads,
                             .smoothed = fitted(smoothed_),
                             .noise = noise_ ? largest_fraction(*noise_) : 0},
                            progress);
    if (!observed) return observed.error();
    if (observed_key.is_spectral) {
        Channels spectra = signed_spectra(*measured_);
        observe_spectra(*observed, observed_key.is_mean ? reciprocal_mean(std::move(spectra)) : spectra);
    }
    return &observations_.emplace(observed_key, *std::move(observed)).first->second;
}

Result<const SampleObservations*> FittedData::sample_observations(const FitRequest& request,
                                                                  const ProgressToken& progress) {
    const ObservationKey observed_key = key(request);
    if (const auto kept = sample_observations_.find(observed_key); kept != sample_observations_.end())
        return &kept->second;
    auto observed = observe(*samples(), observe_samples_options(request), progress);
    if (!observed) return observed.error();
    return &sample_observations_.emplace(observed_key, *std::move(observed)).first->second;
}

Result<Evaluate> FittedData::gap_filled(const FitRequest& request) const {
    const auto kept = sample_observations_.find(key(request));
    if (kept != sample_observations_.end() && kept->second.gap_filled) return evaluator(*kept->second.gap_filled);
    auto filled = fill_gaps(*samples(), request.theta(), request.threads);
    if (!filled) return filled.error();
    return evaluator(*std::move(filled));
}

}  // namespace
