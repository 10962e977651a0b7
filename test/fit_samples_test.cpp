// Fits to scattered samples: folds, spacing, errors away from the samples.
#include "errors/measures.h"
#include "samples/gap_filled_samples.h"

#include <functional>
#include <set>

#include "brdf/directions.h"
#include "fit/cross_validated_fits.h"
#include "properties.h"
#include "samples/fit_pm_to_samples.h"
#include "samples/folds.h"
#include "samples/near_samples.h"
#include "srbf/fit.h"

namespace srbf::fit_samples_test {
namespace {

/// A glossy film over a diffuse base, smooth to the scale of the samples below.
Rgb glossy(Vec3d wl, Vec3d wv) {
    const Vec3d h = normalize(wl + wv);
    const double gloss = 0.6 * elementary::exp(-12 * (1 - h.z)) * (1 + 2 * elementary::pow(1 - dot(wl, h), 3));
    return {float(0.1 + gloss), float(0.2 + gloss), float(0.05 + 0.8 * gloss)};
}

Vec3d draw(std::mt19937_64& random, double theta_max) {
    const double z = 1 - uniform(random) * (1 - elementary::cos(theta_max)), phi = 2 * k_pi * uniform(random);
    return {std::sqrt(1 - z * z) * elementary::cos(phi), std::sqrt(1 - z * z) * elementary::sin(phi), z};
}

ScatteredSamples samples_of(int count, double noise, std::uint64_t seed, double theta_max = 75 * k_degree) {
    std::mt19937_64 random(seed);
    ScatteredSamples samples;
    for (int i = 0; i < count; ++i) {
        const Vec3d wl = draw(random, theta_max), wv = draw(random, theta_max);
        samples.wl.push_back(to_float(wl));
        samples.wv.push_back(to_float(wv));
        // Of that standard deviation, by the sum of twelve.
        double normal = -6;
        for (int k = 0; k < 12; ++k) normal += uniform(random);
        const Rgb f = glossy(wl, wv);
        const float factor = float(1 + noise * normal);
        samples.colour.push_back({factor * f.r, factor * f.g, factor * f.b});
    }
    make_index(samples);
    return samples;
}

constexpr double k_cap = 75 * k_degree;

TEST(Folds, EachGroupIsInOneAndAllAreOfOneSize) {
    ScatteredSamples samples = samples_of(500, 0, 1);
    // A copy of each tenth sample: unchanged, exchanged, mirrored, rotated.
    for (std::size_t i = 0; i < 500; i += 10) {
        const Vec3f l = samples.wl[i], v = samples.wv[i];
        const auto add = [&](Vec3f wl, Vec3f wv) {
            samples.wl.push_back(wl), samples.wv.push_back(wv), samples.colour.push_back(samples.colour[i]);
        };
        add(l, v), add(v, l), add({l.x, -l.y, l.z}, {v.x, -v.y, v.z}), add({-l.y, l.x, l.z}, {-v.y, v.x, v.z});
    }
    make_index(samples);
    const auto fold = assign_folds(samples, k_cap, 7);
    ASSERT_TRUE(fold.ok());
    std::array<int, k_folds> size{};
    for (std::size_t i = 0; i < 500; ++i) ++size[std::size_t((*fold)[i])];
    for (const int n : size) EXPECT_TRUE(n >= 95 && n <= 105) << n;
    for (std::size_t i = 500; i < fold->size(); ++i) EXPECT_EQ((*fold)[i], (*fold)[(i - 500) / 4 * 10]);
    // Rotated anisotropic samples are of different groups.
    samples.isotropic = false;
    const auto turned = assign_folds(samples, k_cap, 7);
    ASSERT_TRUE(turned.ok());
    int apart = 0;
    for (std::size_t i = 503; i < fold->size(); i += 4) apart += (*turned)[i] != (*turned)[(i - 503) / 4 * 10];
    EXPECT_GT(apart, 20);
}

/// The angle between directions, as it counts where both change little.
double apart(Vec3f a, Vec3f b) {
    const Vec3d between = to_double(a) - to_double(b);
    return std::sqrt(dot(between, between));
}

TEST(Folds, GroupsAreThoseOfEveryPairOfSamples) {
    std::mt19937_64 random(1);
    ScatteredSamples samples;
    samples.isotropic = false;
    // Clusters, in which distances are about the greatest of a group.
    for (int cluster = 0; cluster < 40; ++cluster) {
        const Vec3d wl = draw(random, k_cap), wv = draw(random, k_cap);
        for (int i = 0; i < 12; ++i) {
            const auto moved = [&](Vec3d w) { return to_float(normalize(w + 0.01 * draw(random, k_pi))); };
            const Vec3f l = moved(wl), v = moved(wv);
            samples.wl.push_back(i % 3 ? l : v), samples.wv.push_back(i % 3 ? v : l);
            samples.colour.push_back({1, 1, 1});
        }
    }
    const auto n = samples.wl.size();
    const auto distance = [&](std::size_t a, std::size_t b) {
        const auto of = [&](Vec3f l, Vec3f v) { return std::hypot(apart(samples.wl[a], l), apart(samples.wv[a], v)); };
        return std::min(of(samples.wl[b], samples.wv[b]), of(samples.wv[b], samples.wl[b]));
    };
    std::vector<std::size_t> group(n);
    std::iota(group.begin(), group.end(), std::size_t(0));
    for (bool changed = true; changed;) {
        changed = false;
        for (std::size_t a = 0; a < n; ++a)
            for (std::size_t b = 0; b < n; ++b)
                if (group[b] > group[a] && distance(a, b) < k_group_distance) group[b] = group[a], changed = true;
    }
    const SampleGroups found = group_samples(samples);
    EXPECT_EQ(std::size_t(found.count), std::set(group.begin(), group.end()).size());
    EXPECT_GT(found.count, 50);
    EXPECT_LT(found.count, int(n) * 2 / 3);
    NearSamples places(samples);
    const std::vector<int> of_place = places.groups();
    ASSERT_EQ(places.count(), n);
    for (std::size_t a = 0; a < n; ++a) {
        double least = 10;
        for (std::size_t b = 0; b < n; ++b) {
            EXPECT_EQ(found.of[a] == found.of[b], group[a] == group[b]) << a << " " << b;
            if (group[a] != group[b]) least = std::min(least, distance(a, b));
        }
        EXPECT_PRED3(near, places.to_other_group(a, of_place), least, 1e-12);
    }
}

/// Compared pair by pair, these would take minutes.
TEST(Folds, VeryManySamplesMayBeClose) {
    std::mt19937_64 random(1);
    ScatteredSamples samples = samples_of(200, 0, 1);
    for (int i = 0; i < 200'000; ++i) {
        const auto near_to = [&](double theta) {
            return to_float(spherical(theta + 0.004 * uniform(random), 1 + 0.004 * uniform(random)));
        };
        samples.wl.push_back(near_to(0.5)), samples.wv.push_back(near_to(0.7)), samples.colour.push_back({1, 1, 1});
    }
    const SampleGroups groups = group_samples(samples);
    EXPECT_GT(groups.count, 150);
    EXPECT_LE(groups.count, 201);
    EXPECT_EQ(std::set(groups.of.begin() + 200, groups.of.end()).size(), 1u);
    EXPECT_GT(groups.spacing, k_group_distance);
}

TEST(Folds, TheBrightestAreLeftOutOneByOne) {
    const ScatteredSamples samples = samples_of(300, 0, 2);
    const auto fold = assign_folds(samples, k_cap, 3);
    ASSERT_TRUE(fold.ok());
    std::vector<std::size_t> order(samples.wl.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return luminance(samples.colour[a]) > luminance(samples.colour[b]);
    });
    std::set<int> of_brightest;
    for (int k = 0; k < k_folds; ++k) of_brightest.insert((*fold)[order[std::size_t(k)]]);
    EXPECT_EQ(of_brightest.size(), std::size_t(k_folds));
    EXPECT_EQ(*fold, *assign_folds(samples, k_cap, 3));
    EXPECT_NE(*fold, *assign_folds(samples, k_cap, 4));
}

TEST(Folds, ScansAreLeftOutWhole) {
    ScatteredSamples scans;
    constexpr double incidences[] = {60, 5, 41.4};
    for (const double theta : incidences)
        for (int view = -80; view <= 80; view += 5) {
            scans.wl.push_back(to_float(spherical(theta * k_degree, k_pi)));
            scans.wv.push_back(to_float(spherical(view * k_degree, 0.0)));
            scans.colour.push_back({1, 1, 1});
        }
    const auto folds = incidence_folds(scans);
    ASSERT_TRUE(folds);
    EXPECT_EQ(folds->incidences, 3);
    constexpr int expected[] = {2, 0, 1};
    for (std::size_t i = 0; i < folds->of.size(); ++i) EXPECT_EQ(folds->of[i], expected[i / (folds->of.size() / 3)]);
    EXPECT_FALSE(incidence_folds(samples_of(300, 0, 2)));  // of incidences at random
}

/// f of a rough surface with a glossy layer: Lambert and GGX lobes whose roughnesses are not those of the fitted mixture.
const GgxModel k_two_lobes{{0.05f, 0.05f, 0.05f},
                           {{0.013f, {0.5f, 0.5f, 0.5f}, 1}, {0.17f, {0.05f, 0.05f, 0.05f}, 0.3f}}};

/// In-plane scans of `f` at every second degree, with a relative error of at most `noise`.
ScatteredSamples scans_of(const std::function<float(Vec3f wl, Vec3f wv)>& f, std::span<const double> incidences,
                          double noise) {
    std::mt19937_64 random(1);
    ScatteredSamples scans;
    scans.isotropic = true;
    for (const double theta : incidences)
        for (int view = -78; view <= 78; view += 2) {
            const Vec3f wl = to_float(spherical(theta * k_degree, k_pi)),
                        wv = to_float(spherical(view * k_degree, 0.0));
            const float measured = f(wl, wv) * float(1 + noise * (2 * uniform(random) - 1));
            scans.wl.push_back(wl), scans.wv.push_back(wv), scans.colour.push_back({measured, measured, measured});
        }
    make_index(scans);
    return scans;
}

// Of microfacets, scans determine f at all pairs of directions, also out of their plane and at other incidences.
TEST(ObserveSamples, ScatterBetweenScansIsThatOfMicrofacets) {
    constexpr double incidences[] = {5, 40, 60, 75};
    const auto f = [](Vec3f wl, Vec3f wv) { return value(k_two_lobes, wl, wv).g; };
    const auto observed = observe(scans_of(f, incidences, 0.05), {.objective = Objective::relative});
    ASSERT_TRUE(observed.ok()) << message(observed.error());
    const Observations& between = observed->between;
    double squares = 0;
    for (std::size_t i = 0; i < between.f.size(); ++i)
        squares +=
            elementary::square(elementary::log(double(between.f[i].g) / double(f(between.wl[i], between.wv[i]))));
    EXPECT_LT(std::sqrt(squares / double(between.f.size())), 0.1);
}

// Of a distribution that is not GGX, at incidences that were left out.
TEST(FitToSamples, ScatterAtOtherIncidencesIsNearerThanByGgx) {
    constexpr double incidences[] = {10, 30, 50, 70};
    const auto abg = [](Vec3f wl, Vec3f wv) {  // Lambert and A / (B + |Δ sinθ|^g)
        const double apart = std::hypot(double(wl.x + wv.x), double(wl.y + wv.y));
        return float(0.02 + 0.01 / (0.001 + elementary::pow(apart, 1.8)));
    };
    const Measured scans{"", "", 0, scans_of(abg, incidences, 0.05)};
    const auto heldout = [&](const auto& model) {
        const auto outcome = fit(scans, {.model = model, .objective = Objective::relative});
        EXPECT_TRUE(outcome.ok());
        return outcome.ok() ? outcome->errors->heldout.log10_rms : INFINITY;
    };
    PmRequest four;
    four.size = LobeCount{4};
    EXPECT_LT(heldout(four), heldout(GgxRequest{}));
}

TEST(Folds, FewGroupsAreAnError) {
    ScatteredSamples samples = samples_of(4, 0, 3);
    for (int i = 0; i < 4; ++i)
        samples.wl.push_back(samples.wl[std::size_t(i)]), samples.wv.push_back(samples.wv[std::size_t(i)]),
            samples.colour.push_back({2, 2, 2});
    make_index(samples);
    const auto fold = assign_folds(samples, k_cap, 0);
    ASSERT_FALSE(fold.ok());
    EXPECT_NE(message(fold.error()).find("expected at least 5, found 4"), std::string::npos) << message(fold.error());
}

TEST(Spacing, IsThatOfTheDensest) {
    // On a line of samples 2° apart in the plane of incidence.
    ScatteredSamples samples;
    for (int i = 0; i < 30; ++i) {
        samples.wl.push_back(to_float(spherical(80 * k_degree, 0.0)));
        samples.wv.push_back(to_float(spherical((5 + 2 * i) * k_degree, k_pi)));
        samples.colour.push_back({1, 1, 1});
    }
    EXPECT_TRUE(near(spacing(samples) / k_degree, 2, 0.05)) << spacing(samples) / k_degree;
    samples.isotropic = false;
    EXPECT_TRUE(near(spacing(samples) / k_degree, 2, 0.05));
    // 30 times the same place.
    for (Vec3f& w : samples.wv) w = samples.wv[0];
    EXPECT_EQ(spacing(samples), 0);
}

TEST(FitToSamples, NoiseIsNotFittedAndNoLobeIsSharperThanTheSpacing) {
    const double noise = 0.02;
    const ScatteredSamples samples = samples_of(1500, noise, 4);
    const double finest = spacing(samples);
    EXPECT_GT(finest, k_degree);
    const ObserveSamplesOptions options{Objective::raw, k_cap, 0};
    const auto fit = [&](const ScatteredSamples& training, std::size_t = 0) -> Result<std::vector<Model>> {
        const auto observations = observe(training, options);
        if (!observations) return observations.error();
        SampleFitOptions how;
        how.pm.lobes = 3;
        how.pm.starts = 4, how.pm.perturbations = 5;
        auto pm = fit_pm(*observations, how);
        if (!pm) return pm.error();
        return std::vector<Model>{{pm->model, {}}};
    };
    const auto fold = assign_folds(samples, k_cap, 0);
    ASSERT_TRUE(fold.ok());
    const auto predicted = cross_validate(samples, *fold, fit);
    ASSERT_TRUE(predicted.ok());
    std::vector<float> measured;
    for (const Rgb& f : samples.colour) measured.insert(measured.end(), {f.r, f.g, f.b});
    const double error = measure_samples(samples.wl, samples.wv, measured, (*predicted)[0], k_cap).squared_error_ratio;
    EXPECT_LT(error, 2 * noise * noise);    // the held-out samples are noisy themselves
    EXPECT_GT(error, 0.7 * noise * noise);  // a smaller error would mean that they were used in the fit
    const auto whole = fit(samples);
    ASSERT_TRUE(whole.ok());
    // Compared with the noise-free values the fit is better than a sample.
    double wrong = 0, all = 0;
    std::mt19937_64 random(5);
    for (int i = 0; i < 20000; ++i) {
        const Vec3d wl = draw(random, k_cap), wv = draw(random, k_cap);
        const double f = double(glossy(wl, wv).g), g = double(value((*whole)[0], to_float(wl), to_float(wv)).g);
        wrong += (f - g) * (f - g), all += f * f;
    }
    EXPECT_LT(wrong / all, 0.5 * noise * noise);
    for (const float lambda : std::get<PmModel>((*whole)[0].model).bandwidth)
        EXPECT_LE(double(lambda), 1.001 / (finest * finest));
}

TEST(FitToSamples, OneOfManyValuesAtOnePlaceIsTheirMean) {
    // Two values at every place, ±10 % of the smooth one.
    ScatteredSamples samples = samples_of(400, 0, 6);
    const std::size_t n = samples.wl.size();
    for (std::size_t i = 0; i < n; ++i) {
        const Rgb f = samples.colour[i];
        const Vec3f wl = samples.wl[i], wv = samples.wv[i];
        samples.wl.push_back(wl), samples.wv.push_back(wv);
        samples.colour.push_back({0.9f * f.r, 0.9f * f.g, 0.9f * f.b});
        samples.colour[i] = {1.1f * f.r, 1.1f * f.g, 1.1f * f.b};
    }
    make_index(samples);
    const auto observations = observe(samples, {Objective::raw, k_cap, 0});
    ASSERT_TRUE(observations.ok());
    EXPECT_TRUE(near(double(observations->groups), double(n), 3));  // a few lie as near by chance
    SampleFitOptions how;
    how.pm.lobes = 4, how.pm.starts = 4, how.pm.perturbations = 3;
    const auto fit = fit_pm(*observations, how);
    ASSERT_TRUE(fit.ok());
    const Measures at_samples = measure_samples(samples.wl, samples.wv, samples.colour, evaluator(fit->model), k_cap);
    EXPECT_TRUE(near(at_samples.squared_error_ratio, 0.01 / 1.01, 0.001)) << at_samples.squared_error_ratio;
}

TEST(FitToSamples, SamplesOfOnePlaneAreFittedAndStayBounded) {
    ScatteredSamples samples;
    double peak = 0;
    for (int l = 0; l <= 70; l += 10)
        for (int v = -75; v <= 75; v += 5) {
            const Vec3d wl = spherical(l * k_degree, 0.0), wv = spherical(std::abs(v) * k_degree, v < 0 ? 0.0 : k_pi);
            samples.wl.push_back(to_float(wl)), samples.wv.push_back(to_float(wv));
            samples.colour.push_back(glossy(wl, wv));
            peak = std::max(peak, double(samples.colour.back().g) * wl.z * wv.z);
        }
    make_index(samples);
    const auto observations = observe(samples, {Objective::raw, k_cap, 0});
    ASSERT_TRUE(observations.ok());
    for (const bool fill : {false, true}) {
        SampleFitOptions how{{}, fill};
        how.pm.lobes = 4, how.pm.starts = 4, how.pm.perturbations = 3;
        const auto fit = fit_pm(*observations, how);
        ASSERT_TRUE(fit.ok());
        std::mt19937_64 random(8);
        for (int i = 0; i < 20000; ++i) {
            const Vec3d wl = draw(random, 89.9 * k_degree), wv = draw(random, 89.9 * k_degree);
            const double f = double(value(fit->model, to_float(wl), to_float(wv)).g) * wl.z * wv.z;
            EXPECT_TRUE(std::isfinite(f) && f <= 2 * peak) << f << ' ' << peak;
        }
    }
}

/// A rough coat of Beckmann's distribution over a coloured base: similar to what completes samples, but not the same.
Rgb coated(Vec3d wl, Vec3d wv) {
    const Vec3d h = normalize(wl + wv);
    const double m2 = 0.004, cos2 = h.z * h.z, cos_d = dot(wl, h);
    const double distribution = elementary::exp((1 - 1 / cos2) / m2) / (k_pi * m2 * cos2 * cos2);
    const double coat = distribution * (0.04 + 0.96 * elementary::pow(1 - cos_d, 5)) / (4 * cos_d * cos_d);
    return {float(0.15 + coat), float(0.04 + coat), float(0.02 + coat)};
}

/// As a goniometer takes them: four angles of the light, viewers in its plane every 5°, and a few out of it.
ScatteredSamples taken_by_goniometer(Rgb (*f)(Vec3d, Vec3d)) {
    ScatteredSamples samples;
    const auto add = [&](double theta_l, double theta_v, double azimuth) {
        const Vec3d wl = spherical(theta_l * k_degree, 0.0), wv = spherical(theta_v * k_degree, azimuth * k_degree);
        samples.wl.push_back(to_float(wl)), samples.wv.push_back(to_float(wv)), samples.colour.push_back(f(wl, wv));
    };
    for (const double theta_l : {10.0, 30.0, 50.0, 70.0}) {
        for (int theta_v = -80; theta_v <= 80; theta_v += 5) add(theta_l, std::abs(theta_v), theta_v < 0 ? 0 : 180);
        for (const double azimuth : {30.0, 60.0, 90.0, 120.0, 150.0})
            for (const double theta_v : {15.0, 30.0, 45.0, 60.0, 75.0}) add(theta_l, theta_v, azimuth);
    }
    make_index(samples);
    return samples;
}

Evaluate as_brdf(Rgb (*f)(Vec3d, Vec3d)) {
    return [f](std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> values) {
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] = wl[i].z > 0 && wv[i].z > 0 ? f(to_double(wl[i]), to_double(wv[i])) : Rgb{};
    };
}

