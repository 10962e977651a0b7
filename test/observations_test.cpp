// Observations: the values of a BRDF that a fit knows.
#include <map>

#include "brdf_functions.h"
#include "errors/sphere.h"
#include "observe/observations.h"
#include "properties.h"
#include "srbf/kernel.h"
#include "statistics.h"

namespace srbf::observations_test {
namespace {

const Evaluate k_one = constant_brdf({1, 1, 1});
constexpr double k_cap = 80 * k_degree;  // θ_max of most fits

std::size_t fitted_pairs(const Observations& o) { return o.f.size() - o.bound_pairs; }
/// True if both directions of pair i are within the cap.
bool is_in_cap(const Observations& o, std::size_t i) {
    return std::min(double(o.wl[i].z), double(o.wv[i].z)) >= elementary::cos(k_cap) - 1e-6;
}
/// A body of value `body` and a highlight about the normal.
Evaluate body_and_highlight(float body, float height, float bandwidth) {
    return pairwise([=](Vec3f wl, Vec3f wv) {
        const Vec3f h = Kernel<float>::psi(wl, wv, 1, 1);
        return grey(body + height * Kernel<float>::gaussian(h, {0, 0, 1}, bandwidth));
    });
}
/// w |f|² of a pair of a grey BRDF.
double energy_of(const Observations& o, std::size_t i) { return o.weight[i] * 3 * double(o.f[i].r) * double(o.f[i].r); }

TEST(Observations, EstimateTheIntegralOfTheirObjective) {
    for (const Objective objective : {Objective::raw, Objective::cosine}) {
        const auto o = checked(observe(k_one, {objective, k_cap, 1 << 16, 3}));
        // Fractions of Σ w with wl, or wv, within 50° of the normal: of dω for raw, of cos²θl dω and cosθv dω for
        // cosine.
        const double cos_cap = elementary::cos(k_cap), cos_50 = elementary::cos(50 * k_degree);
        double sum = 0, near_l = 0, near_v = 0;
        for (std::size_t i = 0; i < fitted_pairs(*o); ++i) {
            if (!is_in_cap(*o, i)) continue;
            const double w = double(o->weight[i]);
            sum += w;
            if (double(o->wl[i].z) > cos_50) near_l += w;
            if (double(o->wv[i].z) > cos_50) near_v += w;
        }
        const auto fraction = [&](int power) {  // of ∫ μ^power dμ
            return (1 - elementary::pow(cos_50, power + 1)) / (1 - elementary::pow(cos_cap, power + 1));
        };
        const bool is_raw = objective == Objective::raw;
        EXPECT_WITHIN_RELATIVE(near_l / sum, fraction(is_raw ? 0 : 2), 0.01);
        EXPECT_WITHIN_RELATIVE(near_v / sum, fraction(is_raw ? 0 : 1), 0.01);
        EXPECT_WITHIN(3 * sum, 1, 0.05);  // Σ w |f|² = 1; the grid of horizon pairs adds a few pairs within the cap
    }
}

TEST(Observations, EveryPrefixIsARepresentativeSample) {
    const auto o = checked(observe(k_one, {Objective::raw, k_cap, 1 << 16, 0}));
    ASSERT_EQ(fitted_pairs(*o), std::size_t(1) << 16);
    double sum = 0;
    std::size_t horizon_pairs = 0;
    for (std::size_t i = 0; i < 4096; ++i) {
        sum += 3 * double(o->weight[i]);
        horizon_pairs += !is_in_cap(*o, i);
    }
    EXPECT_WITHIN_RELATIVE(sum, 4096.0 / 65536, 0.1);
    EXPECT_GT(horizon_pairs, 4096u / 16);
    EXPECT_LT(horizon_pairs, 4096u / 8 + 1);
}

// A highlight of half a degree contains nearly all of Σ w |f|². Sampled from the mixture alone, only a few dozen of
// 4096 pairs would lie in it.
TEST(Observations, AreDenseWhereTheEnergyIs) {
    const auto o = checked(observe(body_and_highlight(0.01f, 300, 20000), {Objective::raw, 0, 1 << 16, 2}));
    Moments whole, beginning, scaled_beginning;
    for (std::size_t i = 0; i < fitted_pairs(*o); ++i) whole.add(energy_of(*o, i));
    for (std::size_t i = 0; i < 4096; ++i) beginning.add(energy_of(*o, i));
    EXPECT_WITHIN(whole.sum, 1, 0.01);
    EXPECT_WITHIN_RELATIVE(beginning.sum, 4096.0 / double(fitted_pairs(*o)), 0.1);
    EXPECT_GT(beginning.sum * beginning.sum / beginning.squares, 600);
    const Observations few = first_pairs(*o, 4096);
    for (std::size_t i = 0; i < 4096; ++i) scaled_beginning.add(energy_of(few, i));
    EXPECT_WITHIN(scaled_beginning.sum, 1, 1e-6);
}

TEST(Observations, CosineObjectiveKeepsDarkValuesUnderAHighlight) {
    // The fraction of the body in Σ w |f|²: almost none, and most with the additional weights.
    const auto fraction_of_body = [](Objective objective) {
        const auto o = observe(body_and_highlight(0.1f, 1000, 3000), {objective, k_cap, 1 << 16, 0});
        double fraction = 0;
        for (std::size_t i = 0; i < fitted_pairs(*o); ++i)
            if (is_in_cap(*o, i) && o->f[i].r < 0.2f) fraction += energy_of(*o, i);
        return fraction;
    };
    EXPECT_LE(fraction_of_body(Objective::raw), 1e-4);
    EXPECT_GE(fraction_of_body(Objective::cosine), 0.001);
    EXPECT_LE(fraction_of_body(Objective::cosine), 0.005);
}

TEST(Observations, ReachTheHorizonAndItsCorners) {
    const auto o = checked(observe(k_one, {Objective::cosine, 0, 4096, 0}));
    double lowest_light = 1, lowest_both = 1;
    for (std::size_t i = 0; i < o->f.size(); ++i) {
        lowest_light = std::min(lowest_light, double(o->wl[i].z));
        lowest_both = std::min(lowest_both, double(std::max(o->wl[i].z, o->wv[i].z)));
        ASSERT_GT(o->wl[i].z, 0);
        ASSERT_GT(o->wv[i].z, 0);
    }
    EXPECT_LT(lowest_light, elementary::cos(89.89 * k_degree));
    EXPECT_LT(lowest_both, elementary::cos(89.89 * k_degree));
}

TEST(Observations, OmitMissingValuesAndClampNegativeOnes) {
    const Evaluate half_missing = pairwise([](Vec3f wl, Vec3f) { return wl.x < 0 ? grey(NAN) : Rgb{-1, 1, 2}; });
    const auto o = checked(observe(half_missing, {Objective::raw, 0, 4096, 0}));
    EXPECT_GT(o->masked, 1000u);
    EXPECT_GE(o->clamped, o->f.size());  // one channel of each, and of those drawn that were not chosen
    for (const Rgb& f : o->f) ASSERT_EQ(f, (Rgb{0, 1, 2}));
    for (const double w : o->weight) ASSERT_TRUE(std::isfinite(w) && w >= 0);
}

TEST(Observations, DependOnTheSeed) {
    const auto weights_for = [](std::uint64_t seed, int threads = 0) {
        return observe(k_one, {Objective::raw, 0, 4096, seed, threads})->weight;
    };
    EXPECT_EQ(weights_for(1), weights_for(1));
    EXPECT_EQ(weights_for(1), weights_for(1, 1));  // whatever the threads
    EXPECT_NE(weights_for(1), weights_for(2));
}

TEST(Observations, ViewsOfPicturesAreExposedAndWithinTheCap) {
    const auto is_missing = [](Vec3f wl) { return wl.x < -0.9f; };
    const Evaluate f = pairwise([&](Vec3f wl, Vec3f wv) {
        return is_missing(wl) ? grey(NAN) : Rgb{-1, 0.2f, 0.1f + wl.z * wv.z};
    });
    EXPECT_TRUE(observe(f, {Objective::cosine, k_cap, 4096})->views.empty());
    const auto views = observe(f, {Objective::appearance, k_cap, 4096})->views;
    std::map<std::size_t, std::vector<double>> largest_channels;  // of the pixels, by their lighting
    bool any_masked = false;
    for (const ObservedView& view : views) {
        EXPECT_GE(double(view.wv.z), elementary::cos(k_cap) - 1e-6);
        ASSERT_EQ(view.f.size(), view.wl.size());
        for (std::size_t i = 0; i < view.wl.size(); ++i) {
            EXPECT_GE(double(view.wl[i].z), elementary::cos(k_cap) - 1e-6);
            ASSERT_TRUE(is_finite(view.f[i]) && view.f[i].r == 0);
        }
        for (const ObservedPixel& pixel : view.pixels) {
            Rgb colour;
            for (std::size_t i = 0; i < pixel.weight.size(); ++i) {
                const bool is_masked = is_missing(view.wl[pixel.first + i]);
                any_masked |= is_masked;
                EXPECT_EQ(is_masked, pixel.weight[i] == 0);
                for (int c = 0; c < 3; ++c) colour[c] += pixel.weight[i] * view.f[pixel.first + i][c];
            }
            if (largest_of(colour) > 0) largest_channels[pixel.lighting].push_back(largest_of(colour));
        }
    }
    EXPECT_TRUE(any_masked);
    ASSERT_GT(largest_channels.size(), 8u);
    for (auto& [lighting, values] : largest_channels) {
        std::ranges::sort(values);
        EXPECT_WITHIN(values[std::size_t(0.9 * double(values.size() - 1))], k_exposed_value, 1e-3) << lighting;
    }
}

TEST(Observations, RefuseInvalidInput) {
    for (const double x : {0.0, -1.0, double(NAN), double(INFINITY)})
        EXPECT_FALSE(observe(constant_brdf(grey(x)), {}).ok()) << x;
    EXPECT_TRUE(observe(k_one, {}).ok());
    for (const double theta : {-1.0, 0.001, 1.6, double(NAN)})
        EXPECT_FALSE(observe(k_one, {Objective::raw, theta}).ok()) << theta;
    EXPECT_FALSE(observe(k_one, {Objective::raw, 0, 10}).ok());
}

}  // namespace
}  // namespace srbf::observations_test
