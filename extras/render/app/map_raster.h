// Maps of shared lobes in the OpenGL renderer.
#pragma once
#include <span>
#include <vector>

#include "extras/render/scene.h"
#include "extras/render/tone.h"
#include "srbf/library.h"

namespace srbf {

/// Renders the scene under its directional lights with each of the maps, whose levels are those of `map_ktx2`, linear
/// between texels and levels. Requires a mesh with texture coordinates. Errors: those of `check_layers` and
/// `rasterize`; a program built without this renderer.
Result<std::vector<Rendering>> rasterize_maps(const Scene& scene, std::span<const Library* const> maps, int width,
                                              int height, int samples);

}  // namespace srbf