TEST(GapFilledSamples, AreTheSamplesAtTheSamplesAndBoundedElsewhere) {
    const ScatteredSamples samples = taken_by_goniometer(coated);
    const auto completed = fill_gaps(samples, k_cap);
    ASSERT_TRUE(completed.ok());
    double peak = 0;
    for (std::size_t i = 0; i < samples.wl.size(); ++i) {
        const Vec3f wl = samples.wl[i], wv = samples.wv[i];
        if (std::min(wl.z, wv.z) < sample_cap(k_cap)) continue;
        for (int c = 0; c < 3; ++c) {
            const double f = double(samples.colour[i][c]);
            EXPECT_TRUE(near(double(value(*completed, wl, wv)[c]), f, 1e-3 * f));
            EXPECT_TRUE(near(double(value(*completed, wv, wl)[c]), f, 1e-3 * f));
            peak = std::max(peak, f * double(wl.z) * double(wv.z));
        }
    }
    std::mt19937_64 random(10);
    for (int i = 0; i < 20000; ++i) {
        const Vec3f wl = to_float(draw(random, 89.9 * k_degree)), wv = to_float(draw(random, 89.9 * k_degree));
        const Rgb f = value(*completed, wl, wv);
        double agreed = 1.8 * peak;
        for (const GgxModel& prior : completed->priors) {
            const Rgb g = value(prior, wl, wv);
            agreed = std::min(agreed, double(std::max({g.r, g.g, g.b})) * double(wl.z) * double(wv.z));
        }
        const double most = std::max(peak, agreed);
        for (int c = 0; c < 3; ++c)
            EXPECT_TRUE(f[c] >= 0 && double(f[c]) * double(wl.z) * double(wv.z) <= 1.0001 * most);
    }
    const auto of_one = fill_gaps(samples, k_cap, 0, true);
    ASSERT_TRUE(of_one.ok());
    EXPECT_TRUE(near(of_one->most, 1.6 * peak, 1e-5 * peak) && of_one->allowed == of_one->most);
}

