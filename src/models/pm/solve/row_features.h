// The features of a lobe's exponent at the pairs of directions of a block of rows. The exponent is linear in them.
#pragma once
#include "models/pm/solve/rows.h"

namespace SRBF_NAMESPACE {

// Arrays hold k_block numbers and are aligned for SIMD; the first `rows_in` of the block are computed.

/// For the rows of a block and ψ of (a, b): s = −|ψ−ẑ|²/2 = ψ_z − 1 and its derivative with respect to the angle.
/// Unless `axial`, s holds ψ_x, ψ_y and ψ_z − 1 one after the other, likewise their derivatives: 3 × k_block
/// numbers each. On side 1 light and viewer are exchanged.
void variate_features(const Rows& rows, std::size_t block, int side, float a, float b, bool axial, float* s,
                      float* s_by_angle);
/// The first `count` further features (pm_further_features of kernel.glsl), one after the other: `count` × k_block
/// numbers.
void further_features(const Rows& rows, std::size_t block, int count, float* features);
}  // namespace srbf
