#include "extras/render/app/path.h"

#include "app/output.h"
#include "base/printable.h"
#include "brdf/directions.h"

namespace SRBF_NAMESPACE {
namespace {

constexpr Rgb k_ground{0.35f, 0.35f, 0.35f};  // reflectance
constexpr Rgb k_walls{0.7f, 0.7f, 0.68f}, k_floor{0.3f, 0.24f, 0.18f}, k_ball{0.5f, 0.15f, 0.1f};

/// A square light above the scene, to the left and in front of it, as large as the scene.
AreaLight softbox(const Scene& scene) {
    const Bounds box = bounds(scene.mesh);
    const Vec3d min = to_double(box.min), max = to_double(box.max), across = max - min;
    const double size = std::max({across.x, across.y, across.z});
    const Frame axes = frame(scene.camera);
    const Vec3d z = normalize(axes.from({0.5, -0.7, -0.5}));  // direction of emission
    const Vec3d x = normalize(cross(axes.y, z)), y = cross(z, x);
    const Vec3d corner = 0.5 * (min + max) - (1.6 * size) * z - (0.4 * size) * (x + y);
    return {to_float(corner), to_float(0.8 * size * x), to_float(0.8 * size * y), {12, 12, 12}};
}

PreparedBsdf prepare_by_cosine(const LoadedFile& subject) {
    return std::visit([](const auto& content) { return prepare(content, CosineProposal{}); }, subject.content);
}

/// Returns an error if a map or a mask cannot be drawn with these options.
Result<Done> check_pictured(const Pictured& pictured, const Mesh& mesh, const PathCommand& command) {
    if (std::holds_alternative<const LoadedFile*>(pictured)) return Done{};
    const char* const kind = std::holds_alternative<const TexelMap*>(pictured) ? "a map" : "a mask";
    const auto refuse = [&](const char* what, const char* expected, const char* found) {
        return Error{"render", {}, fmt::format("{} of {}", what, kind), expected, found, ErrorCode::argument};
    };
    if (command.scene_name != "object") return refuse("scene", "object", "room");
    if (command.draw == "cosine") return refuse("draws", "by the brdf", "by the cosine");
    if (mesh.texture.empty()) return refuse("mesh", "one with texture coordinates", "none of a corner at least");
    return Done{};
}

/// A room whose only light comes through a shade that fills the opening of one wall. Lengths are in metres, y is
/// up. The wall with the opening is at z = 0, the room at z < 0.
struct Room {
    Mesh shade;     ///< a rectangle, its front outwards, to +z
    Mesh walls;     ///< walls with an opening, floor and ceiling, visible from inside
    Mesh floor;     ///< above the floor of the walls
    Mesh ball;      ///< a ball that lies on the floor
    Camera camera;  ///< a camera in the room that looks at the shade
};
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
constexpr float k_left = -1.4f, k_right = 1.4f, k_sill = 0.7f, k_top = 2.3f;  // sides of the opening [m]
constexpr float k_radius = 0.4f;

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
    front(-x, 0, x, k_sill);
    front(-x, k_top, x, k_height);
    front(-x, k_sill, k_left, k_top);
    front(k_right, k_sill, x, k_top);
    add_rectangle(room.floor, {-x, 1e-3f, -k_depth}, {0, 0, k_depth}, {k_width, 0, 0});
    room.ball = sphere(48);
    for (Vec3f& p : room.ball.positions) p = k_radius * p + Vec3f{0.7f, k_radius, -1.3f};
    room.camera = {{-1.3, 1.5, -4.6}, {0.25, 1.1, 0}, {0, 1, 0}, 52 * k_degree};
    return room;
}

}  // namespace

Result<std::optional<Environment>> load_light(const std::string& name) {
    if (name == "none") return std::optional<Environment>();
    auto loaded = load_environment(name);
    if (!loaded) return loaded.error();
    if (loaded->clamped() > 0)
        fmt::print(stderr, "srbf: {}: {} texels with channels below 0 or not finite, which count as 0\n",
                   printable(name), grouped(loaded->clamped()));
    return std::optional(*std::move(loaded));
}

PreparedBsdf prepare_subject(const LoadedFile& subject, int threads) {
    const ProposeOptions options{.azimuths = azimuths_for(is_isotropic(subject)), .threads = threads};
    return std::visit([&](const auto& content) { return prepare_bsdf(content, options); }, subject.content);
}

PreparedMap prepare_subject(const TexelMap& map, int threads) {
    return prepare_map(map, {.azimuths = map.basis.axial ? 1 : k_anisotropic_azimuths, .threads = threads});
}

