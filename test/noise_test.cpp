// Fits of noisy measurements: the noise is found, and does not bias them.
#include <cstring>

#include "fitting/noise.h"
#include "measured_files.h"
#include "properties.h"
#include "srbf/pictures.h"

namespace srbf::noise_test {
namespace {

const Measured& bundled(const std::string& name) {
    static std::map<std::string, Measured> read;
    const auto at = read.find(name);
    if (at != read.end()) return at->second;
    return read.emplace(name, *load_measured((bundled_data() / (name + ".bsdf")).string())).first->second;
}

/// About normally distributed, of variance 1, and another number for any other directions or channel.
float noise_at(Vec3f wl, Vec3f wv, std::uint32_t channel) {
    const float numbers[] = {wl.x, wl.y, wl.z, wv.x, wv.y, wv.z};
    std::uint32_t words[7];
    std::memcpy(words, numbers, sizeof numbers);
    words[6] = channel;
    std::seed_seq seed(std::begin(words), std::end(words));
    std::uint32_t drawn[12];
    seed.generate(std::begin(drawn), std::end(drawn));
    float sum = -6;
    for (const std::uint32_t x : drawn) sum += float(x) / 4294967296.f;
    return sum;
}
Evaluate with_noise(const Measured& measured, float deviation) {
    return [&measured, deviation](std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
        evaluator(measured)(wl, wv, f);
        for (std::size_t i = 0; i < f.size(); ++i)
            for (int c = 0; c < 3; ++c) f[i][c] += deviation * noise_at(wl[i], wv[i], std::uint32_t(c));
    };
}

TEST(Noise, IsFound) {
    for (const float deviation : {0.02f, 0.3f}) {
        const Noise noise = noise_of(with_noise(bundled("paper_white_rgb"), deviation));
        for (int c = 0; c < 3; ++c) {
            EXPECT_TRUE(near(noise.deviation[c], deviation, 0.03 * deviation));
            EXPECT_TRUE(near(noise.level[c], 0.26f, 0.15f));
        }
    }
    EXPECT_TRUE(is_noisy(noise_of(with_noise(bundled("paper_white_rgb"), 0.3f))));
    for (const char* name : {"paper_white_rgb", "cc_ibiza_sunset_rgb"})
        EXPECT_FALSE(is_noisy(noise_of(evaluator(bundled(name))))) << name;
    EXPECT_EQ(noise_of([](auto, auto, std::span<Rgb> f) { std::ranges::fill(f, Rgb{}); }).share(), 0);
}

/// Noise as large as what it hides: a sixth of the values are below 0.
TEST(Noise, DoesNotBiasAFit) {
    const Measured& truth = bundled("paper_white_rgb");
    Fitter fitter(with_noise(truth, 0.28f));
    const auto outcome = fitter.fit({});
    ASSERT_TRUE(outcome);
    EXPECT_GT(outcome->noise->share(), 1);
    const Evaluate reference = evaluator(truth), fitted = evaluator(outcome->model);
    for (const double theta : {0.0, 30.0, 60.0}) {
        const double expected = luminance(albedo(reference, theta * k_degree, 89 * k_degree)),
                     found = luminance(albedo(fitted, theta * k_degree, 89 * k_degree));
        EXPECT_TRUE(near(found, expected, 0.05 * expected)) << theta;
    }
    EXPECT_LE(compare_pictures(reference, {&fitted, 1})[0].mean.delta_e, 3.3);  // without noise .8
}

}  // namespace
}  // namespace srbf::noise_test
