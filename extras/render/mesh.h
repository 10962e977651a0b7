// Triangle meshes: readers, and built-in meshes.
#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "srbf/result.h"
#include "srbf/vec.h"

namespace SRBF_NAMESPACE {

using Triangle = std::array<std::uint32_t, 3>;

/// A surface of triangles, counter-clockwise seen from outside.
struct Mesh {
    std::vector<Vec3f> positions;     ///< finite
    std::vector<Vec3f> normals;       ///< unit vectors, one per position
    std::vector<Triangle> triangles;  ///< indices of positions; at least one
    /// Texture coordinates (u, v) of the corners of each triangle, where the first row of a map is at v = 0 as in
    /// glTF; or empty.
    std::vector<std::array<Vec2f, 3>> texture;
};

/// The axis-aligned bounding box of the points.
struct Bounds {
    Vec3f min, max;
};
Bounds bounds(const Mesh& mesh);

/// Vertex normals: the sum of the adjacent triangles' normals weighted by area, normalised; (0, 0, 1) if that is zero.
std::vector<Vec3f> area_weighted_normals(std::span<const Vec3f> positions, std::span<const Triangle> triangles);

/// Coordinates of a mesh that is read are at most this far from 0, and its bounds are at least this wide along one
/// axis: then computed values, up to the fourth power of 100 times its size, remain in the range of floats.
inline constexpr float k_furthest_vertex = 1e7f, k_min_extent = 1e-7f;

// Both readers give a mesh without normals `area_weighted_normals`, and invert its orientation if its triangles
// enclose a negative volume. Normals of length 0 are replaced in the same way; others are normalised. Texture
// coordinates, whose v goes upwards in these files, become (u, 1 − v), and (0, 0) if they are not finite.

/// Reads the bytes of a `.ply` (Stanford polygon file), ascii or binary of either byte order. An element `vertex`
/// has x, y, z and, if all three exist, nx, ny, nz, and if both exist s, t (or u, v, or texture_u, texture_v). An
/// element `face` has a list `vertex_indices` (or `vertex_index`), whose polygons become triangle fans. Other
/// elements and properties are skipped.
/// Returns an error if the file is of another format, truncated or without faces; if numbers are not finite, positions
/// or the extent beyond the limits above, or indices out of range; and, before any allocation, if its size cannot hold
/// its counts. `file_name` appears in errors only.
Result<Mesh> read_ply(std::span<const std::byte> bytes, const std::string& file_name);
/// Reads the bytes of a Wavefront `.obj`: `v`, `vt`, `vn` and `f` in the forms v, v/vt, v//vn, v/vt/vn, with
/// indices from 1 or, if negative, relative to the end. Polygons become triangle fans. Other lines are skipped.
/// Normals and texture coordinates are used if every corner has them. Errors name the line.
Result<Mesh> read_obj(std::span<const std::byte> bytes, const std::string& file_name);
/// Reads either format, recognised by its content: a PLY file begins with "ply".
Result<Mesh> read_mesh(std::span<const std::byte> bytes, const std::string& file_name);
/// Loads a mesh from a file, or one of `k_built_in_meshes` by its name.
Result<Mesh> load_mesh(const std::string& name);
inline constexpr std::array<std::string_view, 3> k_built_in_meshes{"sphere", "knot", "ball"};

/// The unit sphere in rings of quadrilaterals around the y axis: `rings` ≥ 2 from pole to pole, twice as many
/// around. A map is wrapped around it once, with its middle at +z and its first row at +y.
Mesh sphere(int rings = 96);
/// The unit sphere on a foot, which is a ring below it; the default mesh for materials. `rings` ≥ 6 and even, as
/// for the sphere.
Mesh ball(int rings = 96);
/// A tube of radius 0.32 around the trefoil knot (sin t + 2 sin 2t, cos t − 2 cos 2t, −sin 3t)/2, t in [0, 2π]. It
/// occludes itself and has normals in all directions. `around` × `along` vertices, each ≥ 3. A map is wrapped
/// around it once, with u along it.
Mesh knot(int along = 480, int around = 64);

}  // namespace
