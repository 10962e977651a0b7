// Pictures of a sphere and their differences.
#include "errors/sphere.h"

#include "brdf_functions.h"
#include "errors/picture_errors.h"
#include "properties.h"
#include "srbf/metrics.h"

namespace srbf::pictures_test {
namespace {

/// A highlight of this bandwidth about the mirror direction on a dark body.
Evaluate glossy(double bandwidth) {
    return pairwise([bandwidth](Vec3f wl, Vec3f wv) {
        const double lobe = std::exp(bandwidth * (double(dot(wl, mirror(wv))) - 1));
        return Rgb{float(0.02 + lobe), float(0.03 + lobe), float(0.05 + lobe)};
    });
}

constexpr float k_white = 1 / float(k_pi);
const Lighting k_uniform{"uniform", {1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {}};

TEST(Pictures, UniformLightShowsTheAlbedo) {
    // In uniform light a pixel is the directional albedo at its angle.
    for (const auto& [brdf, tolerance] :
         {std::pair(constant_brdf({k_white, k_white / 2, 0}), 0.025), {glossy(30), 0.02}, {glossy(3000), 0.05}}) {
        const Evaluate brdfs[] = {brdf};
        const Image image = sphere_pictures(brdfs, {&k_uniform, 1})[0][0];
        for (const int x : {32, 44, 56, 61}) {
            const double across = (2 * x + 1 - 64) / 64.0, theta = std::asin(std::hypot(across, 1 / 64.0));
            const Rgb expected = albedo(brdf, theta, k_pi / 2);
            EXPECT_RGB_WITHIN(image.at(x, 32), expected, tolerance) << x;
        }
        EXPECT_EQ(image.at(0, 0), Rgb());
        EXPECT_FALSE(shows_sphere(64, 0, 0));
    }
}

TEST(Pictures, ADistantLightShowsTheBrdfItself) {
    const Vec3d l = normalize(Vec3d{-0.5, 0.5, 0.7});
    const Lighting light{"light", {}, {}, {}, {{l, 0, {2, 2, 2}}}};
    const Evaluate brdfs[] = {constant_brdf({0.25f, 0.5f, 1})};
    const Image image = sphere_pictures(brdfs, {&light, 1})[0][0];
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
            const double nx = (2 * x + 1 - 64) / 64.0, ny = (63 - 2 * y) / 64.0, nz2 = 1 - nx * nx - ny * ny;
            const double cosine = nz2 > 0 ? std::max(0.0, dot(l, Vec3d{nx, ny, std::sqrt(nz2)})) : 0;
            ASSERT_WITHIN(double(image.at(x, y).r), 0.5 * cosine, 1e-5);
            ASSERT_WITHIN(double(image.at(x, y).b), 2 * cosine, 1e-5);
        }
}

TEST(Pictures, ASmallSourceShowsTheSameAsADistantLightOfItsPower) {
    const Vec3d d = normalize(Vec3d{0.3, 0.5, 0.8});
    const double radius = 2;
    // The mean over a disc with a soft edge, by quadrature.
    const Lighting unit{"disc", {}, {}, {}, {{d, radius, {1, 1, 1}}}};
    double power = 0;
    const double cap = 2 * k_pi * (1 - std::cos(radius * k_degree));
    for (int i = 0; i < 4000; ++i) {
        const double z = 1 - (i + 0.5) / 4000 * (1 - std::cos(radius * k_degree));
        const Vec3d across = normalize(cross(d, Vec3d{0, 1, 0}));
        power += double(radiance(unit, z * d + std::sqrt(1 - z * z) * across).r) * cap / 4000;
    }
    const auto e = float(power);
    const Lighting lights[] = {unit, {"light", {}, {}, {}, {{d, 0, {e, e, e}}}}};
    const Evaluate brdfs[] = {glossy(20)};
    const auto images = sphere_pictures(brdfs, lights);
    // The means over the sphere agree: points of the mixture seldom meet so small a source, and then count little.
    double disc_sum = 0, light_sum = 0;
    for (std::size_t i = 0; i < images[0][0].pixels.size(); ++i) {
        disc_sum += double(images[0][0].pixels[i].g);
        light_sum += double(images[1][0].pixels[i].g);
    }
    EXPECT_WITHIN(disc_sum, light_sum, 0.02 * light_sum);
}

TEST(Pictures, IsotropicBrdfsMayShareValues) {
    const Evaluate brdfs[] = {glossy(100), glossy(90)};
    const auto one_by_one = sphere_pictures(brdfs, standard_lightings(), 24),
               shared = sphere_pictures(brdfs, standard_lightings(), 24, 0, {}, k_mirror_points, true);
    for (std::size_t k = 0; k < shared.size(); ++k)
        for (std::size_t brdf = 0; brdf < 2; ++brdf)
            for (std::size_t i = 0; i < shared[k][brdf].pixels.size(); ++i) {
                const float L = one_by_one[k][brdf].pixels[i].g;
                EXPECT_WITHIN(shared[k][brdf].pixels[i].g, L, 1e-4 * double(L));
            }
}

TEST(Pictures, PointsWithoutMeasurementAreBlackInBoth) {
    const Evaluate holey = pairwise([](Vec3f wl, Vec3f) { return grey(wl.z < 0.5f ? NAN : 1); });
    const Evaluate others[] = {constant_brdf({1, 1, 1})};
    const Appearance same = compare_pictures(holey, others)[0];
    EXPECT_LE(same.mean.delta_e, 1e-3);
    EXPECT_LE(same.mean.rms, 1e-6);
}

TEST(Pictures, ErrorsAreZeroForTheSameBrdfAndGrowWithTheDifference) {
    const Evaluate others[] = {glossy(40), glossy(44), glossy(60), constant_brdf({0.3f, 0.3f, 0.3f})};
    const auto all = compare_pictures(glossy(40), others);
    EXPECT_EQ(all[0].mean.delta_e, 0);
    EXPECT_EQ(all[0].mean.flip, 0);
    EXPECT_EQ(all[0].mean.rms, 0);
    EXPECT_EQ(all[0].mean.psnr, 100);
    for (std::size_t k = 1; k < all.size(); ++k) {
        EXPECT_GT(all[k].mean.delta_e, all[k - 1].mean.delta_e);
        EXPECT_GT(all[k].mean.flip, all[k - 1].mean.flip);
        EXPECT_GT(all[k].mean.rms, all[k - 1].mean.rms);
        EXPECT_LT(all[k].mean.psnr, all[k - 1].mean.psnr);
        EXPECT_GE(all[k].worst_delta_e, all[k].mean.delta_e);
        EXPECT_EQ(all[k].lighting.size(), standard_lightings().size());
    }
}

TEST(Pictures, OnlyBrightnessRelativeToTheReferenceMatters) {
    const auto brightened = [](float factor) {
        return with_values(glossy(40), [factor](const Rgb& f) { return scaled(factor, f); });
    };
    const Evaluate tenth_more[] = {brightened(1.1f)}, tenth_more_of_100[] = {brightened(110)};
    const Appearance a = compare_pictures(brightened(1), tenth_more)[0],
                     b = compare_pictures(brightened(100), tenth_more_of_100)[0];
    EXPECT_WITHIN(a.mean.delta_e, b.mean.delta_e, 1e-3);
    EXPECT_WITHIN(a.mean.rms, 0.1, 1e-5);
    EXPECT_WITHIN(b.mean.rms, 0.1, 1e-5);
    // A tenth more light is seen, and not much: a few just noticeable differences.
    EXPECT_GT(a.mean.delta_e, 1);
    EXPECT_LT(a.mean.delta_e, 10);
}

TEST(DeltaEItp, KnownColoursMatchTheStandard) {
    // White of 100 cd/m² has I = 0.508 on the perceptual quantiser's scale, black 7e-7; grey is neither red nor blue.
    EXPECT_WITHIN(delta_e_itp({1, 1, 1}, {0, 0, 0}), 720 * 0.50808, 0.1);
    EXPECT_EQ(delta_e_itp({0.2f, 0.3f, 0.4f}, {0.2f, 0.3f, 0.4f}), 0);
    EXPECT_WITHIN(delta_e_itp({0.2f, 0.3f, 0.4f}, {0.5f, 0.1f, 0}), delta_e_itp({0.5f, 0.1f, 0}, {0.2f, 0.3f, 0.4f}),
                  1e-9);
    // Hue counts: red and green of one luminance are far apart.
    EXPECT_GT(delta_e_itp({0.5f, 0, 0}, {0, 0.1486f, 0}), 100);
}

}  // namespace
}  // namespace srbf::pictures_test
