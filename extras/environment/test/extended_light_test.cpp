// Lobes that environments and area lights are looked up by.
#include "srbf/extended_light.h"

#include "brdf/directions.h"
#include "models.h"
#include "properties.h"
#include "srbf/models/openpbr.h"

namespace srbf::extended_light_test {
namespace {

const Model& plastic() {
    static const Model model{GgxModel{{0.3f, 0.2f, 0.1f}, {{0.3f, {0.05f, 0.05f, 0.05f}, 1}}}, {}};
    return model;
}

/// The direction to the viewer at this cosine, in the xz plane.
Vec3f viewer_at(float cosine) { return {std::sqrt(1 - cosine * cosine), 0, cosine}; }

/// ∫ g(w) dω over the hemisphere about z, by midpoints that are uniform in √(1 − cosθ) and φ.
template <typename G> double hemisphere_integral(const G& g, int rings = 200, int azimuths = 200) {
    double sum = 0;
    for (int i = 0; i < rings; ++i) {
        const double u = (i + 0.5) / rings, c = 1 - u * u, s = std::sqrt(1 - c * c);
        for (int j = 0; j < azimuths; ++j) {
            const double phi = 2 * k_pi * (j + 0.5) / azimuths;
            sum += g(Vec3d{s * std::cos(phi), s * std::sin(phi), c}) * 2 * u;
        }
    }
    return sum * 2 * k_pi / (rings * double(azimuths));
}

/// The green of the radiance that lobes show.
template <typename L>
double looked_up(const std::vector<ExtendedLight::Lobe>& lobes, const Vec3f& wv, const L& radiance,
                 MapLevels levels = MapLevels::root) {
    double sum = 0;
    for (const ExtendedLight::Lobe& lobe : lobes) {
        const Vec3d z = to_double(axis_of(lobe, wv)), x = normalize(cross(Vec3d{0, 1, 0}, z)), y = cross(z, x);
        sum += double(lobe.weight.g) * hemisphere_integral([&](const Vec3d& w) {
                   return radiance(w.x * x + w.y * y + w.z * z) *
                          double(filter_kernel(lobe.roughness, float(w.z), levels));
               });
    }
    return sum;
}

template <typename L>
double looked_up(const ExtendedLight& light, const Vec3f& wv, const L& radiance, MapLevels levels = MapLevels::root) {
    return looked_up(lobes_at(light, wv.z), wv, radiance, levels);
}

TEST(ExtendedLight, KernelsAreDensities) {
    for (const MapLevels levels : {MapLevels::root, MapLevels::three})
        for (const float roughness : {0.15f, 0.3f, 0.6f, 0.95f, 0.999f, 1.f}) {
            const auto kernel = [&](const Vec3d& w) { return double(filter_kernel(roughness, float(w.z), levels)); };
            EXPECT_WITHIN(hemisphere_integral(kernel, 20000, 1), 1, 1e-4) << roughness;
        }
    EXPECT_WITHIN(filter_kernel(1, 0.5f), 0.5 / k_pi, 1e-6);
    EXPECT_EQ(filter_kernel(0.3f, -0.1f), 0);
}

// At a level K is GGX's of the level's roughness, which is 2 r² wide; between levels it is not.
TEST(ExtendedLight, LevelsAreFilteredForTheirRoughness) {
    EXPECT_WITHIN(roughness_of_level(2), 0.16, 1e-12);
    EXPECT_WITHIN(roughness_of_level(2, MapLevels::three), 1 - std::sqrt(0.6), 1e-12);  // PMREMGenerator.lodToRoughness
    for (const MapLevels levels : {MapLevels::root, MapLevels::three})
        for (int level = 2; level < ExtendedLight::k_levels; ++level) {  // floats have no cosines for the first
            const double r = roughness_of_level(level, levels), a = r * r, c = std::cos(a);
            EXPECT_WITHIN(level_of_roughness(r, levels), level, 1e-12);
            const double falls = c * 4 * a * a * a * a / std::pow(1 + a * a - (1 - a * a) * c, 2);
            EXPECT_WITHIN(filter_kernel(float(r), float(c), levels) / filter_kernel(float(r), 1, levels), falls, 2e-3);
        }
}

/// ∫ f cosθl dω, without nodes.
Rgb reflected_of_white(const PreparedBrdf& brdf, double cosine) {
    const Vec3d wv{std::sqrt(1 - cosine * cosine), 0, cosine};
    const Quadrature points = MirrorMixture(k_pi / 2).quadrature(wv, 1 << 14);
    Vec3d sum{};
    for (std::size_t i = 0; i < points.w.size(); ++i) {
        const Rgb f = value(brdf, points.w[i], to_float(wv));
        sum = sum + points.weight[i] * double(points.w[i].z) * Vec3d{double(f.r), double(f.g), double(f.b)};
    }
    return {float(sum.x), float(sum.y), float(sum.z)};
}

// The test takes every view, between nodes too. It allows at most 1 where a model itself reflects more.
TEST(ExtendedLight, WhiteAllRoundIsReflectedByTheAlbedo) {
    const Model metal{GgxModel{{}, {{0.1f, {0.9f, 0.6f, 0.3f}, 1}}}, {}},
        bright{GgxModel{{0.95f, 0.9f, 0.1f}, {{0.4f, {0.2f, 0.2f, 0.2f}, 1}}}, {}};
    double max = 0;
    for (const Model* model : {&plastic(), &metal, &bright}) {
        const PreparedBrdf brdf = prepare(*model);
        const ExtendedLight light = extended_light(brdf, {.lobes = 3});
        for (double t = 0.011; t < 1; t += 0.0173) {
            const float cosine = float(t * t * t);  // from 1e-6 on
            Rgb sum;
            for (const ExtendedLight::Lobe& lobe : lobes_at(light, cosine))
                for (int c = 0; c < 3; ++c) sum[c] += lobe.weight[c];
            const Rgb whole = reflected_of_white(brdf, double(cosine)), between = albedo(brdf, cosine);
            for (int c = 0; c < 3; ++c) {
                const float within = std::max(0.01f * whole[c], 0.002f);
                EXPECT_WITHIN(between[c], whole[c], within) << cosine;
                EXPECT_WITHIN(sum[c], std::min(whole[c], 1.f), within) << cosine;
                EXPECT_LT(sum[c], 1.0001f) << cosine;
                max = std::max(max, double(whole[c]));
            }
        }
    }
    EXPECT_GT(max, 1.05);
}

// Under half a sphere that glows, and under a soft box of 17 degrees about the mirror direction.
TEST(ExtendedLight, LightsOfAnySizeAreReflected) {
    const PreparedBrdf brdf = prepare(plastic());
    const ExtendedLight light = extended_light(brdf), three_levels = extended_light(brdf, {.levels = MapLevels::three});
    for (const float cosine : {0.15f, 0.4f, 0.7f, 0.95f}) {
        const Vec3f wv = viewer_at(cosine);
        const Vec3d away = normalize(Vec3d{-1, 0.4, 0.2});
        const auto half_sphere = [&](const Vec3d& w) { return dot(w, away) > 0 ? 1.0 : 0; };
        const auto box_light = [&](const Vec3d& w) { return dot(w, to_double(mirror(wv))) > std::cos(0.3) ? 1.0 : 0; };
        const auto reflected = [&](const auto& radiance) {
            return hemisphere_integral([&](const Vec3d& w) {
                const double l = radiance(w);
                return l > 0 ? l * double(value(brdf, to_float(w), wv).g) * w.z : 0;
            });
        };
        const double whole = double(albedo(brdf, cosine).g);
        const double half = reflected(half_sphere), box = reflected(box_light);
        EXPECT_WITHIN(looked_up(light, wv, half_sphere), half, 0.05 * whole) << cosine;
        EXPECT_WITHIN(looked_up(light, wv, box_light), box, 0.05 * whole) << cosine;
        EXPECT_WITHIN(looked_up(three_levels, wv, half_sphere, MapLevels::three), half, 0.05 * whole) << cosine;
        EXPECT_WITHIN(looked_up(three_levels, wv, box_light, MapLevels::three), box, 0.05 * whole) << cosine;
    }
}

// These lights are shown by sums of lobes about the normal, whatever the coefficients are.
TEST(ExtendedLight, SharedLobesReflectAnySum) {
    std::mt19937_64 random(4);
    PmModel basis = random_model(random, {true, false, 6, 3, 100, PmForm::extended});
    const SharedLight shared = shared_light(basis);
    const std::size_t others = std::size_t(shared.lobes - 1), J = basis.coefficient.size();
    ASSERT_EQ(shared.weight.size(), ExtendedLight::k_views * others * J);
    for (int sum = 0; sum < 3; ++sum) {
        for (Rgb& beta : basis.coefficient) beta.r = beta.g = beta.b = float(sum == 0 ? 1 : uniform(random));
        const PreparedBrdf brdf = prepare(Model{basis, {}});
        for (const std::size_t view : {10, 18, 28}) {
            const float cosine = float(ExtendedLight::cosine(int(view)));
            const Vec3f wv = viewer_at(cosine);
            const float whole = albedo(brdf, cosine).g;
            std::vector<ExtendedLight::Lobe> lobes{{0, 1, {1, 1, 1}}};
            for (std::size_t i = view * others; i < (view + 1) * others; ++i) {
                float weight = 0;
                for (std::size_t j = 0; j < J; ++j) weight += shared.weight[i * J + j] * basis.coefficient[j].g / whole;
                lobes.push_back({shared.shape[i].axis, shared.shape[i].roughness, {0, weight, 0}});
                lobes[0].weight.g -= weight;
            }
            for (const double width : {0.3, 1.0}) {
                const auto box_light = [&](const Vec3d& w) {
                    return dot(w, to_double(mirror(wv))) > std::cos(width) ? 1.0 : 0;
                };
                const double box = hemisphere_integral(
                    [&](const Vec3d& w) { return box_light(w) * double(value(brdf, to_float(w), wv).g) * w.z; });
                EXPECT_WITHIN(double(whole) * looked_up(lobes, wv, box_light), box, 0.05 * double(whole)) << cosine;
            }
        }
    }
}

// An anisotropic BRDF is reflected by its mean over azimuths, and over the two halves beside the plane of incidence, in
// which lobes lie.
TEST(ExtendedLight, AnisotropicIsTheMeanOverAzimuths) {
    OpenPbrModel metal;
    metal.base_metalness = 1;
    metal.specular_roughness = 0.5f;
    metal.specular_roughness_anisotropy = 0.8f;
    const Model model{metal, {}};
    const PreparedBrdf brdf = prepare(model);
    const ExtendedLight light = extended_light(brdf, {.isotropic = false});
    const Vec3d away = normalize(Vec3d{-1, 0.4, 0.2}), mirrored{away.x, -away.y, away.z};
    for (const float cosine : {0.3f, 0.9f}) {
        const Vec3f wv = viewer_at(cosine);
        constexpr int k_azimuths = 12;
        double lit = 0, whole = 0, first = 0;  // by half a sphere, by all of it, the fraction at azimuth 0
        for (int i = 0; i < k_azimuths; ++i) {
            const auto turned = [&](const Vec3d& w) { return rotate(w, 2 * k_pi * i / k_azimuths); };
            const auto reflected = [&](const auto& fraction) {
                const Vec3f v = to_float(turned(to_double(wv)));
                return hemisphere_integral(
                    [&](const Vec3d& w) { return fraction(w) * double(value(brdf, to_float(w), v).g) * w.z; }, 100,
                    200);
            };
            const double half = reflected(
                [&](const Vec3d& w) { return 0.5 * ((dot(w, turned(away)) > 0) + (dot(w, turned(mirrored)) > 0)); });
            const double all = reflected([](const Vec3d&) { return 1.0; });
            lit += half;
            whole += all;
            if (i == 0) first = half / all;
        }
        const double looked = looked_up(light, wv, [&](const Vec3d&w) { return dot(w, away) > 0 ? 1.0 : 0; }),
                     looked_up_whole = looked_up(light, wv, [](const Vec3d&) { return 1.0; });
        EXPECT_GT(std::abs(first - lit / whole), 0.05);
        EXPECT_WITHIN(looked / looked_up_whole, lit / whole, 0.015) << cosine;
    }
}

}  // namespace
}  // namespace srbf::extended_light_test
