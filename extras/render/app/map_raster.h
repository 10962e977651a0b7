// Maps of shared lobes in the OpenGL renderer.
#pragma once
#include <span>
#include <vector>

#include "extras/render/app/raster.h"
#include "extras/render/scene.h"
#include "extras/render/tone.h"
#include "srbf/map.h"

namespace SRBF_NAMESPACE {

/// Renders the scene with each of the maps, linear between texels. Under directional lights alone the levels are those of
/// `map_ktx2`; under an environment the samples of a pixel are all over it. Requires a mesh with texture coordinates.
/// Errors: those of `check_layers` and `rasterize`; a program built without this renderer.
Result<std::vector<Rendering>> rasterize_maps(const Scene& scene, std::span<const TexelMap* const> maps, int width,
                                              int height, const RasterLight& light);

}  // namespace srbf
