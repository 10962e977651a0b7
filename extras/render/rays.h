// Ray intersection with meshes by Embree 3 or 4, which is used only here.
#pragma once
#include <memory>
#include <optional>

#include "extras/render/mesh.h"
#include "srbf/vec.h"

namespace SRBF_NAMESPACE {

/// The point origin + distance × direction on a triangle.
struct Hit {
    float distance;
    std::uint32_t mesh, triangle;
    float u, v;              ///< the point is (1−u−v) p0 + u p1 + v p2
    Vec3f geometric_normal;  ///< unit normal of the triangle, on its counter-clockwise side
};

/// The texture coordinates of a mesh that has them at this hit.
Vec2f texture_at(const Mesh& mesh, const Hit& hit);

/// Meshes for ray intersection. Keeps references to them; they must outlive this object.
class Rays {
  public:
    explicit Rays(const std::vector<const Mesh*>& meshes);

    /// The first hit along a unit vector.
    std::optional<Hit> closest(Vec3f origin, Vec3f direction) const;
    /// True if any hit is closer than `distance`.
    bool occluded(Vec3f origin, Vec3f direction, float distance) const;

  private:
    std::shared_ptr<void> device_, scene_;
};

}  // namespace
