// Soft von Mises-Fisher clustering, for the initial lobes of a view.
#pragma once
#include <span>
#include <vector>

#include "fit/views/view_problem.h"

namespace srbf {

/// Fits a mixture of von Mises-Fisher densities to weighted directions by maximum likelihood (Banerjee et al.,
/// "Clustering on the unit hypersphere using von Mises-Fisher distributions", 2005): `rounds` iterations of expectation
/// maximisation from `lobes`. Bandwidths stay in the range of 16-bit floats.
std::vector<ViewLobe> vmf_clusters(std::span<const Vec3f> directions, std::span<const double> weight,
                                   std::vector<ViewLobe> lobes, int rounds);

}  // namespace srbf
