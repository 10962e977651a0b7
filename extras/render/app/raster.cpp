#include "extras/render/app/raster.h"

#include <algorithm>
#include <cstdlib>

#include "extras/render/raster.h"

namespace SRBF_NAMESPACE {

Result<Material> material_of(const Subject& subject) { return material_of(subject.content, subject.path); }

Proposals proposal_of(const Subject& subject, int threads) {
    const ProposeOptions options{
        .azimuths = azimuths_of(subject), .threads = threads, .facets = facets_of(subject.content)};
    if (is_two_sided(subject.content)) return propose_parts(evaluator(subject), options);
    return propose(evaluator(subject), options);
}

#ifdef SRBF_RASTER
Result<std::vector<Rendering>> rasterize(const Scene& scene, std::span<const Subject* const> subjects, int width,
                                         int height, const RasterLight& light) {
    // Suppresses the library's messages about drivers that it tried; the error reports the result.
    ::setenv("EGL_LOG_LEVEL", "fatal", 0);
    std::vector<Material> materials;
    for (const Subject* subject : subjects) {
        auto material = material_of(*subject);
        if (!material) return material.error();
        materials.push_back(*std::move(material));
    }
    if (!light.environment) return rasterize(scene, materials, width, height, light.samples);
    std::vector<SampledMaterial> sampled;
    for (std::size_t i = 0; i < subjects.size(); ++i)
        sampled.push_back({std::move(materials[i]), proposal_of(*subjects[i], 0)});
    return rasterize(scene, *light.environment, sampled,
                     {.width = width, .height = height, .samples = light.samples, .progress = light.progress});
}
#else
Result<std::vector<Rendering>> rasterize(const Scene&, std::span<const Subject* const>, int, int, const RasterLight&) {
    return Error{"renderer raster", {}, "this program", "one built with libepoxy", "one without"};
}
#endif

}  // namespace srbf