TEST(GapFilledSamples, OfAMicrofacetModelAreThatModel) {
    static const GgxModel paint{{0.3f, 0.1f, 0.05f}, {{0.08f, {0.05f, 0.05f, 0.05f}, 0.8f}}};
    const ScatteredSamples samples =
        taken_by_goniometer([](Vec3d wl, Vec3d wv) { return value(paint, to_float(wl), to_float(wv)); });
    const auto completed = fill_gaps(samples, k_cap);
    ASSERT_TRUE(completed.ok());
    const Evaluate others[] = {evaluator(*completed), evaluator(Measured{"", "", 0, samples})};
    const auto errors = measure_heldout(rgb_channels(evaluator(paint)), rgb_channels(others), {k_cap}, 20000);
    EXPECT_LT(errors[0].squared_error_ratio, 0.001);
    EXPECT_GT(errors[1].squared_error_ratio, 0.1);  // of the interpolated samples
}

TEST(GapFilledSamples, LeaveHighlightsToGgxIfFoldsPreferIt) {
    const ScatteredSamples samples = taken_by_goniometer(coated);
    const auto without = fill_gaps(samples, k_cap);
    ASSERT_TRUE(without.ok());
    GapFilledSamples with = *without;
    with.continuation = {1, 0.05};
    std::mt19937_64 random(11);
    int bright = 0, dark = 0;
    for (int i = 0; i < 2000; ++i) {
        const Vec3f wl = to_float(draw(random, k_cap)), wv = to_float(draw(random, k_cap));
        const Rgb f = value(*without, wl, wv), g = value(with.priors[1], wl, wv), found = value(with, wl, wv);
        const double area = double(wl.z) * double(wv.z), limit = 0.05 * with.allowed;
        const double largest = double(std::max({f.r, f.g, f.b, g.r, g.g, g.b})) * area;
        bright += largest > limit, dark += largest < limit / 2;
        if (largest > limit) {
            EXPECT_TRUE(near(found.g, g.g, 1e-4 * double(g.g)));
        }
        if (largest < limit / 2) {
            EXPECT_EQ(found.g, f.g);
        }
    }
    EXPECT_GT(bright, 20);
    EXPECT_GT(dark, 20);

    GapFilledSamples lowered = with;
    lowered.continuation.share = 0.8;
    const Vec3f mirrored = to_float(spherical(60 * k_degree, 0.0)), viewer = to_float(spherical(60 * k_degree, k_pi));
    const Rgb g = value(with.priors[1], mirrored, viewer);
    EXPECT_TRUE(near(value(lowered, mirrored, viewer).g, 0.8f * g.g, 1e-4 * double(g.g)));

    const auto fold = assign_folds(samples, k_cap, 0);
    ASSERT_TRUE(fold.ok());
    const auto without_each = fill_gaps_without_folds(samples, *fold, k_cap);
    ASSERT_TRUE(without_each.ok() && without_each->size() == std::size_t(k_folds));
    for (const GapFilledSamples& others : *without_each)
        EXPECT_EQ(words(others.continuation), words(without_each->front().continuation));
    EXPECT_EQ(words(Continuation{}), "neighbours");
    EXPECT_EQ(words(lowered.continuation), "0.8 times one lobe of GGX");
    EXPECT_EQ(words(Continuation{0, 1}), "two lobes of GGX beyond the largest sample");
}

