#include "srbf/models/su.h"

#include "base/parallel.h"
#include "brdf/directions.h"
#include "models/su/su_functions.h"
#include "models/su/su_kind.h"
#include "srbf/kernel.h"

namespace SRBF_NAMESPACE {
namespace {

/// The direction at which lobes are evaluated, and the one that was sampled.
struct SampledPair {
    Vec3f evaluated, sampled;
};
SampledPair sampled_pair(const SuModel& model, Vec3f wl, Vec3f wv) {
    return model.discretise == Discretise::view ? SampledPair{wl, wv} : SampledPair{wv, wl};
}

Rgb plain_value(const SuModel& model, const NearestViews& nearest, const SampledPair& pair) {
    const Vec3f f = Kernel<float>::su_plain_value(model, nearest, pair.evaluated, pair.sampled, model.neighbours);
    return {f.x, f.y, f.z};
}

}  // namespace

std::string_view name(Discretise discretise) { return discretise == Discretise::view ? "view" : "light"; }
std::optional<Discretise> discretise_named(std::string_view text) {
    for (const Discretise discretise : {Discretise::view, Discretise::light})
        if (name(discretise) == text) return discretise;
    return std::nullopt;
}

std::string_view name(SuInterpolation interpolation) {
    return interpolation == SuInterpolation::rotated ? "rotated" : "plain";
}
std::optional<SuInterpolation> interpolation_named(std::string_view text) {
    for (const SuInterpolation interpolation : {SuInterpolation::rotated, SuInterpolation::plain})
        if (name(interpolation) == text) return interpolation;
    return std::nullopt;
}

std::string_view name(DirectionMap map) { return map == DirectionMap::cube ? "cube" : "parabolic"; }
std::optional<DirectionMap> map_named(std::string_view text) {
    for (const DirectionMap map : {DirectionMap::cube, DirectionMap::parabolic})
        if (name(map) == text) return map;
    return std::nullopt;
}

Rgb value(const SuModel& model, Vec3f wl, Vec3f wv) {
    if (!above_horizon(wl, wv)) return {};
    const SampledPair pair = sampled_pair(model, wl, wv);
    if (model.interpolation == SuInterpolation::plain)
        return plain_value(model, nearest_views(model, pair.sampled), pair);
    const Vec3f f = Kernel<float>::su_rotated_value(model, pair.evaluated, pair.sampled);
    return {f.x, f.y, f.z};
}

Rgb value(const SuModel& model, const IndexTexture& index, Vec3f wl, Vec3f wv) {
    if (!above_horizon(wl, wv)) return {};
    const SampledPair pair = sampled_pair(model, wl, wv);
    NearestViews nearest = index.texels[texel_of(index.map, index.size, pair.sampled)];
    const auto squared_distance = [&](std::uint16_t view) {
        const Vec3f difference = model.direction[view] - pair.sampled;
        return dot(difference, difference);
    };
    std::stable_sort(nearest.begin(), nearest.end(),
                     [&](std::uint16_t a, std::uint16_t b) { return squared_distance(a) < squared_distance(b); });
    return plain_value(model, nearest, pair);
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
    parallel_for_parts(index.texels.size(), block, 0, [&](std::size_t begin, std::size_t end) {
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

}  // namespace srbf
