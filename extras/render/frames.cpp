#include "extras/render/frames.h"

#include <epoxy/gl.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <limits>

namespace SRBF_NAMESPACE {
namespace {

using Clock = std::chrono::steady_clock;

double cpu_milliseconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto milliseconds = [](const timeval& time) {
        return 1e3 * double(time.tv_sec) + 1e-3 * double(time.tv_usec);
    };
    return milliseconds(usage.ru_utime) + milliseconds(usage.ru_stime);
}

/// Draws a frame and waits for it. With `on_cpu` the query ends only after that, because a library that draws later
/// on other threads would stop its clock before it begins.
template <typename Draw> FrameTime time_frame(const Draw& draw, bool on_cpu) {
    GLuint query = 0;
    glGenQueries(1, &query);
    glFinish();
    const double cpu_before = cpu_milliseconds();
    const auto begin = Clock::now();
    glBeginQuery(GL_TIME_ELAPSED, query);
    draw();
    if (on_cpu) glFinish();
    glEndQuery(GL_TIME_ELAPSED);
    glFinish();
    const double wall = 1e3 * std::chrono::duration<double>(Clock::now() - begin).count();
    const double cpu = cpu_milliseconds() - cpu_before;
    GLuint64 nanoseconds = 0;
    glGetQueryObjectui64v(query, GL_QUERY_RESULT, &nanoseconds);
    glDeleteQueries(1, &query);
    return {1e-6 * double(nanoseconds), wall, cpu};
}

}  // namespace

bool draws_on_cpu(const OffscreenContext& context) { return context.renderer().find("llvmpipe") != std::string::npos; }

Result<std::vector<FrameCost>> time_frames(const OffscreenContext& context, const Scene& scene,
                                           std::span<const Material> materials, const FrameOptions& options) {
    const bool two_passes = options.input == PixelInput::surface, on_cpu = draws_on_cpu(context);
    const Dialect dialect = context.dialect();
    const RasterMesh mesh(scene.mesh);
    const RasterView view{scene.camera, double(options.width) / options.height, scene.lights, 3, false};
    const auto surface = RasterSurface::make(dialect, options.width, options.height);
    if (!surface) return surface.error();
    const auto target =
        two_passes ? RasterTarget::make_for(*surface)
                   : RasterTarget::make(options.width, options.height, options.samples, RasterTarget::Format::bytes);
    if (!target) return target.error();
    std::vector<RasterMaterial> raster_materials;
    std::vector<FrameCost> costs;
    constexpr double never = std::numeric_limits<double>::infinity();
    for (const Material& material_source : materials) {
        auto material = RasterMaterial::make(material_source, {.dialect = dialect, .input = options.input});
        if (!material) return material.error();
        costs.push_back({{never, never, never}, material->data_bytes(), material->auxiliary_bytes()});
        raster_materials.push_back(*std::move(material));
    }
    for (int round = -2; round < options.frames; ++round)  // the first two rounds warm up caches
        for (std::size_t i = 0; i < raster_materials.size(); ++i) {
            const FrameTime time = time_frame(
                [&] {
                    if (two_passes) surface->draw(mesh, view);
                    target->begin();
                    if (two_passes)
                        raster_materials[i].draw(*surface, view);
                    else
                        raster_materials[i].draw(mesh, view);
                },
                on_cpu);
            if (round < 0) continue;
            FrameTime& least = costs[i].least;
            least = {std::min(least.gpu, time.gpu), std::min(least.wall, time.wall), std::min(least.cpu, time.cpu)};
        }
    return costs;
}

}  // namespace srbf
