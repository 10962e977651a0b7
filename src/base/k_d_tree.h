// Nearest-neighbour search among points.
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

namespace srbf {

/// Points with `dimensions` coordinates, in the interface that nanoflann requires.
template <typename Real, std::size_t dimensions> struct PointCloud {
    std::vector<std::array<Real, dimensions>> at;
    std::size_t kdtree_get_point_count() const { return at.size(); }
    Real kdtree_get_pt(std::size_t i, std::size_t dimension) const { return at[i][dimension]; }
    template <typename Box> bool kdtree_get_bbox(Box&) const { return false; }
};

/// A k-d tree over such points with 32-bit indices and Euclidean distance. Keeps a reference to the points.
template <typename Real, std::size_t dimensions>
using KdTree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<Real, PointCloud<Real, dimensions>>,
                                                   PointCloud<Real, dimensions>, int(dimensions), std::uint32_t>;

/// For each point the first one that is at exactly the same place. A tree of very many points at one place finds them as
/// slowly as a list.
template <typename Real, std::size_t dimensions>
std::vector<std::uint32_t> first_at_its_place(const PointCloud<Real, dimensions>& points) {
    std::vector<std::uint32_t> order(points.at.size()), first(points.at.size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::sort(order, {}, [&](std::uint32_t i) { return std::pair(points.at[i], i); });
    for (std::size_t k = 0; k < order.size(); ++k) {
        const bool is_first = k == 0 || points.at[order[k]] != points.at[order[k - 1]];
        first[order[k]] = is_first ? order[k] : first[order[k - 1]];
    }
    return first;
}

/// The result of a search within a radius: pairs of an index, `first`, and a squared distance, `second`, whose type
/// depends on nanoflann's version.
template <typename Real>
using FoundPoints = std::remove_reference_t<decltype(nanoflann::RadiusResultSet<Real, std::uint32_t>::m_indices_dists)>;

}  // namespace srbf
