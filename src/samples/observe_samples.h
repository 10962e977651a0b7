// Observations of scattered samples, and the fit of a multivariate model to them.
#pragma once
#include <optional>

#include "models/pm/search/fit_pm.h"
#include "observe/observations.h"
#include "samples/gap_filled_samples.h"

namespace SRBF_NAMESPACE {

struct ObserveSamplesOptions {
    Objective objective = k_default_objective;
    double max_theta = 0;  ///< [rad], in (0, π/2); 0: the objective's default
    std::uint64_t seed = 0;
    bool spectral = false;  ///< also observe the spectra of spectral samples, not only their colours
    bool fill_gaps = true;  ///< also observe the gap-filled samples, to which lobes are then fitted
    int threads = 0;        ///< number of threads; 0: all of the machine. The result does not depend on it
    /// If not 0, a quick mode for fits of many files: only samples filled by one prior, at this many pairs, no views.
    std::size_t only_gap_filled = 0;
};

/// The indices of the samples within `sample_cap` of max_theta [rad].
std::vector<std::size_t> samples_within(const ScatteredSamples& samples, double max_theta);
/// The smallest roughness α of a microfacet lobe that pairs of directions support. θh is the angle between half
/// vector and normal, t = tan θh. The smallest t of the pairs is t₀; t₁ is the smallest one that exceeds t₀ by more
/// than half of `k_group_distance`. The result is max(t₀, t₁ / 4). The GGX distribution at t₀ is then at least a
/// quarter of its peak, so that no peak is more than four times the value measured beside it. Where the peak itself
/// is measured, the narrowest lobe has fallen to 0.4 % of it at the next sample.
double min_roughness(std::span<const Vec3f> wl, std::span<const Vec3f> wv);
/// Each sample with light and viewer exchanged is omitted, or added.
enum class ExchangedSamples { omitted, added };
/// The given samples with weight 1 and negative values set to 0. `spectral` adds the spectra; negative values are then
/// counted in spectra instead of colours.
Observations observations_of(const ScatteredSamples& samples, std::span<const std::size_t> which,
                             ExchangedSamples exchanged, bool spectral = false);

/// Samples prepared for fits. Each sample is observed twice: as it is, and with light and viewer exchanged.
struct SampleObservations {
    ObserveSamplesOptions options;
    Observations samples;  ///< the samples within θmax
    /// The samples with gaps filled, in colours, observed like a table: by GGX, or by a `FacetMixture` for an objective
    /// of scatter, with the samples at the same total weight, and pairs near the horizon. Empty if gaps are not filled.
    Observations gap_filled_table;
    std::optional<GapFilledSamples> gap_filled;  ///< the gap-filled samples that were observed
};
/// Observes samples. Returns an error if there is no sample above 0 within θmax, if spectra are requested of samples
/// without spectra, or if it is cancelled.
Result<SampleObservations> observe(const ScatteredSamples& samples, const ObserveSamplesOptions& options,
                                   const ProgressToken& progress = {});
/// Fits lobes to the gap-filled samples, and coefficients of wavelengths to the samples. Returns an error if the
/// `fit_pm` of fit_pm.h does, or if the samples have fewer values than the model has parameters.
Result<PmFit> fit_pm(const SampleObservations& observations, const PmFitOptions& options,
                     const ProgressToken& progress = {});

}  // namespace
