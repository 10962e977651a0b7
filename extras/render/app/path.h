// The path tracer with its command-line options.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "app/commands.h"
#include "app/load.h"
#include "extras/render/path.h"

namespace srbf {

/// The subject of a picture: a measurement or a model, or a map of texels.
using Pictured = std::variant<const Subject*, const Library*>;

struct PathCommand {
    /// Not given: the renderer's default; three lights if `environment` is none.
    std::string environment, lights, draw = "brdf", scene_name = "object";
    int samples = 0;  ///< 0: not given
    int bounces = 8, threads = 0;
    std::uint64_t seed = 0;
    bool no_ground = false, no_occlusion = false;

    /// Returns what is read of them, and of `about_mesh`; `is_path()`: by the path tracer, otherwise by raster.
    std::vector<Reading> add_options(const Subcommand& sub, const std::vector<Option>& about_mesh,
                                     std::function<bool()> is_path);
    /// Renders the scene with each of the subjects under the lights of `lights`. `progress` receives the completed
    /// share of the whole. Errors: a map for a mesh without places in it.
    Result<std::vector<PathPicture>> render(const Scene& scene, std::span<const Pictured> subjects, int width,
                                            int height, const std::function<void(double)>& progress = {}) const;
};

/// Samples per pixel under an environment, where none are asked for.
inline constexpr int k_samples = 64;
/// The environment of that name or file; none for "none". Says on standard error what of it counts as 0.
Result<std::optional<Environment>> load_light(const std::string& name);

/// The subject, importance-sampled by a proposal prepared for it.
PreparedBsdf prepared(const Subject& subject, int threads);
PreparedMap prepared(const Library& map, int threads);

}  // namespace srbf