std::vector<AllowedWhen> PathCommand::add_options(const Subcommand& sub, const std::vector<Option>& about_mesh,
                                                  std::function<bool()> is_path) {
    const Option environment_option =
        sub.add_option("--env", environment, "path: environment map, a .hdr or .exr file, or studio (default) or none")
            .type_name("FILE");
    const Option further_lights =
        sub.add_option("--lights", lights,
                       "Further lights: three (directional; default without environment), behind (one behind the "
                       "object,\nfor what light passes through), or of path softbox (a square) or none")
            .type_name("NAME")
            .one_of({"none", "three", "behind", "softbox"});
    const Option paths =
        sub.add_option("--spp", samples, fmt::format("path: paths per pixel, 1 to 1048576 ({})", k_samples))
            .type_name("S")
            .check(within(1, 1 << 20));
    const Option max_bounces = sub.add_option("--bounces", bounces, "path: maximum number of bounces, 1 to 1000")
                                   .type_name("N")
                                   .check(within(1, 1000))
                                   .capture_default_str();
    const Option draw_option =
        sub.add_option("--draw", draw, "path: sample directions by the brdf or, for comparison, by the cosine")
            .type_name("BY")
            .one_of({"brdf", "cosine"})
            .capture_default_str();
    const Option scene =
        sub.add_option("--scene", scene_name,
                       "path: object: the mesh; room: a room lit through a shade of the material, which is as large as "
                       "its window")
            .type_name("NAME")
            .one_of({"object", "room"})
            .capture_default_str();
    const Option without_ground = sub.add_flag("--no-ground", no_ground, "path: omit the ground below the mesh");
    const Option without_occlusion =
        sub.add_flag("--no-occlusion", no_occlusion,
                     "path: let all light reach every point, in one bounce, as the renderer raster does");
    const Option seed_option =
        sub.add_option("--seed", seed, "path: seed of the random numbers").type_name("N").capture_default_str();
    const Option threads_option =
        sub.add_option("--threads", threads,
                       "path: number of threads; 0: all of the machine. The picture does not depend on it")
            .type_name("T")
            .check(within(0, k_max_threads))
            .capture_default_str();
    std::vector<Option> object_options = about_mesh;
    object_options.push_back(without_ground);
    return {
        {{environment_option, paths, max_bounces, draw_option, scene, without_ground, without_occlusion, seed_option,
          threads_option},
         "only with --renderer path",
         is_path},
        {{further_lights},
         "softbox and none only with --renderer path",
         [=, this] { return is_path() || lights == "three" || lights == "behind"; }},
        {{max_bounces}, "not with --no-occlusion, in one bounce", [this] { return !no_occlusion; }},
        {object_options, "only with --scene object", [this] { return scene_name == "object"; }},
    };
}

Result<std::vector<PathPicture>> PathCommand::render(const Scene& scene, std::span<const Pictured> subjects, int width,
                                                     int height, const std::function<void(double)>& progress) const {
    for (const Pictured& pictured : subjects)
        if (const auto valid = check_pictured(pictured, scene.mesh, *this); !valid) return valid.error();
    const auto loaded = load_light(environment.empty() ? std::string(k_built_in_environment) : environment);
    if (!loaded) return loaded.error();
    const std::optional<Environment>& light = *loaded;
    const Mesh floor = ground_below(scene.mesh, scene.camera.up);
    PathScene paths{{{&scene.mesh, 0}}, {}, scene.camera, {}, {}, light ? &*light : nullptr};
    if (!no_ground) paths.bodies.push_back({&floor, 1});
    if (lights == "three" || (lights.empty() && !light)) paths.lights = scene.lights;
    if (lights == "behind") paths.lights = {light_behind(scene.camera)};
    if (lights == "softbox") paths.area_lights = {softbox(scene)};
    const Room behind_shade = room();
    std::vector<PreparedBsdf> others{diffuse(k_ground)};
    if (scene_name == "room") {
        paths.bodies = {
            {&behind_shade.shade, 0}, {&behind_shade.walls, 1}, {&behind_shade.floor, 2}, {&behind_shade.ball, 3}};
        others = {diffuse(k_walls), diffuse(k_floor), diffuse(k_ball)};
        paths.camera = behind_shade.camera;
    }

    std::vector<PathPicture> pictures;
    for (const Pictured& pictured : subjects) {
        if (const auto* subject = std::get_if<const LoadedFile*>(&pictured)) {
            paths.materials = {draw == "cosine" ? prepare_by_cosine(**subject) : prepare_subject(**subject, threads)};
        } else if (const auto* masked = std::get_if<const MaskedSubjects*>(&pictured)) {
            MaskedMaterials mixed{{}, (*masked)->mask};
            for (const LoadedFile* each : (*masked)->subjects)
                mixed.materials.push_back(prepare_subject(*each, threads));
            paths.materials = {std::move(mixed)};
        } else {
            paths.materials = {prepare_subject(*std::get<const TexelMap*>(pictured), threads)};
        }
        paths.materials.insert(paths.materials.end(), others.begin(), others.end());
        const auto done = double(pictures.size()), total = double(subjects.size());
        const auto report_total = [&](double part) {
            if (progress) progress((done + part) / total);
        };
        pictures.push_back(render_paths(paths, {.width = width,
                                                .height = height,
                                                .samples = samples > 0 ? samples : k_samples,
                                                .bounces = bounces,
                                                .occlusion = !no_occlusion,
                                                .seed = seed,
                                                .threads = threads,
                                                .progress = report_total}));
    }
    return pictures;
}

}  // namespace
