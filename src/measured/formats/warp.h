// The warp of an RGL measurement: from the unit square of half-vector directions to that of the measured colours.
#pragma once
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <span>

#include "srbf/measured.h"

namespace srbf {

/// A position between two nodes of a uniform grid: between nodes `first` and `first + 1` with fraction `to`, 0 ≤ to ≤
/// 1.
struct Between {
    std::size_t first;
    float to;
};

/// The position of u in [0,1] on a grid of `size` ≥ 2 nodes. Values outside, and NaN, are clamped to an end.
inline Between between_nodes(float u, std::size_t size) {
    const float x = std::min(std::max(0.0f, u), 1.0f) * float(size - 1);
    const std::size_t first = std::min(std::size_t(x), size - 2);
    return {first, x - float(first)};
}

inline float mix(float a, float b, float to) { return a + to * (b - a); }

/// Four consecutive numbers in memory.
using Four [[gnu::vector_size(16)]] = float;
inline Four four_at(const void* numbers) {
    Four four;
    std::memcpy(&four, numbers, sizeof four);
    return four;
}
inline Four mix(Four a, Four b, float to) { return a + to * (b - a); }

/// Two slices and the fraction `to` between them; both are equal at and beyond the ends.
struct Slices {
    std::size_t first, second;
    float to;
    /// Interpolates `of(slice)`.
    template <typename Of> auto blend(Of of) const { return mix(of(first), of(second), to); }
};

/// The position in an increasing list with at least one value.
inline Slices slices_at(std::span<const float> values, float x) {
    std::size_t after = 0;  // tables have eight values: counting is faster than a search with unpredictable branches
    for (const float value : values) after += value <= x;
    const std::size_t first = std::max<std::size_t>(after, 1) - 1, second = std::min(after, values.size() - 1);
    if (first == second) return {first, first, 0};
    return {first, second, (x - values[first]) / (values[second] - values[first])};
}

/// Slices of a table of azimuths × polar angles.
struct TurnedSlices {
    Slices phi, theta;
    std::size_t polar;  ///< number of polar angles
    template <typename Of> auto blend(Of of) const {
        return phi.blend([&](std::size_t p) { return theta.blend([&](std::size_t t) { return of(p * polar + t); }); });
    }
};

/// Normalises a slice of densities and integrates it; returns false if its integral is not a positive number.
inline bool integrate(std::span<const float> density, RglTable::VisibleNormals& visible) {
    const std::size_t width = visible.width, height = visible.height;
    std::vector<double> left(density.size());
    double integral = 0;
    for (std::size_t y = 0; y < height; ++y) {
        const std::size_t row = y * width, end = row + width - 1;
        for (std::size_t i = row; i < end; ++i)
            left[i + 1] = left[i] + 0.5 * (double(density[i]) + double(density[i + 1]));
        integral += left[end] * (y == 0 || y == height - 1 ? 0.5 : 1);
    }
    if (!(integral > 0)) return false;
    double below = 0, last = 0;
    for (std::size_t y = 0; y < height; ++y) {
        const std::size_t row = y * width;
        for (std::size_t i = row; i < row + width; ++i)
            visible.nodes.push_back({float(double(density[i]) / integral), float(left[i] / integral)});
        const double whole = left[row + width - 1] / integral;
        if (y > 0) below += 0.5 * (last + whole);
        visible.rows.push_back({float(whole), float(below)});
        last = whole;
    }
    return true;
}

/// u(θ) = √(2θ/π)
inline float to_unit(float theta) { return std::sqrt(theta * float(2 / k_pi)); }

inline float at(const RglTable::Profile& profile, float u) {
    const auto [i, to] = between_nodes(u, profile.width);
    return mix(profile.nodes[i], profile.nodes[i + 1], to);
}

/// A point of the unit square and the density there; the density integrates to 1 over the square.
struct Warped {
    float x, y, density;
};

/// w = warp⁻¹(u): w_y = ∫_0^{u_y} ∫_0^1 p(x,y) dx dy,  w_x = ∫_0^{u_x} p(x,u_y) dx / ∫_0^1 p(x,u_y) dx;
/// |∂w/∂u| = p(u). Source: Dupuy & Jakob (2018).
template <typename AnySlices>
Warped unwarp(const RglTable::VisibleNormals& visible, const AnySlices& slices, float u_x, float u_y) {
    const std::size_t width = visible.width, height = visible.height;
    const auto [column, x] = between_nodes(u_x, width);
    const auto [row, y] = between_nodes(u_y, height);

    // Two adjacent nodes are density, left, density, left; two rows are whole, below, whole, below.
    const RglTable::VisibleNormals::Node* const nodes = &visible.nodes[row * width + column];
    const std::size_t size = width * height;
    const auto two_nodes = [&](std::size_t i) {
        return slices.blend([&](std::size_t slice) { return four_at(nodes + slice * size + i); });
    };
    const Four between = mix(two_nodes(0), two_nodes(width), y);
    const float p0 = between[0], p1 = between[2];
    const float to_left = between[1] + x * (p0 + 0.5f * x * (p1 - p0));

    const RglTable::VisibleNormals::Row* const rows = &visible.rows[row];
    const Four two_rows = slices.blend([&](std::size_t slice) { return four_at(rows + slice * height); });
    const float w0 = two_rows[0], w1 = two_rows[2], total = mix(w0, w1, y);
    const float below = two_rows[1] + y * (w0 + 0.5f * y * (w1 - w0));

    // Rounding may exceed the square slightly. If a row has no density, the warp is undefined and any value will do.
    return {total > 0 ? std::min(to_left / total, 1.0f) : u_x, std::min(below, 1.0f),
            mix(p0, p1, x) * float(width - 1) * float(height - 1)};
}

/// Solves s (a + s (b − a) / 2) = area for s in [0, 1]: the inverse of the integral of a line from a to b ≥ 0.
inline float along_line(float a, float b, float area) {
    const float root = std::sqrt(std::max(0.0f, a * a + 2 * area * (b - a)));
    return a + root > 0 ? std::clamp(2 * area / (a + root), 0.0f, 1.0f) : 0;
}

/// The inverse of `unwarp` on one slice: maps the uniform density on the square to the slice's density.
inline Warped warp(const RglTable::VisibleNormals& visible, std::size_t slice, float w_x, float w_y) {
    const std::size_t width = visible.width, height = visible.height;
    const RglTable::VisibleNormals::Row* const rows = &visible.rows[slice * height];
    const auto above =
        std::upper_bound(rows + 1, rows + height - 1, w_y,
                         [](float y, const RglTable::VisibleNormals::Row& row) { return y < row.below; });
    const std::size_t row = std::size_t(above - rows) - 1;
    const float y = along_line(rows[row].whole, rows[row + 1].whole, w_y - rows[row].below);

    const RglTable::VisibleNormals::Node* const nodes = &visible.nodes[(slice * height + row) * width];
    const auto left = [&](std::size_t i) { return mix(nodes[i].left, nodes[i + width].left, y); };
    const auto density = [&](std::size_t i) { return mix(nodes[i].density, nodes[i + width].density, y); };
    const float wanted = w_x * mix(rows[row].whole, rows[row + 1].whole, y);
    std::size_t column = 0;
    for (std::size_t step = std::bit_ceil(width) / 2; step > 0; step /= 2)
        if (column + step < width - 1 && left(column + step) <= wanted) column += step;
    const float x = along_line(density(column), density(column + 1), wanted - left(column));
    return {(float(column) + x) / float(width - 1), (float(row) + y) / float(height - 1),
            mix(density(column), density(column + 1), x) * float(width - 1) * float(height - 1)};
}

}  // namespace srbf
