// Fits of noisy measurements: the noise is found, and does not bias them.
#include <bit>

#include "errors/picture_errors.h"
#include "fit/noise.h"
#include "measured_files.h"
#include "properties.h"
#include "srbf/convert.h"
#include "srbf/fit.h"

namespace srbf::noise_test {
namespace {

/// A number that is about normally distributed, of variance 1, and independent for each pair and channel.
float noise_at(Vec3f wl, Vec3f wv, std::uint32_t channel) {
    // splitmix64 of the bits of the numbers; the sum of twelve uniform numbers of 16 bits
    const auto mixed = [](std::uint64_t x) {
        x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
        x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
        return x ^ (x >> 31);
    };
    std::uint64_t state = channel;
    for (const float number : {wl.x, wl.y, wl.z, wv.x, wv.y, wv.z})
        state = mixed(state + 0x9e3779b97f4a7c15 + std::bit_cast<std::uint32_t>(number));
    float sum = -6;
    for (int i = 0; i < 3; ++i) {
        state = mixed(state + 0x9e3779b97f4a7c15);
        for (int shift = 0; shift < 64; shift += 16) sum += float((state >> shift) & 0xffff) / 65536.f;
    }
    return sum;
}
Evaluate with_noise(const Measured& measured, float deviation) {
    return [&measured, deviation](std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
        evaluator(measured)(wl, wv, f);
        for (std::size_t i = 0; i < f.size(); ++i)
            for (int c = 0; c < 3; ++c) f[i][c] += deviation * noise_at(wl[i], wv[i], std::uint32_t(c));
    };
}

double median(std::vector<double> x) {
    std::ranges::nth_element(x, x.begin() + std::ptrdiff_t(x.size() / 2));
    return x[x.size() / 2];
}

TEST(Noise, IsEstimated) {
    for (const float deviation : {0.02f, 0.3f}) {
        const Noise noise = noise_of(with_noise(bundled("paper_white_rgb"), deviation));
        for (int c = 0; c < 3; ++c) {
            EXPECT_WITHIN(noise.deviation[c], deviation, 0.03 * deviation);
            EXPECT_WITHIN(noise.level[c], 0.26f, 0.15f);
        }
    }
    EXPECT_TRUE(is_noisy(noise_of(with_noise(bundled("paper_white_rgb"), 0.3f))));
    for (const char* name : {"paper_white_rgb", "cc_ibiza_sunset_rgb"})
        EXPECT_FALSE(is_noisy(noise_of(evaluator(bundled(name))))) << name;
    EXPECT_EQ(fraction_of(noise_of([](auto, auto, std::span<Rgb> f) { std::ranges::fill(f, Rgb{}); })), 0);
}

/// Noise as large as the values, of which a sixth are below 0.
TEST(Noise, DoesNotBiasAFit) {
    const Measured& truth = bundled("paper_white_rgb");
    Fitter fitter(with_noise(truth, 0.28f));
    const auto outcome = checked(fitter.fit({.model = PmRequest{.effort = 0.1}}));
    EXPECT_GT(fraction_of(*outcome->noise), 1);
    const Evaluate reference = evaluator(truth), fitted = evaluator(outcome->model);
    for (const double theta : {0.0, 30.0, 60.0}) {
        const double expected = luminance(albedo(reference, theta * k_degree, 89 * k_degree)),
                     found = luminance(albedo(fitted, theta * k_degree, 89 * k_degree));
        EXPECT_WITHIN(found, expected, 0.05 * expected) << theta;
    }
    EXPECT_LE(compare_pictures(reference, {&fitted, 1})[0].mean.delta_e, 3.3);  // without noise .8
}

/// f at the nodes of MBSDF's layout.
MbsdfTable table_of(const Evaluate& f) {
    MbsdfTable table;
    table.polar = 45;
    table.azimuths = 61;
    std::vector<Vec3f> wl, wv;
    for (std::uint32_t i = 0; i < table.polar; ++i)
        for (std::uint32_t j = 0; j < table.polar; ++j)
            for (std::uint32_t k = 0; k < table.azimuths; ++k) {
                wl.push_back(to_float(spherical(k_pi / 2 / table.polar * i, 0.0)));
                wv.push_back(to_float(spherical(k_pi / 2 / table.polar * j, 3 * k_degree * k)));
            }
    table.cells.resize(wl.size());
    f(wl, wv, table.cells);
    return table;
}

/// The table has signed noise as large as its body, at its nodes.
TEST(Noise, IsHardlyLeftInASmoothedTable) {
    const Evaluate truth = evaluator(bundled("paper_white_rgb"));
    Measured measured{"", "", 0, table_of(truth)};
    EXPECT_FALSE(smoothed_to_noise(measured));
    auto& table = std::get<MbsdfTable>(measured.table);
    const std::vector<Rgb> clean = table.cells;
    std::mt19937_64 random(2);
    std::normal_distribution<float> normal;
    for (Rgb& cell : table.cells)
        for (int c = 0; c < 3; ++c) cell[c] += 0.28f * normal(random);
    const auto smooth = checked(smoothed_to_noise(measured));
    const MbsdfTable found = to_mbsdf(*smooth, {table.polar, table.azimuths, {}, 0});
    std::vector<double> before, after;
    for (std::uint32_t l = 0; l < 34; ++l)  // to 66°
        for (std::uint32_t v = 0; v < 34; ++v)
            for (std::uint32_t k = 0; k < table.azimuths; ++k) {
                const std::size_t i = (l * table.polar + v) * table.azimuths + k;
                before.push_back(std::abs(double(table.cells[i].g - clean[i].g)));
                after.push_back(std::abs(double(found.cells[i].g - clean[i].g)));
            }
    EXPECT_LT(median(after), 0.2 * median(before));
}

}  // namespace
}  // namespace srbf::noise_test
