// Coefficients of texels in a basis: the solver, and texels that were measured badly.
#include "extras/maps/test/texel_values.h"

namespace srbf::texel_coefficients_test {
namespace {

/// A map of one texel.
TexelMap map_of_one() {
    TexelMap map;
    map.basis = three_lobes();
    map.width = 1;
    map.error = {0};
    map.coefficient = {{0.25f, 0.2f, 0.1f}, {0, 0, 0}, {4, 4, 4}};
    return map;
}

class BadTexels : public testing::Test {
  protected:
    void SetUp() override {
        std::mt19937_64 random(5);
        for (std::size_t i = 0; i < 100; ++i) {
            const Vec3d v = random_direction(random, 0.2), l = random_direction(random, 0.2);
            pairs.wv.push_back(to_float(v));
            pairs.wl.push_back(i % 2 == 0 ? to_float(l) : to_float(normalize(Vec3d{-v.x, -v.y, v.z} + 0.1 * l)));
        }
        good.resize(pairs.wl.size());
        evaluate(texel(map, 0), pairs.wl, pairs.wv, good);
    }
    TexelCoefficients fit(std::span<const Rgb> f) const { return coefficients_of_texels(map, pairs, f, 1); }
    void expect_good(const TexelCoefficients& found, std::size_t t, float tolerance) const {
        EXPECT_EQ(found.state[t], TexelState::fitted);
        for (std::size_t j = 0; j < 3; ++j)
            EXPECT_RGB_WITHIN(found.coefficient[3 * t + j], map.coefficient[j], tolerance) << j;
    }
    void expect_dark(const TexelCoefficients& found, TexelState state, float error) const {
        EXPECT_EQ(found.state[0], state);
        EXPECT_EQ(found.error[0], error);
        for (const Rgb& beta : found.coefficient) EXPECT_EQ(beta, Rgb());
    }
    const TexelMap map = map_of_one();
    SharedPairs pairs;
    std::vector<Rgb> good;
};

TEST_F(BadTexels, ValuesThatWereNotMeasuredAreCountedAndLeftOut) {
    std::vector<Rgb> f = good;
    f[3].g = NAN;
    f[4].b = INFINITY;
    f[5] = {1e30f, 1e30f, 1e30f};
    const TexelCoefficients found = fit(f);
    EXPECT_EQ(found.left_out[0], 3u);
    expect_good(found, 0, 0.01f);
    std::ranges::fill(f, Rgb{NAN, 0, 0});
    expect_dark(fit(f), TexelState::failed, 1);
    std::ranges::fill(f, Rgb{-1, -1, 0});
    expect_dark(fit(f), TexelState::black, 0);
}

TEST_F(BadTexels, OneHotPixelHasLittleWeightAndATexelTooBrightFails) {
    std::vector<Rgb> f = good;
    f[6] = {1e9f, 1e9f, 1e9f};
    expect_good(fit(f), 0, 0.01f);
    f = good;
    for (Rgb& colour : f) colour.b *= 1e8f;
    expect_dark(fit(f), TexelState::failed, 1);
}

TEST_F(BadTexels, APairWithoutLightAndFewPairsSuffice) {
    constexpr std::size_t k_few = 17;
    pairs.wl.resize(k_few);
    pairs.wv.resize(k_few);
    std::vector<Rgb> f(good.begin(), good.begin() + k_few);
    pairs.wl.push_back({1, 0, -0.01f});
    pairs.wv.push_back({0, 0, 1});
    f.push_back({7, 7, 7});
    const TexelCoefficients found = fit(f);
    EXPECT_EQ(found.left_out[0], 0u);
    expect_good(found, 0, 0.01f);
}

TEST_F(BadTexels, ConstantTexelsAreConstant) {
    const TexelCoefficients found = fit(std::vector<Rgb>(good.size(), {0.1f, 0.2f, 0.3f}));
    EXPECT_RGB_WITHIN(found.coefficient[0], (Rgb{0.1f, 0.2f, 0.3f}), 1e-3f);
    for (std::size_t j = 1; j < 3; ++j) EXPECT_LT(found.coefficient[j].r, 1e-2f);
}

/// Texels of one call are fitted as each of them alone, wherever they are in a block.
TEST_F(BadTexels, TexelsDoNotDependOnEachOther) {
    std::vector<Rgb> f;
    const std::size_t count = 70, M = good.size();
    for (std::size_t t = 0; t < count; ++t)
        for (std::size_t i = 0; i < M; ++i) f.push_back(scaled(0.1f + float((t * i) % 7), good[i]));
    f[66 * M + 1] = {1e9f, 1e9f, 1e9f};
    const TexelCoefficients all = fit(f);
    for (const std::size_t t : {std::size_t(0), std::size_t(63), std::size_t(66), count - 1}) {
        const TexelCoefficients alone = fit(std::span(f).subspan(t * M, M));
        for (std::size_t j = 0; j < 3; ++j) EXPECT_EQ(alone.coefficient[j], all.coefficient[3 * t + j]) << t;
        EXPECT_EQ(alone.error[0], all.error[t]);
    }
}

}  // namespace
}  // namespace srbf::texel_coefficients_test
