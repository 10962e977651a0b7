// White furnace tests of a BSDF: the light of a thin sphere in uniform illumination.
#pragma once
#include "properties.h"
#include "srbf/metrics.h"
#include "srbf/prepared_bsdf.h"

namespace srbf {

/// The radiance at a viewer's angle `theta` of a thin sphere in uniform illumination of radiance 1, after at most this
/// number of bounces. With one bounce, the inside of the sphere is lit, too. A chord of a sphere meets it at equal
/// angles at both ends.
inline double reflected_by_sphere(const PreparedBsdf& bsdf, double theta, int bounces) {
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
/// The mean of `reflected_by_sphere` over the disc that the viewer sees.
inline double mean_over_disc(const PreparedBsdf& bsdf, int bounces) {
    constexpr int k_rings = 16;
    double sum = 0;
    for (int i = 0; i < k_rings; ++i)
        sum += reflected_by_sphere(bsdf, elementary::acos(std::sqrt((i + 0.5) / k_rings)), bounces);
    return sum / k_rings;
}
/// Expects that a sphere of the model shows the sum of its parts' albedos and beams after one bounce, and no more after
/// many, because its inside is not brighter than its surroundings. Returns the mean over the disc after many bounces.
inline double expect_energy_conserved(const Model& model) {
    const auto& bsdf = std::get<BsdfModel>(model.model);
    const PreparedBsdf prepared = prepare_bsdf(model, {.threads = 1});
    const Evaluate values = evaluator(model);
    for (const double theta : {5.0, 30.0, 60.0, 75.0}) {
        double expected = 0;
        const Vec3f from = to_float(spherical(theta * k_degree, 0.0));
        for (const Part part : {Part::reflection_front, Part::transmission_back})
            expected += double(fraction_at(bsdf.beam, part, from).g) +
                        double(albedo(part_of(values, part), theta * k_degree, k_pi / 2).g);
        EXPECT_WITHIN(reflected_by_sphere(prepared, theta * k_degree, 1), expected, 0.02) << theta;
    }
    const double mean = mean_over_disc(prepared, 64);
    EXPECT_LE(mean, std::min(1.0, 1.002 * mean_over_disc(prepared, 1)));
    return mean;
}

}  // namespace srbf
