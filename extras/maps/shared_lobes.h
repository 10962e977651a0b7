// The search for lobes that materials share.
#pragma once
#include <functional>
#include <memory>
#include <span>

#include "base/reporter.h"
#include "extras/maps/shared_problem.h"
#include "observe/observations.h"
#include "srbf/basis.h"

namespace srbf {

/// The observations of material t, from any thread; null if there are none.
using ObservationsOf = std::function<std::shared_ptr<const Observations>(std::size_t t)>;

/// The rows by which lobes are searched for: pairs and albedos.
SharedRows rows_for_search(const Observations& observations);

/// The lobes that materials share, as a model with coefficients and scales 1: by `rows` of each, of `rows_for_search`, and
/// then by all terms of their objectives if there are `observations`.
PmModel find_shared_lobes(std::span<SharedRows> rows, const ObservationsOf& observations, const BasisOptions& of,
                          Reporter& reporter);

}  // namespace srbf
