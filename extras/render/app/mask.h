// Masks that mix materials.
#pragma once
#include <string>

#include "errors/picture.h"
#include "srbf/result.h"

namespace srbf {

/// The numbers of a picture as they are stored: of .png and .jpg 0 to 1, without a conversion of colours; of .exr limited to
/// this range. Errors: another file, more than 8192 pixels a side.
Result<Image> load_mask(const std::string& path);

}  // namespace srbf
