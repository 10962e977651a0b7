// The chi-square test itself: tabulated values, uniform p-values for a correct sampler, small ones for a wrong one.
#include "statistics.h"

#include "properties.h"

namespace srbf::statistics_test {
namespace {

TEST(Statistics, UpperGammaRatioAgreesWithTables) {
    // Critical values of the chi-square distribution: Q(dof/2, x/2).
    EXPECT_WITHIN(upper_gamma_ratio(0.5, 3.841459 / 2), 0.05, 1e-7);
    EXPECT_WITHIN(upper_gamma_ratio(5, 18.307038 / 2), 0.05, 1e-7);
    EXPECT_WITHIN(upper_gamma_ratio(5, 3.940299 / 2), 0.95, 1e-7);
    EXPECT_WITHIN(upper_gamma_ratio(50, 135.806723 / 2), 0.01, 1e-7);
    for (const double x : {0.0, 0.1, 1.0, 3.0, 30.0})
        EXPECT_WITHIN_RELATIVE(upper_gamma_ratio(1, x), std::exp(-x), 1e-12) << x;
    EXPECT_WITHIN(upper_gamma_ratio(3, 4 - 1e-9), upper_gamma_ratio(3, 4 + 1e-9), 1e-8);
}

TEST(Statistics, PValuesOfTheRightDistributionAreUniform) {
    std::mt19937_64 random(1);
    const std::vector<double> expected(20, 50.0);
    double below_tenth = 0, sum = 0;
    constexpr int trials = 2000;
    for (int trial = 0; trial < trials; ++trial) {
        std::vector<double> observed(20);
        for (int i = 0; i < 1000; ++i) observed[std::size_t(20 * uniform(random))] += 1;
        const double p = chi2_p_value(observed, expected);
        below_tenth += p < 0.1;
        sum += p;
    }
    EXPECT_WITHIN(below_tenth / trials, 0.1, 0.03);
    EXPECT_WITHIN(sum / trials, 0.5, 0.03);
}

TEST(Statistics, WrongDistributionsAreRejected) {
    std::mt19937_64 random(2);
    const PolarBins bins{{0, 0, 1}, {0, 0.5, 1, 1.5, 2}};
    const auto even = [](Vec3d) { return 1 / (4 * k_pi); };
    const auto tilted = [](Vec3d w) { return (1 + 0.2 * w.x) / (4 * k_pi); };
    const auto sample = [&] { return random_direction(random); };
    EXPECT_GT(sampler_p_value(bins, even, 20000, sample), 0.01);
    EXPECT_LT(sampler_p_value(bins, tilted, 20000, sample), 1e-6);
    // Samples that are not directions, and densities that do not integrate to 1.
    EXPECT_EQ(sampler_p_value(bins, even, 20000, [] { return Vec3d(NAN, 0, 0); }), 0);
    EXPECT_EQ(sampler_p_value(
                  bins, [](Vec3d) { return 1.02 / (4 * k_pi); }, 20000, sample),
              0);
    // Many samples where almost none are expected.
    EXPECT_LT(chi2_p_value(std::vector{50.0, 50.0}, std::vector{99.0, 1.0}), 1e-6);
    EXPECT_EQ(chi2_p_value(std::vector{NAN, 50.0}, std::vector{50.0, 50.0}), 0);
}

TEST(Statistics, SidakKeepsTheWholeSignificance) {
    EXPECT_WITHIN(sidak(0.01, 1), 0.01, 1e-15);
    EXPECT_WITHIN(1 - std::pow(1 - sidak(0.01, 64), 64), 0.01, 1e-12);
}

TEST(Statistics, PolarBinsCoverTheSphereOnce) {
    std::mt19937_64 random(3);
    const PolarBins bins{random_direction(random), {0, 1e-3, 0.1, 1, 2}, 5};
    const auto mass = bins.integrals([](Vec3d) { return 1.0; }, 4);
    for (std::size_t bin = 0; bin < bins.size(); ++bin) {
        const std::size_t ring = bin / 5;
        EXPECT_WITHIN_RELATIVE(mass[bin], 2 * k_pi / 5 * (bins.edge[ring + 1] - bins.edge[ring]), 1e-12);
    }
    // Each quadrature point lies in its own bin.
    std::vector<std::size_t> visits(bins.size());
    bins.integrals([&](Vec3d w) { return ++visits[bins.index(w)], 1.0; }, 4);
    for (const std::size_t v : visits) EXPECT_EQ(v, 16u);
}

}  // namespace
}  // namespace srbf::statistics_test
