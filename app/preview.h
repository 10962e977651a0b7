// The preview of a fit: three spheres, measured, fitted and their difference.
#pragma once
#include "app/image.h"
#include "srbf/brdf.h"

namespace srbf {

struct PreviewOptions {
    int size = 256;   ///< pixels per side of each sphere's square, at least 16
    int threads = 0;  ///< 0: all of the machine; the picture does not depend on the number
    std::string caption = "fit";
};

/// Three squares side by side, each with a caption in a strip of max(12, size/8) rows below it: `sphere_pictures`
/// of `measured` and of `fit` under the standard lighting `studio`, and 10 |L − L̂| of their radiances per channel.
/// As in `picture_errors`, all have the exposure of the first and are clipped at white. The background is
/// `k_background`.
Image8 preview(const Evaluate& measured, const Evaluate& fit, const PreviewOptions& options = {});

}  // namespace srbf
