#include "app/raster.h"

#include "render/raster.h"
#include "srbf/convert.h"

namespace srbf {

#ifdef SRBF_RASTER
namespace {

/// What OpenGL draws of a subject: a model as it is, a measurement as a table in Rusinkiewicz' angles.
Result<Material> material_of(const Subject& subject) {
    if (const auto* model = std::get_if<Model>(&subject.content))
        return std::visit([](const auto& of) -> Material { return of; }, model->model);
    const Measured& measured = std::get<Measured>(subject.content);
    if (const auto* table = std::get_if<MerlTable>(&measured.table)) return Material(*table);
    if (!is_isotropic(measured))
        return Error{subject.path, {}, "measurement for the renderer raster", "an isotropic one", "an anisotropic one"};
    return Material(to_merl(evaluator(subject)));
}

}  // namespace

Result<std::vector<Rendering>> rasterize(const Scene& scene, std::span<const Subject> subjects, int width, int height) {
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
