// Pictures show the evaluated values: conversion to 8 bits, PNG, captions, and the spheres of a preview.
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <limits>

#include "properties.h"
#include "extras/render/preview.h"
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
    EXPECT_TRUE(near(srgb_encoded(0.5f), 0.7353570, 1e-6));
    EXPECT_TRUE(near(srgb_encoded(0.2140411f), 0.5, 1e-6));
    EXPECT_TRUE(near(srgb_encoded(0.0031308f), 0.04045, 1e-5));
    for (int i = 0; i < 20000; ++i) EXPECT_LE(srgb_encoded(float(i) / 20000), srgb_encoded(float(i + 1) / 20000));
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
    const double expected = double(k_knee) / (1 + 100 * k_exposed);
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
    EXPECT_GE(as_they_are, int(101 * k_exposed));
}

TEST(AutomaticExposure, IsOneInTheDarkAndFiniteAlways) {
    EXPECT_EQ(automatic_exposure(Image(4, 3)), 1);
    EXPECT_EQ(automatic_exposure(Image()), 1);
    EXPECT_EQ(automatic_exposure(greys({k_nan, 0, -2})), 1);
    const float dim = automatic_exposure(greys({std::numeric_limits<float>::denorm_min()}));
    EXPECT_TRUE(std::isfinite(dim) && dim > 1);
    EXPECT_NE(to_srgb8({0, 0, 0}, dim), k_not_measured);
}

// Captions.

Image8 written(int width, int height, int x, int y, std::string_view text, int scale) {
    Image8 image(width, height, k_black);
    draw_text(image, x, y, text, k_white, scale);
    return image;
}

TEST(DrawText, InksEveryPrintableCharacterWithinItsBox) {
    for (char c = '!'; c <= '~'; ++c)
        for (const int scale : {1, 3}) {
            const std::string text(1, c);
            const Image8 image = written(40 * scale, 40 * scale, 10 * scale, 10 * scale, text, scale);
            int ink = 0;
            for (int y = 0; y < image.height; ++y)
                for (int x = 0; x < image.width; ++x) {
                    if (image.at(x, y) == k_black) continue;
                    ++ink;
                    EXPECT_TRUE(x / scale >= 10 && x / scale < 10 + text_width(text)) << c;
                    EXPECT_TRUE(y / scale >= 10 && y / scale < 22) << c;
                }
            EXPECT_GT(ink, 0) << c;
            EXPECT_EQ(ink % (scale * scale), 0);
        }
    EXPECT_EQ(written(30, 30, 5, 5, " ", 1), Image8(30, 30, k_black));
    EXPECT_EQ(written(30, 30, 5, 5, "", 1), Image8(30, 30, k_black));
}

TEST(DrawText, LeavesOutWhatLiesOutside) {
    const std::string_view text = "10 x difference, Qgjpqy";
    const Image8 whole = written(600, 300, 200, 100, text, 2);
    for (const auto& [x0, y0] : {std::pair(190, 90), {230, 104}, {205, 60}, {380, 95}, {100, 0}, {0, 200}}) {
        const Image8 part = written(60, 50, 200 - x0, 100 - y0, text, 2);
        for (int y = 0; y < part.height; ++y)
            for (int x = 0; x < part.width; ++x) EXPECT_EQ(part.at(x, y), whole.at(x0 + x, y0 + y));
    }
    Image8 nothing;
    draw_text(nothing, 0, 0, text, k_white);
    for (const int far : {std::numeric_limits<int>::min(), std::numeric_limits<int>::max()})
        EXPECT_EQ(written(9, 9, far, 0, text, 4), Image8(9, 9));
}

TEST(DrawText, ShowsOtherBytesAsQuestionMarks) {
    EXPECT_EQ(written(200, 20, 1, 1, "a\xc3\xa9\n\x7f\x01z", 1), written(200, 20, 1, 1, "a?????z", 1));
    EXPECT_EQ(text_width("\xff\x80"), text_width("??"));
}

TEST(DrawText, WritesLongLinesToTheirEnd) {
    const std::string text(3000, 'X');  // it has more strokes than any other
    const int width = text_width(text);
    const Image8 image = written(width, 12, 0, 0, text, 1);
    for (int y = 0; y < 12; ++y)
        for (int x = 0; x < width / 3000; ++x) EXPECT_EQ(image.at(x, y), image.at(width - width / 3000 + x, y));
    EXPECT_NE(image, Image8(width, 12));
}

// PNG.

/// An empty folder, removed with what it holds.
struct Folder {
    std::filesystem::path path;
    explicit Folder(const std::string& name)
        : path(std::filesystem::temp_directory_path() / ("srbf_render_" + name + std::to_string(::getpid()))) {
        std::filesystem::create_directory(path);
    }
    ~Folder() { std::filesystem::remove_all(path); }
    std::string operator/(const char* name) const { return (path / name).string(); }
    bool empty() const { return std::filesystem::is_empty(path); }
};

