// The warp of an RGL measurement: from the unit square of half-way directions to that of the measured
// colours.
#pragma once
#include <algorithm>

#include "srbf/measured.h"

namespace srbf {

/// A place between two nodes of a regular line: node `first`, then `first + 1`, `to` of the way, 0 ≤ to ≤ 1.
struct Between {
    std::size_t first;
    float to;
};

/// u in [0,1] on a line of `size` ≥ 2 nodes; what lies outside, or is no number, goes to an end.
inline Between between_nodes(float u, std::size_t size) {
    const float x = std::min(std::max(0.0f, u), 1.0f) * float(size - 1);
    const std::size_t first = std::min(std::size_t(x), size - 2);
    return {first, x - float(first)};
}

inline float mix(float a, float b, float to) { return a + to * (b - a); }

/// Two slices, `to` of the way from one to the other; they are the same at and past the ends.
struct Slices {
    std::size_t first, second;
    float to;
};

inline Slices slices_at(std::span<const float> theta_l, float theta) {
    std::size_t after = 0;  // a table has eight: counting is faster than a search, whose branches cannot be foreseen
    for (const float t : theta_l) after += t <= theta;
    const std::size_t first = std::max<std::size_t>(after, 1) - 1, second = std::min(after, theta_l.size() - 1);
    if (first == second) return {first, first, 0};
    return {first, second, (theta - theta_l[first]) / (theta_l[second] - theta_l[first])};
}

/// A point of the unit square and the density there, which integrates to 1 over the square.
struct Warped {
    float x, y, density;
};

/// w = warp⁻¹(u): w_y = ∫_0^{u_y} ∫_0^1 p(x,y) dx dy,  w_x = ∫_0^{u_x} p(x,u_y) dx / ∫_0^1 p(x,u_y) dx;
/// |∂w/∂u| = p(u). Source: Dupuy & Jakob (2018).
inline Warped unwarp(const RglTable::VisibleNormals& visible, const Slices& slices, float u_x, float u_y) {
    const std::size_t width = visible.width, height = visible.height;
    const auto [column, x] = between_nodes(u_x, width);
    const auto [row, y] = between_nodes(u_y, height);

    const RglTable::VisibleNormals::Node* const near_nodes =
        &visible.nodes[(slices.first * height + row) * width + column];
    const RglTable::VisibleNormals::Node* const far_nodes =
        &visible.nodes[(slices.second * height + row) * width + column];
    const auto density = [&](std::size_t i) { return mix(near_nodes[i].density, far_nodes[i].density, slices.to); };
    const auto left = [&](std::size_t i) { return mix(near_nodes[i].left, far_nodes[i].left, slices.to); };
    const float p0 = mix(density(0), density(width), y), p1 = mix(density(1), density(width + 1), y);
    const float to_left = mix(left(0), left(width), y) + x * (p0 + 0.5f * x * (p1 - p0));

    const RglTable::VisibleNormals::Row* const near_rows = &visible.rows[slices.first * height + row];
    const RglTable::VisibleNormals::Row* const far_rows = &visible.rows[slices.second * height + row];
    const auto whole = [&](std::size_t j) { return mix(near_rows[j].whole, far_rows[j].whole, slices.to); };
    const float w0 = whole(0), w1 = whole(1), total = mix(w0, w1, y);
    const float below = mix(near_rows->below, far_rows->below, slices.to) + y * (w0 + 0.5f * y * (w1 - w0));

    // Rounding may leave the square by a hair. Where a row has no density, no warp is defined and any will
    // do.
    return {total > 0 ? std::min(to_left / total, 1.0f) : u_x, std::min(below, 1.0f),
            mix(p0, p1, x) * float(width - 1) * float(height - 1)};
}

}  // namespace srbf
