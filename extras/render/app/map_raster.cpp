#include "extras/render/app/map_raster.h"

#include "app/map_layers.h"
#include "base/half.h"
#include "extras/render/raster.h"
#include "srbf/shading_code.h"

namespace srbf {

#ifdef SRBF_RASTER
namespace {

RasterMap::Level halves_of(const MapLevel& level, std::size_t layers) {
    RasterMap::Level halves{int(level.width), int(level.height), {}};
    halves.halves.reserve(4 * level.coefficient.size());
    for (std::size_t j = 0; j < layers; ++j)
        for (std::size_t i = j; i < level.coefficient.size(); i += layers) {
            const auto& [r, g, b] = level.coefficient[i];
            for (const float number : {r, g, b, 1.f}) halves.halves.push_back(to_half(number));
        }
    return halves;
}

}  // namespace

Result<std::vector<Rendering>> rasterize_maps(const Scene& scene, std::span<const Library* const> maps, int width,
                                              int height, int samples) {
    std::vector<RasterMap> rasterized;
    for (const Library* map : maps) {
        if (const auto valid = check_layers(*map, "render"); !valid) return valid.error();
        const auto code = map_code(*map, "map", {.language = CodeLanguage::glsl});
        if (!code) return code.error();
        rasterized.push_back({*code, map->basis.lobes, {}});
        for (const MapLevel& level : mip_levels(*map))
            rasterized.back().levels.push_back(halves_of(level, std::size_t(map->basis.lobes)));
    }
    return rasterize(scene, std::span<const RasterMap>(rasterized), width, height, samples);
}
#else
Result<std::vector<Rendering>> rasterize_maps(const Scene&, std::span<const Library* const>, int, int, int) {
    return Error{"renderer raster", {}, "this program", "one built with libepoxy", "one without"};
}
#endif

}  // namespace srbf
