// Tone mapping, exposure and lights of pictures.
#include <algorithm>
#include <limits>

#include "extras/render/scene.h"
#include "extras/render/tone.h"
#include "properties.h"

namespace srbf::render_test {
namespace {

constexpr float k_nan = std::numeric_limits<float>::quiet_NaN();
constexpr float k_infinity = std::numeric_limits<float>::infinity();
constexpr Rgb8 k_black{0, 0, 0}, k_white{255, 255, 255};

// Radiance is displayed on a screen by these functions.

TEST(SrgbEncoded, IsTheStandardsFunctionAndMonotone) {
    EXPECT_EQ(srgb_encoded(0), 0);
    EXPECT_WITHIN(srgb_encoded(1), 1, 1e-6);
    EXPECT_WITHIN(srgb_encoded(0.5), 0.7353570, 1e-6);
    EXPECT_WITHIN(srgb_encoded(0.2140411), 0.5, 1e-6);
    EXPECT_WITHIN(srgb_encoded(0.0031308), 0.04045, 1e-5);
    for (int i = 0; i < 20000; ++i) EXPECT_LE(srgb_encoded(i / 20000.0), srgb_encoded((i + 1) / 20000.0));
}

TEST(ToneMap, IsMonotoneOnGreysWithoutAKinkAndStaysBelowOne) {
    EXPECT_EQ(tone_map({}, 3), Rgb{});
    EXPECT_WITHIN(tone_map({1, 1, 1}, 1).g, 0.88, 1e-6);
    float last = 0;
    for (double x = 1e-4; x < 1e9; x *= 1.01) {
        const Rgb shown = tone_map({float(x), float(x), float(x)}, 1);
        EXPECT_TRUE(shown.r == shown.b && shown.r >= last && shown.r <= 1) << x;
        last = shown.r;
    }
    const auto grey = [](double x) { return double(tone_map({float(x), float(x), float(x)}, 1).r); };
    constexpr double step = 1.0 / 1024;
    EXPECT_WITHIN((grey(k_knee + step) - grey(k_knee)) / step, 1, 0.01);
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
    EXPECT_WITHIN_RELATIVE(automatic_exposure(greys(values)), expected, 1e-6);

    std::mt19937_64 random(2);
    std::shuffle(values.begin(), values.end(), random);
    for (const float unlit : {0.0f, -1.0f, k_nan, k_infinity}) values.push_back(unlit);
    EXPECT_WITHIN_RELATIVE(automatic_exposure(greys(values)), expected, 1e-6);
    for (float& v : values) v *= v == 101 ? 1e6f : 8;  // a highlight counts by its size alone
    Image image = greys(values);
    EXPECT_WITHIN_RELATIVE(automatic_exposure(image), expected / 8, 1e-6);
    for (std::size_t i = 0; i < values.size(); ++i) image.pixels[i][int(i % 3)] *= 0.5f;  // the largest channel counts
    EXPECT_WITHIN_RELATIVE(automatic_exposure(image), expected / 8, 1e-6);
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

TEST(PreviewLights, AreUnitVectorsThatLightTheWholeVisibleHalf) {
    for (const auto& light : k_three_lights) EXPECT_WITHIN(dot(light.towards, light.towards), 1, 1e-15);
    const auto& [key, rim, fill] = k_three_lights;
    EXPECT_TRUE(key.towards.x < 0 && key.towards.y > 0 && key.towards.z > 0);
    EXPECT_TRUE(rim.towards.x > 0 && rim.towards.z < 0);
    EXPECT_WITHIN(std::acos(key.towards.z) / k_degree, 50, 0.5);
    EXPECT_WITHIN(std::acos(rim.towards.z) / k_degree, 115, 0.5);
    EXPECT_LT(fill.irradiance.g, key.irradiance.g);
}

}  // namespace
}  // namespace srbf::render_test