/// Pairs of directions as instruments take them, none at the mirror direction: on a grid of angles, in the plane of incidence,
/// and few at random.
std::vector<ScatteredSamples> layouts_without_mirror() {
    std::vector<ScatteredSamples> all(3);
    const auto add = [](ScatteredSamples& to, double theta_l, double theta_v, double azimuth) {
        to.wl.push_back(to_float(spherical(theta_l * k_degree, k_pi)));
        to.wv.push_back(to_float(spherical(theta_v * k_degree, azimuth * k_degree)));
    };
    for (const double theta_l : {0.0, 20.0, 40.0, 60.0})
        for (int theta_v = 5; theta_v < 80; theta_v += 10)
            for (int azimuth = 0; azimuth <= 180; azimuth += 30) add(all[0], theta_l, theta_v, azimuth);
    for (const double theta_l : {15.0, 45.0})
        for (int theta_v = -70; theta_v <= 70; theta_v += 10) add(all[1], theta_l, theta_v, 0);
    std::mt19937_64 random(12);
    while (all[2].wl.size() < 60)
        if (const Vec3d wl = draw(random, k_cap), wv = draw(random, k_cap); normalize(wl + wv).z < 0.999)
            all[2].wl.push_back(to_float(wl)), all[2].wv.push_back(to_float(wv));
    return all;
}

