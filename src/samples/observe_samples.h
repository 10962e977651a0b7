// Observations of scattered samples, which a fit matches.
#pragma once
#include <optional>

#include "observe/observations.h"
#include "samples/gap_filled_samples.h"

namespace SRBF_NAMESPACE {

struct ObserveSamplesOptions {
    Objective objective = k_default_objective;
    double max_theta = 0;  ///< [rad], in (0, π/2); 0: the objective's default
    std::uint64_t seed = 0;
    bool spectral = false;  ///< also observe the spectra of spectral samples, not only their colours
    /// Also observe the gap-filled samples in colours, to which lobes are then fitted. Applies only to objectives of
    /// pictures.
    bool fill_gaps = true;
    int threads = 0;  ///< 0: as many as the machine has; the result does not depend on it
    /// If not 0, a quick mode for fits of many files: only the samples filled by one g, at this many pairs and
    /// without views.
    std::size_t only_gap_filled = 0;
    /// The gap-filled samples, if they are known already. Not used with `only_gap_filled`.
    const GapFilledSamples* gap_filled = nullptr;
};

/// The indices of the samples within `sample_cap` of max_theta [rad].
std::vector<std::size_t> samples_within(const ScatteredSamples& samples, double max_theta);
/// The smallest roughness α of a microfacet lobe that pairs of directions support. θh is the angle between half
/// vector and normal, t = tan θh. The smallest t of the pairs is t₀; t₁ is the smallest one that exceeds t₀ by more
/// than half of `k_group_distance`. The result is max(t₀, t₁ / 4). The GGX distribution at t₀ is then at least a
/// quarter of its peak, so that no peak is more than four times the value measured beside it. Where the peak itself
/// is measured, the narrowest lobe has fallen to 0.4 % of it at the next sample.
double least_roughness(std::span<const Vec3f> wl, std::span<const Vec3f> wv);
/// The given samples with weight 1 and negative values set to 0. `both_ways` also adds each sample with light and
/// viewer swapped. `spectral` adds the spectra; their negative values are then counted instead of those of the
/// colours.
Observations observations_of(const ScatteredSamples& samples, std::span<const std::size_t> which, bool both_ways,
                             bool spectral);

/// Samples prepared for fits. Each sample is observed twice: as it is, and with light and viewer swapped.
struct SampleObservations {
    ObserveSamplesOptions options;
    Observations samples;  ///< within θmax, then horizon pairs beyond it, then bound pairs
    /// Interpolated values on a grid of pairs within θmax, with Σ w |f|² = 1. For an objective of scatter: values
    /// of a `FacetMixture` at pairs around the mirror direction and elsewhere.
    Observations between;
    /// The gap-filled samples, observed like a table. The samples themselves are added with the same total weight,
    /// and pairs near the horizon. Empty if gaps are not filled. A fit uses either this member or all the others.
    Observations gap_filled_table;
    /// The gap-filled samples that were observed, and those without each fold; empty if the caller supplied them.
    std::optional<GapFilledSamples> gap_filled;
    std::vector<GapFilledSamples> without_fold;
    /// Errors of the interpolation at left-out samples, or of the mixture at the samples.
    Measures interpolation;
    double finest = 0;       ///< lower bound on the width of a lobe [rad]: the spacing of the samples
    std::size_t groups = 0;  ///< number of `SampleGroups` within θmax
};
/// Errors: no sample within θmax, or all of them are 0; fewer than k_folds groups; spectra requested of samples
/// without spectra; cancelled.
Result<SampleObservations> observe(const ScatteredSamples& samples, const ObserveSamplesOptions& options,
                                   const ProgressToken& progress = {});

}  // namespace srbf
