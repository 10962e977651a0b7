// The renderer of paths, as the command line has it.
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
        draw = "brdf";  ///< no lights named: three where `environment` is none
    int samples = 64, bounces = 8, threads = 0;
    std::uint64_t seed = 0;
    bool no_ground = false;

    void add_options(const Subcommand& sub);
    /// The scene in each of the subjects; its lights are those that `lights` names. `progress` is told the part of all that is done.
    Result<std::vector<PathPicture>> render(const Scene& scene, std::span<const Subject> subjects, int width,
                                            int height, const std::function<void(double)>& progress = {}) const;
};

/// The subject, importance-sampled by a proposal made for it.
PreparedBrdf prepared(const Subject& subject, int threads);

}  // namespace srbf
