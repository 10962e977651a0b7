// Pictures by path tracing: level 6.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "render/environment.h"
#include "render/image.h"
#include "render/scene.h"
#include "srbf/prepared.h"

namespace srbf {

/// A parallelogram corner + s·x + t·y, s and t in [0, 1], that shines to the side of x × y. It casts no shadow.
struct AreaLight {
    Vec3f corner, x, y;
    Rgb radiance;
};

/// A mesh made of a material, each by its number.
struct Body {
    const Mesh* mesh;
    std::size_t material;
};

struct PathScene {
    std::vector<Body> bodies;
    std::vector<PreparedBrdf> materials;
    Camera camera;  ///< whose `up` is the environment's +y too
    std::vector<DirectionalLight> lights;
    std::vector<AreaLight> area_lights;
    const Environment* environment = nullptr;  ///< none: black
};

struct PathOptions {
    int width = 640, height = 480;
    int samples = 64;  ///< paths a pixel, ≥ 1
    int bounces = 8;   ///< of a path at most, ≥ 1; from the fourth on a path ends by chance (Russian roulette)
    std::uint64_t seed = 0;
    int threads = 0;  ///< 0: as many as the machine has; the picture does not depend on it
    /// Called now and then with the part that is done, 0..1, from one thread at a time.
    std::function<void(double)> progress;
};

/// What the paths of a pixel hit first, their means; 0 where they hit nothing.
struct FirstHits {
    Image normal;              ///< x, y, z in the camera's frame, towards the viewer
    Image albedo;              ///< directional albedo of the material, by one draw a path
    std::vector<float> depth;  ///< distance from the eye
};
struct PathPicture {
    Rendering rendering;  ///< an environment covers every pixel, a light what it is seen in
    FirstHits first;
    std::uint64_t rays = 0;  ///< that were traced
};

/// Traces paths from the eye: at each hit the light of the environment and of the area lights is sampled, and so is the BRDF, both weighted by
/// the power heuristic (Veach & Guibas 1995); directional lights are summed. Normals are interpolated; a surface shows the same material on both
/// of its sides.
PathPicture render_paths(const PathScene& scene, const PathOptions& options);

/// A square on the ground below a mesh, `size` times as wide as the mesh, its upper side towards `up`.
Mesh ground_below(const Mesh& mesh, Vec3d up, double size = 40);

}  // namespace srbf