Image8 decoded(const std::string& path) {
    int width = 0, height = 0, channels = 0;
    stbi_uc* data = stbi_load(path.c_str(), &width, &height, &channels, 3);
    Image8 image(width, height);
    if (data) std::memcpy(image.pixels.data(), data, 3 * image.pixels.size());
    stbi_image_free(data);
    EXPECT_EQ(channels, 3);
    return image;
}

TEST(WritePng, DecodesToTheSamePixels) {
    const Folder folder("png");
    std::mt19937_64 random(3);
    for (const auto& [width, height] : {std::pair(1, 1), {3, 7}, {641, 5}, {2, 300}, {100, 100}}) {
        Image8 image(width, height);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                image.at(x, y) = y % 2 ? Rgb8{std::uint8_t(x), std::uint8_t(y), 7}
                                       : Rgb8{std::uint8_t(random()), std::uint8_t(random()), 0};
        ASSERT_TRUE(write_png(image, folder / "a.png").ok());
        EXPECT_EQ(decoded(folder / "a.png"), image);
    }
}

TEST(Jpeg, IsTheImageUpToItsQuality) {
    const Folder folder("jpeg");
    Image8 image(50, 30);
    for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 50; ++x)
            image.at(x, y) = {std::uint8_t(5 * x), std::uint8_t(8 * y), std::uint8_t(255 - 5 * x)};
    std::size_t bytes_before = 0;
    for (const auto& [quality, furthest] : {std::pair(50, 20), {95, 6}}) {
        const std::vector<std::byte> bytes = jpeg(image, quality);
        EXPECT_GT(bytes.size(), bytes_before);
        bytes_before = bytes.size();
        ASSERT_TRUE(write_file(folder / "a.jpg", bytes).ok());
        const Image8 back = decoded(folder / "a.jpg");
        ASSERT_EQ(std::pair(back.width, back.height), std::pair(50, 30));
        int most = 0;
        for (std::size_t i = 0; i < image.pixels.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c)
                most = std::max(most, std::abs(int(back.pixels[i][c]) - int(image.pixels[i][c])));
        EXPECT_LE(most, furthest) << quality;
        EXPECT_GT(most, 0) << quality;
    }
}

TEST(WritePng, FailsWithoutATrace) {
    const Folder folder("png_failure");
    const Image8 image(2, 2);
    const auto missing = write_png(image, folder / "missing/a.png");
    ASSERT_FALSE(missing.ok());
    EXPECT_EQ(missing.error().source, folder / "missing/a.png");
    EXPECT_FALSE(write_png(image, folder.path.string()).ok());
    for (const auto& none : {Image8(), Image8(0, 5), Image8(5, 0)})
        EXPECT_FALSE(write_png(none, folder / "a.png").ok());
    EXPECT_TRUE(folder.empty());
}

// Spheres.

struct Lambert {
    Rgb albedo;
};
Rgb value(const Lambert& b, Vec3f wl, Vec3f wv) {
    if (wl.z <= 0 || wv.z <= 0) return {};
    return {float(b.albedo.r / k_pi), float(b.albedo.g / k_pi), float(b.albedo.b / k_pi)};
}

/// A glossy one, sharp and far from symmetric, that has no value where `hole` says so.
struct Glossy {
    float scale = 1;
    bool (*hole)(Vec3f wl, Vec3f wv) = [](Vec3f, Vec3f) { return false; };
};
Rgb value(const Glossy& b, Vec3f wl, Vec3f wv) {
    if (b.hole(wl, wv)) return {k_nan, k_nan, k_nan};
    if (wl.z <= 0 || wv.z <= 0) return {};
    const Vec3f h = normalize(wl + wv);
    const float peak = std::exp(-300 * (1 - h.z)), brushed = std::exp(-40 * h.x * h.x);
    return {b.scale * (0.05f + 9 * peak), b.scale * (0.02f + 8 * peak), b.scale * (0.2f * brushed + 7 * peak)};
}

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

// Previews.

constexpr int k_size = 48;

/// Pixel (x, y) of one of a preview's three squares.
Rgb8 pixel(const Image8& image, int square, int x, int y) { return image.at(square * k_size + x, y); }

/// One of them, without its caption.
Image8 square(const Image8& image, int which) {
    Image8 out(k_size, k_size);
    for (int y = 0; y < k_size; ++y)
        for (int x = 0; x < k_size; ++x) out.at(x, y) = pixel(image, which, x, y);
    return out;
}

template <typename A, typename B> Image8 small_preview(const A& measured, const B& fit, PreviewOptions options = {}) {
    options.size = k_size;
    options.samples = 2;
    return preview(evaluator(measured), evaluator(fit), options);
}

/// Pixels inside of the sphere, away from its edge.
template <typename Visit> void for_each_inside(const Visit& visit) {
    for (int y = 0; y < k_size; ++y)
        for (int x = 0; x < k_size; ++x)
            if (std::hypot(x + 0.5 - k_size / 2.0, y + 0.5 - k_size / 2.0) < 0.85 * k_size / 2) visit(x, y);
}

