// The inner loops of the view-by-view fit: Gaussian lobes and their derivatives on the directions of one view.
#pragma once
#include <array>
#include <span>

#include "base/aligned.h"
#include "models/pm/solve/columns.h"
#include "srbf/vec.h"

namespace srbf {

/// A set of directions as the loops take it: an array a component, filled up to whole blocks.
struct DirectionRows {
    DirectionRows() = default;
    explicit DirectionRows(std::span<const Vec3f> directions);
    std::size_t blocks = 0;
    std::array<Aligned<float>, 3> w;
};

/// A lobe to be differentiated: its centre and what that changes by when it moves along two tangents.
struct MovingLobe {
    Vec3f centre, along[2];
    float bandwidth;
};

// Every array below holds k_block numbers and is aligned for vectors.

/// x = `gaussian_exponent`; returns the largest of the rows with a positive weight, the lowest float where there is none.
float exponents(const DirectionRows& rows, std::size_t block, const MovingLobe& lobe, const float* root_weight,
                float* x);
/// The derivatives of √w G by the shifts along the tangents and by log λ, `e` and `x` as of `exponents` and
/// `exponentiate`: λ ((w − ξ)·along_k) e and x e.
void derive(const DirectionRows& rows, std::size_t block, const MovingLobe& lobe, const float* e, const float* x,
            float* by_first, float* by_second, float* by_log_bandwidth);

}  // namespace srbf
