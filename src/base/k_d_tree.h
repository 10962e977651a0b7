// Nanoflann's k-d trees over points.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <nanoflann.hpp>
#include <type_traits>
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

/// The result of a search within a radius: pairs of an index and a squared distance. Their type depends on nanoflann.
template <typename Real>
using FoundPoints = std::remove_reference_t<decltype(nanoflann::RadiusResultSet<Real, std::uint32_t>::m_indices_dists)>;

}  // namespace
