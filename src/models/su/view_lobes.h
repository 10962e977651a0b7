// The inner loops of the view-by-view fit: Gaussian lobes and their derivatives on the directions of one view.
#pragma once
#include <array>

#include "base/aligned.h"
#include "models/pm/solve/simd_columns.h"
#include "srbf/vec.h"

namespace SRBF_NAMESPACE {

/// Directions as an array for each component, padded to whole blocks.
struct DirectionRows {
    DirectionRows() = default;
    explicit DirectionRows(std::span<const Vec3f> directions);
    std::size_t blocks = 0;
    std::array<Aligned<float>, 3> w;
};

/// A lobe, and the derivatives of its centre by shifts along two tangents.
struct MovingLobe {
    Vec3f centre, along[2];
    float bandwidth;
};

// Every array below holds k_block numbers and is aligned for SIMD.

/// x = `gaussian_exponent`. Returns the largest of the rows with positive weight, or the lowest float if there are
/// none.
float exponents(const DirectionRows& rows, std::size_t block, const MovingLobe& lobe, const float* root_weight,
                float* x);
/// The derivatives of e = √w G by the shifts along the tangents, λ ((w − ξ)·along_k) e, and by log λ, x e.
void derive(const DirectionRows& rows, std::size_t block, const MovingLobe& lobe, const float* e, const float* x,
            float* by_first, float* by_second, float* by_log_bandwidth);

}  // namespace