/// f at those pairs, each channel with noise of its own.
ScatteredSamples with_noise(ScatteredSamples samples, const std::function<Rgb(Vec3d, Vec3d)>& f, double noise,
                            std::uint64_t seed) {
    std::mt19937_64 random(seed);
    for (std::size_t i = 0; i < samples.wl.size(); ++i) {
        Rgb value = f(to_double(samples.wl[i]), to_double(samples.wv[i]));
        for (int c = 0; c < 3; ++c) {
            double normal = -6;
            for (int k = 0; k < 12; ++k) normal += uniform(random);
            value[c] *= float(1 + noise * normal);
        }
        samples.colour.push_back(value);
    }
    make_index(samples);
    return samples;
}

// A lobe narrower than the gap between samples would cost nothing at them, and be a highlight that nobody measured.
TEST(GapFilledSamples, OfAMatteSurfaceHaveNoHighlight) {
    constexpr double noise = 0.01, lambert[] = {0.1592, 0.1273, 0.0955};
    const auto matte = [&](Vec3d, Vec3d) { return Rgb{float(lambert[0]), float(lambert[1]), float(lambert[2])}; };
    for (const ScatteredSamples& layout : layouts_without_mirror())
        for (std::uint64_t seed = 0; seed < 20; ++seed)
            for (const bool of_one : {false, true}) {
                const auto completed = fill_gaps(with_noise(layout, matte, noise, seed), k_cap, 0, of_one);
                ASSERT_TRUE(completed.ok());
                EXPECT_EQ(words(*completed), k_no_highlight);
                for (int theta = 0; theta <= 75; theta += 15) {
                    const Rgb f = value(*completed, to_float(spherical(theta * k_degree, k_pi)),
                                        to_float(spherical(theta * k_degree, 0.0)));
                    for (int c = 0; c < 3; ++c)
                        EXPECT_TRUE(near(double(f[c]), lambert[c], 3 * noise * lambert[c])) << seed << ' ' << theta;
                }
            }
}

