// The sampled views between which a view-by-view model interpolates, and the integrals of their lobes.
#pragma once
#include "srbf/kernel.h"
#include "srbf/models/su.h"

namespace SRBF_NAMESPACE {

/// Sampled views with weights that sum to 1.
struct ViewNeighbours {
    std::array<Kernel<float>::SuNeighbour, k_max_neighbours> view{};
    int count = 0;
};
ViewNeighbours find_neighbours(const SuModel& model, Vec3f w);

/// ∫ G_ij cosθ dω of each lobe, n × J, with coefficients 1.
std::vector<float> lobe_integrals(const SuModel& model);

}  // namespace
