#include "extras/render/scene.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "extras/render/shading.h"

namespace SRBF_NAMESPACE {

Frame frame(const Camera& camera) { return frame_about(normalize(camera.eye - camera.target), camera.up); }

Frame environment_frame(const Camera& camera) {
    const Vec3d y = normalize(camera.up), side = normalize(cross(y, frame(camera).z));
    return {side, y, cross(side, y)};
}

Vec3d direction_through(const Camera& camera, double aspect, double s, double t) {
    const double half = std::tan(camera.fov / 2);
    return frame(camera).from(normalize(Vec3d{half * aspect * s, half * t, -1}));
}

Camera camera_of(const Mesh& mesh, const Viewpoint& viewpoint, double aspect) {
    assert(!mesh.positions.empty() && aspect > 0);
    const double c = std::cos(viewpoint.elevation);
    const Vec3d from{c * std::sin(viewpoint.azimuth), std::sin(viewpoint.elevation), c * std::cos(viewpoint.azimuth)};
    // The axes x, y, z of a mesh with y upwards correspond to x, z, −y of one with z upwards.
    const auto to_mesh_axes = [&](Vec3d w) { return viewpoint.z_up ? Vec3d{w.x, -w.z, w.y} : w; };

    const Bounds box = bounds(mesh);
    Camera camera;
    camera.target = 0.5 * (to_double(box.min) + to_double(box.max));
    camera.fov = viewpoint.fov;
    camera.up = to_mesh_axes(
        std::abs(c) > 1e-6 ? Vec3d{0, 1, 0}
                           : Vec3d{-from.y * std::sin(viewpoint.azimuth), 0, -from.y * std::cos(viewpoint.azimuth)});
    camera.eye = camera.target + to_mesh_axes(from);

    // A point (x, y, z) of the frame about the target is projected to x / (distance − z).
    const Frame axes = frame(camera);
    const double half = std::tan(camera.fov / 2) * (1 - k_margin);
    double distance = 0;
    for (const Vec3f& position : mesh.positions) {
        const Vec3d p = to_double(position) - camera.target;
        const double off = std::max(std::abs(dot(p, axes.x)) / aspect, std::abs(dot(p, axes.y)));
        distance = std::max(distance, dot(p, axes.z) + off / half);
    }
    camera.eye = camera.target + (distance > 0 ? distance : 1) * axes.z;
    return camera;
}

std::array<DirectionalLight, 3> lights_of(const Camera& camera) {
    const Frame axes = frame(camera);
    auto lights = k_three_lights;
    for (DirectionalLight& light : lights) light.towards = axes.from(light.towards);
    return lights;
}

DirectionalLight light_behind(const Camera& camera) {
    return {frame(camera).from(k_light_behind.towards), k_light_behind.irradiance};
}

Scene scene_of(Mesh mesh, const Viewpoint& viewpoint, double aspect) {
    const Camera camera = camera_of(mesh, viewpoint, aspect);
    const auto lights = lights_of(camera);
    return {std::move(mesh), camera, {lights.begin(), lights.end()}};
}

Frame surface_frame(Vec3d n) {
    const auto surface = Shading<double>::surface_frame_about(n);
    return {surface.tangent, surface.bitangent, surface.normal};
}

}  // namespace
