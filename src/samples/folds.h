// Groups of close samples, and folds of them for cross-validation.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "srbf/measured.h"
#include "srbf/metrics.h"
#include "srbf/result.h"

namespace srbf {

/// Assigns each sample to a fold, 0..k_folds−1, for cross-validation. Samples within `k_group_distance` of each other
/// are a *group* and belong to the same fold. That includes samples with light and viewer exchanged and, for isotropic
/// samples, rotated or mirrored ones. Groups within max_theta [rad] that are adjacent in brightness get different
/// folds, otherwise at random, so that no fold contains a whole highlight.
/// Errors: fewer than k_folds groups.
Result<std::vector<int>> assign_folds(const ScatteredSamples& samples, double max_theta, std::uint64_t seed);
inline constexpr double k_group_distance = 0.5 * k_degree;  ///< √(|Δωl|² + |Δωv|²), to first order
/// The samples of all folds except `left_out`.
ScatteredSamples without_fold(const ScatteredSamples& samples, std::span<const int> fold, int left_out);

/// Spacing of the samples where they are densest [rad]: the 5th percentile of the distances of samples to the nearest
/// of another group (see `assign_folds`). 0 if there is only one group.
double spacing(const ScatteredSamples& samples);

/// Samples within `k_group_distance` of each other have the same number, from 0 on; so do samples that are close to
/// them with wl and wv exchanged.
struct SampleGroups {
    std::vector<int> of;  ///< the group of each sample
    int count = 0;
    double spacing = 0;  ///< see `spacing`
};
SampleGroups group_samples(const ScatteredSamples& samples);
/// `assign_folds` for known groups.
Result<std::vector<int>> assign_folds(const ScatteredSamples& samples, const SampleGroups& groups, double max_theta,
                                      std::uint64_t seed);

/// Scans: samples of 3 to 64 angles of incidence, 8 or more of each. Of these a fold holds whole incidences, the k-th of
/// them in ascending order in fold k mod k_folds, since a sample's neighbours in its scan foretell it. Nothing: others.
struct IncidenceFolds {
    std::vector<int> of;  ///< the fold of each sample
    int incidences = 0;
};
std::optional<IncidenceFolds> incidence_folds(const ScatteredSamples& samples);

}  // namespace srbf
