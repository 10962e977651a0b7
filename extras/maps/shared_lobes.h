// The search for lobes that materials share.
#pragma once
#include <functional>
#include <memory>
#include <span>

#include "base/reporter.h"
#include "extras/maps/shared_problem.h"
#include "observe/observations.h"
#include "srbf/basis.h"

namespace SRBF_NAMESPACE {

/// Returns the observations of material t; null if there are none. May be called from any thread.
using ObservationsOf = std::function<std::shared_ptr<const Observations>(std::size_t t)>;

/// The rows with which lobes are searched for: pairs and albedos.
SharedRows rows_for_search(const Observations& observations);

/// The lobes that materials share, as a model with coefficients and scales 1. They are found with the `rows` of
/// each material, which are those of `rows_for_search`. If `observations` is not null, they then follow all terms
/// of the materials' objectives.
PmModel find_shared_lobes(std::span<SharedRows> rows, const ObservationsOf& observations, const BasisOptions& options,
                          Reporter& reporter);

}  // namespace srbf
