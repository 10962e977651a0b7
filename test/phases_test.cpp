// Weights of radiance in pictures by one light.
#include "observe/directional_lights.h"

#include "brdf/directions.h"
#include "observe/observations.h"
#include "observe/pair_weights.h"
#include "properties.h"

namespace srbf::phases_test {
namespace {

/// A matt body under a coat.
Observations coated() {
    return *observe(
        [](auto wl, auto wv, auto f) {
            for (std::size_t i = 0; i < f.size(); ++i) {
                const Vec3f h = normalize(wl[i] + wv[i]);
                const float coat = elementary::exp(50 * (h.z - 1));
                f[i] = {0.1f + coat, 0.05f + coat, 0.02f + coat};
            }
        },
        {Objective::appearance, 0, 1 << 14, 0});
}
/// What is fitted has this relative error everywhere.
Evaluate with_error(const Observations& o, float error) {
    return [&o, error](auto, auto, auto f) {
        for (std::size_t i = 0; i < f.size(); ++i)
            f[i] = {(1 + error) * o.f[i].r, (1 + error) * o.f[i].g, (1 + error) * o.f[i].b};
    };
}
/// What the added weights cost, relative to the others, if `most` of the loss counts.
double added_cost(float error, double most = 1) {
    Observations o = coated();
    const Observations before = o;
    const Evaluate fitted = with_error(before, error);
    add_directional_lights(o, fitted, most * loss_of(before, fitted));
    EXPECT_TRUE(o.directional_light_weight.empty());
    double others = 0, added = 0;
    for (std::size_t i = 0; i < o.f.size(); ++i) {
        const double square = square_of(o.f[i]);
        others += before.weight[i] * square, added += (o.weight[i] - before.weight[i]) * square;
    }
    return added / others;
}

TEST(PhaseWeights, CostLessWhereNothingMatches) {
    const double small = added_cost(0.01f);
    EXPECT_GT(small, 1);
    EXPECT_TRUE(near_relative(added_cost(0.01f, 0.25), small / 4, 1e-9));
    EXPECT_TRUE(near(added_cost(0.2f), small, 1e-4 * small));
    EXPECT_TRUE(near(added_cost(0.5f), small / 4, 1e-4 * small));
    EXPECT_TRUE(near(added_cost(-1), small / 16, 1e-4 * small));
}

// Neither exposure nor the brightness of one phase against another matters.
TEST(PhaseWeights, AreRelativeToTheEnergyOfTheirPhase) {
    const Observations o = coated();
    std::vector<double> measure(o.f.size(), 1e-4);
    std::vector<Rgb> scaled = o.f;
    for (std::size_t i = 0; i < scaled.size(); ++i) {
        const bool backwards = dot(o.wl[i], o.wv[i]) > elementary::cos(k_pi / 4);  // whole phases
        for (int c = 0; c < 3; ++c) scaled[i][c] *= backwards ? 50.f : 2.f;
    }
    const std::vector<double> once = directional_light_weights(o.wl, o.wv, o.f, measure),
                              twice = directional_light_weights(o.wl, o.wv, scaled, measure);
    for (std::size_t i = 0; i < scaled.size(); ++i)
        ASSERT_TRUE(
            near(twice[i] * square_of(scaled[i]), once[i] * square_of(o.f[i]), 1e-5 * once[i] * square_of(o.f[i])))
            << i;
}

}  // namespace
}  // namespace srbf::phases_test
