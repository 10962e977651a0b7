// The warp of an RGL measurement: from the unit square of half-vector directions to the unit square of its colours.
#pragma once
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "srbf/measured.h"

namespace SRBF_NAMESPACE {

/// A position on a uniform grid: between nodes `first` and `first + 1`, with the fraction in [0, 1].
struct GridPosition {
    std::size_t first;
    float fraction;
};

/// The position of u in [0,1] on a grid of `size` ≥ 2 nodes. Clamps values outside, and NaN.
inline GridPosition grid_position(float u, std::size_t size) {
    const float x = std::min(std::max(0.0f, u), 1.0f) * float(size - 1);
    const std::size_t first = std::min(std::size_t(x), size - 2);
    return {first, x - float(first)};
}

inline float mix(float a, float b, float t) { return a + t * (b - a); }

/// Four consecutive numbers in memory.
using Four [[gnu::vector_size(16)]] = float;
inline Four four_at(const void* numbers) {
    Four four;
    std::memcpy(&four, numbers, sizeof four);
    return four;
}
inline Four mix(Four a, Four b, float t) { return a + t * (b - a); }

/// Two slices and the fraction between them; they are equal at and beyond the ends.
struct Slices {
    std::size_t first, second;
    float fraction;
    /// Interpolates value(slice).
    template <typename Value> auto blend(Value value) const { return mix(value(first), value(second), fraction); }
};

/// The position of x in an increasing list with at least one value.
inline Slices slices_at(std::span<const float> values, float x) {
    std::size_t after = 0;  // tables have eight values: counting is faster than a search with unpredictable branches
    for (const float value : values) after += value <= x;
    const std::size_t first = std::max<std::size_t>(after, 1) - 1, second = std::min(after, values.size() - 1);
    if (first == second) return {first, first, 0};
    return {first, second, (x - values[first]) / (values[second] - values[first])};
}

/// Slices of an anisotropic table, by azimuth and polar angle.
struct AnisotropicSlices {
    Slices phi, theta;
    std::size_t polar;  ///< number of polar angles
    template <typename Value> auto blend(Value value) const {
        return phi.blend(
            [&](std::size_t p) { return theta.blend([&](std::size_t t) { return value(p * polar + t); }); });
    }
};

/// Appends a slice of densities, normalised and integrated; returns false if its integral is not a positive number.
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
    double below = 0, previous = 0;
    for (std::size_t y = 0; y < height; ++y) {
        const std::size_t row = y * width;
        for (std::size_t i = row; i < row + width; ++i)
            visible.nodes.push_back({float(double(density[i]) / integral), float(left[i] / integral)});
        const double whole = left[row + width - 1] / integral;
        if (y > 0) below += 0.5 * (previous + whole);
        visible.rows.push_back({float(whole), float(below)});
        previous = whole;
    }
    return true;
}

/// u(θ) = √(2θ/π)
inline float to_unit(float theta) { return std::sqrt(theta * float(2 / k_pi)); }

inline float at(const RglTable::Profile& profile, float u) {
    const auto [i, t] = grid_position(u, profile.width);
    return mix(profile.nodes[i], profile.nodes[i + 1], t);
}

/// A point of the unit square and the density there, which integrates to 1 over the square.
struct Warped {
    float x, y, density;
};

/// w = warp⁻¹(u): w_y = ∫_0^{u_y} ∫_0^1 p(x,y) dx dy,  w_x = ∫_0^{u_x} p(x,u_y) dx / ∫_0^1 p(x,u_y) dx;
/// |∂w/∂u| = p(u). Source: Dupuy & Jakob (2018).
template <typename AnySlices>
Warped unwarp(const RglTable::VisibleNormals& visible, const AnySlices& slices, float u_x, float u_y) {
    const std::size_t width = visible.width, height = visible.height;
    const auto [column, x] = grid_position(u_x, width);
    const auto [row, y] = grid_position(u_y, height);

    // In memory, two adjacent nodes are density, left, density, left; two rows are whole, below, whole, below.
    const RglTable::VisibleNormals::Node* const nodes = &visible.nodes[row * width + column];
    const std::size_t size = width * height;
    const auto two_nodes = [&](std::size_t i) {
        return slices.blend([&](std::size_t slice) { return four_at(nodes + slice * size + i); });
    };
    const Four node = mix(two_nodes(0), two_nodes(width), y);
    const float p0 = node[0], p1 = node[2];
    const float left = node[1] + x * (p0 + 0.5f * x * (p1 - p0));

    const RglTable::VisibleNormals::Row* const rows = &visible.rows[row];
    const Four two_rows = slices.blend([&](std::size_t slice) { return four_at(rows + slice * height); });
    const float w0 = two_rows[0], w1 = two_rows[2], total = mix(w0, w1, y);
    const float below = two_rows[1] + y * (w0 + 0.5f * y * (w1 - w0));

    // Results may be rounded beyond the square. If a row has no density, the warp is undefined and any value will do.
    return {total > 0 ? std::min(left / total, 1.0f) : u_x, std::min(below, 1.0f),
            mix(p0, p1, x) * float(width - 1) * float(height - 1)};
}

/// Solves s (a + s (b − a) / 2) = area for s in [0, 1]: inverts the integral of a linear function from a ≥ 0 to b ≥ 0.
inline float invert_linear_integral(float a, float b, float area) {
    const float root = std::sqrt(std::max(0.0f, a * a + 2 * area * (b - a)));
    return a + root > 0 ? std::clamp(2 * area / (a + root), 0.0f, 1.0f) : 0;
}

/// The inverse of `unwarp` on one slice, which maps the uniform density on the square to the slice's density.
inline Warped warp(const RglTable::VisibleNormals& visible, std::size_t slice, float w_x, float w_y) {
    const std::size_t width = visible.width, height = visible.height;
    const RglTable::VisibleNormals::Row* const rows = &visible.rows[slice * height];
    const auto above =
        std::upper_bound(rows + 1, rows + height - 1, w_y,
                         [](float y, const RglTable::VisibleNormals::Row& row) { return y < row.below; });
    const std::size_t row = std::size_t(above - rows) - 1;
    const float y = invert_linear_integral(rows[row].whole, rows[row + 1].whole, w_y - rows[row].below);

    const RglTable::VisibleNormals::Node* const nodes = &visible.nodes[(slice * height + row) * width];
    const auto left = [&](std::size_t i) { return mix(nodes[i].left, nodes[i + width].left, y); };
    const auto density = [&](std::size_t i) { return mix(nodes[i].density, nodes[i + width].density, y); };
    const float target = w_x * mix(rows[row].whole, rows[row + 1].whole, y);
    std::size_t column = 0;
    for (std::size_t step = std::bit_ceil(width) / 2; step > 0; step /= 2)
        if (column + step < width - 1 && left(column + step) <= target) column += step;
    const float x = invert_linear_integral(density(column), density(column + 1), target - left(column));
    return {(float(column) + x) / float(width - 1), (float(row) + y) / float(height - 1),
            mix(density(column), density(column + 1), x) * float(width - 1) * float(height - 1)};
}

}  // namespace
