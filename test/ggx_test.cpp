// Lambert and GGX: the formula and its fit. Its file: versions_test.cpp.
#include "brdf/directions.h"
#include "brdf_functions.h"
#include "models/ggx/ggx_kind.h"
#include "observe/pair_weights.h"
#include "observe/surface_problem.h"
#include "properties.h"
#include "srbf/metrics.h"
#include "srbf/model.h"

namespace srbf::ggx_test {
namespace {

GgxModel random_ggx(std::mt19937_64& random, int lobes) {
    const auto colour = [&](double max) {
        return Rgb{float(max * uniform(random)), float(max * uniform(random)), float(max * uniform(random))};
    };
    GgxModel model{colour(0.8), {}};
    for (int i = 0; i < lobes; ++i)
        model.lobes.push_back({float(elementary::exp2(i == 0 ? -4 + 2 * uniform(random) : -1 - uniform(random))),
                               colour(0.5), float(0.4 + 0.6 * uniform(random))});
    return model;
}

/// Directional albedo of one channel of perfectly reflecting facets, by quadrature in the lobe of the half vector.
double facet_albedo(float alpha, double theta_v) {
    const GgxModel white{{}, {{alpha, {1, 1, 1}, 1}}};
    return double(albedo(evaluator(white), theta_v, k_pi / 2).g);
}

TEST(Ggx, IsReciprocalIsotropicAndNeverNegative) {
    std::mt19937_64 random(1);
    for (int i = 0; i < 2000; ++i) {
        const GgxModel model = random_ggx(random, 1 + i % 2);
        Vec3d wl = random_direction(random), wv = random_direction(random);
        wl.z = std::abs(wl.z);
        wv.z = std::abs(wv.z);
        const Rgb f = value(model, to_float(wl), to_float(wv)), g = value(model, to_float(wv), to_float(wl));
        const double angle = 6 * uniform(random);
        EXPECT_TRUE(f.r >= 0 && f.g >= 0 && f.b >= 0);
        EXPECT_RGB_WITHIN_RELATIVE(g, f, 1e-5, 0);
        EXPECT_RGB_WITHIN_RELATIVE(value(model, rotate(to_float(wl), angle), rotate(to_float(wv), angle)), f, 1e-4, 0);
    }
    EXPECT_EQ(value(random_ggx(random, 1), {0, 0, -1}, {0, 0, 1}), Rgb{});
}

TEST(Ggx, ALambertianReflectsItsColour) {
    const GgxModel model{{0.2f, 0.5f, 0.9f}, {{0.3f, {}, 0}}};
    for (const double theta : {0.0, 1.0, 1.4})
        EXPECT_RGB_WITHIN(albedo(evaluator(model), theta, k_pi / 2), model.diffuse, 2e-4);
}

TEST(Ggx, FacetsReflectNoMoreThanTheyGetAndSmoothOnesAll) {
    // Masking and shadowing lose the light of multiple scattering.
    for (const float alpha : {0.02f, 0.1f, 0.3f, 1.0f})
        for (const double theta : {0.0, 0.7, 1.2})
            EXPECT_LT(facet_albedo(alpha, theta), 1 + 1e-3) << alpha << ' ' << theta;
    EXPECT_WITHIN(facet_albedo(0.02f, 0.0), 1, 2e-3);
    // At α = 1 and normal incidence the albedo is 1 - ln 2: ∫ cosθl / (2 (1 + cosθl)) dcosθl, twice.
    EXPECT_WITHIN(facet_albedo(1, 0.0), 1 - elementary::log(2.0), 1e-4);
}

TEST(Ggx, IsFittedBack) {
    std::mt19937_64 random(3);
    for (int i = 0; i < 8; ++i) {
        const GgxModel truth = random_ggx(random, 1 + i % 2);
        const auto observed = checked(observe(evaluator(truth), {.objective = Objective::cosine, .count = 8192}));
        const auto fit = checked(Kind<GgxModel>::fit(*observed, {int(truth.lobes.size())}));
        EXPECT_EQ(payload_bytes(fit->model), truth.lobes.size() == 1 ? 16u : 26u);
        EXPECT_LT(fit->unrounded_loss, 1e-6);
        EXPECT_LT(fit->loss, 1e-5);  // roughness in halves
        EXPECT_WITHIN(fit->unrounded.lobes[0].roughness, truth.lobes[0].roughness,
                      2e-3 * double(truth.lobes[0].roughness));
    }
}

/// Two lobes are fitted back from their pictures. One lobe in their place looks more like them if pictures are
/// observed.
TEST(Ggx, IsFittedToVisibleDifferences) {
    std::mt19937_64 random(5);
    const GgxModel truth = random_ggx(random, 2);
    const auto observed = observe(evaluator(truth), {.count = 8192});
    ASSERT_TRUE(observed.ok() && !observed->views.empty());
    Observations values = *observed;
    values.views.clear();
    const auto visible_loss = [&](const Observations& fitted, int lobes) {
        const auto fit = Kind<GgxModel>::fit(fitted, {lobes});
        SurfaceData::Outputs colours;
        std::vector<Rgb> f;
        PixelSlopes slopes;
        const SurfaceData data(*observed, 1);
        data.compute_outputs(evaluator(fit->model), f, colours);
        return data.loss(colours, slopes);
    };
    EXPECT_LT(visible_loss(*observed, 2), 0.01);  // ΔE_ITP of 0.1
    EXPECT_LT(visible_loss(*observed, 1), 0.95 * visible_loss(values, 1));
}

TEST(Ggx, FitScalesWithTheData) {
    std::mt19937_64 random(4);
    const GgxModel truth = random_ggx(random, 2);
    const auto observed_times = [&](float scale) {
        return *observe(with_values(evaluator(truth), [=](const Rgb& f) { return scaled(scale, f); }),
                        {.objective = Objective::cube_root, .count = 4096});
    };
    const auto once = checked(Kind<GgxModel>::fit(observed_times(1))),
               large = checked(Kind<GgxModel>::fit(observed_times(64)));
    EXPECT_WITHIN(large->unrounded.diffuse.g, 64 * double(once->unrounded.diffuse.g),
                  64e-4 * double(once->unrounded.diffuse.g) + 1e-6);
    EXPECT_WITHIN(large->unrounded.lobes[0].roughness, once->unrounded.lobes[0].roughness, 1e-4);
}

TEST(Ggx, NoiseBelowZeroIsFitted) {
    std::mt19937_64 random(5);
    const GgxModel truth = random_ggx(random, 1);
    for (const Objective objective : objectives()) {
        auto observed = checked(observe(evaluator(truth), {.objective = objective, .count = 1024}));
        for (std::size_t i = 0; i < observed->fitted_count(); i += 8) observed->f[i] = {-observed->f[i].r, -1, -1e-3f};
        const auto fit = Kind<GgxModel>::fit(*observed);
        ASSERT_TRUE(fit.ok()) << name(objective);
        EXPECT_TRUE(std::isfinite(fit->loss)) << name(objective);
    }
}

TEST(Ggx, RefusesOtherNumbersOfLobes) {
    const auto observed = checked(observe(evaluator(GgxModel{{1, 1, 1}, {{0.5f, {}, 0}}}), {.count = 1024}));
    for (const int lobes : {0, 3, -1}) EXPECT_FALSE(Kind<GgxModel>::fit(*observed, {lobes}).ok());
}

}  // namespace
}  // namespace srbf::ggx_test
