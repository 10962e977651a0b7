#include "extras/render/app/map_raster.h"

#include "app/map_layers.h"
#include "code/added_code.h"
#include "extras/render/raster.h"
#include "srbf/shading_code.h"

namespace SRBF_NAMESPACE {

#ifdef SRBF_RASTER
Result<std::vector<Rendering>> rasterize_maps(const Scene& scene, std::span<const TexelMap* const> maps, int width,
                                              int height, const RasterLight& light) {
    std::vector<RasterMap> rasterized;
    for (const TexelMap* map : maps) {
        if (const auto valid = check_layers(*map, "render"); !valid) return valid.error();
        const auto code = map_code(*map, "map", {.language = CodeLanguage::glsl});
        if (!code) return code.error();
        rasterized.push_back({*code, map->basis.lobes, {}});
        for (const MapLevel& level : mip_levels(*map))
            rasterized.back().levels.push_back({int(level.width), int(level.height), layers_in_halves(level)});
    }
    if (!light.environment)
        return rasterize(scene, std::span<const RasterMap>(rasterized), width, height, light.samples);
    std::vector<SampledMap> sampled;
    for (std::size_t i = 0; i < maps.size(); ++i) {
        const Model mean{with_mean_coefficients(*maps[i]), {}};
        const int azimuths = maps[i]->basis.axial ? 1 : k_anisotropic_azimuths;
        sampled.push_back({std::move(rasterized[i]), {propose(evaluator(mean), {.azimuths = azimuths})}});
    }
    return rasterize(scene, *light.environment, std::span<const SampledMap>(sampled),
                     {.width = width, .height = height, .samples = light.samples, .progress = light.progress});
}
#else
Result<std::vector<Rendering>> rasterize_maps(const Scene&, std::span<const TexelMap* const>, int, int,
                                              const RasterLight&) {
    return Error{"renderer raster", {}, "this program", "one built with libepoxy", "one without"};
}
#endif

}  // namespace srbf
