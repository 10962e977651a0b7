// Pictures show the evaluated values: conversion to 8 bits, and a sphere.
#include <algorithm>
#include <atomic>
#include <limits>

#include "extras/render/sphere_picture.h"
#include "properties.h"
#include "shown_brdfs.h"
#include "srbf/file.h"
#include "srbf/measured.h"

namespace srbf::render_test {
namespace {

constexpr float k_nan = std::numeric_limits<float>::quiet_NaN();
constexpr float k_infinity = std::numeric_limits<float>::infinity();
constexpr Rgb8 k_black{0, 0, 0}, k_white{255, 255, 255};

// To the screen.

TEST(SrgbEncoded, IsTheStandardsFunctionAndMonotone) {
    EXPECT_EQ(srgb_encoded(0), 0);
    EXPECT_TRUE(near(srgb_encoded(1), 1, 1e-6));
    EXPECT_TRUE(near(srgb_encoded(0.5), 0.7353570, 1e-6));
    EXPECT_TRUE(near(srgb_encoded(0.2140411), 0.5, 1e-6));
    EXPECT_TRUE(near(srgb_encoded(0.0031308), 0.04045, 1e-5));
    for (int i = 0; i < 20000; ++i) EXPECT_LE(srgb_encoded(i / 20000.0), srgb_encoded((i + 1) / 20000.0));
}

TEST(ToneMap, IsItsFormula) {
    std::mt19937_64 random(1);
    for (int i = 0; i < 2000; ++i) {
        const float exposure = float(std::exp(8 * uniform(random) - 4));
        Rgb radiance;
        for (int c = 0; c < 3; ++c) radiance[c] = float(std::exp(14 * uniform(random) - 9) - 0.01);
        double x[3], m = 0;
        for (int c = 0; c < 3; ++c) m = std::max(m, x[c] = exposure * std::max(double(radiance[c]), 0.0));
        const double k = k_knee, s = k_whitening, shoulder = 1 - (1 - k) * (1 - k) / (m + 1 - 2 * k);
        const double g = 1 - 1 / (1 + s * (m - shoulder));
        const Rgb shown = tone_map(radiance, exposure);
        for (int c = 0; c < 3; ++c)
            EXPECT_TRUE(near(shown[c], m <= k ? x[c] : (1 - g) * x[c] * shoulder / m + g * shoulder, 2e-6));
    }
}

TEST(ToneMap, IsMonotoneOnGreysWithoutAKinkAndStaysBelowOne) {
    EXPECT_EQ(tone_map({}, 3), Rgb{});
    EXPECT_TRUE(near(tone_map({1, 1, 1}, 1).g, 0.88, 1e-6));
    float last = 0;
    for (double x = 1e-4; x < 1e9; x *= 1.01) {
        const Rgb shown = tone_map({float(x), float(x), float(x)}, 1);
        EXPECT_TRUE(shown.r == shown.b && shown.r >= last && shown.r <= 1) << x;
        last = shown.r;
    }
    const auto grey = [](double x) { return double(tone_map({float(x), float(x), float(x)}, 1).r); };
    constexpr double step = 1.0 / 1024;
    EXPECT_TRUE(near((grey(k_knee + step) - grey(k_knee)) / step, 1, 0.01));
}

TEST(ToneMap, KeepsTheOrderOfTheChannelsAndWhitens) {
    for (float exposure = 0.01f; exposure < 1e6f; exposure *= 1.5f) {
        const Rgb shown = tone_map({0.9f, 0.5f, 0.1f}, exposure);
        EXPECT_TRUE(shown.r >= shown.g && shown.g >= shown.b && shown.b >= 0 && shown.r <= 1);
    }
    EXPECT_EQ(to_srgb8({0.9f, 0.5f, 0.1f}, 1e7f), k_white);
}

TEST(ToSrgb8, TakesAnyFloat) {
    EXPECT_EQ(to_srgb8({}, 1), k_black);
    EXPECT_EQ(to_srgb8({1, 1, 1}), k_white);
    EXPECT_EQ(to_srgb8({1, 1, 1}, 1), to_srgb8({0.88f, 0.88f, 0.88f}));
    EXPECT_EQ(to_srgb8({0.5f, 0.2f, 0.05f}, 1), (Rgb8{188, 124, 63}));  // 187.5, 123.5, 63.2
    EXPECT_EQ(to_srgb8({-1, -k_infinity, -1e-30f}, 5), k_black);
    EXPECT_EQ(to_srgb8({k_infinity, k_infinity, k_infinity}, 1e-3f), k_white);
    EXPECT_EQ(to_srgb8({k_infinity, 0, 0}, 0), k_black);
    EXPECT_EQ(to_srgb8({1, 1, 1}, std::numeric_limits<float>::max()), k_white);
    EXPECT_EQ(to_srgb8({9, -3, k_infinity}), (Rgb8{255, 0, 255}));
    for (const Rgb& hole : {Rgb{k_nan, 0, 0}, Rgb{1, k_nan, 1}, Rgb{-1, k_infinity, k_nan}}) {
        EXPECT_EQ(to_srgb8(hole), k_not_measured);
        EXPECT_EQ(to_srgb8(hole, 2), k_not_measured);
    }
    for (int i = 0; i < 5000; ++i) {
        const float a = float(i) / 5000, b = float(i + 1) / 5000;
        EXPECT_LE(to_srgb8({a, a, a}), to_srgb8({b, b, b}));
    }
}

/// A row of greys.
Image greys(const std::vector<float>& values) {
    Image image(int(values.size()), 1);
    for (std::size_t i = 0; i < values.size(); ++i) image.pixels[i] = {values[i], values[i], values[i]};
    return image;
}

TEST(AutomaticExposure, TakesTheQuantileOfLitPixelsToTheKnee) {
    std::vector<float> values;
    for (int i = 1; i <= 101; ++i) values.push_back(float(i));
    const double expected = double(k_knee) / (1 + 100 * k_exposed_quantile);
    EXPECT_TRUE(near_relative(automatic_exposure(greys(values)), expected, 1e-6));

    std::mt19937_64 random(2);
    std::shuffle(values.begin(), values.end(), random);
    for (const float unlit : {0.0f, -1.0f, k_nan, k_infinity}) values.push_back(unlit);
    EXPECT_TRUE(near_relative(automatic_exposure(greys(values)), expected, 1e-6));
    for (float& v : values) v *= v == 101 ? 1e6f : 8;  // a highlight counts by its size alone
    Image image = greys(values);
    EXPECT_TRUE(near_relative(automatic_exposure(image), expected / 8, 1e-6));
    for (std::size_t i = 0; i < values.size(); ++i) image.pixels[i][int(i % 3)] *= 0.5f;  // the largest channel counts
    EXPECT_TRUE(near_relative(automatic_exposure(image), expected / 8, 1e-6));
    const float exposure = automatic_exposure(image);
    int as_they_are = 0;
    for (Rgb x : image.pixels) {
        const Rgb shown = tone_map(x, exposure);
        as_they_are += x.r > 0 && shown == Rgb{exposure * x.r, exposure * x.g, exposure * x.b};
    }
    EXPECT_GE(as_they_are, int(101 * k_exposed_quantile));
}

TEST(AutomaticExposure, IsOneInTheDarkAndFiniteAlways) {
    EXPECT_EQ(automatic_exposure(Image(4, 3)), 1);
    EXPECT_EQ(automatic_exposure(Image()), 1);
    EXPECT_EQ(automatic_exposure(greys({k_nan, 0, -2})), 1);
    const float dim = automatic_exposure(greys({std::numeric_limits<float>::denorm_min()}));
    EXPECT_TRUE(std::isfinite(dim) && dim > 1);
    EXPECT_NE(to_srgb8({0, 0, 0}, dim), k_not_measured);
}

// Spheres.

using shown_brdfs::Glossy, shown_brdfs::Lambert;

TEST(PreviewLights, AreUnitVectorsThatLightTheWholeVisibleHalf) {
    for (const auto& light : k_three_lights) EXPECT_TRUE(near(dot(light.towards, light.towards), 1, 1e-15));
    const auto& [key, rim, fill] = k_three_lights;
    EXPECT_TRUE(key.towards.x < 0 && key.towards.y > 0 && key.towards.z > 0);
    EXPECT_TRUE(rim.towards.x > 0 && rim.towards.z < 0);
    EXPECT_TRUE(near(std::acos(key.towards.z) / k_degree, 50, 0.5));
    EXPECT_TRUE(near(std::acos(rim.towards.z) / k_degree, 115, 0.5));
    EXPECT_LT(fill.irradiance.g, key.irradiance.g);
}

TEST(RenderSphere, OfLambertIsTheClosedForm) {
    const Lambert lambert{{0.8f, 0.5f, 0.2f}};
    for (const int samples : {1, 3}) {
        const SphereOptions options{45, samples, 0};
        const Image image = render_sphere(evaluator(lambert), options);
        const auto coverage = sphere_coverage(options);
        for (int y = 0; y < options.size; ++y)
            for (int x = 0; x < options.size; ++x) {
                Rgb sum;
                int hits = 0;
                for (int s = 0; s < samples * samples; ++s) {
                    // Pixels are squares of side 2/size; the sphere's radius is k_radius, y points up.
                    const double px = (x + (s % samples + 0.5) / samples) * 2 / options.size - 1;
                    const double py = 1 - (y + (s / samples + 0.5) / samples) * 2 / options.size;
                    const double nx = px / SphereOptions::k_radius, ny = py / SphereOptions::k_radius;
                    if (nx * nx + ny * ny >= 1) continue;
                    ++hits;
                    const Vec3d n{nx, ny, std::sqrt(1 - nx * nx - ny * ny)};
                    for (const auto& light : k_three_lights)
                        for (int c = 0; c < 3; ++c)
                            sum[c] += float(lambert.albedo[c] / k_pi * std::max(0.0, dot(n, light.towards)) *
                                            light.irradiance[c]);
                }
                const std::size_t i = std::size_t(y * options.size + x);
                EXPECT_EQ(coverage[i], float(hits) / float(samples * samples));
                for (int c = 0; c < 3; ++c)
                    EXPECT_TRUE(near(image.at(x, y)[c], sum[c] / float(std::max(1, hits)), 1e-6)) << x << ' ' << y;
            }
    }
}

TEST(RenderSphere, AsksInTheFrameOfTheLatitude) {
    // With one point per pixel, wl·wv identifies the light of a pixel; it is independent of the frame.
    const SphereOptions options{91, 1, 1};
    const auto view_cosine = [](int k) { return float(k_three_lights[std::size_t(k)].towards.z); };
    std::array<std::atomic<int>, 3> asked{};
    const Evaluate check = [&](std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
        for (std::size_t i = 0; i < f.size(); ++i) {
            EXPECT_TRUE(near(dot(wl[i], wl[i]), 1, 1e-6) && near(dot(wv[i], wv[i]), 1, 1e-6));
            EXPECT_TRUE(wl[i].z >= 0 && wv[i].z > 0);
            for (int k = 0; k < 3; ++k) asked[std::size_t(k)] += near(dot(wl[i], wv[i]), view_cosine(k), 1e-6);
            f[i] = {wl[i].x, wl[i].y, wv[i].y};
        }
    };
    const Image image = render_sphere(check, options);
    for (const auto& count : asked) EXPECT_GT(count, 300);
    // On the equator the bitangent is the vertical, in which the view has no part.
    for (int x = 10; x < 40; ++x) {
        const double nx = (2.0 * x + 1 - options.size) / (options.size * SphereOptions::k_radius);
        const Vec3d n{nx, 0, std::sqrt(1 - nx * nx)}, t{n.z, 0, -n.x};
        Rgb sum;
        for (const auto& [towards, irradiance] : k_three_lights) {
            const double e = std::max(0.0, dot(n, towards)) * irradiance.g;
            sum.r += float(e * dot(towards, t));
            sum.g += float(e * towards.y);
        }
        const Rgb pixel = image.at(x, 45);
        EXPECT_TRUE(near(pixel.r, sum.r, 1e-5) && near(pixel.g, sum.g, 1e-5) && near(pixel.b, 0, 1e-6));
    }
}

TEST(RenderSphere, IsTheSameForAnyNumberOfThreads) {
    const Glossy glossy;
    const Image one = render_sphere(evaluator(glossy), {64, 3, 1});
    for (const int threads : {0, 2, 5})
        EXPECT_EQ(render_sphere(evaluator(glossy), {64, 3, threads}).pixels, one.pixels);
}

TEST(SphereCoverage, AddsUpToTheDisc) {
    for (const int size : {16, 101}) {
        const auto coverage = sphere_coverage({size, 4, 0});
        double sum = 0;
        for (const float c : coverage) sum += c;
        const double radius = SphereOptions::k_radius * size / 2;
        EXPECT_TRUE(near_relative(sum, k_pi * radius * radius, 0.005));
        EXPECT_EQ(coverage.front(), 0);
        EXPECT_EQ(coverage[std::size_t(size / 2 * size + size / 2)], 1);
    }
}

}  // namespace
}  // namespace srbf::render_test
