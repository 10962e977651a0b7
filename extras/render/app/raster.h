// The OpenGL renderer with its command-line options.
#pragma once
#include <functional>
#include <span>
#include <vector>

#include "app/load.h"
#include "extras/render/environment.h"
#include "extras/render/material.h"
#include "extras/render/pixel_shader.h"
#include "extras/render/scene.h"
#include "extras/render/tone.h"
#include "srbf/sampling.h"

namespace SRBF_NAMESPACE {

/// The material of a subject in OpenGL. Errors: an anisotropic measurement.
Result<Material> material_of(const Subject& subject);

/// The density from which the subject's light is sampled in OpenGL. `threads`: 0 is as many as the machine has.
Proposals proposal_of(const Subject& subject, int threads = 0);

/// The light of a rasterized picture.
struct RasterLight {
    const Environment* environment = nullptr;  ///< null: the scene's lights alone
    int samples = 4;                           ///< per pixel
    std::function<void(double)> progress;      ///< with an environment: receives the completed fraction
};
/// Renders the scene with each of the subjects. Errors: those of `material_of` and `rasterize`; a program built without
/// this renderer.
Result<std::vector<Rendering>> rasterize(const Scene& scene, std::span<const Subject* const> subjects, int width,
                                         int height, const RasterLight& light);

}  // namespace srbf
