// Soft von Mises-Fisher clustering: where the lobes of a view start from.
#pragma once
#include <span>
#include <vector>

#include "fit/view_problem.h"

namespace srbf {

/// Lobes about which weighted directions cluster: the mixture of von Mises-Fisher densities that makes them most
/// likely (Banerjee et al., "Clustering on the unit hypersphere using von Mises-Fisher distributions", 2005), by
/// `rounds` of expectation maximisation from `lobes`. Bandwidths stay within those of halves.
std::vector<ViewLobe> vmf_clusters(std::span<const Vec3f> directions, std::span<const double> weight,
                                   std::vector<ViewLobe> lobes, int rounds);

}  // namespace srbf
