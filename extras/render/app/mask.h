// Masks that mix materials.
#pragma once
#include "extras/render/tone.h"
#include "srbf/result.h"

namespace SRBF_NAMESPACE {

/// The numbers of a picture as they are stored: of .png and .jpg 0 to 1, without a conversion of colours; of .exr limited to
/// this range. Errors: another file, more than 8192 pixels a side.
Result<Image> load_mask(const std::string& path);

}  // namespace srbf
