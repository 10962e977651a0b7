// Models on arrays of pairs, and prepared for single ones, against kernel.glsl in double, for each instruction set of
// this machine.
#include "brdf/colour.h"
#include "models.h"
#include "models/pm/pm_functions.h"
#include "one_target.h"
#include "properties.h"
#include "srbf/kernel.h"
#include "srbf/prepared.h"

namespace srbf::evaluate_test {
namespace {

struct DirectionPairs {
    std::vector<Vec3f> wl, wv;
    void add(Vec3d l, Vec3d v) {
        wl.push_back(to_float(l));
        wv.push_back(to_float(v));
    }
    void add_random(std::mt19937_64& random, double z_min, int count) {
        for (int i = 0; i < count; ++i) add(random_direction(random, z_min), random_direction(random, z_min));
    }
    /// Adds pairs with viewers at distances up to `reach` from the mirror direction of l, in all directions from it.
    void add_about_mirror(std::mt19937_64& random, Vec3d l, double reach, int count) {
        for (int i = 0; i < count; ++i) {
            const Vec3d v = normalize(mirror(l) + (reach * uniform(random)) * random_direction(random));
            if (v.z > 0) add(l, v);
        }
    }
};

std::vector<Rgb> evaluated(const PmModel& model, const DirectionPairs& pairs) {
    std::vector<Rgb> f(pairs.wl.size());
    evaluate(model, pairs.wl, pairs.wv, f);
    return f;
}

std::vector<Vec3d> exact(const PmModel& model, const DirectionPairs& pairs) {
    std::vector<Vec3d> f;
    for (std::size_t i = 0; i < pairs.wl.size(); ++i) {
        const Vec3d wl = to_double(pairs.wl[i]), wv = to_double(pairs.wv[i]);
        f.push_back(wl.z > 0 && wv.z > 0 ? Kernel<double>::pm_value(model, wl, wv) : Vec3d());
    }
    return f;
}

/// Relative tolerance 1e-4; absolute 1e-6 of the channel's maximum, or the smallest normal float.
void expect_exact(const PmModel& model, const DirectionPairs& pairs) {
    const std::vector<Rgb> f = evaluated(model, pairs);
    const std::vector<Vec3d> expected = exact(model, pairs);
    const PreparedBrdf prepared = prepare(Model{model, {}}, CosineProposal{});
    for (int c = 0; c < 3; ++c) {
        const auto channel = [&](const Vec3d& e) { return c == 0 ? e.x : c == 1 ? e.y : e.z; };
        double peak = 0;
        for (const Vec3d& e : expected) peak = std::max(peak, channel(e));
        for (std::size_t i = 0; i < f.size(); ++i) {
            const double e = channel(expected[i]), bound = std::max({1e-4 * e, 1e-6 * peak, 1e-35});
            EXPECT_WITHIN(f[i][c], e, bound) << peak;
            EXPECT_WITHIN(value(prepared, pairs.wl[i], pairs.wv[i])[c], e, bound)
                << peak << ", J " << model.lobes << ", N " << model.variates;
        }
    }
}

class EvaluateOn : public testing::TestWithParam<Target> {
  protected:
    const OneTarget target_{GetParam()};
    std::mt19937_64 random_{1};
};
INSTANTIATE_TEST_SUITE_P(EachTarget, EvaluateOn, testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const auto& target) { return std::string(hwy::TargetName(target.param)); });

TEST_P(EvaluateOn, AgreesWithDouble) {
    DirectionPairs pairs;
    pairs.add_random(random_, -0.2, 100);
    for (int i = 0; i < 20; ++i) pairs.add_about_mirror(random_, random_direction(random_, 0.05), 0.3, 10);
    for (const PmForm form : k_forms)
        for (const bool axial : {true, false})
            for (int variates = 1; variates <= k_max_variates; ++variates)
                for (const int lobes : {1, 6, 9, 33})  // also more than lanes
                    expect_exact(random_model(random_, {axial, variates % 2 == 0, lobes, variates, 3000, form}), pairs);
    expect_exact(random_model(random_, {false, true, k_max_lobes, k_max_variates, 3000, PmForm::extended}), pairs);
}

TEST_P(EvaluateOn, SpectraAgreeWithDoubleAndHaveTheColour) {
    DirectionPairs pairs;
    pairs.add_random(random_, -0.2, 300);
    for (const PmForm form : k_forms)
        for (const bool axial : {true, false})
            for (const int count : {1, 2, 7, 31}) {
                const PmModel model =
                    spectral_model(random_, {.axial = axial, .lobes = 4, .variates = 3, .form = form}, count);
                const auto C = std::size_t(count);
                std::vector<float> f(C * pairs.wl.size());
                spectra(model).evaluate(pairs.wl, pairs.wv, f);
                for (std::size_t c = 0; c < C; ++c) {
                    PmModel grey = model;
                    for (std::size_t j = 0; j < 4; ++j) grey.coefficient[j].r = model.spectrum[j * C + c];
                    const std::vector<Vec3d> expected = exact(grey, pairs);
                    double peak = 0;
                    for (const Vec3d& e : expected) peak = std::max(peak, e.x);
                    for (std::size_t i = 0; i < expected.size(); ++i)
                        EXPECT_WITHIN(f[i * C + c], expected[i].x, 1e-4 * expected[i].x + 1e-6 * peak);
                }
                // A lobe's colour may have a negative channel, a value has none.
                expect_exact(model, pairs);
                const std::vector<Rgb> weights = rgb_weights(model.wavelength), rgb = evaluated(model, pairs);
                for (std::size_t i = 0; i < rgb.size(); ++i) {
                    const Rgb colour = to_rgb(std::span(f).subspan(i * C, C), weights);
                    for (int k = 0; k < 3; ++k) {
                        EXPECT_GE(rgb[i][k], 0);
                        EXPECT_WITHIN(rgb[i][k], std::max(colour[k], 0.f), 1e-3 * double(luminance(rgb[i])) + 1e-6);
                    }
                }
            }
}

TEST_P(EvaluateOn, KeepsTheDigitsOfTheSharpestPeaks) {
    for (const bool axial : {true, false})
        for (const Parameterization p : {Parameterization{1, 1}, {0.7f, 0.7f}, {-0.7f, -0.7f}, {0.8f, 0.6f}}) {
            PmModel model = random_model(random_, {.axial = axial, .lobes = 2, .variates = 1});
            model.parameterization = {p};
            model.bandwidth = {k_half_max, 3000};
            const float pole = p.a > 0 ? 1.f : -1.f;
            model.centre = {{0, 0, pole}, {0, 0, pole}};
            for (const double theta : {0.0, 0.1, 0.7, 1.3, 1.5}) {
                DirectionPairs pairs;
                for (const double reach : {0.1, 0.01})
                    pairs.add_about_mirror(random_, spherical(theta, 1.0), reach, 500);
                expect_exact(model, pairs);
            }
        }
}

TEST_P(EvaluateOn, HoldsAtTheHorizon) {
    DirectionPairs pairs;
    for (const double cosine : {1e-30, 1e-8, 1e-6, 1e-5, 1e-3, 0.1, 0.0, -0.0, -1e-30, -0.5, 1.0})
        for (int i = 0; i < 50; ++i) {
            const double phi = 2 * k_pi * uniform(random_);
            const Vec3d low = normalize(Vec3d(std::cos(phi), std::sin(phi), cosine)),
                        other = random_direction(random_, 0);
            pairs.add(low, other);
            pairs.add(other, low);
            pairs.add(low, mirror(low));
            pairs.add(low, -1.0 * low);
        }
    for (const PmForm form : k_forms)
        for (const bool axial : {true, false}) {
            const PmModel model = random_model(random_, {.axial = axial, .log_scale = true, .form = form});
            expect_exact(model, pairs);
            const std::vector<Rgb> f = evaluated(model, pairs);
            for (std::size_t i = 0; i < f.size(); ++i)
                if (!(pairs.wl[i].z > 0 && pairs.wv[i].z > 0)) {
                    EXPECT_EQ(f[i], Rgb());
                }
        }
}

TEST_P(EvaluateOn, IsCutBeforeSubnormalNumbersAndInfinity) {
    DirectionPairs pairs;
    pairs.add_random(random_, 0, 200);
    PmModel model = random_model(random_, {.lobes = 1, .variates = 1});
    model.parameterization = {{1, 1}};
    model.centre = {{0, 0, -1}};  // at least sqrt(2) away
    model.coefficient = {{k_half_max, 1, 0}};
    for (const float bandwidth : {130.f, 1000.f, k_half_max}) {
        model.bandwidth = {bandwidth};
        for (const Rgb& f : evaluated(model, pairs)) {
            EXPECT_WITHIN_RELATIVE(f.g, 0x1p-100, 1e-4);
            EXPECT_EQ(f.b, 0);
        }
    }
    for (double min = -80; min <= -60; min += 0.05) {  // 2^-100 is e^-69.3
        model.bandwidth = {0};
        model.log_scale = {float(min)};
        const double expected = std::max(std::exp(double(model.log_scale[0])), 0x1p-100);
        for (const Rgb& f : evaluated(model, pairs)) EXPECT_WITHIN_RELATIVE(f.g, expected, 1e-4);
    }
    model = axial_gaussians(std::vector(k_max_lobes, Rgb{k_half_max, 1, 0}), std::vector(k_max_lobes, 0.f));
    model.log_scale.assign(k_max_lobes, k_half_max);
    for (const Rgb& f : evaluated(model, pairs)) {
        EXPECT_TRUE(is_finite(f));
        EXPECT_WITHIN_RELATIVE(f.g, k_max_lobes * 0x1p100, 1e-4);
        EXPECT_EQ(f.b, 0);
    }
}

TEST_P(EvaluateOn, APairsValueDoesNotDependOnItsPlace) {
    DirectionPairs pairs;
    pairs.add_random(random_, 0, 150);
    for (int trial = 0; trial < 12; ++trial) {
        const PmModel model =
            random_model(random_, {.axial = trial % 2 == 0, .form = k_forms[std::size_t(trial) % k_forms.size()]});
        const std::vector<Rgb> all = evaluated(model, pairs);
        for (std::size_t first = 0; first < 40; first += 3)
            for (std::size_t count = 0; count <= 70; count += 7) {
                std::vector<Rgb> f(count + 1, Rgb{-1, -1, -1});
                evaluate(model, std::span(pairs.wl).subspan(first, count), std::span(pairs.wv).subspan(first, count),
                         std::span(f).first(count));
                EXPECT_TRUE(std::equal(f.begin(), f.end() - 1, all.begin() + std::ptrdiff_t(first)));
                EXPECT_EQ(f.back(), (Rgb{-1, -1, -1}));
            }
    }
}

}  // namespace
}  // namespace srbf::evaluate_test
