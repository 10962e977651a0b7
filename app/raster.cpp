#include "app/raster.h"

#include <cstdlib>

#include "app/material.h"
#include "render/raster.h"

namespace srbf {

#ifdef SRBF_RASTER
Result<std::vector<Rendering>> rasterize(const Scene& scene, std::span<const Subject> subjects, int width, int height) {
    // What the library has to say of drivers that it tried is no news; what comes of it, the error tells.
    ::setenv("EGL_LOG_LEVEL", "fatal", 0);
    std::vector<Material> materials;
    for (const Subject& subject : subjects) {
        auto material = material_of(subject);
        if (!material) return material.error();
        materials.push_back(*std::move(material));
    }
    return rasterize(scene, materials, width, height);
}
#else
Result<std::vector<Rendering>> rasterize(const Scene&, std::span<const Subject>, int, int) {
    return Error{"renderer raster", {}, "this program", "one built with libepoxy", "one without"};
}
#endif

}  // namespace srbf
