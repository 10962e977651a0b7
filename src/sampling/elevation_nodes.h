// The nodes of tables over the elevation of the view.
#pragma once
#include <cmath>
#include <cstddef>

namespace SRBF_NAMESPACE {

/// t = (1 + ∜cosθv − √(1 − cosθv)) / 2 for cosθv in [0, 1]: 0 at the horizon, 1 at the normal. Nodes that are
/// uniform in t are dense towards the normal, where highlights are, and denser still towards the horizon, where
/// albedos change fastest.
template <typename Real> Real elevation_coordinate(Real cosine) {
    return (1 + std::sqrt(std::sqrt(cosine)) - std::sqrt(1 - cosine)) / 2;
}
/// The inverse of `elevation_coordinate`, by bisection: t rises with the cosine.
inline double elevation_cosine(double t) {
    double below = 0, above = 1;
    for (double middle = 0.5; middle != below && middle != above; middle = (below + above) / 2)
        (elevation_coordinate(middle) < t ? below : above) = middle;
    return above;
}

/// A position between two nodes: the lower one, and the fraction of the way to the next.
struct NodePosition {
    std::size_t below;
    float fraction;
};

inline constexpr int k_albedo_nodes = 129;
template <typename Real> Real albedo_coordinate(Real cosine) {
    return Real(k_albedo_nodes - 1) * elevation_coordinate(cosine);
}
inline double albedo_cosine(int node) { return elevation_cosine(double(node) / (k_albedo_nodes - 1)); }

}  // namespace
