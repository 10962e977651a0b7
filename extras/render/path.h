// Path tracing.
#pragma once
#include <functional>
#include <variant>

#include "errors/picture.h"
#include "extras/render/environment.h"
#include "extras/render/scene.h"
#include "extras/render/tone.h"
#include "srbf/prepared_bsdf.h"
#include "srbf/prepared_map.h"

namespace SRBF_NAMESPACE {

/// A parallelogram corner + s·x + t·y, s and t in [0, 1], that emits to the side of x × y. It casts no shadow.
struct AreaLight {
    Vec3f corner, x, y;
    Rgb radiance;
};

/// The fractions of the first, second and third of `materials`, two or three, at (u, v) of a mask. Red is the fraction
/// of the second material, green the fraction of the third, clamped to 1 − red, and the first has the rest. The mask
/// repeats, and is interpolated as a map is (prepared_map.h).
Rgb mask_fractions(const Image& mask, std::size_t materials, Vec2f uv);

/// Two or three materials, mixed by `mask_fractions` at each point of a mesh with texture coordinates.
struct MaskedMaterials {
    std::vector<PreparedBsdf> materials;
    Image mask;

    /// The material that a path meets at (u, v), for a number uniform in [0, 1): each with its fraction as probability.
    const PreparedBsdf& chosen(Vec2f uv, float selector) const;
};

/// The material of a body. A BRDF is the same at the front and the back, and transmits nothing. A map has one BRDF
/// at each point of a mesh with texture coordinates.
using PathMaterial = std::variant<PreparedBsdf, PreparedMap, MaskedMaterials>;

/// An object: the indices of a mesh and a material.
struct Body {
    const Mesh* mesh;
    std::size_t material;
};

struct PathScene {
    std::vector<Body> bodies;
    std::vector<PathMaterial> materials;
    Camera camera;  ///< its `up` is also the environment's +y
    std::vector<DirectionalLight> lights;
    std::vector<AreaLight> area_lights;
    const Environment* environment = nullptr;  ///< null: black
};

struct PathOptions {
    int width = 640, height = 480;
    int samples = 64;  ///< paths per pixel, ≥ 1
    int bounces = 8;   ///< maximum number of bounces of a path, ≥ 1; Russian roulette from the fourth on
    /// True if surfaces block light. If false, all light reaches every point, in one bounce, as in `rasterize`.
    bool occlusion = true;
    std::uint64_t seed = 0;
    int threads = 0;  ///< number of threads; 0: all of the machine. The result does not depend on it
    /// Called regularly with the completed fraction, 0..1, by one thread at a time.
    std::function<void(double)> progress;
};

/// Means over the paths of a pixel of properties of the first hit; 0 where nothing is hit.
struct FirstHits {
    Image normal;              ///< x, y, z in the camera's frame, towards the viewer
    Image albedo;              ///< directional albedo of the material, estimated with one sample per path
    std::vector<float> depth;  ///< distance from the eye
};
struct PathPicture {
    Rendering rendering;  ///< an environment covers every pixel, a light only the pixels in which it is visible
    FirstHits first;
    std::uint64_t rays = 0;  ///< number of rays traced
};

/// Traces paths from the eye. At each hit the environment, the area lights and the BRDF are sampled and combined
/// with the power heuristic (Veach & Guibas 1995); directional lights are summed. Normals are interpolated, and
/// made visible (`visible_normal` of shading.glsl). The front of a BSDF is the side from which triangles are
/// counter-clockwise. Light that its beams transmit is followed along its direction, so that they show the
/// environment and area lights, but not directional lights.
PathPicture render_paths(const PathScene& scene, const PathOptions& options);

/// A square on the ground below a mesh, `size` times as wide as the mesh, with its upper side towards `up`.
Mesh ground_below(const Mesh& mesh, Vec3d up, double size = 40);

}  // namespace
