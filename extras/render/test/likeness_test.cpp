// Perceptual differences of images.
#include "extras/render/likeness.h"

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

TEST(Likeness, APictureEqualsItself) {
    const Likeness same = likeness(pattern(), pattern());
    EXPECT_TRUE(std::isinf(same.psnr) && same.psnr > 0);
    EXPECT_WITHIN(same.ssim, 1, 1e-12);
    EXPECT_WITHIN(same.flip, 0, 1e-12);
}

TEST(Likeness, IsSymmetricAndWithinItsRange) {
    const Image8 a = pattern(), b = noisy(a, 60);
    const Likeness there = likeness(a, b), back = likeness(b, a);
    EXPECT_WITHIN(there.psnr, back.psnr, 1e-12);
    EXPECT_WITHIN(there.ssim, back.ssim, 1e-12);
    EXPECT_WITHIN(there.flip, back.flip, 1e-12);
    for (const double x : flip_map(a, b)) EXPECT_TRUE(x >= 0 && x <= 1);
    for (const double x : ssim_map(a, b)) EXPECT_TRUE(x >= -1 && x <= 1);
}

TEST(Likeness, FallsWithNoise) {
    double psnr = 1e9, ssim = 2, flip = -1;
    for (const int by : {2, 10, 40, 100}) {
        const Likeness found = likeness(pattern(), noisy(pattern(), by));
        EXPECT_LT(found.psnr, psnr);
        EXPECT_LT(found.ssim, ssim);
        EXPECT_GT(found.flip, flip);
        psnr = found.psnr;
        ssim = found.ssim;
        flip = found.flip;
    }
}

TEST(Likeness, PsnrAndSsimOfUniformPicturesMatchTheClosedForms) {
    const Likeness found = likeness(plain({51, 51, 51}), plain({102, 102, 102}));
    EXPECT_WITHIN(found.psnr, -20 * std::log10(0.2), 1e-9);
    EXPECT_WITHIN(found.ssim, (2 * 0.2 * 0.4 + 1e-4) / (0.04 + 0.16 + 1e-4), 1e-9);
    // One channel of three in one pixel.
    Image8 other = plain({51, 51, 51});
    other.at(3, 4)[1] = 102;
    EXPECT_WITHIN(likeness(plain({51, 51, 51}), other).psnr, -10 * std::log10(0.04 / (3 * 24 * 20)), 1e-9);
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
