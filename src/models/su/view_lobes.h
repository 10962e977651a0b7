// The inner loops of the view-by-view fit: Gaussian lobes and their derivatives on the directions of one view.
#pragma once
#include <array>
#include <span>

#include "base/aligned.h"
#include "models/pm/solve/columns.h"
#include "observe/pixels.h"
#include "srbf/vec.h"

namespace srbf {

/// A set of directions as the loops take it: an array a component, filled up to whole blocks.
struct DirectionRows {
    DirectionRows() = default;
    explicit DirectionRows(std::span<const Vec3f> directions);
    std::size_t blocks = 0;
    std::array<Aligned<float>, 3> w;
    Aligned<float> slant;  ///< 1/w_z − 1 as in kernel.glsl; 0 where w_z ≤ 0
};

/// A lobe to be differentiated: its centre and what that changes by when it moves along two tangents; and the tangent
/// of its shape.
struct MovingLobe {
    Vec3f centre, along[2];
    float bandwidth, shape;
    Vec3f across;
};

// Every array below holds k_block numbers and is aligned for vectors.

/// x = `shaped_exponent`; returns the largest of the rows with a positive weight, the lowest float where there is none.
float exponents(const DirectionRows& rows, std::size_t block, const MovingLobe& lobe, const float* root_weight,
                float* x);
/// The derivatives of √w G by the shifts along the tangents, by log λ and, unless `by_shape` is null, by the shape, `e`
/// and `x` as of `exponents` and `exponentiate`, with d = w − ξ: λ (d·along_k + α (d·t) (t·along_k)) e,
/// (x + τ (1/w_z − 1)) e, and (1 − 1/w_z) e of a shape from 0 up, ½ λ (d·t)² e of one from −0 down.
void derive(const DirectionRows& rows, std::size_t block, const MovingLobe& lobe, const float* e, const float* x,
            float* by_first, float* by_second, float* by_log_bandwidth, float* by_shape);

}  // namespace srbf
