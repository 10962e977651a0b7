// Triangle meshes: files, and two that need none: level 5.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "srbf/result.h"
#include "srbf/vec.h"

namespace srbf {

using Triangle = std::array<std::uint32_t, 3>;

/// A surface of triangles, counter-clockwise seen from outside.
struct Mesh {
    std::vector<Vec3f> positions;     ///< finite
    std::vector<Vec3f> normals;       ///< unit vectors, one for each position
    std::vector<Triangle> triangles;  ///< numbers of positions; one at least
};

/// The least box along the axes that holds all points.
struct Bounds {
    Vec3f least, most;
};
Bounds bounds(const Mesh& mesh);

/// The normal of a vertex: the sum of its triangles' normals, each by its area, made a unit vector; (0, 0, 1) where that is zero.
std::vector<Vec3f> area_weighted_normals(std::span<const Vec3f> positions, std::span<const Triangle> triangles);

// Both readers: a mesh without normals gets `area_weighted_normals`, and is turned inside out where its triangles enclose a negative
// volume. Normals of length 0 are made likewise, others normalized.

/// Reads the bytes of a `.ply` (Stanford polygon file), ascii or binary of either order: an element `vertex` with x, y, z and, if all
/// three are there, nx, ny, nz; an element `face` with a list `vertex_indices` (or `vertex_index`), polygons cut into fans. Other
/// elements and properties are passed over. Errors: another file; no faces; numbers that are not finite, indices out of
/// range; the file's end; counts that its size cannot hold, before anything is allocated. `source` is for errors alone.
Result<Mesh> read_ply(std::span<const std::byte> bytes, const std::string& source);
/// Reads the bytes of a Wavefront `.obj`: `v`, `vn` and `f` of any of the forms v, v/vt, v//vn, v/vt/vn, from the front or, negative, from the
/// last one back; polygons cut into fans. Other lines are passed over. Normals are taken where every corner has one. Errors name the line.
Result<Mesh> read_obj(std::span<const std::byte> bytes, const std::string& source);
/// Either of them, told by the content, which begins with "ply" or does not.
Result<Mesh> read_mesh(std::span<const std::byte> bytes, const std::string& source);
/// The mesh in a file, or one of `k_built_in_meshes` by its name.
Result<Mesh> load_mesh(const std::string& name);
inline constexpr std::array<std::string_view, 3> k_built_in_meshes{"sphere", "knot", "ball"};

/// The unit sphere in rings of quadrilaterals about the y axis; `rings` ≥ 2 from pole to pole, twice as many around.
Mesh sphere(int rings = 96);
/// The unit sphere on a foot, a ring below it: what materials are shown by. `rings` ≥ 6, as of the sphere, even.
Mesh ball(int rings = 96);
/// A tube of radius 0.32 around the trefoil (sin t + 2 sin 2t, cos t − 2 cos 2t, −sin 3t)/2, t in [0, 2π]: self-occluding, of every
/// normal. `around` × `along` vertices, each ≥ 3.
Mesh knot(int along = 480, int around = 64);

}  // namespace srbf
