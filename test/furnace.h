// A sphere of a two-sided model under uniform light.
#pragma once
#include <optional>

#include "extras/render/path.h"
#include "properties.h"
#include "srbf/file.h"
#include "srbf/metrics.h"
#include "srbf/prepared_bsdf.h"

namespace srbf {

/// A picture of a thin sphere under uniform light of radiance 1, seen from far away: after one bounce without
/// occlusion, or after all bounces with it.
inline PathPicture furnace(const PreparedBsdf& bsdf, bool whole) {
    static const Environment even_light(Image(8, 4, {1, 1, 1}));
    static const Mesh mesh = sphere(64);
    const PathScene scene{{{&mesh, 0}}, {bsdf}, {{0, 0, 400}, {0, 0, 0}, {0, 1, 0}, 0.0052}, {}, {}, &even_light};
    PathOptions options;
    options.width = options.height = 32, options.samples = whole ? 64 : 256;
    options.bounces = whole ? 64 : 1, options.occlusion = whole;
    return render_paths(scene, options);
}
/// The cosine between a pixel's normal and the viewer; no value outside the sphere.
inline std::optional<double> cosine_at(const PathPicture& picture, std::size_t pixel) {
    const Rgb n = picture.first.normal.pixels[pixel];
    const double length = std::sqrt(double(n.r * n.r + n.g * n.g + n.b * n.b));
    return length > 0.99 && n.b > 0.3f ? std::optional(double(n.b) / length) : std::nullopt;
}
inline double mean_of(const PathPicture& picture) {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < picture.first.depth.size(); ++i)
        if (cosine_at(picture, i)) sum += double(picture.rendering.radiance.pixels[i].g), ++count;
    EXPECT_GT(count, 300);
    return sum / count;
}
/// Expects that under uniform light the sphere has, after one bounce, the sum of its parts' albedos and beams along the
/// middle of the picture, and after all bounces no more, since light inside is no brighter than outside.
inline double expect_furnace(const Model& model) {
    const auto& bsdf = std::get<BsdfModel>(model.model);
    const PreparedBsdf prepared = prepare_bsdf(model, {.threads = 1});
    const PathPicture once = furnace(prepared, false);
    const Evaluate values = evaluator(model);
    double sum = 0, expected = 0, most_apart = 0;
    for (std::size_t i = 15 * 32; i < 17 * 32; ++i) {
        const auto cosine = cosine_at(once, i);
        if (!cosine) continue;
        double due = 0;
        const Vec3f from = to_float(spherical(elementary::acos(*cosine), 0.0));
        for (const Part part : {Part::reflection_front, Part::transmission_back})
            due += double(share_at(bsdf.beam, part, from).g) +
                   double(albedo(part_of(values, part), elementary::acos(*cosine), k_pi / 2).g);
        const double seen = double(once.rendering.radiance.pixels[i].g);
        sum += seen, expected += due;
        most_apart = std::max(most_apart, std::abs(seen - due));
    }
    EXPECT_PRED3(near_relative, sum, expected, 0.01);
    EXPECT_LT(most_apart, 0.05);  // with the noise of a pixel
    const double all = mean_of(furnace(prepared, true));
    EXPECT_LE(all, std::min(1.0, 1.002 * mean_of(once)));
    return all;
}

}  // namespace srbf
