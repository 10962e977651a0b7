#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <nanoflann.hpp>
#include <numeric>
#include <type_traits>
#include <utility>
#include <vector>

namespace SRBF_NAMESPACE {

/// Points with `dimensions` coordinates each, in the interface that nanoflann requires.
template <typename Real, std::size_t dimensions> struct PointCloud {
    std::vector<std::array<Real, dimensions>> coordinates;
    std::size_t kdtree_get_point_count() const { return coordinates.size(); }
    Real kdtree_get_pt(std::size_t i, std::size_t dimension) const { return coordinates[i][dimension]; }
    template <typename Box> bool kdtree_get_bbox(Box&) const { return false; }
};

/// A k-d tree over such points with 32-bit indices and Euclidean distance. Keeps a reference to the points.
template <typename Real, std::size_t dimensions>
using KdTree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<Real, PointCloud<Real, dimensions>>,
                                                   PointCloud<Real, dimensions>, int(dimensions), std::uint32_t>;

/// The index of the first point with exactly the same coordinates, for each point. Searches in a tree with many
/// coincident points are as slow as in a list, so they are removed first.
template <typename Real, std::size_t dimensions>
std::vector<std::uint32_t> first_coincident_points(const PointCloud<Real, dimensions>& points) {
    std::vector<std::uint32_t> order(points.coordinates.size()), first(points.coordinates.size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::sort(order, {}, [&](std::uint32_t i) { return std::pair(points.coordinates[i], i); });
    for (std::size_t k = 0; k < order.size(); ++k) {
        const bool is_first = k == 0 || points.coordinates[order[k]] != points.coordinates[order[k - 1]];
        first[order[k]] = is_first ? order[k] : first[order[k - 1]];
    }
    return first;
}

/// The result of a search within a radius: pairs of an index and a squared distance. Their type depends on nanoflann.
template <typename Real>
using FoundPoints = std::remove_reference_t<decltype(nanoflann::RadiusResultSet<Real, std::uint32_t>::m_indices_dists)>;

}  // namespace srbf
