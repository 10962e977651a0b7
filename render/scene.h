// What is drawn: a mesh, from where it is seen, and the light on it: level 5.
#pragma once
#include <array>
#include <vector>

#include "render/mesh.h"
#include "srbf/vec.h"

namespace srbf {

/// Where the picture is taken from. Its frame: x right, y up, z to the viewer, that is away from `target`.
struct Camera {
    Vec3d eye{0, 0, 1}, target{0, 0, 0};
    Vec3d up{0, 1, 0};           ///< what shall point upwards in the picture; not along the view
    double fov = 30 * k_degree;  ///< from the picture's lower border to its upper one [rad], in (0, π)
};

/// Three axes of unit length.
struct Frame {
    Vec3d x, y, z;
    /// The vector whose coordinates in the frame are those of w.
    Vec3d from(Vec3d w) const { return w.x * x + w.y * y + w.z * z; }
    /// The coordinates of w in the frame.
    Vec3d to(Vec3d w) const { return {dot(w, x), dot(w, y), dot(w, z)}; }
};
Frame frame(const Camera& camera);
/// The unit vector from the eye through the point (s, t) of the picture: s from −1 at its left border to 1 at its right one, t from −1 at
/// its lower border to 1 at its upper one; aspect = width / height.
Vec3d direction_through(const Camera& camera, double aspect, double s, double t);

/// How an object is looked at.
struct Viewpoint {
    double azimuth = 0;                ///< [rad] about `up`, from +z (up along y) or −y (up along z) eastwards
    double elevation = 15 * k_degree;  ///< [rad] above the horizon, within ±π/2
    double fov = 30 * k_degree;        ///< [rad]
    bool z_up = false;                 ///< the mesh's z axis points upwards, else its y axis
};
/// A camera towards the middle of the mesh's bounds, as near as the whole mesh still lies within the picture and a margin of
/// `k_margin` of its size.
Camera camera_of(const Mesh& mesh, const Viewpoint& viewpoint, double aspect);
inline constexpr double k_margin = 0.04;

/// Light from one direction, without fall-off.
struct DirectionalLight {
    Vec3d towards;   ///< unit vector to the light
    Rgb irradiance;  ///< E on a surface that faces the light
};

/// The lights of every picture unless others are named, white, in the camera's frame: a key from the upper left, 50° off the view;
/// one from behind on the right, 115° off it, that shows grazing angles; a weak fill from below.
inline constexpr std::array<DirectionalLight, 3> k_three_lights{{
    {{-6.0 / 11, 6.0 / 11, 7.0 / 11}, {3, 3, 3}},
    {{6.0 / 7, 2.0 / 7, -3.0 / 7}, {2, 2, 2}},
    {{1.0 / 3, -2.0 / 3, 2.0 / 3}, {0.5f, 0.5f, 0.5f}},
}};
/// `k_three_lights` where the camera has them.
std::array<DirectionalLight, 3> lights_of(const Camera& camera);

/// What a renderer draws; of what material is said apart.
struct Scene {
    Mesh mesh;
    Camera camera;
    std::vector<DirectionalLight> lights;
};
/// The mesh from that viewpoint, by `k_three_lights`.
Scene scene_of(Mesh mesh, const Viewpoint& viewpoint, double aspect);

/// The surface's frame about its normal n, for directions in its local frame: t = (n_z, 0, −n_x)/√(n_x² + n_z²) along the circle of
/// latitude about y, b = n × t, n. At the poles t = (1, 0, 0).
Frame surface_frame(Vec3d n);

}  // namespace srbf
