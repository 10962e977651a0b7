// The nodes of tables of directional albedo.
#pragma once
#include <cmath>

namespace srbf {

/// Nodes are uniform in t = (1 + ∜cosθv − √(1 − cosθv)) / 2, from the horizon to the normal: close to each other towards
/// the normal, where highlights are, and closer towards the horizon, where albedos change fastest.
inline constexpr int k_albedo_nodes = 97;

/// t (k_albedo_nodes − 1) of cosθv in [0, 1].
template <typename Real> Real albedo_coordinate(Real cosine) {
    return Real(k_albedo_nodes - 1) * (1 + std::sqrt(std::sqrt(cosine)) - std::sqrt(1 - cosine)) / 2;
}
/// cosθv of a node, by bisection: t rises with it.
inline double albedo_cosine(int node) {
    double below = 0, above = 1;
    for (double middle = 0.5; middle != below && middle != above; middle = (below + above) / 2)
        (albedo_coordinate(middle) < node ? below : above) = middle;
    return above;
}

}  // namespace srbf
