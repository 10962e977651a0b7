// Observations: the values of a BRDF that a fit knows.
#include <map>

#include "errors/sphere.h"
#include "observe/observations.h"
#include "properties.h"
#include "srbf/kernel.h"

namespace srbf::observations_test {
namespace {

Evaluate constant(Rgb colour) {
    return [colour](auto, auto, auto f) { std::fill(f.begin(), f.end(), colour); };
}

std::size_t fitted(const Observations& o) { return o.f.size() - o.bound_pairs; }
bool within(const Observations& o, std::size_t i, double theta) {
    return std::min(double(o.wl[i].z), double(o.wv[i].z)) >= elementary::cos(theta) - 1e-6;
}

TEST(Observations, EstimateTheIntegralOfTheirObjective) {
    for (const Objective objective : {Objective::raw, Objective::cosine}) {
        const auto o = checked(observe(constant({1, 1, 1}), {objective, 80 * k_degree, 1 << 16, 3}));
        // Shares of Σ w with wl, or wv, within 50° of the normal: of dω for raw, of cos²θl dω and cosθv dω for cosine.
        double all = 0, near_l = 0, near_v = 0;
        for (std::size_t i = 0; i < fitted(*o); ++i) {
            if (!within(*o, i, 80 * k_degree)) continue;
            const double w = double(o->weight[i]);
            all += w;
            if (double(o->wl[i].z) > elementary::cos(50 * k_degree)) near_l += w;
            if (double(o->wv[i].z) > elementary::cos(50 * k_degree)) near_v += w;
        }
        const auto fraction = [](int power) {  // of ∫ μ^power dμ
            const double c = elementary::cos(80 * k_degree), d = elementary::cos(50 * k_degree);
            return (1 - elementary::pow(d, power + 1)) / (1 - elementary::pow(c, power + 1));
        };
        const bool raw = objective == Objective::raw;
        EXPECT_WITHIN_RELATIVE(near_l / all, fraction(raw ? 0 : 2), 0.01);
        EXPECT_WITHIN_RELATIVE(near_v / all, fraction(raw ? 0 : 1), 0.01);
        EXPECT_WITHIN(3 * all, 1, 0.05);  // Σ w |f|² = 1; the grid of horizon pairs adds a few pairs within the cap
    }
}

TEST(Observations, EveryPrefixIsARepresentativeSample) {
    const auto o = checked(observe(constant({1, 1, 1}), {Objective::raw, 80 * k_degree, 1 << 16, 0}));
    ASSERT_EQ(fitted(*o), std::size_t(1) << 16);
    double sum = 0;
    for (std::size_t i = 0; i < 4096; ++i) sum += 3 * double(o->weight[i]);
    EXPECT_WITHIN_RELATIVE(sum, 4096.0 / 65536, 0.1);
    std::size_t horizon_pairs = 0;
    for (std::size_t i = 0; i < 4096; ++i) horizon_pairs += !within(*o, i, 80 * k_degree);
    EXPECT_GT(horizon_pairs, 4096u / 16);
    EXPECT_LT(horizon_pairs, 4096u / 8 + 1);
}

// A highlight of half a degree contains nearly all of Σ w |f|². Sampled from the mixture alone, only a few dozen of
// 4096 pairs would lie in it.
TEST(Observations, AreDenseWhereTheEnergyIs) {
    const auto o = checked(observe(
        [](auto wl, auto wv, auto f) {
            for (std::size_t i = 0; i < f.size(); ++i) {
                const float g = Kernel<float>::gaussian(Kernel<float>::psi(wl[i], wv[i], 1, 1), {0, 0, 1}, 20000);
                f[i] = {0.01f + 300 * g, 0.01f + 300 * g, 0.01f + 300 * g};
            }
        },
        {Objective::raw, 0, 1 << 16, 2}));
    const auto energy = [&](std::size_t i) { return o->weight[i] * 3 * double(o->f[i].r) * double(o->f[i].r); };
    double all = 0, sum = 0, squares = 0;
    for (std::size_t i = 0; i < fitted(*o); ++i) all += energy(i);
    for (std::size_t i = 0; i < 4096; ++i) {
        sum += energy(i);
        squares += energy(i) * energy(i);
    }
    EXPECT_WITHIN(all, 1, 0.01);
    EXPECT_WITHIN_RELATIVE(sum, 4096.0 / double(fitted(*o)), 0.1);
    EXPECT_GT(sum * sum / squares, 600);

    // A beginning is scaled like the whole.
    const Observations few = first_pairs(*o, 4096);
    double few_energy = 0;
    for (std::size_t i = 0; i < 4096; ++i) few_energy += few.weight[i] * 3 * double(few.f[i].r) * double(few.f[i].r);
    EXPECT_WITHIN(few_energy, 1, 1e-6);
}

TEST(Observations, CosineObjectiveKeepsDarkValuesUnderAHighlight) {
    const Evaluate glossy = [](auto wl, auto wv, auto f) {
        for (std::size_t i = 0; i < f.size(); ++i) {
            const float x =
                0.1f + 1000 * Kernel<float>::gaussian(Kernel<float>::psi(wl[i], wv[i], 1, 1), {0, 0, 1}, 3000);
            f[i] = {x, x, x};
        }
    };
    // The fraction of the body in Σ w |f|²: almost none, and most with the additional weights.
    const auto fraction_of_body = [&](Objective objective) {
        const auto o = observe(glossy, {objective, 80 * k_degree, 1 << 16, 0});
        double fraction = 0;
        for (std::size_t i = 0; i < fitted(*o); ++i)
            if (within(*o, i, 80 * k_degree) && o->f[i].r < 0.2f)
                fraction += 3 * o->weight[i] * double(o->f[i].r) * double(o->f[i].r);
        return fraction;
    };
    EXPECT_LE(fraction_of_body(Objective::raw), 1e-4);
    EXPECT_GE(fraction_of_body(Objective::cosine), 0.001);
    EXPECT_LE(fraction_of_body(Objective::cosine), 0.005);
}

TEST(Observations, ReachTheHorizonAndItsCorners) {
    const auto o = checked(observe(constant({1, 1, 1}), {Objective::cosine, 0, 4096, 0}));
    double lowest = 1, lowest_both = 1;
    for (std::size_t i = 0; i < o->f.size(); ++i) {
        lowest = std::min(lowest, double(o->wl[i].z));
        lowest_both = std::min(lowest_both, double(std::max(o->wl[i].z, o->wv[i].z)));
        ASSERT_GT(o->wl[i].z, 0);
        ASSERT_GT(o->wv[i].z, 0);
    }
    EXPECT_LT(lowest, elementary::cos(89.89 * k_degree));
    EXPECT_LT(lowest_both, elementary::cos(89.89 * k_degree));
}

TEST(Observations, OmitMissingValuesAndClampNegativeOnes) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const auto o = checked(observe(
        [&](auto wl, auto, auto f) {
            for (std::size_t i = 0; i < f.size(); ++i) f[i] = wl[i].x < 0 ? Rgb{nan, nan, nan} : Rgb{-1, 1, 2};
        },
        {Objective::raw, 0, 4096, 0}));
    EXPECT_GT(o->masked, 1000u);
    EXPECT_GE(o->clamped, o->f.size());  // one channel of each, and of those drawn that were not chosen
    for (const Rgb& f : o->f) ASSERT_EQ(f, (Rgb{0, 1, 2}));
    for (const double w : o->weight) ASSERT_TRUE(std::isfinite(w) && w >= 0);
}

TEST(Observations, DependOnTheSeed) {
    const auto with = [](std::uint64_t seed) { return *observe(constant({1, 1, 1}), {Objective::raw, 0, 4096, seed}); };
    EXPECT_EQ(with(1).weight, with(1).weight);
    EXPECT_EQ(with(1).weight,
              observe(constant({1, 1, 1}), {Objective::raw, 0, 4096, 1, 1})->weight);  // whatever the threads
    EXPECT_NE(with(1).weight, with(2).weight);
}

TEST(Observations, ViewsOfPicturesAreExposedAndWithinTheCap) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const double theta_max = 80 * k_degree;
    const Evaluate f = [&](auto wl, auto wv, auto out) {
        for (std::size_t i = 0; i < out.size(); ++i)
            out[i] = wl[i].x < -0.9f ? Rgb{nan, nan, nan} : Rgb{-1, 0.2f, 0.1f + wl[i].z * wv[i].z};
    };
    EXPECT_TRUE(observe(f, {Objective::cosine, theta_max, 4096})->views.empty());
    const auto views = observe(f, {Objective::appearance, theta_max, 4096})->views;
    std::map<std::size_t, std::vector<double>> largest;
    bool any_masked = false;
    for (const ObservedView& view : views) {
        EXPECT_GE(double(view.wv.z), elementary::cos(theta_max) - 1e-6);
        ASSERT_EQ(view.f.size(), view.wl.size());
        for (std::size_t i = 0; i < view.wl.size(); ++i) {
            EXPECT_GE(double(view.wl[i].z), elementary::cos(theta_max) - 1e-6);
            ASSERT_TRUE(is_finite(view.f[i]) && view.f[i].r == 0);
        }
        for (const ObservedPixel& pixel : view.pixels) {
            Rgb colour;
            for (std::size_t i = 0; i < pixel.weight.size(); ++i) {
                const bool masked = view.wl[pixel.first + i].x < -0.9f;
                any_masked |= masked;
                EXPECT_EQ(masked, pixel.weight[i] == 0);
                for (int c = 0; c < 3; ++c) colour[c] += pixel.weight[i] * view.f[pixel.first + i][c];
            }
            if (const double max = std::max({colour.r, colour.g, colour.b}); max > 0)
                largest[pixel.lighting].push_back(max);
        }
    }
    EXPECT_TRUE(any_masked);
    ASSERT_GT(largest.size(), 8u);
    for (auto& [lighting, values] : largest) {
        std::ranges::sort(values);
        EXPECT_WITHIN(values[std::size_t(0.9 * double(values.size() - 1))], k_exposed_value, 1e-3) << lighting;
    }
}

TEST(Observations, RefuseInvalidInput) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    for (const float x : {0.f, -1.f, nan, inf}) EXPECT_FALSE(observe(constant({x, x, x}), {}).ok()) << x;
    const Evaluate one = constant({1, 1, 1});
    EXPECT_TRUE(observe(one, {}).ok());
    for (const double theta : {-1.0, 0.001, 1.6, double(nan)})
        EXPECT_FALSE(observe(one, {Objective::raw, theta}).ok()) << theta;
    EXPECT_FALSE(observe(one, {Objective::raw, 0, 10}).ok());
}

}  // namespace
}  // namespace srbf::observations_test
