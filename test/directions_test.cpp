// Fibonacci sets and the mixture about the mirror direction.
#include "brdf/directions.h"

#include "properties.h"
#include "srbf/models/su.h"
#include "statistics.h"

namespace srbf::directions_test {
namespace {

TEST(Fibonacci, DirectionsMatchTheFormula) {
    for (const double theta_max : {10 * k_degree, 80 * k_degree, k_pi / 2, k_pi}) {
        for (const int n : {1, 2, 100, 1536}) {
            const auto all = fibonacci_directions(n, theta_max);
            ASSERT_EQ(all.size(), std::size_t(n));
            double mean = 0;
            for (int i = 0; i < n; ++i) {
                const Vec3d w = fibonacci_direction(i, n, theta_max);
                const double z = (i + 0.5) / n * (1 - std::cos(theta_max)) + std::cos(theta_max);
                const double phi = i * k_pi * (3 - std::sqrt(5.0)), r = std::sqrt(1 - z * z);
                EXPECT_WITHIN(w.x, r * std::cos(phi), 1e-12);
                EXPECT_WITHIN(w.y, r * std::sin(phi), 1e-12);
                EXPECT_WITHIN(w.z, z, 1e-15);
                EXPECT_WITHIN(dot(w, w), 1, 1e-15);
                EXPECT_GE(w.z, std::cos(theta_max));
                EXPECT_EQ(all[std::size_t(i)], to_float(w));
                mean += w.z / n;
            }
            EXPECT_WITHIN(mean, 0.5 * (1 + std::cos(theta_max)), 1e-12);
        }
    }
}

TEST(Uniform, IsUniformAndBelowOne) {
    std::mt19937_64 random(2);
    std::vector<double> observed(64);
    for (int i = 0; i < 64000; ++i) {
        const double u = uniform(random);
        ASSERT_TRUE(u >= 0 && u < 1);
        observed[std::size_t(64 * u)] += 1;
    }
    EXPECT_GT(chi2_p_value(observed, std::vector<double>(64, 1000)), 0.01);
    std::mt19937_64 twin(2), reference(2);
    EXPECT_EQ(uniform(twin), std::ldexp(double(reference() >> 11), -53));
}

/// Views, and rings about their mirror directions that resolve the sharpest lobe.
const std::vector<double> k_views{0, 0.6, 1.2, 1.5};
PolarBins bins_about(Vec3d axis) {
    PolarBins bins{axis, {0}};
    for (double t = 2.0 / (1 << 18); t < 1.99; t *= 2) bins.edge.push_back(t);
    bins.edge.push_back(1.5);
    std::sort(bins.edge.begin(), bins.edge.end());
    bins.edge.push_back(2);
    return bins;
}

TEST(MirrorMixture, DensityIntegratesToOneOverTheSphere) {
    for (const double theta_max : {40 * k_degree, 80 * k_degree, k_pi / 2}) {
        const MirrorMixture mixture(theta_max);
        for (const double view : k_views) {
            const Vec3d wv = spherical(view, 2.0);
            const auto mass = bins_about(mirror(wv)).integrals([&](Vec3d w) { return mixture.pdf(w, wv); });
            EXPECT_WITHIN(sum_of(mass), 1, 2e-3) << theta_max << ' ' << view;
        }
    }
}

TEST(MirrorMixture, SamplesFollowTheDensity) {
    std::mt19937_64 random(3);
    const double significance = sidak(0.01, 2 * int(k_views.size()));
    for (const double theta_max : {40 * k_degree, 80 * k_degree}) {
        const MirrorMixture mixture(theta_max);
        for (const double view : k_views) {
            const Vec3d wv = spherical(view, -1.0);
            const auto pdf = [&](Vec3d w) { return mixture.pdf(w, wv); };
            const auto sample = [&] {
                const double u0 = uniform(random), u1 = uniform(random), u2 = uniform(random);
                return mixture.sample(wv, u0, u1, u2);
            };
            EXPECT_GT(sampler_p_value(bins_about(mirror(wv)), pdf, 50000, sample), significance) << view;
        }
    }
}

TEST(Nearest, AgreesWithASearchOfAllDirections) {
    std::mt19937_64 random(5);
    for (const int n : {8, 9, 100, 1536}) {
        const auto set = fibonacci_directions(n, k_pi / 2);
        for (int trial = 0; trial < 300; ++trial) {
            // Samples themselves, the poles and directions below the horizon among them.
            const Vec3f w = trial == 0   ? Vec3f(0, 0, 1)
                            : trial == 1 ? Vec3f(0, 0, -1)
                            : trial < 20 ? set[std::size_t(trial % n)]
                                         : to_float(random_direction(random));
            std::vector<std::pair<float, std::uint16_t>> all;
            for (std::size_t i = 0; i < set.size(); ++i) {
                const Vec3f d = set[i] - w;
                all.emplace_back(dot(d, d), std::uint16_t(i));
            }
            std::sort(all.begin(), all.end());
            std::array<std::uint16_t, 8> nearest{};
            find_nearest(set, w, nearest);
            for (std::size_t k = 0; k < 8; ++k) EXPECT_EQ(nearest[k], all[k].second) << n << ' ' << trial << ' ' << k;
            std::array<std::uint16_t, 1> first{};
            find_nearest(set, w, first);
            EXPECT_EQ(first[0], all[0].second);
        }
    }
}

TEST(DirectionMaps, ATexelHoldsItsCentre) {
    for (const auto map : {DirectionMap::cube, DirectionMap::parabolic})
        for (const int size : {1, 2, 7, 128}) {
            for (std::size_t texel = 0; texel < texels(map, size); ++texel) {
                const Vec3f w = texel_direction(map, size, texel);
                EXPECT_WITHIN(double(dot(w, w)), 1, 1e-6);
                EXPECT_EQ(texel_of(map, size, w), texel) << size;
            }
        }
}

TEST(DirectionMaps, TexelsCoverTheHemisphere) {
    std::mt19937_64 random(6);
    for (const auto map : {DirectionMap::cube, DirectionMap::parabolic}) {
        const int size = 64;
        // Half the diagonal of a texel at the centre of the cube's face, and at the centre of the parabolic map, where
        // it is coarsest.
        const double widest = (map == DirectionMap::cube ? 1 : 2) * std::sqrt(2.0) / size;
        for (int trial = 0; trial < 20000; ++trial) {
            const Vec3d w = random_direction(random, map == DirectionMap::cube ? -1 : 0);
            const std::size_t texel = texel_of(map, size, to_float(w));
            ASSERT_LT(texel, texels(map, size));
            const Vec3d d = to_double(texel_direction(map, size, texel)) - w;
            EXPECT_LE(std::sqrt(dot(d, d)), 1.01 * widest);
        }
    }
}

TEST(DirectionMaps, FacesAreThoseOfOpenGl) {
    // The centres of the faces, and the corner of the first texel of face +x.
    const Vec3f centres[6] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    for (std::size_t face = 0; face < 6; ++face) EXPECT_EQ(texel_direction(DirectionMap::cube, 1, face), centres[face]);
    const Vec3f corner = texel_direction(DirectionMap::cube, 2, 0);
    EXPECT_TRUE(corner.x > 0 && corner.y > 0 && corner.z > 0);  // s along -z, t along -y, from -1 on
    EXPECT_LT(texel_direction(DirectionMap::cube, 2, 1).z, 0);
    EXPECT_LT(texel_direction(DirectionMap::cube, 2, 2).y, 0);
}

}  // namespace
}  // namespace srbf::directions_test