TEST(Preview, IsThreeSquaresWithCaptions) {
    const Lambert lambert{{0.5f, 0.5f, 0.5f}};
    const Image8 image = preview(evaluator(lambert), evaluator(lambert));
    EXPECT_EQ(image.width, 960);
    EXPECT_EQ(image.height, 360);
    const PreviewOptions plain;
    EXPECT_EQ(plain.captions[2], "10 x difference");
}

TEST(Preview, OfEqualBrdfsHasABlackDifference) {
    const Glossy glossy;
    const Image8 image = small_preview(glossy, glossy);
    EXPECT_EQ(square(image, 0), square(image, 1));
    for_each_inside([&](int x, int y) { EXPECT_EQ(pixel(image, 2, x, y), k_black); });
}

TEST(Preview, ShowsTenTimesTheDifferenceAtTheExposureOfTheMeasured) {
    const Glossy measured, low{0.97f}, high{1.04f};
    const Image truth = render_sphere(evaluator(measured), {k_size, 2, 0});
    const float exposure = automatic_exposure(truth);
    for (const Glossy& fit : {low, high}) {
        const Image8 image = small_preview(measured, fit);
        const float factor = 10 * std::abs(fit.scale - 1);
        for_each_inside([&](int x, int y) {
            const Rgb l = truth.at(x, y);
            const Rgb8 expected = to_srgb8({factor * l.r, factor * l.g, factor * l.b}, exposure);
            EXPECT_EQ(pixel(image, 0, x, y), to_srgb8(l, exposure));
            for (std::size_t c = 0; c < 3; ++c) EXPECT_TRUE(near(pixel(image, 2, x, y)[c], expected[c], 1));
        });
    }
    EXPECT_EQ(square(small_preview(measured, low), 0), square(small_preview(measured, Glossy{1000}), 0));
    // A common factor is exposed away.
    EXPECT_EQ(small_preview(Glossy{16}, Glossy{8}), small_preview(Glossy{1}, Glossy{0.5f}));
}

TEST(Preview, MarksWhatIsNotMeasured) {
    const Lambert grey{{0.5f, 0.5f, 0.5f}};
    const Glossy nothing{1, [](Vec3f, Vec3f) { return true; }};
    const Glossy partly{1, [](Vec3f, Vec3f wv) { return wv.z < 0.7f; }};
    const Image8 none = small_preview(nothing, grey), part = small_preview(partly, grey);
    for_each_inside([&](int x, int y) {
        EXPECT_EQ(pixel(none, 0, x, y), k_not_measured);
        EXPECT_EQ(pixel(none, 2, x, y), k_not_measured);
        EXPECT_NE(pixel(none, 1, x, y), k_not_measured);
        EXPECT_EQ(pixel(part, 0, x, y) == k_not_measured, pixel(part, 2, x, y) == k_not_measured);
    });
    EXPECT_EQ(pixel(part, 0, 6, k_size / 2), k_not_measured);
    EXPECT_NE(pixel(part, 0, k_size / 2, k_size / 2), k_not_measured);
    EXPECT_EQ(pixel(none, 0, 0, 0), pixel(none, 1, 0, 0));
}

TEST(Preview, OfBlackIsBlack) {
    const Lambert black{};
    const Image8 image = small_preview(black, black);
    for_each_inside([&](int x, int y) { EXPECT_EQ(pixel(image, 0, x, y), k_black); });
}

TEST(Preview, KeepsCaptionsInTheirStrips) {
    const Lambert grey{{0.5f, 0.5f, 0.5f}};
    PreviewOptions options;
    options.captions = {"", "", ""};
    const Image8 bare = small_preview(grey, grey, options);
    options.captions[1] = std::string(500, 'M');
    const Image8 full = small_preview(grey, grey, options);
    EXPECT_NE(full, bare);
    for (int y = 0; y < full.height; ++y)
        for (int x = 0; x < full.width; ++x)
            if (y < k_size || x / k_size != 1) {
                EXPECT_EQ(full.at(x, y), bare.at(x, y));
            }
}

TEST(Preview, IsTheSameForAnyNumberOfThreads) {
    PreviewOptions one, two;
    one.threads = 1;
    two.threads = 2;
    EXPECT_EQ(small_preview(Glossy{}, Glossy{0.9f}, one), small_preview(Glossy{}, Glossy{0.9f}, two));
}

TEST(Preview, OfAMeasurementHasNoHoles) {
    const auto paper = load_measured((bundled_data() / "paper_white_rgb.bsdf").string());
    ASSERT_TRUE(paper.ok());
    const Image8 image = small_preview(*paper, *paper);
    int bright = 0;
    for_each_inside([&](int x, int y) {
        EXPECT_NE(pixel(image, 0, x, y), k_not_measured);
        bright += pixel(image, 0, x, y)[1] > 150;
    });
    EXPECT_GT(bright, k_size * k_size / 4);
}

}  // namespace
}  // namespace srbf::render_test
