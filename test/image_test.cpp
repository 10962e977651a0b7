// Images for display: captions, PNG, and the picture of a fit.
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

#include <algorithm>
#include <cstring>

#include "analytic_brdfs.h"
#include "app/image.h"
#include "errors/sphere.h"
#include "properties.h"
#include "srbf/file.h"
#include "temporary_folder.h"

namespace srbf::image_test {
namespace {

constexpr Rgb8 k_black{0, 0, 0}, k_white{255, 255, 255};

// Captions.

Image8 drawn_text(int width, int height, int x, int y, std::string_view text, int scale) {
    Image8 image(width, height, k_black);
    draw_text(image, x, y, text, k_white, scale);
    return image;
}

TEST(DrawText, InksEveryPrintableCharacterWithinItsBox) {
    for (char c = '!'; c <= '~'; ++c)
        for (const int scale : {1, 3}) {
            const std::string text(1, c);
            const Image8 image = drawn_text(40 * scale, 40 * scale, 10 * scale, 10 * scale, text, scale);
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
    EXPECT_EQ(drawn_text(30, 30, 5, 5, " ", 1), Image8(30, 30, k_black));
    EXPECT_EQ(drawn_text(30, 30, 5, 5, "", 1), Image8(30, 30, k_black));
}

TEST(DrawText, LeavesOutWhatLiesOutside) {
    const std::string_view text = "10 x difference, Qgjpqy";
    const Image8 complete = drawn_text(600, 300, 200, 100, text, 2);
    for (const auto& [x0, y0] : {std::pair(190, 90), {230, 104}, {205, 60}, {380, 95}, {100, 0}, {0, 200}}) {
        const Image8 cropped = drawn_text(60, 50, 200 - x0, 100 - y0, text, 2);
        for (int y = 0; y < cropped.height; ++y)
            for (int x = 0; x < cropped.width; ++x) EXPECT_EQ(cropped.at(x, y), complete.at(x0 + x, y0 + y));
    }
    Image8 nothing;
    draw_text(nothing, 0, 0, text, k_white);
    for (const int far : {std::numeric_limits<int>::min(), std::numeric_limits<int>::max()})
        EXPECT_EQ(drawn_text(9, 9, far, 0, text, 4), Image8(9, 9));
}

TEST(DrawText, ShowsOtherBytesAsQuestionMarks) {
    EXPECT_EQ(drawn_text(200, 20, 1, 1, "a\xc3\xa9\n\x7f\x01z", 1), drawn_text(200, 20, 1, 1, "a?????z", 1));
    EXPECT_EQ(text_width("\xff\x80"), text_width("??"));
}

TEST(DrawText, WritesLongLinesToTheirEnd) {
    const std::string text(3000, 'X');  // it has more strokes than any other
    const int width = text_width(text);
    const Image8 image = drawn_text(width, 12, 0, 0, text, 1);
    for (int y = 0; y < 12; ++y)
        for (int x = 0; x < width / 3000; ++x) EXPECT_EQ(image.at(x, y), image.at(width - width / 3000 + x, y));
    EXPECT_NE(image, Image8(width, 12));
}

// PNG.

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
    const TemporaryFolder folder;
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
    const TemporaryFolder folder;
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
        int max = 0;
        for (std::size_t i = 0; i < image.pixels.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c)
                max = std::max(max, std::abs(int(back.pixels[i][c]) - int(image.pixels[i][c])));
        EXPECT_LE(max, furthest) << quality;
        EXPECT_GT(max, 0) << quality;
    }
}

using analytic_brdfs::Glossy, analytic_brdfs::Lambert;

// Previews.

constexpr int k_size = 48;

/// Pixel (x, y) of one of a preview's three squares.
Rgb8 pixel(const Image8& image, int square, int x, int y) { return image.at(square * k_size + x, y); }

/// One of the three squares, without its caption.
Image8 square(const Image8& image, int index) {
    Image8 out(k_size, k_size);
    for (int y = 0; y < k_size; ++y)
        for (int x = 0; x < k_size; ++x) out.at(x, y) = pixel(image, index, x, y);
    return out;
}

template <typename A, typename B> Image8 small_preview(const A& measured, const B& fit, PreviewOptions options = {}) {
    options.size = k_size;
    return preview(evaluator(measured), evaluator(fit), options);
}

/// Pixels inside of the sphere, away from its edge.
template <typename Visit> void for_each_inside(const Visit& visit) {
    for (int y = 0; y < k_size; ++y)
        for (int x = 0; x < k_size; ++x)
            if (std::hypot(x + 0.5 - k_size / 2.0, y + 0.5 - k_size / 2.0) < 0.85 * k_size / 2) visit(x, y);
}

TEST(Preview, DifferenceOfEqualBrdfsIsBlack) {
    const Glossy glossy;
    const Image8 image = small_preview(glossy, glossy);
    EXPECT_EQ(square(image, 0), square(image, 1));
    for_each_inside([&](int x, int y) { EXPECT_EQ(pixel(image, 2, x, y), k_black); });
}

TEST(Preview, ShowsTenTimesTheDifferenceAtTheExposureOfTheMeasured) {
    const Glossy measured, low{0.97f}, high{1.04f};
    const auto studio = std::ranges::find(standard_lightings(), "studio", &Lighting::name);
    const Evaluate brdf[] = {evaluator(measured)};
    const Image truth = sphere_pictures(brdf, {&*studio, 1}, k_size)[0][0];
    const float exposure = exposure_to(truth, k_exposed_value);
    const auto displayed = [&](const Rgb& l, float factor) {
        factor *= exposure;
        return to_srgb8({factor * l.r, factor * l.g, factor * l.b});
    };
    for (const Glossy& fit : {low, high}) {
        const Image8 image = small_preview(measured, fit);
        const float factor = 10 * std::abs(fit.scale - 1);
        for_each_inside([&](int x, int y) {
            const Rgb8 expected = displayed(truth.at(x, y), factor);
            EXPECT_EQ(pixel(image, 0, x, y), displayed(truth.at(x, y), 1));
            EXPECT_RGB_WITHIN(pixel(image, 2, x, y), expected, 1);
        });
    }
    EXPECT_EQ(square(small_preview(measured, low), 0), square(small_preview(measured, Glossy{1000}), 0));
    // A common factor is exposed away.
    EXPECT_EQ(small_preview(Glossy{16}, Glossy{8}), small_preview(Glossy{1}, Glossy{0.5f}));
}

TEST(Preview, KeepsCaptionsInTheirStrips) {
    const Lambert grey{{0.5f, 0.5f, 0.5f}};
    const Image8 bare = small_preview(grey, grey, {.caption = ""}),
                 full = small_preview(grey, grey, {.caption = std::string(500, 'M')});
    EXPECT_NE(full, bare);
    for (int y = 0; y < full.height; ++y)
        for (int x = 0; x < full.width; ++x)
            if (y < k_size || x / k_size != 1) {
                EXPECT_EQ(full.at(x, y), bare.at(x, y));
            }
}

TEST(Preview, IsTheSameForAnyNumberOfThreads) {
    EXPECT_EQ(small_preview(Glossy{}, Glossy{0.9f}, {.threads = 1}),
              small_preview(Glossy{}, Glossy{0.9f}, {.threads = 2}));
}

}  // namespace
}  // namespace srbf::image_test
