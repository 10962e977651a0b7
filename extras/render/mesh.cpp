#include "extras/render/mesh.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "base/files.h"
#include "srbf/file.h"

namespace SRBF_NAMESPACE {

Bounds bounds(const Mesh& mesh) {
    constexpr float max = std::numeric_limits<float>::max();
    Bounds box{{max, max, max}, {-max, -max, -max}};
    for (const Vec3f& p : mesh.positions) {
        box.min = {std::min(box.min.x, p.x), std::min(box.min.y, p.y), std::min(box.min.z, p.z)};
        box.max = {std::max(box.max.x, p.x), std::max(box.max.y, p.y), std::max(box.max.z, p.z)};
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

/// True if a file with this beginning may be a mesh: `.obj` is text, which has no zero byte.
bool may_be_mesh(std::span<const std::byte> head) {
    const auto first = head.first(4096);
    return is_ply(head) || std::ranges::find(first, std::byte(0)) == first.end();
}

/// Adds the quadrilaterals of a grid of rows × columns vertices that begins with vertex `first`. `place` returns
/// the texture coordinates of a row and column. Column `columns` is column 0; row `rows` is row 0 if `closed`.
template <typename Place>
void add_grid(std::uint32_t first, std::uint32_t rows, std::uint32_t columns, bool closed, const Place& place,
              Mesh& mesh) {
    using RowAndColumn = std::array<std::uint32_t, 2>;
    for (std::uint32_t i = 0; i + (closed ? 0 : 1) < rows; ++i)
        for (std::uint32_t j = 0; j < columns; ++j) {
            const RowAndColumn here{i, j}, below{i + 1, j}, across{i + 1, j + 1}, next{i, j + 1};
            for (const auto& corners : {std::array{here, below, across}, {here, across, next}}) {
                auto& triangle = mesh.triangles.emplace_back();
                auto& texture = mesh.texture.emplace_back();
                for (std::size_t k = 0; k < 3; ++k) {
                    const auto [row, column] = corners[k];
                    triangle[k] = first + row % rows * columns + column % columns;
                    texture[k] = place(float(row) / float(closed ? rows : rows - 1), float(column) / float(columns));
                }
            }
        }
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
    Mesh grid;
    add_grid(
        0, std::uint32_t(rings + 1), std::uint32_t(around), false,
        [](float down, float turn) {
            return Vec2f{turn + 0.5f, down};
        },
        grid);
    const auto ring = [&](std::uint32_t i) { return i / std::uint32_t(around); };
    for (std::size_t i = 0; i < grid.triangles.size(); ++i) {
        const Triangle& t = grid.triangles[i];
        const bool is_degenerate =
            ring(t[1]) == ring(t[2]) ? ring(t[1]) == std::uint32_t(rings) : ring(t[0]) == ring(t[2]) && ring(t[0]) == 0;
        if (is_degenerate) continue;  // triangles at the poles
        mesh.triangles.push_back(t);
        mesh.texture.push_back(grid.texture[i]);
    }
    return mesh;
}

Mesh ball(int rings) {
    assert(rings >= 6 && rings % 2 == 0);
    Mesh mesh = sphere(rings);
    // The foot: a ring with circular cross-section around the y axis.
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
    add_grid(
        first, std::uint32_t(along), std::uint32_t(around), true,
        [](float turn, float up) {
            return Vec2f{turn + 0.5f, 1 - up};
        },
        mesh);
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
    add_grid(
        0, std::uint32_t(along), std::uint32_t(around), true,
        [](float along_tube, float across) {
            return Vec2f{along_tube, across};
        },
        mesh);
    return mesh;
}

}  // namespace
