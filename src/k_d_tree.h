// Nearest-neighbour search among points: level 1.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <nanoflann.hpp>
#include <type_traits>
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

/// What a search within a radius finds: indices, `first`, and squared distances, `second`. The type of these pairs
/// depends on nanoflann's version.
template <typename Real>
using FoundPoints = std::remove_reference_t<decltype(nanoflann::RadiusResultSet<Real, std::uint32_t>::m_indices_dists)>;

}  // namespace srbf
