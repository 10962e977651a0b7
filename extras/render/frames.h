// Time per frame, as in Table 7.2 of Tsai 2009.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "extras/render/offscreen.h"
#include "extras/render/raster.h"

namespace SRBF_NAMESPACE {

/// Milliseconds per frame: by the graphics library's clock, by the wall clock, and as CPU time of all threads of
/// this process.
struct FrameTime {
    double gpu = 0, wall = 0, cpu = 0;
};

/// The cost of drawing with a material.
struct FrameCost {
    FrameTime least;  ///< minimum over all frames, separately for each clock
    /// size of the data that a pixel looks up, as in `RasterMaterial`
    std::size_t data_bytes = 0, auxiliary_bytes = 0;
};

struct FrameOptions {
    int width = 640, height = 480;
    PixelInput input = PixelInput::surface;  ///< two passes with one sample, or one pass with `samples` per pixel
    int samples = 4;
    /// per material; materials alternate, so that other load on the machine affects all of them equally
    int frames = 60;
};

/// Draws the scene with each material in the current context, with back faces culled. Errors: those of
/// `RasterMaterial`.
Result<std::vector<FrameCost>> time_frames(const OffscreenContext& context, const Scene& scene,
                                           std::span<const Material> materials, const FrameOptions& options);
/// True if the library renders on the CPU, so that only the CPU time is meaningful.
bool draws_on_cpu(const OffscreenContext& context);

}  // namespace srbf
