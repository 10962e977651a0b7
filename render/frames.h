// What a frame costs: level 7. Table 7.2 of Tsai 2009 anew.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "render/offscreen.h"
#include "render/raster.h"

namespace srbf {

/// Milliseconds of a frame: by the graphics library's own clock, by ours, and those that all threads of this process worked.
struct FrameTime {
    double gpu = 0, wall = 0, cpu = 0;
};

/// What drawing in a material costs.
struct FrameCost {
    FrameTime least;                                  ///< of all frames, each clock by itself
    std::size_t data_bytes = 0, auxiliary_bytes = 0;  ///< what a pixel looks up, as of `RasterMaterial`
};

struct FrameOptions {
    int width = 640, height = 480;
    PixelInput input = PixelInput::surface;  ///< two passes of one sample; or one pass of `samples` for each pixel
    int samples = 4;
    int frames = 60;  ///< of each material; they are drawn in turn, so that what else the machine does hits all alike
};

/// Draws the scene in each material in the current context. Triangles seen from behind are left out. Errors: those of `RasterMaterial`.
Result<std::vector<FrameCost>> time_frames(const OffscreenContext& context, const Scene& scene,
                                           std::span<const Material> materials, const FrameOptions& options);
/// Whether the library draws on the CPU, where only the CPU's clock sees the work.
bool draws_on_cpu(const OffscreenContext& context);

}  // namespace srbf
