// Errors of pixels against the measure of pictures and their own differences.
#include "fit/pixels.h"

#include "properties.h"
#include "srbf/pictures.h"

namespace srbf::pixels_test {
namespace {

using Triplet = Pixels::Triplet;

double delta_e(const Triplet& a, const Triplet& b) {
    const auto rgb = [](const Triplet& x) { return Rgb{float(x[0]), float(x[1]), float(x[2])}; };
    return delta_e_itp(rgb(a), rgb(b));
}

TEST(Pixels, ErrorIsASquareWhereNothingIsSeenAndLinearBeyond) {
    Pixels pixels;
    const Triplet reference{0.3, 0.2, 0.05};
    pixels.add(reference);
    EXPECT_EQ(pixels.error(0, reference), 0);
    const Triplet near_it{0.3002, 0.2, 0.05}, far{0.6, 0.1, 0.3};
    const double little = delta_e(reference, near_it), much = delta_e(reference, far);
    ASSERT_LT(little, 0.1);
    ASSERT_GT(much, 30);
    EXPECT_TRUE(near_relative(pixels.delta_e(0, far), much, 1e-4));
    EXPECT_TRUE(near_relative(pixels.error(0, near_it), little * little, 0.01));
    EXPECT_TRUE(near_relative(pixels.error(0, far), 2 * (much - 1), 0.01));
}

TEST(Pixels, WhatBothClipIsEqual) {
    Pixels pixels;
    pixels.add({2, 0.5, 1.5});
    EXPECT_EQ(pixels.error(0, {1, 0.5, 7}), 0);
    EXPECT_GT(pixels.error(0, {0.9, 0.5, 1}), 0);
    EXPECT_GT(pixels.error(0, {2, 1.1, 2}), pixels.error(0, {2, 1, 2}));  // beyond white, where the reference is not
}

TEST(Pixels, SlopeIsThatOfTheError) {
    std::mt19937_64 random(3);
    for (int k = 0; k < 200; ++k) {
        const auto colour = [&] {
            Triplet x;
            for (double& channel : x) channel = 1.2 * std::pow(uniform(random), 3) + 1e-3;
            return x;
        };
        Pixels pixels;
        pixels.add(colour());
        const Triplet at = colour();
        Pixels::Slope slope;
        EXPECT_EQ(pixels.error(0, at, &slope), pixels.error(0, at));
        for (std::size_t c = 0; c < 3; ++c) {
            const double step = 1e-5 * at[c];
            Triplet more = at, less = at;
            more[c] += step, less[c] -= step;
            const double difference = (pixels.error(0, more) - pixels.error(0, less)) / (2 * step);
            EXPECT_TRUE(near(2 * slope.by_colour[c], difference, 1e-4 * std::abs(difference) + 1e-5));
            double product = 0;
            for (std::size_t i = 0; i < 3; ++i) product += slope.jacobian[i][c] * slope.r[i];
            EXPECT_TRUE(near(product, slope.by_colour[c], 1e-9 * std::abs(product)));
        }
    }
}

}  // namespace
}  // namespace srbf::pixels_test
