// Conversion of spectra to colours: white, known colours, linearity.
#include "brdf/colour.h"
#include "properties.h"

namespace srbf::colour_test {
namespace {

/// Wavelengths at equal steps [nm].
std::vector<float> every(float step, float first = 400, float last = 700) {
    std::vector<float> wavelengths;
    for (float nm = first; nm <= last; nm += step) wavelengths.push_back(nm);
    return wavelengths;
}

TEST(Colour, WhiteReflectorIsWhite) {
    // Values of ASTM E308 for 5 nm.
    const Xyz white = white_point();
    EXPECT_WITHIN(white.x, 0.95047, 2e-4);
    EXPECT_WITHIN(white.y, 1, 1e-12);
    EXPECT_WITHIN(white.z, 1.08883, 2e-4);
    for (const auto& nm :
         {every(10), every(5, 360, 830), every(1, 380, 780), std::vector<float>{550}, every(37, 300, 1100)}) {
        Rgb sum;
        for (const Rgb& weight : rgb_weights(nm))
            for (int c = 0; c < 3; ++c) sum[c] += weight[c];
        EXPECT_RGB_WITHIN(sum, (Rgb{1, 1, 1}), 3e-6);
    }
    EXPECT_RGB_WITHIN(to_rgb(white), (Rgb{1, 1, 1}), 1e-6);
}

TEST(Colour, PrimariesAreThoseOfSrgb) {
    const double chromaticity[3][2] = {{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}};
    for (int c = 0; c < 3; ++c) {
        const auto [x, y] = chromaticity[c];
        const Rgb primary = to_rgb(Xyz{x / y, 1, (1 - x - y) / y});
        for (int k = 0; k < 3; ++k) EXPECT_TRUE(k == c ? primary[k] > 1 : near(primary[k], 0, 2e-7));
    }
}

TEST(Colour, MonochromesLieWhereTheObserverSeesThem) {
    // 520 nm is outside of the sRGB gamut in green, 450 nm in blue, 620 nm in red.
    const auto colour_of = [](float nm) {
        const std::vector<float> three{nm - 5, nm, nm + 5};
        return rgb_weights(three)[1];
    };
    EXPECT_TRUE(colour_of(520).g > 0 && colour_of(520).r < 0);
    EXPECT_TRUE(colour_of(450).b > 0 && colour_of(450).g < 0);
    EXPECT_TRUE(colour_of(620).r > 0 && colour_of(620).g < 0);
    // Luminous efficiency peaks at 555 nm.
    EXPECT_GT(luminance(colour_of(555)), luminance(colour_of(540)));
    EXPECT_GT(luminance(colour_of(555)), luminance(colour_of(570)));
}

TEST(Colour, SmoothSpectraDoNotDependOnTheirSampling) {
    const auto colour_of = [](const std::vector<float>& nm) {
        std::vector<float> spectrum;
        for (const float wavelength : nm) spectrum.push_back(0.5f + 0.4f * std::sin(wavelength / 60));
        return to_rgb(spectrum, rgb_weights(nm));
    };
    const Rgb fine = colour_of(every(1, 360, 830)), coarse = colour_of(every(5, 360, 830));
    EXPECT_RGB_WITHIN(coarse, fine, 1e-3);
}

}  // namespace
}  // namespace srbf::colour_test
