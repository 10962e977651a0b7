// Groups of close samples, and folds of them for cross-validation.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "srbf/measured.h"
#include "srbf/metrics.h"
#include "srbf/result.h"

namespace SRBF_NAMESPACE {

/// Assigns each sample to a fold, 0..k_folds−1, for cross-validation. Samples within `k_group_distance` of each
/// other form a *group* and belong to the same fold. That includes samples with light and viewer swapped and, for
/// isotropic samples, rotated or mirrored ones. Groups within max_theta [rad] that are adjacent in brightness get
/// different folds, so that no fold contains a whole highlight; otherwise folds are random.
/// Errors: fewer than k_folds groups.
Result<std::vector<int>> assign_folds(const ScatteredSamples& samples, double max_theta, std::uint64_t seed);
inline constexpr double k_group_distance = 0.5 * k_degree;  ///< of √(|Δωl|² + |Δωv|²), to first order
/// The samples of all folds except `left_out`.
ScatteredSamples without_fold(const ScatteredSamples& samples, std::span<const int> fold, int left_out);

/// Spacing of the samples where they are densest [rad]: the 5th percentile of the distances from each sample to the
/// nearest one of another group (see `assign_folds`). 0 if there is only one group.
double spacing(const ScatteredSamples& samples);

/// Groups of samples, numbered from 0. Samples within `k_group_distance` of each other belong to the same group,
/// also if they are so only with wl and wv swapped.
struct SampleGroups {
    std::vector<int> group_of;  ///< the group group_of each sample
    int count = 0;
    double spacing = 0;  ///< see `spacing`
};
SampleGroups group_samples(const ScatteredSamples& samples);
/// `assign_folds` for known groups.
Result<std::vector<int>> assign_folds(const ScatteredSamples& samples, const SampleGroups& groups, double max_theta,
                                      std::uint64_t seed);

/// Folds of scans: samples with 3 to 64 angles of incidence, and at least 8 samples for each angle. A fold holds
/// whole incidences, the k-th in ascending order in fold k mod k_folds, because a sample is predictable from its
/// neighbours in the same scan. No value for other samples.
struct IncidenceFolds {
    std::vector<int> fold_of;  ///< the fold fold_of each sample
    int incidences = 0;
};
std::optional<IncidenceFolds> incidence_folds(const ScatteredSamples& samples);

}  // namespace srbf
