// The path tracer with its command-line options.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "app/commands.h"
#include "app/load.h"
#include "render/path.h"

namespace srbf {

struct PathCommand {
    std::string environment{k_built_in_environment}, lights,
        draw = "brdf", scene_name = "object";  ///< lights not given: three if `environment` is none
    int samples = 64, bounces = 8, threads = 0;
    std::uint64_t seed = 0;
    bool no_ground = false;

    void add_options(const Subcommand& sub);
    /// Renders the scene with each of the subjects under the lights of `lights`. `progress` receives the completed
    /// share of the whole.
    Result<std::vector<PathPicture>> render(const Scene& scene, std::span<const Subject> subjects, int width,
                                            int height, const std::function<void(double)>& progress = {}) const;
};

/// The subject, importance-sampled by a proposal prepared for it.
PreparedBsdf prepared(const Subject& subject, int threads);

}  // namespace srbf