/// Lobes do not follow the noise of samples into gaps either.
TEST(FitToSamples, OfAMatteSurfaceHasNoHighlight) {
    constexpr double noise = 0.01;
    const auto matte = [](Vec3d, Vec3d) { return Rgb{0.16f, 0.13f, 0.1f}; };
    for (const ScatteredSamples& layout : layouts_without_mirror())
        for (std::uint64_t seed = 0; seed < 2; ++seed) {
            const auto observations =
                observe(with_noise(layout, matte, noise, seed), {.objective = Objective::appearance, .seed = seed});
            ASSERT_TRUE(observations.ok());
            SampleFitOptions how;
            how.pm.lobes = 4, how.pm.starts = 3, how.pm.perturbations = 4, how.pm.seed = seed;
            const auto fit = fit_pm(*observations, how);
            ASSERT_TRUE(fit.ok());
            for (int theta = 0; theta <= 75; theta += 5)
                EXPECT_TRUE(near(double(value(fit->model, to_float(spherical(theta * k_degree, k_pi)),
                                              to_float(spherical(theta * k_degree, 0.0)))
                                            .g),
                                 0.13, 3 * noise * 0.13))
                    << seed << ' ' << theta;
        }
}

TEST(GapFilledSamples, APeakIsAtMostFourTimesWhatIsMeasuredBesideIt) {
    // A highlight of which samples show the skirt alone.
    static const GgxModel narrow{{0.1f, 0.1f, 0.1f}, {{0.02f, {0.05f, 0.05f, 0.05f}, 0.05f}}};
    const auto f = [](Vec3d wl, Vec3d wv) { return value(narrow, to_float(wl), to_float(wv)); };
    for (const ScatteredSamples& layout : layouts_without_mirror()) {
        const ScatteredSamples samples = with_noise(layout, f, 0.01, 1);
        const auto completed = fill_gaps(samples, k_cap);
        ASSERT_TRUE(completed.ok());
        double largest = 0;  // f A
        for (std::size_t i = 0; i < samples.wl.size(); ++i)
            largest = std::max(largest, double(samples.colour[i].g) * double(samples.wl[i].z * samples.wv[i].z));
        for (const GgxModel& prior : completed->priors)
            for (const GgxModel::Lobe& lobe : prior.lobes)
                EXPECT_GE(lobe.roughness, 0.999 * least_roughness(samples.wl, samples.wv));
        for (int theta = 0; theta <= 60; theta += 15) {
            const Vec3f wl = to_float(spherical(theta * k_degree, k_pi)),
                        wv = to_float(spherical(theta * k_degree, 0.0));
            EXPECT_LE(double(value(*completed, wl, wv).g * wl.z * wv.z), 4.4 * largest) << theta;
        }
    }
}

