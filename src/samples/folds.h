// Groups of close samples, and folds of them for cross-validation.
#pragma once
#include "srbf/measured.h"
#include "srbf/metrics.h"
#include "srbf/result.h"

namespace SRBF_NAMESPACE {

/// Assigns each sample to a fold, 0..k_folds−1, for cross-validation. Samples within about `k_group_distance` of each
/// other form a *group* and belong to the same fold. That includes samples with light and viewer exchanged and, for
/// isotropic samples, rotated or mirrored ones. Groups within max_theta [rad] that are adjacent in brightness get
/// different folds, so that none has a whole highlight; other folds are random. Fewer than k_folds groups are an error.
Result<std::vector<int>> assign_folds(const ScatteredSamples& samples, double max_theta, std::uint64_t seed);
inline constexpr double k_group_distance = 0.5 * k_degree;  ///< bound on √(|Δωl|² + |Δωv|²), to first order
/// The samples of all folds except `left_out`.
ScatteredSamples without_fold(const ScatteredSamples& samples, std::span<const int> fold, int left_out);

}  // namespace
