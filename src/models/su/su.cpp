#include "srbf/models/su.h"

#include "base/parallel.h"
#include "brdf/directions.h"
#include "models/su/su_functions.h"
#include "models/su/su_kind.h"
#include "srbf/kernel.h"

namespace SRBF_NAMESPACE {
namespace {

template <typename Choice> std::optional<Choice> choice_named(std::string_view text) {
    for (const Choice choice : {Choice(0), Choice(1)})
        if (name(choice) == text) return choice;
    return std::nullopt;
}

}  // namespace

std::string_view name(Discretise discretise) { return discretise == Discretise::view ? "view" : "light"; }
std::optional<Discretise> discretise_named(std::string_view text) { return choice_named<Discretise>(text); }

std::string_view name(SuInterpolation interpolation) {
    return interpolation == SuInterpolation::rotated ? "rotated" : "plain";
}
std::optional<SuInterpolation> interpolation_named(std::string_view text) {
    return choice_named<SuInterpolation>(text);
}

std::string_view name(DirectionMap map) { return map == DirectionMap::cube ? "cube" : "parabolic"; }
std::optional<DirectionMap> map_named(std::string_view text) { return choice_named<DirectionMap>(text); }

Rgb value(const SuModel& model, Vec3f wl, Vec3f wv) {
    using K = Kernel<float>;
    if (!above_horizon(wl, wv)) return {};
    if (model.discretise == Discretise::light) std::swap(wl, wv);  // lobes are functions of wv then
    const Vec3f f = model.interpolation == SuInterpolation::rotated
                        ? K::su_rotated_value(model, wl, wv)
                        : K::su_plain_value(model, nearest_views(model, wv), wl, wv, model.neighbours);
    return {f.x, f.y, f.z};
}

NearestViews nearest_views(const SuModel& model, Vec3f w) {
    NearestViews nearest;
    find_nearest(model.direction, w, nearest);
    return nearest;
}

IndexTexture index_texture(const SuModel& model, DirectionMap map, int size) {
    IndexTexture index{map, size > 0 ? size : default_size(map), {}};
    index.texels.resize(texels(map, index.size));
    constexpr std::size_t block = 1024;
    parallel_for_chunks(index.texels.size(), block, 0, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            index.texels[i] = nearest_views(model, texel_direction(map, index.size, i));
    });
    return index;
}

std::size_t payload_bytes(const SuModel& model) { return 2 * model.direction.size() * std::size_t(model.lobes) * 6; }

std::size_t auxiliary_bytes(const SuModel& model) {
    const DirectionMap map = model.index ? model.index->map : DirectionMap::cube;
    const int size = model.index ? model.index->size : default_size(map);
    return texels(map, size) * sizeof(NearestViews) + 8 * model.direction.size();
}

SuModel rounded(const SuModel& model) { return *as_stored(model); }

void exchange(SuModel& model) {
    model.discretise = model.discretise == Discretise::view ? Discretise::light : Discretise::view;
}

}  // namespace