TEST(GapFilledSamples, SupportNoNarrowerLobeThanTheirHalfVectors) {
    const auto pairs_at = [](std::initializer_list<double> theta_h) {
        std::pair<std::vector<Vec3f>, std::vector<Vec3f>> pairs;
        for (const double theta : theta_h) {  // 30° on either side of the half vector, across its plane
            const Vec3d h = spherical(theta * k_degree, 0.0), across{0, 0.5, 0};
            pairs.first.push_back(to_float(std::sqrt(0.75) * h + across));
            pairs.second.push_back(to_float(std::sqrt(0.75) * h - across));
        }
        return pairs;
    };
    const auto least = [&](std::initializer_list<double> theta_h) {
        const auto [wl, wv] = pairs_at(theta_h);
        return least_roughness(wl, wv);
    };
    const double tan2 = std::tan(2 * k_degree), tan12 = std::tan(12 * k_degree);
    EXPECT_TRUE(near(least({5, 2, 7}), tan2, 1e-6));             // GGX has a quarter of its peak there
    EXPECT_TRUE(near(least({0, 0, 0.1, 12}), tan12 / 4, 1e-6));  // the peak itself is measured
    EXPECT_TRUE(near(least({2, 12}), std::max(tan2, tan12 / 4), 1e-6));
    EXPECT_EQ(least({}), 0);
}

/// Between lights 20° apart, where few viewers are out of the plane, and at the rim of a sphere, beyond the samples.
TEST(FitToSamples, GapsLookLikeTheMaterial) {
    const ScatteredSamples samples = taken_by_goniometer(coated);
    const Evaluate truth = as_brdf(coated);
    // Means of three seeds, which differ by a factor of two. Of a fit to the samples and interpolated values: 0.033,
    // 0.09, 1.6 and 2.8.
    constexpr std::uint64_t seeds = 3;
    double cosine = 0, albedo = 0, delta_e = 0, worst = 0;
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
        const auto observations =
            observe(samples, {.objective = Objective::appearance, .max_theta = k_cap, .seed = seed});
        ASSERT_TRUE(observations.ok());
        SampleFitOptions how;
        how.pm.starts = 6, how.pm.perturbations = 10, how.pm.seed = seed;
        const auto fit = fit_pm(*observations, how);
        ASSERT_TRUE(fit.ok());
        const Evaluate others[] = {evaluator(fit->model)};
        cosine +=
            measure_heldout(rgb_channels(truth), rgb_channels(others), {k_cap}, 20000)[0].squared_error_ratio_cosine /
            seeds;
        albedo += albedo_errors(truth, others, {k_cap})[0] / seeds;
        const Appearance seen = compare_pictures(truth, others, 0, {}, 32)[0];
        delta_e += seen.mean.delta_e / seeds;
        worst += seen.worst_delta_e / seeds;
    }
    EXPECT_LT(cosine, 0.015);
    EXPECT_LT(albedo, 0.07);
    EXPECT_LT(delta_e, 1);
    EXPECT_LT(worst, 2);
}

