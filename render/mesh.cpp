#include "render/mesh.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "srbf/file.h"

namespace srbf {

Bounds bounds(const Mesh& mesh) {
    constexpr float most = std::numeric_limits<float>::max();
    Bounds box{{most, most, most}, {-most, -most, -most}};
    for (const Vec3f& p : mesh.positions) {
        box.least = {std::min(box.least.x, p.x), std::min(box.least.y, p.y), std::min(box.least.z, p.z)};
        box.most = {std::max(box.most.x, p.x), std::max(box.most.y, p.y), std::max(box.most.z, p.z)};
    }
    return box;
}

std::vector<Vec3f> area_weighted_normals(std::span<const Vec3f> positions, std::span<const Triangle> triangles) {
    std::vector<Vec3d> sum(positions.size());
    for (const Triangle& t : triangles) {
        const Vec3d a = to_double(positions[t[0]]), b = to_double(positions[t[1]]), c = to_double(positions[t[2]]);
        const Vec3d twice_area = cross(b - a, c - a);
        for (const std::uint32_t i : t) sum[i] = sum[i] + twice_area;
    }
    std::vector<Vec3f> normals;
    normals.reserve(sum.size());
    for (const Vec3d& n : sum) normals.push_back(dot(n, n) > 0 ? to_float(normalize(n)) : Vec3f{0, 0, 1});
    return normals;
}

namespace {

bool is_ply(std::span<const std::byte> bytes) {
    return bytes.size() >= 3 && bytes[0] == std::byte('p') && bytes[1] == std::byte('l') && bytes[2] == std::byte('y');
}

/// Whether a file that begins like this may be a mesh: `.obj` is text, which has no zero.
bool may_be_mesh(std::span<const std::byte> head) {
    const auto first = head.first(4096);
    return is_ply(head) || std::ranges::find(first, std::byte(0)) == first.end();
}

}  // namespace

Result<Mesh> read_mesh(std::span<const std::byte> bytes, const std::string& file_name) {
    return is_ply(bytes) ? read_ply(bytes, file_name) : read_obj(bytes, file_name);
}

Result<Mesh> load_mesh(const std::string& name) {
    if (name == k_built_in_meshes[0]) return sphere();
    if (name == k_built_in_meshes[1]) return knot();
    if (name == k_built_in_meshes[2]) return ball();
    return within_memory(name, [&]() -> Result<Mesh> {
        const auto bytes = read_file(name, all_if(may_be_mesh));
        if (!bytes) return bytes.error();
        return read_mesh(*bytes, name);
    });
}

namespace {

/// Quadrilaterals of a grid of rows × columns vertices. Column `columns` is column 0; row `rows` is row 0 if `closed`.
std::vector<Triangle> grid(std::uint32_t rows, std::uint32_t columns, bool closed) {
    std::vector<Triangle> triangles;
    for (std::uint32_t i = 0; i + (closed ? 0 : 1) < rows; ++i)
        for (std::uint32_t j = 0; j < columns; ++j) {
            const std::uint32_t below = (i + 1) % rows * columns, next = (j + 1) % columns;
            triangles.push_back({i * columns + j, below + j, below + next});
            triangles.push_back({i * columns + j, below + next, i * columns + next});
        }
    return triangles;
}

}  // namespace

Mesh sphere(int rings) {
    assert(rings >= 2);
    Mesh mesh;
    const int around = 2 * rings;
    for (int i = 0; i <= rings; ++i)
        for (int j = 0; j < around; ++j) {
            const Vec3d w = spherical(k_pi * i / rings, 2 * k_pi * j / around);
            mesh.positions.push_back(to_float(Vec3d{w.y, w.z, w.x}));  // poles along y
        }
    mesh.normals = mesh.positions;
    mesh.triangles = grid(std::uint32_t(rings + 1), std::uint32_t(around), false);
    std::erase_if(mesh.triangles, [&](const Triangle& t) {  // degenerate triangles at the poles
        const auto ring = [&](std::uint32_t i) { return i / std::uint32_t(around); };
        return ring(t[1]) == ring(t[2]) ? ring(t[1]) == std::uint32_t(rings)
                                        : ring(t[0]) == ring(t[2]) && ring(t[0]) == 0;
    });
    return mesh;
}

Mesh ball(int rings) {
    assert(rings >= 6 && rings % 2 == 0);
    Mesh mesh = sphere(rings);
    // The foot: a ring with circular cross-section about the y axis.
    const int along = 2 * rings, around = rings / 2;
    constexpr double ring = 0.66, section = 0.17, height = -0.9;
    const auto first = std::uint32_t(mesh.positions.size());
    for (int i = 0; i < along; ++i)
        for (int j = 0; j < around; ++j) {
            const double phi = 2 * k_pi * i / along, angle = 2 * k_pi * j / around;
            const Vec3d out{std::sin(phi), 0, std::cos(phi)},
                n = std::cos(angle) * out + std::sin(angle) * Vec3d{0, 1, 0};
            mesh.positions.push_back(to_float(ring * out + Vec3d{0, height, 0} + section * n));
            mesh.normals.push_back(to_float(n));
        }
    for (const Triangle& t : grid(std::uint32_t(along), std::uint32_t(around), true))
        mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    return mesh;
}

Mesh knot(int along, int around) {
    assert(along >= 3 && around >= 3);
    constexpr double radius = 0.32;
    Mesh mesh;
    for (int i = 0; i < along; ++i) {
        const double t = 2 * k_pi * i / along;
        const Vec3d centre =
            0.5 * Vec3d{std::sin(t) + 2 * std::sin(2 * t), std::cos(t) - 2 * std::cos(2 * t), -std::sin(3 * t)};
        const Vec3d velocity{std::cos(t) + 4 * std::cos(2 * t), -std::sin(t) + 4 * std::sin(2 * t),
                             -3 * std::cos(3 * t)};
        const Vec3d acceleration{-std::sin(t) - 8 * std::sin(2 * t), -std::cos(t) + 8 * std::cos(2 * t),
                                 9 * std::sin(3 * t)};
        // The curvature never vanishes, so that the Frenet frame closes up.
        const Vec3d side = normalize(cross(velocity, acceleration)), inward = normalize(cross(side, velocity));
        for (int j = 0; j < around; ++j) {
            const double angle = 2 * k_pi * j / around;
            const Vec3d n = std::cos(angle) * inward - std::sin(angle) * side;
            mesh.positions.push_back(to_float(centre + radius * n));
            mesh.normals.push_back(to_float(n));
        }
    }
    mesh.triangles = grid(std::uint32_t(along), std::uint32_t(around), true);
    return mesh;
}

}  // namespace srbf
