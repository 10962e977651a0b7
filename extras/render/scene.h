// Scenes: a mesh, a camera and lights.
#pragma once
#include "brdf/directions.h"
#include "extras/render/mesh.h"
#include "srbf/vec.h"

namespace SRBF_NAMESPACE {

/// A camera. In its frame x points right, y up and z to the viewer, away from `target`.
struct Camera {
    Vec3d eye{0, 0, 1}, target{0, 0, 0};
    Vec3d up{0, 1, 0};           ///< upwards in the picture; not parallel to the view direction
    double fov = 30 * k_degree;  ///< vertical field of view [rad], in (0, π)
};

Frame frame(const Camera& camera);
/// The axes of an environment for this camera: its +y is `up`, and the picture shows its -z side.
Frame environment_frame(const Camera& camera);
/// The unit vector from the eye through the point (s, t) of the picture: s from −1 (left) to 1 (right), t from −1
/// (bottom) to 1 (top); aspect = width / height.
Vec3d direction_through(const Camera& camera, double aspect, double s, double t);

/// Parameters of an automatic camera.
struct Viewpoint {
    double azimuth = 0;                ///< [rad] about `up`, from +z (up along y) or −y (up along z) eastwards
    double elevation = 15 * k_degree;  ///< [rad] above the horizon, within ±π/2
    double fov = 30 * k_degree;        ///< [rad]
    bool z_up = false;                 ///< the mesh's z axis is up, otherwise its y axis
};
/// A camera that looks at the centre of the mesh's bounds. It is as close as possible with the whole mesh within the
/// picture and a margin of `k_margin` of the picture's size.
Camera camera_of(const Mesh& mesh, const Viewpoint& viewpoint, double aspect);
inline constexpr double k_margin = 0.04;

struct DirectionalLight {
    Vec3d towards;   ///< unit vector to the light
    Rgb irradiance;  ///< E on a surface that faces the light
};

/// The default lights of all pictures, white, in the camera's frame: a key light from the upper left, 50° off the view
/// direction; one from behind on the right, 115° off it, for grazing angles; a weak fill light from below.
inline constexpr std::array<DirectionalLight, 3> k_three_lights{{
    {{-6.0 / 11, 6.0 / 11, 7.0 / 11}, {3, 3, 3}},
    {{6.0 / 7, 2.0 / 7, -3.0 / 7}, {2, 2, 2}},
    {{1.0 / 3, -2.0 / 3, 2.0 / 3}, {0.5f, 0.5f, 0.5f}},
}};
/// `k_three_lights`, transformed from the camera's frame to the world.
std::array<DirectionalLight, 3> lights_of(const Camera& camera);
/// A light behind the scene in the camera's frame, from the upper left, 132° off the view direction: surfaces that face
/// the camera show only transmitted light.
inline constexpr DirectionalLight k_light_behind{{-1.0 / 3, 2.0 / 3, -2.0 / 3}, {3, 3, 3}};
/// `k_light_behind`, transformed from the camera's frame to the world.
DirectionalLight light_behind(const Camera& camera);

/// A scene without its material.
struct Scene {
    Mesh mesh;
    Camera camera;
    std::vector<DirectionalLight> lights;
};
/// The mesh from that viewpoint under `k_three_lights`.
Scene scene_of(Mesh mesh, const Viewpoint& viewpoint, double aspect);

/// The local frame of a surface with normal n: t = (n_z, 0, −n_x)/√(n_x² + n_z²) along the circle of latitude about y,
/// b = n × t, n. At the poles t = (1, 0, 0).
Frame surface_frame(Vec3d n);

}  // namespace
