// The renderer that draws with OpenGL, as the command line has it.
#pragma once
#include <span>
#include <vector>

#include "app/load.h"
#include "render/image.h"
#include "render/scene.h"

namespace srbf {

/// The scene in each of the subjects, four samples a pixel. Errors: an anisotropic measurement; those of `rasterize`; a program built
/// without this renderer.
Result<std::vector<Rendering>> rasterize(const Scene& scene, std::span<const Subject> subjects, int width, int height);

}  // namespace srbf