/// Towards the horizon, beyond the samples, lobes would exceed what they follow by 40 %.
TEST(FitToSamples, HighlightsOfTheHorizonAreNoBrighterThanCompleted) {
    const ScatteredSamples samples = taken_by_goniometer(coated);
    const double max_theta = 89 * k_degree;
    const auto observations = observe(samples, {.objective = Objective::appearance, .max_theta = max_theta});
    ASSERT_TRUE(observations.ok());
    SampleFitOptions how;
    how.pm.lobes = 8, how.pm.starts = 3, how.pm.perturbations = 4;
    const auto fit = fit_pm(*observations, how);
    ASSERT_TRUE(fit.ok());
    for (int theta = 70; theta <= 88; ++theta) {
        const Vec3f wl = to_float(spherical(theta * k_degree, 0.0)), wv = to_float(spherical(theta * k_degree, k_pi));
        EXPECT_LT(value(fit->model, wl, wv).g, 1.2f * value(*observations->gap_filled, wl, wv).g) << theta;
    }
}

/// Pairs beyond the samples at which lobes exceed bounds take few steps to hold, and leave the samples as they were.
TEST(FitToSamples, BoundsHardlyChangeAFitOfAMetal) {
    static const GgxModel metal{{0.003f, 0.002f, 0.002f}, {{0.0527f, {0.19f, 0.17f, 0.16f}, 0}}};
    const ScatteredSamples samples =
        taken_by_goniometer([](Vec3d wl, Vec3d wv) { return value(metal, to_float(wl), to_float(wv)); });
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
        const auto observations =
            observe(samples, {.objective = Objective::appearance, .max_theta = 89 * k_degree, .seed = seed});
        ASSERT_TRUE(observations.ok());
        SampleFitOptions how;
        how.pm.lobes = 6, how.pm.starts = 2, how.pm.perturbations = 4, how.pm.seed = seed;
        const auto fit = fit_pm(*observations, how);
        ASSERT_TRUE(fit.ok());
        const Measures at =
            measure_samples(samples.wl, samples.wv, samples.colour, evaluator(fit->model), 89 * k_degree);
        EXPECT_LT(at.squared_error_ratio, 0.001) << seed;  // with few steps alone 0.0022
    }
}

/// The fit of a paint's spectra, as colours, is as good as the fit of its colours, and nearly the same.
TEST(FitToSamples, SpectraOfARealPaintHaveTheColoursOfItsFit) {
    const auto path = shared_data() / "cornell" / "krylon_blue.brdf";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
    const Measured paint = *load_measured(path.string());
    const auto& samples = std::get<ScatteredSamples>(paint.table);
    SampleFitOptions how;
    how.pm.lobes = 4;
    how.pm.starts = 12, how.pm.perturbations = 24;
    const auto fit = [&](bool spectral) {
        return fit_pm(*observe(samples, ObserveSamplesOptions{Objective::raw, 80 * k_degree, 0, spectral}), how);
    };
    const auto rgb = fit(false), spectral = fit(true);
    ASSERT_TRUE(rgb && spectral);
    EXPECT_EQ(spectral->model.wavelength, samples.wavelengths);
    EXPECT_EQ(payload_bytes(spectral->model), payload_bytes(rgb->model) + 2 * 4 * (31 - 3));
    const auto off = [&](const PmModel& model) {
        return measure_samples(samples.wl, samples.wv, samples.colour, evaluator(model), 80 * k_degree)
            .squared_error_ratio;
    };
    std::vector<float> f(samples.spectrum.size());
    spectra(spectral->model).evaluate(samples.wl, samples.wv, f);
    const double of_spectra =
        measure_samples(samples.wl, samples.wv, samples.spectrum, f, 80 * k_degree).squared_error_ratio;
    std::vector<Rgb> of_rgb(samples.wl.size());
    evaluate(rgb->model, samples.wl, samples.wv, of_rgb);
    const double apart =
        measure_samples(samples.wl, samples.wv, of_rgb, evaluator(spectral->model), 80 * k_degree).squared_error_ratio;
    EXPECT_LT(off(spectral->model), 1.5 * off(rgb->model));
    EXPECT_LT(of_spectra, 1.5 * off(rgb->model));
    EXPECT_LT(apart, off(rgb->model));
}

TEST(FitToSamples, WhatCannotBeFittedIsAnError) {
    const auto why = [](const ScatteredSamples& samples, int lobes) {
        const auto observations = observe(samples, {Objective::raw, k_cap, 0});
        if (!observations) return message(observations.error());
        SampleFitOptions how;
        how.pm.lobes = lobes, how.pm.starts = 1, how.pm.perturbations = 0;
        const auto fit = fit_pm(*observations, how);
        return fit ? std::string() : message(fit.error());
    };
    EXPECT_NE(why(samples_of(20, 0, 9), 8).find("samples: expected at least 96 values, found 60"), std::string::npos)
        << why(samples_of(20, 0, 9), 8);
    EXPECT_EQ(why(samples_of(40, 0, 9), 2), "");
    ScatteredSamples black = samples_of(40, 0, 9);
    for (Rgb& f : black.colour) f = {0, -1, 0};
    EXPECT_NE(why(black, 1).find("some above 0"), std::string::npos);
    ScatteredSamples grazing = samples_of(40, 0, 9);
    for (Vec3f& w : grazing.wl) w = to_float(spherical(88 * k_degree, 1.0));
    EXPECT_NE(why(grazing, 1).find("within the largest angle"), std::string::npos);
}

}  // namespace
}  // namespace srbf::fit_samples_test
