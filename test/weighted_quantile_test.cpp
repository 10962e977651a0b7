// Quantiles against the definition, and where numbers coincide.
#include "base/weighted_quantile.h"

#include "properties.h"

namespace srbf::weighted_quantile_test {
namespace {

TEST(WeightedQuantile, IsTheFirstOfTheSortedThatReachesTheShare) {
    std::mt19937_64 random(7);
    for (int trial = 0; trial < 200; ++trial) {
        std::vector<std::pair<double, double>> weighted;
        double whole = 0;
        for (int i = 0; i <= trial; ++i) {
            const auto weight = std::floor(4 * uniform(random)) + (i == 0 ? 1 : 0);  // exact sums, some of them 0
            weighted.emplace_back(std::floor(20 * uniform(random)), weight);
            whole += weight;
        }
        const double fraction = (1 + std::floor(8 * uniform(random))) / 8;
        auto sorted = weighted;
        std::ranges::sort(sorted);
        double sum = 0;
        const auto reached = std::ranges::find_if(sorted, [&](const auto& pair) {
            sum += pair.second;
            return sum >= fraction * whole;
        });
        ASSERT_NE(reached, sorted.end());
        EXPECT_EQ(weighted_quantile(weighted, fraction), reached->first) << trial;
    }
}

TEST(WeightedQuantile, IsZeroWithoutValues) { EXPECT_EQ(weighted_quantile({}, 0.5), 0); }

}  // namespace
}  // namespace srbf::weighted_quantile_test
