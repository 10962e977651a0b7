// Perceptual differences of images.
#include "errors/image_errors.h"

#include <algorithm>

#include "properties.h"

namespace srbf::likeness_test {
namespace {

Image8 plain(Rgb8 colour, int width = 24, int height = 20) { return Image8(width, height, colour); }

Image8 pattern() {
    Image8 image(40, 30);
    for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 40; ++x)
            image.at(x, y) = {std::uint8_t(6 * x), std::uint8_t(8 * y), std::uint8_t((x / 5 + y / 5) % 2 * 200)};
    return image;
}
Image8 noisy(const Image8& image, int by) {
    std::mt19937_64 random(1);
    Image8 other = image;
    for (Rgb8& pixel : other.pixels)
        for (std::uint8_t& channel : pixel)
            channel = std::uint8_t(std::clamp(int(channel) + int(random() % std::uint64_t(2 * by + 1)) - by, 0, 255));
    return other;
}

TEST(Likeness, OfAPictureWithItself) {
    const Likeness same = likeness(pattern(), pattern());
    EXPECT_TRUE(std::isinf(same.psnr) && same.psnr > 0);
    EXPECT_TRUE(near(same.ssim, 1, 1e-12));
    EXPECT_TRUE(near(same.flip, 0, 1e-12));
}

TEST(Likeness, IsSymmetricAndWithinItsRange) {
    const Image8 a = pattern(), b = noisy(a, 60);
    const Likeness there = likeness(a, b), back = likeness(b, a);
    EXPECT_TRUE(near(there.psnr, back.psnr, 1e-12));
    EXPECT_TRUE(near(there.ssim, back.ssim, 1e-12));
    EXPECT_TRUE(near(there.flip, back.flip, 1e-12));
    for (const double x : flip_map(a, b)) EXPECT_TRUE(x >= 0 && x <= 1);
    for (const double x : ssim_map(a, b)) EXPECT_TRUE(x >= -1 && x <= 1);
}

TEST(Likeness, FallsWithNoise) {
    double psnr = 1e9, ssim = 2, flip = -1;
    for (const int by : {2, 10, 40, 100}) {
        const Likeness of = likeness(pattern(), noisy(pattern(), by));
        EXPECT_LT(of.psnr, psnr);
        EXPECT_LT(of.ssim, ssim);
        EXPECT_GT(of.flip, flip);
        psnr = of.psnr, ssim = of.ssim, flip = of.flip;
    }
}

TEST(Likeness, PsnrAndSsimOfPlainPictures) {
    const Likeness of = likeness(plain({51, 51, 51}), plain({102, 102, 102}));
    EXPECT_TRUE(near(of.psnr, -20 * std::log10(0.2), 1e-9));
    EXPECT_TRUE(near(of.ssim, (2 * 0.2 * 0.4 + 1e-4) / (0.04 + 0.16 + 1e-4), 1e-9));
    // One channel of three in one pixel.
    Image8 other = plain({51, 51, 51});
    other.at(3, 4)[1] = 102;
    EXPECT_TRUE(near(likeness(plain({51, 51, 51}), other).psnr, -10 * std::log10(0.04 / (3 * 24 * 20)), 1e-9));
}

TEST(Likeness, FlipOfPlainPictures) {
    // Green and blue have the largest distance: 1 by definition.
    for (const double x : flip_map(plain({0, 255, 0}), plain({0, 0, 255}))) EXPECT_TRUE(near(x, 1, 1e-4));
    // Black and white, a lightness difference of 100: to the power 0.7 25.119; the largest distance is 41.276.
    const double expected = 0.95 + 0.05 * (std::pow(100, 0.7) - 0.4 * 41.276) / (0.6 * 41.276);
    for (const double x : flip_map(plain({0, 0, 0}), plain({255, 255, 255}))) EXPECT_TRUE(near(x, expected, 1e-4));
    // Two greys below the knee: 0.95 / (0.4 cmax) |L - L'|^0.7, L = 116 (Y)^(1/3) - 16.
    const auto lightness = [](double v) { return 116 * std::cbrt(std::pow((v / 255 + 0.055) / 1.055, 2.4)) - 16; };
    const double grey = 0.95 * std::pow(lightness(140) - lightness(120), 0.7) / (0.4 * 41.276);
    for (const double x : flip_map(plain({120, 120, 120}), plain({140, 140, 140})))
        EXPECT_TRUE(near(x, grey, 1e-4)) << x << ' ' << grey;
}

TEST(Likeness, FlipSeesFeaturesMoreThanTheirColours) {
    // The same change of grey as a point, whose edges also count, and as a uniform image, filtered by distance.
    Image8 point = plain({120, 120, 120}, 60, 60), line = point;
    point.at(30, 30) = {255, 255, 255};
    for (int y = 0; y < 60; ++y) line.at(30, y) = {255, 255, 255};
    const auto of_point = flip_map(plain({120, 120, 120}, 60, 60), point),
               of_line = flip_map(plain({120, 120, 120}, 60, 60), line);
    const std::size_t middle = 30 * 60 + 30;
    EXPECT_GT(of_line[middle], of_point[middle]);
    EXPECT_GT(of_point[middle], 0.05);
    EXPECT_TRUE(near(of_point[0], 0, 1e-9));  // far from it
    // From a greater distance a point is less visible.
    const auto from_afar = flip_map(plain({120, 120, 120}, 60, 60), point, 4 * k_pixels_per_degree);
    EXPECT_LT(from_afar[middle], of_point[middle]);
}

TEST(Likeness, FalseColoursGrowLighter) {
    const Image8 image = in_false_colours({0, 0.25, 0.5, 0.75, 1}, 5, 1);
    for (int x = 0; x < 4; ++x) {
        const auto light = [&](int i) {
            return 299 * image.at(i, 0)[0] + 587 * image.at(i, 0)[1] + 114 * image.at(i, 0)[2];
        };
        EXPECT_LT(light(x), light(x + 1));
    }
}

}  // namespace
}  // namespace srbf::likeness_test
