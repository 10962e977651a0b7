// ꟻLIP of pictures whose value is known.
#include "errors/image_errors.h"
#include "properties.h"

namespace srbf::flip_test {
namespace {

constexpr Rgb k_grey{0.19f, 0.19f, 0.19f};
Image plain(Rgb colour, int width = 24, int height = 20) { return Image(width, height, colour); }

TEST(Flip, UniformPicturesMatchTheClosedForm) {
    // Green and blue have the largest distance: 1 by definition.
    for (const double x : flip_map(plain({0, 1, 0}), plain({0, 0, 1}))) EXPECT_WITHIN(x, 1, 1e-4);
    // Black and white, a lightness difference of 100: to the power 0.7 25.119; the largest distance is 41.276.
    const double expected = 0.95 + 0.05 * (std::pow(100, 0.7) - 0.4 * 41.276) / (0.6 * 41.276);
    for (const double x : flip_map(plain({0, 0, 0}), plain({1, 1, 1}))) EXPECT_WITHIN(x, expected, 1e-4);
    // Two greys below the knee: 0.95 / (0.4 cmax) |L - L'|^0.7, L = 116 (Y)^(1/3) - 16.
    const auto lightness = [](double y) { return 116 * std::cbrt(y) - 16; };
    const double grey = 0.95 * std::pow(lightness(0.27) - lightness(0.19), 0.7) / (0.4 * 41.276);
    for (const double x : flip_map(plain(k_grey), plain({0.27f, 0.27f, 0.27f}))) EXPECT_WITHIN(x, grey, 1e-4);
}

TEST(Flip, SeesFeaturesMoreThanTheirColours) {
    // The same change of grey as a point, whose edges also count, and as a uniform image, filtered by distance.
    Image point = plain(k_grey, 60, 60), line = point;
    point.at(30, 30) = {1, 1, 1};
    for (int y = 0; y < 60; ++y) line.at(30, y) = {1, 1, 1};
    const auto point_map = flip_map(plain(k_grey, 60, 60), point), line_map = flip_map(plain(k_grey, 60, 60), line);
    const std::size_t middle = 30 * 60 + 30;
    EXPECT_GT(line_map[middle], point_map[middle]);
    EXPECT_GT(point_map[middle], 0.05);
    EXPECT_WITHIN(point_map[0], 0, 1e-9);  // far from it
    // From a greater distance a point is less visible.
    const auto distant_map = flip_map(plain(k_grey, 60, 60), point, 4 * k_pixels_per_degree);
    EXPECT_LT(distant_map[middle], point_map[middle]);
}

}  // namespace
}  // namespace srbf::flip_test
