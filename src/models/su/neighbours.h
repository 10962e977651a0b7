// The sampled views that a view-by-view model interpolates from, and what their lobes reflect.
#pragma once
#include "srbf/kernel.h"
#include "srbf/models/su.h"

namespace srbf {

/// Sampled views with weights that sum to 1.
struct ViewNeighbours {
    std::array<Kernel<float>::SuNeighbour, k_most_neighbours> of{};
    int count = 0;
};
ViewNeighbours neighbours_at(const SuModel& model, Vec3f w);

/// ∫ G_ij cosθ dω of each lobe, of coefficient 1, n × J.
std::vector<float> lobe_integrals(const SuModel& model);

}  // namespace srbf
