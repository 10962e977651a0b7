// The PM fit: recovery of synthetic models, documented properties, errors.
#include "models/pm/search/fit_pm.h"

#include <map>

#include "brdf/colour.h"
#include "brdf/directions.h"
#include "brdf_functions.h"
#include "errors/picture_errors.h"
#include "measured_files.h"
#include "models.h"
#include "models/ggx/ggx_kind.h"
#include "models/pm/pm_functions.h"
#include "observe/albedo_bound.h"
#include "observe/observations.h"
#include "observe/pair_weights.h"
#include "properties.h"
#include "srbf/elementary.h"
#include "srbf/measured.h"
#include "srbf/metrics.h"

namespace srbf::fit_pm_test {
namespace {

Observations observed(const Evaluate& f, Objective objective = Objective::raw) { return *observe(f, {objective, 0}); }

/// Options for a search that is shorter than the default, and sufficient for these tests.
PmFitOptions short_search(PmForm form, int lobes, int variates) {
    return {.form = form, .lobes = lobes, .variates = variates, .starts = 6, .perturbations = 10};
}

/// A model of J axial lobes and N variates whose features are visible within the hemispheres.
PmModel model_of(int lobes, int variates, std::mt19937_64& random) {
    PmModel model;
    model.lobes = lobes;
    model.variates = variates;
    const float angles[] = {float(k_pi / 4), 0.1f, 1.3f};
    for (int n = 0; n < variates; ++n)
        model.parameterization.push_back({elementary::cos(angles[n]), elementary::sin(angles[n])});
    for (int j = 0; j < lobes; ++j) {
        const auto colour = [&] { return float(0.1 + uniform(random)); };
        model.coefficient.push_back({colour(), colour(), colour()});
        model.log_scale.push_back(0);
        for (int n = 0; n < variates; ++n) {
            model.centre.push_back({0, 0, 1});
            model.bandwidth.push_back(
                float(n == 0 ? 0.5 * elementary::pow(12.0, j) * (1 + uniform(random)) : 2 * uniform(random)));
        }
    }
    return model;
}

TEST(FitPm, RecoversASyntheticModel) {
    std::mt19937_64 random(11);
    for (int lobes = 1; lobes <= 4; ++lobes)
        for (const int variates : {lobes % 2 ? 1 : 2, 3}) {
            const PmModel model = model_of(lobes, variates, random);
            const auto fit =
                checked(fit_pm(observed(evaluator(model)), short_search(PmForm::gaussian, lobes, variates)));
            const Measures errors = heldout_measures(evaluator(model), evaluator(fit->unrounded));
            EXPECT_LE(errors.squared_error_ratio, 1e-8) << lobes << " lobes, " << variates << " variates";
        }
}

TEST(FitPm, RecoversSyntheticSpectra) {
    std::mt19937_64 random(12);
    PmModel model = model_of(3, 3, random);
    for (int c = 0; c < 9; ++c) model.wavelength.push_back(400 + 35.5f * float(c));
    for (std::size_t j = 0; j < 3; ++j)
        for (int c = 0; c < 9; ++c) model.spectrum.push_back(float(0.5 + 0.4 * elementary::sin(c + 2.0 * double(j))));
    model.coefficient = colours(model.spectrum, model.wavelength);
    Observations observations = observed(evaluator(model));
    observe_spectra(observations, spectra(model));
    const PmFitOptions options = short_search(PmForm::gaussian, 3, 3);
    const auto fit = checked(fit_pm(observations, options));
    EXPECT_EQ(fit->model.wavelength, model.wavelength);
    const Channels others[] = {spectra(fit->unrounded), spectra(fit->model)};
    const auto error = measure_heldout(spectra(model), others, {80 * k_degree, 0});
    EXPECT_LE(error[0].squared_error_ratio, 1e-8);
    EXPECT_LE(error[1].squared_error_ratio, 1e-5);
    EXPECT_EQ(fit->model, rounded(fit->model));
    observations.spectrum[0] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(fit_pm(observations, options));
}

TEST(FitPm, DoesNotDependOnTheUnitOfTheData) {
    const Evaluate paper = signed_evaluator(bundled("paper_white_rgb"));
    const PmFitOptions options{.lobes = 2, .variates = 2, .starts = 4, .perturbations = 4};
    std::vector<double> losses;
    for (const float unit : {1e-20f, 1.f, 1e20f}) {
        const auto fit = fit_pm(observed(with_values(paper, [=](const Rgb& f) { return scaled(unit, f); })), options);
        ASSERT_TRUE(fit) << unit;
        losses.push_back(fit->unrounded_loss);
    }
    EXPECT_WITHIN_RELATIVE(losses[0], losses[1], 1e-3);
    EXPECT_WITHIN_RELATIVE(losses[2], losses[1], 1e-3);
}

/// The fit of a bundled material with default options, computed once.
struct Fitted {
    const Measured& measured;
    PmFit fit;
    Measures rounded, unrounded;
};
const Fitted& fitted(const char* name) {
    static std::map<std::string, Fitted> fits;
    if (const auto entry = fits.find(name); entry != fits.end()) return entry->second;
    const Measured& measured = bundled(name);
    PmFit fit = *fit_pm(observed(signed_evaluator(measured)), PmFitOptions{.form = PmForm::gaussian});
    const Measures rounded = heldout_measures(evaluator(measured), evaluator(fit.model)),
                   unrounded = heldout_measures(evaluator(measured), evaluator(fit.unrounded));
    return fits.emplace(name, Fitted{measured, std::move(fit), rounded, unrounded}).first->second;
}

TEST(FitPm, ReciprocalFormIsReciprocal) {
    const Measured& paper = bundled("paper_white_rgb");
    for (const bool axial : {true, false}) {
        PmFitOptions options = short_search(PmForm::reciprocal, axial ? 6 : 4, 3);
        options.axial = axial;
        const auto fit = checked(fit_pm(observed(reciprocal_mean(signed_evaluator(paper))), options));
        std::mt19937_64 random(5);
        const auto draw = [&](double max_cosine) {
            return to_float(spherical(elementary::acos(max_cosine * uniform(random)), 2 * k_pi * uniform(random)));
        };
        std::vector<Vec3f> a, b;
        for (int i = 0; i < 1000; ++i) {  // to the horizon
            a.push_back(draw(i % 4 == 0 ? 1e-5 : 1));
            b.push_back(draw(i % 3 == 0 ? 1e-4 : 1));
            EXPECT_EQ(value(fit->model, a.back(), b.back()), value(fit->model, b.back(), a.back()));
        }
        std::vector<Rgb> f(a.size()), exchanged(a.size());
        evaluate(fit->model, a, b, f);
        evaluate(fit->model, b, a, exchanged);
        EXPECT_EQ(f, exchanged);
        EXPECT_LE(heldout_measures(evaluator(paper), evaluator(fit->model)).squared_error_ratio, 0.005) << axial;
    }
}

// f rises towards the horizon such that the albedo is 0.96 at 80° and exceeds 1 beyond 82°, or a third more.
TEST(FitPm, AlbedoIsWithinItsLimit) {
    constexpr double k_none = std::numeric_limits<double>::infinity();
    struct Case {
        PmForm form;
        std::optional<double> limit;
        float scale;
        double max;
    };
    for (const auto& [form, limit, scale, max] : {Case{PmForm::reciprocal, {}, 1, 1},
                                                  {PmForm::extended, 0.5, 1, 0.5},
                                                  {PmForm::reciprocal, {}, 1.33f, 1},
                                                  {PmForm::reciprocal, k_none, 1.33f, k_none}}) {
        const Evaluate rising = pairwise([scale = scale](Vec3f wl, Vec3f wv) {
            const float sum = wl.z + wv.z, value = scale * (0.2f + 0.05f / (sum * sum + 1e-4f));
            return Rgb{value, 0.8f * value, 0.5f * value};
        });
        PmFitOptions options = short_search(form, 3, 2);
        options.axial = form == PmForm::extended || scale > 1;
        options.albedo_limit = limit;
        options.starts = options.perturbations = 2;
        const auto fit = checked(fit_pm(*observe(rising, {}), options));
        for (const PmModel& model : {fit->model, fit->unrounded}) {
            double largest = 0;
            for (double cosine = 1; cosine >= 1e-3; cosine *= 0.93)
                largest = std::max(largest, largest_of(albedo(evaluator(model), elementary::acos(cosine), k_pi / 2)));
            EXPECT_LE(largest, 1.001 * max);
            EXPECT_GE(largest, std::min(0.9 * max, 1.2));
        }
        EXPECT_GT(albedo(evaluator(fit->model), 30 * k_degree, k_pi / 2).r, std::min(0.6, 0.8 * max));
    }
}

/// Channels that are equal everywhere have equal coefficients, also where pixels are compared.
TEST(FitPm, GreyStaysGrey) {
    const Evaluate film = reciprocal_mean(evaluator(bundled("cc_ibiza_sunset_rgb")));
    const Evaluate grey = with_values(film, [](const Rgb& f) { return Rgb{f.g, f.g, f.g}; });
    const Observations observations = *observe(grey, {.count = 8192});
    const auto is_grey = [](const Rgb& colour) { return colour.r == colour.g && colour.g == colour.b; };
    const auto fit = fit_pm(observations, short_search(PmForm::reciprocal, 4, 2));
    EXPECT_TRUE(std::ranges::all_of(fit->model.coefficient, is_grey));
    const auto facets = Kind<GgxModel>::fit(observations);
    EXPECT_TRUE(is_grey(facets->model.diffuse) && is_grey(facets->model.lobes[0].f0));
}

/// The mean is reciprocal, equal to a reciprocal function, and where one value is missing, equal to the other.
TEST(FitPm, ReciprocalMeanIsWeightedByTheCosines) {
    const Evaluate f = pairwise([](Vec3f wl, Vec3f wv) {
        return Rgb{1 / wv.z, wl.z * wv.z, wl.x > 0.5f ? std::numeric_limits<float>::quiet_NaN() : 1};
    });
    const Vec3f a = to_float(spherical(0.3, 0.0)), b = to_float(spherical(1.4, 2.0)), c = to_float(spherical(1.2, 0.1));
    const std::vector<Vec3f> wl{a, b, c, a}, wv{b, a, a, c};
    std::vector<Rgb> mean(4);
    reciprocal_mean(f)(wl, wv, mean);
    EXPECT_RGB_WITHIN_RELATIVE(mean[0], mean[1], 1e-6, 0);
    EXPECT_WITHIN_RELATIVE(mean[0].r, 2 / (a.z + b.z), 1e-5);  // (1 + 1) / (cosθv + cosθl)
    EXPECT_WITHIN_RELATIVE(mean[0].g, a.z * b.z, 1e-5);
    EXPECT_EQ(mean[2].b, 1);
    EXPECT_EQ(mean[3].b, 1);
    std::vector<float> channels(12);
    reciprocal_mean(rgb_channels(f)).evaluate(wl, wv, channels);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(channels[3 * i], mean[i].r);
}

TEST(FitPm, EachObjectiveIsBestInItsOwnMeasure) {
    const Measured& film = bundled("cc_ibiza_sunset_rgb");
    const double cap = 80 * k_degree;
    std::vector<Measures> measures;
    for (const auto& [objective, measure] : k_objective_measures) {
        const auto fit =
            checked(fit_pm(*observe(signed_evaluator(film), {objective, cap}), short_search(PmForm::extended, 4, 3)));
        measures.push_back(heldout_measures(evaluator(film), evaluator(fit->model), cap));
    }
    for (std::size_t i = 0; i < measures.size(); ++i)
        for (std::size_t k = 0; k < measures.size(); ++k) {
            const auto [objective, measure] = k_objective_measures[i];
            EXPECT_LE(measures[i].*measure, measures[k].*measure)
                << name(objective) << " by its measure against " << name(k_objective_measures[k].first);
        }
}

TEST(FitPm, LosesLittleByRounding) {
    for (const char* name : {"paper_white_rgb", "cc_ibiza_sunset_rgb"}) {
        const Fitted& f = fitted(name);
        EXPECT_LE(f.rounded.squared_error_ratio, 1.05 * f.unrounded.squared_error_ratio) << name;
        EXPECT_EQ(f.fit.model, rounded(f.fit.model)) << name;
        EXPECT_EQ(payload_bytes(f.fit.model), has_log_scale(f.fit.model) ? 144u : 128u) << name;
        EXPECT_NE(f.fit.stop, StopReason::cancelled);
    }
}

TEST(FitPm, RefusesInvalidOptionsAndObservations) {
    const Observations good = observed(signed_evaluator(bundled("paper_white_rgb")));
    const auto accepts = [&](auto change) {
        PmFitOptions options;
        change(options);
        return fit_pm(good, options).ok();
    };
    for (const int bad : {0, -1, 65, 1 << 30}) EXPECT_FALSE(accepts([&](PmFitOptions& o) { o.lobes = bad; })) << bad;
    for (const int bad : {0, -1, 9, 1 << 30}) EXPECT_FALSE(accepts([&](PmFitOptions& o) { o.variates = bad; })) << bad;
    EXPECT_FALSE(accepts([](PmFitOptions& o) { o.starts = 0; }));
    EXPECT_FALSE(accepts([](PmFitOptions& o) { o.perturbations = -1; }));
    for (const double effort : {0.0, -1.0, 51.0, double(NAN)})
        EXPECT_FALSE(accepts([=](PmFitOptions& o) { o.effort = effort; })) << effort;
    EXPECT_FALSE(accepts([](PmFitOptions& o) { o.threads = -1; }));

    const auto rejects = [&](auto change) {
        Observations bad = good;
        change(bad);
        const auto fit = fit_pm(bad, {});
        return !fit.ok() && !fit.error().what.empty();
    };
    EXPECT_TRUE(rejects([](Observations& o) { o.f[5].g = std::numeric_limits<float>::quiet_NaN(); }));
    EXPECT_TRUE(rejects([](Observations& o) { o.weight[5] = -1; }));
    EXPECT_TRUE(rejects([](Observations& o) { o.weight[5] = std::numeric_limits<float>::infinity(); }));
    EXPECT_TRUE(rejects([](Observations& o) { std::fill(o.weight.begin(), o.weight.end(), 0.f); }));
    EXPECT_TRUE(rejects([](Observations& o) {
        o.bound_pairs = 0;
        o.wl.resize(20), o.wv.resize(20), o.f.resize(20), o.weight.resize(20);
    }));
}

}  // namespace
}  // namespace srbf::fit_pm_test
