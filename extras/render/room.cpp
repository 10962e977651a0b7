#include "extras/render/room.h"

namespace SRBF_NAMESPACE {
namespace {

/// A rectangle with the corners `corner`, + s, + s + t and + t; its front faces s × t.
void add_rectangle(Mesh& mesh, Vec3f corner, Vec3f s, Vec3f t) {
    const auto first = std::uint32_t(mesh.positions.size());
    const Vec3f n = normalize(cross(s, t));
    for (const Vec3f p : {corner, corner + s, corner + s + t, corner + t})
        mesh.positions.push_back(p), mesh.normals.push_back(n);
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
}

constexpr float k_width = 4, k_height = 2.6f, k_depth = 5;
constexpr float k_left = -1.4f, k_right = 1.4f, k_sill = 0.7f, k_top = 2.3f;  // of the opening
constexpr float k_radius = 0.4f;

}  // namespace

Room room() {
    Room room;
    const float x = k_width / 2;
    add_rectangle(room.shade, {k_left, k_sill, 0}, {k_right - k_left, 0, 0}, {0, k_top - k_sill, 0});
    Mesh& walls = room.walls;
    add_rectangle(walls, {-x, 0, -k_depth}, {0, 0, k_depth}, {k_width, 0, 0});         // floor
    add_rectangle(walls, {-x, k_height, -k_depth}, {k_width, 0, 0}, {0, 0, k_depth});  // ceiling
    add_rectangle(walls, {-x, 0, -k_depth}, {0, k_height, 0}, {0, 0, k_depth});        // left
    add_rectangle(walls, {x, 0, -k_depth}, {0, 0, k_depth}, {0, k_height, 0});         // right
    add_rectangle(walls, {-x, 0, -k_depth}, {k_width, 0, 0}, {0, k_height, 0});        // far from the shade
    const auto front = [&](float left, float bottom, float right, float top) {
        add_rectangle(walls, {left, bottom, 0}, {0, top - bottom, 0}, {right - left, 0, 0});
    };
    front(-x, 0, x, k_sill), front(-x, k_top, x, k_height);
    front(-x, k_sill, k_left, k_top), front(k_right, k_sill, x, k_top);
    add_rectangle(room.floor, {-x, 1e-3f, -k_depth}, {0, 0, k_depth}, {k_width, 0, 0});
    room.ball = sphere(48);
    for (Vec3f& p : room.ball.positions) p = k_radius * p + Vec3f{0.7f, k_radius, -1.3f};
    room.camera = {{-1.3, 1.5, -4.6}, {0.25, 1.1, 0}, {0, 1, 0}, 52 * k_degree};
    return room;
}

}  // namespace srbf
