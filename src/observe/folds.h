// Groups of close samples, for cross-validation.
#pragma once
#include <optional>
#include <vector>

#include "srbf/fit_samples.h"

namespace srbf {

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
