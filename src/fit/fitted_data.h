// The data of fits, and what several fits of them share.
#pragma once
#include <map>
#include <optional>

#include "fit/noise.h"
#include "fit/requests.h"
#include "observe/observations.h"
#include "srbf/fit.h"

namespace SRBF_NAMESPACE {

/// A table, scattered samples, or a function, with the observations of its fits.
class FittedData {
  public:
    /// `measured`: what f evaluates, which must outlive this; null: a function.
    explicit FittedData(Evaluate f, const Measured* measured = nullptr);

    const Measured* measured() const { return measured_; }
    /// Null if a table or a function is fitted.
    const ScatteredSamples* samples() const;
    const Evaluate& signed_values() const { return signed_; }
    /// Values below 0 are set to 0.
    const Evaluate& values() const { return values_; }
    /// The noise of a table once `smooth` was called, and the smoothed values; null unless the table is noisy.
    const std::optional<Noise>& noise() const { return noise_; }
    const Evaluate& smoothed_values() const { return smoothed_; }
    /// True if a reciprocal model is fitted, to the mean of a table.
    bool fits_mean(const FitRequest& request) const { return key(request).is_mean; }
    /// True if the values depend on the difference of azimuths alone, up to their noise, within θmax of the request.
    bool looks_isotropic(const FitRequest& request);
    /// True if values of the measurement and of the fit do not change at all when light and viewer turn together.
    bool is_isotropic_with(const Model& fitted) const;

    /// Determines the noise of a table, and smooths it if it is noisy. Returns the rest of the progress.
    Result<ProgressToken> smooth(const FitRequest& request, const ProgressToken& progress);
    /// The observations of a table or function, or of samples, by which the request is fitted.
    Result<const Observations*> observations(const FitRequest& request, const ProgressToken& progress);
    Result<const SampleObservations*> sample_observations(const FitRequest& request, const ProgressToken& progress);
    /// Samples with gaps filled, as the fit of the request observed them.
    Result<Evaluate> gap_filled(const FitRequest& request) const;

  private:
    ObservationKey key(const FitRequest& request) const { return observation_key(request, samples() != nullptr); }

    const Measured* measured_;
    Evaluate signed_, values_, smoothed_ = nullptr;
    std::optional<Noise> noise_;
    std::map<ObservationKey, Observations> observations_;
    std::map<ObservationKey, SampleObservations> sample_observations_;
    std::map<double, bool> isotropic_;  ///< the keys are θmax
};

}  // namespace
