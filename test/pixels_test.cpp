// Errors of pixels against the measure of pictures and their own differences.
#include "observe/pixels.h"

#include "errors/itp.h"
#include "errors/sphere.h"
#include "properties.h"

namespace srbf::pixels_test {
namespace {

using Triplet = Pixels::Triplet;

double delta_e(const Triplet& a, const Triplet& b) {
    const auto rgb = [](const Triplet& x) { return Rgb{float(x[0]), float(x[1]), float(x[2])}; };
    return delta_e_itp(rgb(a), rgb(b));
}

/// Pixels of a reference, and other colours of them.
struct Case {
    std::vector<Triplet> reference, other;
    Pixels pixels = Pixels(reference);
    /// The columns of the other colours from the first pixel of a block on.
    Aligned<float> columns(std::size_t block = 0) const {
        Aligned<float> columns(3 * k_block);
        for (std::size_t p = block * k_block; p < std::min(other.size(), (block + 1) * k_block); ++p)
            for (std::size_t c = 0; c < 3; ++c) columns[c * k_block + p % k_block] = float(other[p][c]);
        return columns;
    }
    static Pixels::Colours colours(const Aligned<float>& columns) {
        return {&columns[0], &columns[k_block], &columns[2 * k_block]};
    }
    double error(PixelSlopes& slopes, std::size_t block = 0) const {
        return pixels.errors(block, colours(columns(block)), slopes);
    }
};
double error(const Triplet& reference, const Triplet& other) {
    PixelSlopes slopes;
    return Case{{reference}, {other}}.error(slopes);
}

/// Returns the same error in double precision.
double exact_error(const Triplet& reference, Triplet other) {
    Triplet shown = reference;
    for (std::size_t c = 0; c < 3; ++c) {
        shown[c] = std::min(shown[c], 1.0);
        if (reference[c] >= 1) other[c] = std::min(other[c], 1.0);
    }
    const auto a = Itp<double>(shown).value(), b = Itp<double>(other).value();
    return 2 * (std::hypot(1, std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2])) - 1);
}

Triplet random_colour(std::mt19937_64& random) {
    Triplet x;
    for (double& channel : x) channel = 1.2 * std::pow(uniform(random), 3) + 1e-3;
    return x;
}

TEST(Pixels, ErrorIsQuadraticBelowTheVisibleThresholdAndLinearAbove) {
    const Triplet reference{0.3, 0.2, 0.05}, near_it{0.3005, 0.2, 0.05}, far{0.6, 0.1, 0.3};
    EXPECT_EQ(error(reference, reference), 0);
    const double little = delta_e(reference, near_it), much = delta_e(reference, far);
    ASSERT_LT(little, 0.1);
    ASSERT_GT(much, 30);
    EXPECT_WITHIN_RELATIVE(error(reference, near_it), little * little, 0.02);
    EXPECT_WITHIN_RELATIVE(error(reference, far), 2 * (much - 1), 0.01);
    const Case one{{reference}, {far}};
    const Aligned<float> columns = one.columns();
    EXPECT_WITHIN_RELATIVE(one.pixels.delta_e(0, Case::colours(columns)), much, 1e-4);
}

TEST(Pixels, ColoursThatBothClipAreEqual) {
    const Triplet reference{2, 0.5, 1.5};
    EXPECT_EQ(error(reference, {1, 0.5, 7}), 0);
    EXPECT_GT(error(reference, {0.9, 0.5, 1}), 0);
    EXPECT_GT(error(reference, {2, 1.1, 2}), error(reference, {2, 1, 2}));  // beyond white, where the reference is not
}

TEST(Pixels, ErrorsAreThoseOfEachPixel) {
    std::mt19937_64 random(5);
    Case one;
    double sum = 0;
    for (std::size_t p = 0; p < k_block + 100; ++p) {
        one.reference.push_back(random_colour(random));
        one.other.push_back(random_colour(random));
        sum += exact_error(one.reference.back(), one.other.back());
    }
    one.pixels = Pixels(one.reference);
    ASSERT_EQ(one.pixels.count(), one.reference.size());
    double block_sum = 0;
    PixelSlopes slopes;
    for (std::size_t block = 0; block < one.pixels.blocks(); ++block) block_sum += one.error(slopes, block);
    EXPECT_WITHIN_RELATIVE(block_sum, sum, 1e-5);
}

TEST(Pixels, SlopeIsThatOfTheError) {
    std::mt19937_64 random(3);
    Case one;
    for (int k = 0; k < 200; ++k) {
        one.reference.push_back(random_colour(random));
        one.other.push_back(random_colour(random));
    }
    one.pixels = Pixels(one.reference);
    PixelSlopes slopes;
    one.error(slopes);
    for (std::size_t p = 0; p < one.reference.size(); ++p) {
        const Triplet at = one.other[p];
        Triplet slope{}, difference{};
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t component = 0; component < 3; ++component)
                slope[c] += 2 * double(slopes.jacobian_of(component)[c][p]) * double(slopes.residual(component)[p]);
            const double step = 1e-5 * at[c];
            Triplet more = at, less = at;
            more[c] += step;
            less[c] -= step;
            difference[c] = (exact_error(one.reference[p], more) - exact_error(one.reference[p], less)) / (2 * step);
        }
        const double size = std::hypot(difference[0], difference[1], difference[2]);
        EXPECT_RGB_WITHIN(slope, difference, 1e-3 * size) << p;
    }
    // Nothing is seen beyond the last pixel.
    for (std::size_t p = one.reference.size(); p < k_block; ++p)
        for (std::size_t component = 0; component < 3; ++component) {
            EXPECT_EQ(slopes.residual(component)[p], 0);
            for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(slopes.jacobian_of(component)[c][p], 0);
        }
}

}  // namespace
}  // namespace srbf::pixels_test
