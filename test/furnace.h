// The light that a thin sphere of a BSDF in even light sends to its viewer.
#pragma once
#include "properties.h"
#include "srbf/metrics.h"
#include "srbf/prepared_bsdf.h"

namespace srbf {

/// The light that a thin sphere in even light of radiance 1 sends to a viewer at `theta`, after at most this number of
/// bounces; after one bounce light is everywhere. A chord of a sphere meets it at equal angles at both ends.
inline double furnace(const PreparedBsdf& bsdf, double theta, int bounces) {
    constexpr int k_paths = 4096;
    std::mt19937_64 random(1);
    double sum = 0;
    for (int i = 0; i < k_paths; ++i) {
        Vec3f wv = to_float(spherical(theta, 0.0));
        double weight = 1;
        for (int bounce = 0; bounce < bounces && weight > 0; ++bounce) {
            const Vec2f u{float(uniform(random)), float(uniform(random))};
            const BsdfSample light = sample(bsdf, wv, u, float(uniform(random)));
            weight *= double(light.weight.g);
            if (bounces == 1 || light.wl.z > 0) {
                sum += weight;
                break;
            }
            wv = {-light.wl.x, -light.wl.y, light.wl.z};
        }
    }
    return sum / k_paths;
}
/// The mean of that light over the disc that the viewer sees.
inline double furnace(const PreparedBsdf& bsdf, int bounces) {
    constexpr int k_rings = 16;
    double sum = 0;
    for (int i = 0; i < k_rings; ++i) sum += furnace(bsdf, elementary::acos(std::sqrt((i + 0.5) / k_rings)), bounces);
    return sum / k_rings;
}
/// Expects that a model in even light sends its viewer the sum of its parts' albedos and beams after one bounce. In all
/// it sends no more than that, because the inside of the sphere is not brighter than its surroundings.
inline double expect_furnace(const Model& model) {
    const auto& bsdf = std::get<BsdfModel>(model.model);
    const PreparedBsdf prepared = prepare_bsdf(model, {.threads = 1});
    const Evaluate values = evaluator(model);
    for (const double theta : {5.0, 30.0, 60.0, 75.0}) {
        double expected = 0;
        const Vec3f from = to_float(spherical(theta * k_degree, 0.0));
        for (const Part part : {Part::reflection_front, Part::transmission_back})
            expected += double(share_at(bsdf.beam, part, from).g) +
                        double(albedo(part_of(values, part), theta * k_degree, k_pi / 2).g);
        EXPECT_WITHIN(furnace(prepared, theta * k_degree, 1), expected, 0.02) << theta;
    }
    const double all = furnace(prepared, 64);
    EXPECT_LE(all, std::min(1.0, 1.002 * furnace(prepared, 1)));
    return all;
}

}  // namespace srbf
