// Masks that mix materials.
#pragma once
#include "extras/render/tone.h"
#include "srbf/result.h"

namespace SRBF_NAMESPACE {

/// The numbers of a picture as the file stores them, without a conversion of colours: 0 to 1 in .png and .jpg, and
/// clamped to this range in .exr. Returns an error for any other file, and for more than 8192 pixels on a side.
Result<Image> load_mask(const std::string& path);

}  // namespace
