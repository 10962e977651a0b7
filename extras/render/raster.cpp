#include "extras/render/raster.h"

#include <epoxy/gl.h>

#include <algorithm>

#include "extras/render/offscreen.h"

namespace SRBF_NAMESPACE {

namespace {

template <typename M>
Result<std::vector<Rendering>> rasterize_each(const Scene& scene, std::span<const M> materials, int width, int height,
                                              int samples) {
    const auto context = OffscreenContext::make();
    if (!context) return context.error();
    const auto target = RasterTarget::make(width, height, samples, RasterTarget::Format::floats);
    if (!target) return target.error();
    const RasterMesh mesh(scene.mesh, std::is_same_v<M, RasterMap>);
    const RasterView view{scene.camera, double(width) / height, scene.lights, 1};
    std::vector<Rendering> renderings;
    for (const M& material_source : materials) {
        const auto material = RasterMaterial::make(material_source, {.dialect = context->dialect(),
                                                                     .output = PixelOutput::radiance,
                                                                     .lights = std::max(1, int(scene.lights.size()))});
        if (!material) return material.error();
        target->begin();
        material->draw(mesh, view);
        Rendering& rendering = renderings.emplace_back(Rendering{Image(width, height), {}});
        rendering.coverage.reserve(rendering.radiance.pixels.size());
        std::size_t i = 0;
        for (const Float4& pixel : target->read_floats()) {
            rendering.coverage.push_back(pixel[3]);
            if (pixel[3] > 0)
                rendering.radiance.pixels[i] = {pixel[0] / pixel[3], pixel[1] / pixel[3], pixel[2] / pixel[3]};
            ++i;
        }
    }
    return renderings;
}

/// Under an environment, by a sample of every pixel after the other.
template <typename M>
Result<std::vector<Rendering>> rasterize_under(const Scene& scene, const Environment& environment,
                                               std::span<const Sampled<M>> materials,
                                               const EnvironmentOptions& options) {
    constexpr bool is_map = std::is_same_v<M, RasterMap>;
    const int width = options.width, height = options.height;
    const auto context = OffscreenContext::make();
    if (!context) return context.error();
    const Dialect dialect = context->dialect();
    const auto light = RasterEnvironment::make(environment);
    if (!light) return light.error();
    const auto surface = RasterSurface::make(dialect, width, height, RasterSurface::Points::four, is_map);
    if (!surface) return surface.error();
    std::vector<RasterMaterial> raster_materials;
    std::vector<RasterMean> means;
    for (const Sampled<M>& sampled : materials) {
        auto material = RasterMaterial::make(
            sampled.material,
            {.dialect = dialect, .lights = std::max(1, int(scene.lights.size())), .environment = true});
        if (!material) return material.error();
        material->set_proposal(sampled.proposal);
        raster_materials.push_back(*std::move(material));
        auto mean = RasterMean::make(*surface);
        if (!mean) return mean.error();
        means.push_back(*std::move(mean));
    }
    const RasterMesh mesh(scene.mesh, is_map);
    for (int i = 0; i < options.samples; ++i) {
        const RasterView view{.camera = scene.camera,
                              .aspect = double(width) / height,
                              .lights = scene.lights,
                              .shift = sample_shift(i, width, height)};
        surface->draw(mesh, view);
        for (std::size_t k = 0; k < raster_materials.size(); ++k)
            means[k].add(raster_materials[k], *surface, view,
                         {&*light, environment_frame(scene.camera), options.draws});
        glFinish();
        if (options.progress) options.progress(double(i + 1) / options.samples);
    }
    std::vector<Rendering> renderings;
    for (const RasterMean& mean : means) {
        const std::vector<Float4> pixels = mean.picture().read_floats();
        Rendering& rendering = renderings.emplace_back(Rendering{Image(width, height), {}});
        rendering.coverage.assign(pixels.size(), 1);
        for (std::size_t i = 0; i < pixels.size(); ++i)
            rendering.radiance.pixels[i] = {pixels[i][0], pixels[i][1], pixels[i][2]};
    }
    return renderings;
}

}  // namespace

Result<std::vector<Rendering>> rasterize(const Scene& scene, std::span<const Material> materials, int width, int height,
                                         int samples) {
    return rasterize_each(scene, materials, width, height, samples);
}
Result<std::vector<Rendering>> rasterize(const Scene& scene, std::span<const RasterMap> maps, int width, int height,
                                         int samples) {
    return rasterize_each(scene, maps, width, height, samples);
}

Result<std::vector<Rendering>> rasterize(const Scene& scene, const Environment& environment,
                                         std::span<const SampledMaterial> materials,
                                         const EnvironmentOptions& options) {
    return rasterize_under(scene, environment, materials, options);
}
Result<std::vector<Rendering>> rasterize(const Scene& scene, const Environment& environment,
                                         std::span<const SampledMap> maps, const EnvironmentOptions& options) {
    return rasterize_under(scene, environment, maps, options);
}

}  // namespace srbf
