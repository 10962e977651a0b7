// The path tracer with its command-line options.
#pragma once
#include <span>

#include "app/commands.h"
#include "app/load.h"
#include "extras/render/path.h"

namespace SRBF_NAMESPACE {

/// Materials that a mask mixes, see `MaskedMaterials`.
struct MaskedSubjects {
    std::vector<const LoadedFile*> subjects;
    Image mask;
};
/// The subject of a picture: a measurement or model, a map of texels, or a mask's materials.
using Pictured = std::variant<const LoadedFile*, const TexelMap*, const MaskedSubjects*>;

struct PathCommand {
    /// Texts of options, empty if not given. The default environment is the renderer's; by default there are three
    /// lights if `environment` is none.
    std::string environment, lights, draw = "brdf", scene_name = "object";
    int samples = 0;  ///< 0: not given
    int bounces = 8, threads = 0;
    std::uint64_t seed = 0;
    bool no_ground = false, no_occlusion = false;

    /// Returns the conditions under which these options and `about_mesh` are read. `is_path()`: true for the path
    /// tracer, false for raster.
    std::vector<AllowedWhen> add_options(const Subcommand& sub, const std::vector<Option>& about_mesh,
                                         std::function<bool()> is_path);
    /// Renders the scene with each of the subjects under the lights of `lights`. `progress` receives the completed
    /// fraction of all pictures. Returns an error if a map or a mask is on a mesh without texture coordinates.
    Result<std::vector<PathPicture>> render(const Scene& scene, std::span<const Pictured> subjects, int width,
                                            int height, const std::function<void(double)>& progress = {}) const;
};

/// The default number of samples per pixel under an environment.
inline constexpr int k_samples = 64;
/// The environment with this name or in this file; no value for "none". Reports texels that count as 0 on standard
/// error.
Result<std::optional<Environment>> load_light(const std::string& name);

/// Prepares the subject, with importance sampling by its own proposal.
PreparedBsdf prepare_subject(const LoadedFile& subject, int threads);
PreparedMap prepare_subject(const TexelMap& map, int threads);

}  // namespace
