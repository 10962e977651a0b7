// The observations of scattered samples that a fit matches.
#pragma once
#include <optional>

#include "observe/observations.h"
#include "samples/gap_filled_samples.h"

namespace srbf {

struct ObserveSamplesOptions {
    Objective objective = k_default_objective;
    double max_theta = 0;  ///< [rad], in (0, π/2); 0: the objective's default
    std::uint64_t seed = 0;
    bool spectral = false;  ///< also observe the spectra of spectral samples, not only their colours
    /// Also observe the gap-filled samples, for lobes; only for an objective of pictures, in colours.
    bool fill_gaps = true;
    int threads = 0;  ///< 0: as many as the machine has; the result does not depend on it
    /// If not 0, for fits of many: only the samples filled by one g, at this many pairs and without views.
    std::size_t only_gap_filled = 0;
    /// These samples filled, if that is known already. Not of `only_gap_filled`.
    const GapFilledSamples* gap_filled = nullptr;
};

/// The indices of the samples within `sample_cap` of max_theta [rad].
std::vector<std::size_t> samples_within(const ScatteredSamples& samples, double max_theta);
/// The smallest roughness α of a microfacet lobe that pairs of directions support. With t = tan θh, θh the angle between
/// half vector and normal, it is max(t₀, t₁ / 4): t₀ is the smallest t of the pairs, t₁ the smallest one that is larger
/// by more than half of `k_group_distance`. The GGX distribution at t₀ is then at least a quarter of its peak, so that
/// no peak is more than four times what is measured beside it; where the peak itself is measured, the lobe is no
/// narrower than what leaves 0.4 % of it at the next sample.
double least_roughness(std::span<const Vec3f> wl, std::span<const Vec3f> wv);
/// These samples with weight 1, negative values set to 0; `both_ways`: each also with light and viewer exchanged;
/// `spectral`: with their spectra, whose negative values are then counted instead of those of the colours.
Observations observations_of(const ScatteredSamples& samples, std::span<const std::size_t> which, bool both_ways,
                             bool spectral);

/// Samples prepared for fits. Each sample counts twice: as it is, and with light and viewer exchanged.
struct SampleObservations {
    ObserveSamplesOptions options;
    Observations samples;  ///< within θmax, and horizon pairs beyond it; followed by bound pairs
    /// Interpolated values on a grid of pairs within θmax, with Σ w |f|² = 1; of scatter those of a `FacetMixture`, at pairs
    /// about the mirror direction and elsewhere
    Observations between;
    /// The gap-filled samples observed like a table, with as much weight again on the samples themselves, and pairs near
    /// the horizon; or none. A fit uses either these or all the others.
    Observations gap_filled_table;
    /// The gap-filled samples that were observed, and those without each fold, unless they were given.
    std::optional<GapFilledSamples> gap_filled;
    std::vector<GapFilledSamples> without_fold;
    /// Errors of interpolation at samples that were left out, or of the mixture at the samples.
    Measures interpolation;
    double finest = 0;       ///< lower bound on the width of a lobe [rad]: the spacing of the samples
    std::size_t groups = 0;  ///< number of `SampleGroups` within θmax
};
/// Errors: no sample within θmax, or all of them 0; fewer than k_folds groups; spectra requested of samples without
/// spectra; cancelled.
Result<SampleObservations> observe(const ScatteredSamples& samples, const ObserveSamplesOptions& options,
                                   const ProgressToken& progress = {});

}  // namespace srbf
