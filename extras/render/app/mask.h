// Masks that mix materials.
#pragma once
#include <span>
#include <string>

#include "extras/render/scene.h"
#include "extras/render/tone.h"
#include "srbf/result.h"

namespace SRBF_NAMESPACE {

/// The numbers of a picture as they are stored: of .png and .jpg 0 to 1, without a conversion of colours; of .exr limited to
/// this range. Errors: another file, more than 8192 pixels a side.
Result<Image> load_mask(const std::string& path);

/// One picture of pictures of the scene with each of a mask's materials: their mean, weighted by the mean shares (path.h)
/// over the points of each pixel. The mesh has texture coordinates.
Rendering mixed(const Scene& scene, const Image& mask, std::span<const Rendering> of);

}  // namespace srbf
