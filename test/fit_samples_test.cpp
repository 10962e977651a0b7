// Fits to scattered samples: folds, spacing, errors away from the samples.
#include "errors/measures.h"
#include "samples/gap_filled_samples.h"

#include <numeric>
#include <set>

#include "brdf/colour.h"
#include "brdf/directions.h"
#include "brdf/values.h"
#include "brdf_functions.h"
#include "errors/picture_errors.h"
#include "fit/cross_validated_fits.h"
#include "fit/request_traits.h"
#include "measured_files.h"
#include "models/ggx/ggx_kind.h"
#include "models/pm/pm_functions.h"
#include "properties.h"
#include "samples/facets.h"
#include "samples/folds.h"
#include "srbf/fit.h"

namespace srbf::fit_samples_test {
namespace {

/// A glossy film over a diffuse base. It is smooth at the scale of the samples below.
Rgb glossy(Vec3d wl, Vec3d wv) {
    const Vec3d h = normalize(wl + wv);
    const double gloss = 0.6 * elementary::exp(-12 * (1 - h.z)) * (1 + 2 * elementary::pow(1 - dot(wl, h), 3));
    return {float(0.1 + gloss), float(0.2 + gloss), float(0.05 + 0.8 * gloss)};
}

Vec3d random_direction_within(std::mt19937_64& random, double theta_max) {
    const double z = 1 - uniform(random) * (1 - elementary::cos(theta_max)), phi = 2 * k_pi * uniform(random);
    return {std::sqrt(1 - z * z) * elementary::cos(phi), std::sqrt(1 - z * z) * elementary::sin(phi), z};
}

/// Samples of `glossy` with noise of this standard deviation, relative to the values.
ScatteredSamples random_samples(int count, double noise, std::uint64_t seed, double theta_max = 75 * k_degree) {
    std::mt19937_64 random(seed);
    ScatteredSamples samples;
    for (int i = 0; i < count; ++i) {
        const Vec3d wl = random_direction_within(random, theta_max), wv = random_direction_within(random, theta_max);
        samples.wl.push_back(to_float(wl));
        samples.wv.push_back(to_float(wv));
        samples.colour.push_back(scaled(float(1 + noise * standard_normal(random)), glossy(wl, wv)));
    }
    make_index(samples);
    return samples;
}

constexpr double k_cap = 75 * k_degree;

/// The errors of a model against values at the samples.
Measures errors_at(const ScatteredSamples& samples, std::span<const Rgb> f, const Evaluate& model, double max_theta) {
    std::vector<float> g(3 * f.size());
    rgb_channels(model).evaluate(samples.wl, samples.wv, g);
    return measure_samples(samples.wl, samples.wv, {&f[0].r, g.size()}, g, max_theta);
}

TEST(Folds, KeepGroupsTogetherAndHaveEqualSizes) {
    ScatteredSamples samples = random_samples(500, 0, 1);
    // Copies of every tenth sample: unchanged, exchanged, mirrored and rotated.
    for (std::size_t i = 0; i < 500; i += 10) {
        const Vec3f l = samples.wl[i], v = samples.wv[i];
        const auto add = [&](Vec3f wl, Vec3f wv) {
            samples.wl.push_back(wl);
            samples.wv.push_back(wv);
            samples.colour.push_back(samples.colour[i]);
        };
        add(l, v), add(v, l), add({l.x, -l.y, l.z}, {v.x, -v.y, v.z}), add({-l.y, l.x, l.z}, {-v.y, v.x, v.z});
    }
    make_index(samples);
    const auto fold = checked(assign_folds(samples, k_cap, 7));
    for (int k = 0; k < k_folds; ++k) {
        const auto size = std::count(fold->begin(), fold->begin() + 500, k);
        EXPECT_TRUE(size >= 95 && size <= 105) << size;
    }
    for (std::size_t i = 500; i < fold->size(); ++i) EXPECT_EQ((*fold)[i], (*fold)[(i - 500) / 4 * 10]);
    // If the samples are anisotropic, rotated copies belong to other groups.
    samples.isotropic = false;
    const auto anisotropic_fold = checked(assign_folds(samples, k_cap, 7));
    int separated = 0;
    for (std::size_t i = 503; i < fold->size(); i += 4)
        separated += (*anisotropic_fold)[i] != (*anisotropic_fold)[(i - 503) / 4 * 10];
    EXPECT_GT(separated, 20);
}

/// A comparison of all pairs of these samples would take minutes.
TEST(Folds, VeryManySamplesMayBeClose) {
    std::mt19937_64 random(1);
    ScatteredSamples samples = random_samples(200, 0, 1);
    for (int i = 0; i < 200'000; ++i) {
        const auto direction_near = [&](double theta) {
            return to_float(spherical(theta + 0.004 * uniform(random), 1 + 0.004 * uniform(random)));
        };
        samples.wl.push_back(direction_near(0.5));
        samples.wv.push_back(direction_near(0.7));
        samples.colour.push_back({1, 1, 1});
    }
    const auto fold = checked(assign_folds(samples, k_cap, 0));
    EXPECT_EQ(std::set(fold->begin() + 200, fold->end()).size(), 1u);
    EXPECT_EQ(std::set(fold->begin(), fold->begin() + 200).size(), std::size_t(k_folds));
}

TEST(Folds, TheBrightestSamplesAreInDifferentFolds) {
    const ScatteredSamples samples = random_samples(300, 0, 2);
    const auto fold = checked(assign_folds(samples, k_cap, 3));
    std::vector<std::size_t> order(samples.wl.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return luminance(samples.colour[a]) > luminance(samples.colour[b]);
    });
    std::set<int> folds_of_brightest;
    for (int k = 0; k < k_folds; ++k) folds_of_brightest.insert((*fold)[order[std::size_t(k)]]);
    EXPECT_EQ(folds_of_brightest.size(), std::size_t(k_folds));
    EXPECT_EQ(*fold, *assign_folds(samples, k_cap, 3));
    EXPECT_NE(*fold, *assign_folds(samples, k_cap, 4));
}

/// A rough surface with a glossy layer: Lambert and two GGX lobes, whose roughnesses differ from those of the
/// fitted mixture.
const GgxModel k_two_lobes{{0.05f, 0.05f, 0.05f},
                           {{0.013f, {0.5f, 0.5f, 0.5f}, 1}, {0.17f, {0.05f, 0.05f, 0.05f}, 0.3f}}};

/// Returns in-plane scans of `f` every two degrees, with a relative error of at most `noise`.
ScatteredSamples scans_of(const std::function<float(Vec3f wl, Vec3f wv)>& f, std::span<const double> incidences,
                          double noise) {
    std::mt19937_64 random(1);
    ScatteredSamples scans;
    scans.isotropic = true;
    for (const double theta : incidences)
        for (int view = -78; view <= 78; view += 2) {
            const Vec3f wl = direction_at(theta, 180), wv = direction_at(view, 0);
            const float measured = f(wl, wv) * float(1 + noise * (2 * uniform(random) - 1));
            scans.wl.push_back(wl), scans.wv.push_back(wv), scans.colour.push_back({measured, measured, measured});
        }
    make_index(scans);
    return scans;
}

// For microfacets, scans determine f for all pairs of directions, including pairs out of the plane and other
// incidences.
TEST(FacetMixture, BetweenScansFollowsMicrofacets) {
    constexpr double incidences[] = {5, 40, 60, 75};
    const auto f = [](Vec3f wl, Vec3f wv) { return value(k_two_lobes, wl, wv).g; };
    const auto observed =
        checked(observe(scans_of(f, incidences, 0.05), {.objective = Objective::relative, .fill_gaps = false}));
    const FacetMixture facets = fit_facets(observed->samples);
    double squares = 0;
    std::mt19937_64 random(2);
    constexpr int pairs = 4096;
    for (int i = 0; i < pairs; ++i) {
        const Vec3f wl = to_float(random_direction_within(random, k_cap)),
                    wv = to_float(random_direction_within(random, k_cap));
        squares += elementary::square(elementary::log(double(value(facets, wl, wv).g) / double(f(wl, wv))));
    }
    EXPECT_LT(std::sqrt(squares / pairs), 0.1);
}

// A distribution other than GGX, evaluated at held-out incidences.
TEST(FitSamples, IsCloserThanGgxAtHeldoutIncidences) {
    constexpr double incidences[] = {10, 30, 50, 70};
    const auto abg = [](Vec3f wl, Vec3f wv) {  // Lambert and A / (B + |Δ sinθ|^g)
        const double distance = std::hypot(double(wl.x + wv.x), double(wl.y + wv.y));
        return float(0.02 + 0.01 / (0.001 + elementary::pow(distance, 1.8)));
    };
    const Measured scans{"", "", 0, scans_of(abg, incidences, 0.05)};
    const auto heldout = [&](const auto& model) {
        const auto outcome = fit(scans, {.model = model, .objective = Objective::relative});
        EXPECT_TRUE(outcome.ok());
        return outcome.ok() ? outcome->errors->heldout.log10_rms : INFINITY;
    };
    EXPECT_LT(heldout(PmRequest{.size = LobeCount{4}}), heldout(GgxRequest{}));
}

TEST(Folds, FewGroupsAreAnError) {
    ScatteredSamples samples = random_samples(4, 0, 3);
    for (std::size_t i = 0; i < 4; ++i) {
        samples.wl.push_back(samples.wl[i]);
        samples.wv.push_back(samples.wv[i]);
        samples.colour.push_back({2, 2, 2});
    }
    make_index(samples);
    const auto fold = assign_folds(samples, k_cap, 0);
    ASSERT_FALSE(fold.ok());
    EXPECT_CONTAINS(error_text(fold), "expected at least 5, found 4");
}

TEST(FitSamples, NoiseIsNotFitted) {
    const double noise = 0.02;
    const ScatteredSamples samples = random_samples(1500, noise, 4);
    const auto outcome = checked(fit({"", "", 0, samples}, {PmRequest{.size = LobeCount{3}}, Objective::raw, k_cap}));
    const double error = outcome->errors->heldout.squared_error_ratio;
    EXPECT_LT(error, 2 * noise * noise);    // the held-out samples are noisy themselves
    EXPECT_GT(error, 0.7 * noise * noise);  // a smaller error would mean that the fit used them
    // The error against the noise-free values is smaller than that of a sample.
    double squared_error = 0, squares = 0;
    std::mt19937_64 random(5);
    for (int i = 0; i < 20000; ++i) {
        const Vec3d wl = random_direction_within(random, k_cap), wv = random_direction_within(random, k_cap);
        const double f = double(glossy(wl, wv).g), g = double(value(outcome->model, to_float(wl), to_float(wv)).g);
        squared_error += (f - g) * (f - g);
        squares += f * f;
    }
    EXPECT_LT(squared_error / squares, 0.5 * noise * noise);
}

TEST(FitSamples, AveragesValuesAtTheSameDirections) {
    // Two values for each pair of directions, 10 % above and below the smooth one.
    ScatteredSamples samples = random_samples(400, 0, 6);
    const std::size_t n = samples.wl.size();
    for (std::size_t i = 0; i < n; ++i) {
        const Rgb f = samples.colour[i];
        const Vec3f wl = samples.wl[i], wv = samples.wv[i];
        samples.wl.push_back(wl);
        samples.wv.push_back(wv);
        samples.colour.push_back(scaled(0.9f, f));
        samples.colour[i] = scaled(1.1f, f);
    }
    make_index(samples);
    const auto observations = checked(observe(samples, {Objective::raw, k_cap, 0}));
    const auto fit = checked(fit_pm(*observations, {.lobes = 4, .starts = 4, .perturbations = 3}));
    const Measures errors = errors_at(samples, samples.colour, evaluator(fit->model), k_cap);
    EXPECT_WITHIN(errors.squared_error_ratio, 0.01 / 1.01, 0.001);
}

TEST(FitSamples, StaysBoundedOutsideThePlaneOfItsSamples) {
    ScatteredSamples samples;
    double peak = 0;
    for (int l = 0; l <= 70; l += 10)
        for (int v = -75; v <= 75; v += 5) {
            const Vec3d wl = spherical(l * k_degree, 0.0), wv = spherical(std::abs(v) * k_degree, v < 0 ? 0.0 : k_pi);
            samples.wl.push_back(to_float(wl));
            samples.wv.push_back(to_float(wv));
            samples.colour.push_back(glossy(wl, wv));
            peak = std::max(peak, double(samples.colour.back().g) * wl.z * wv.z);
        }
    make_index(samples);
    const auto observations = checked(observe(samples, {Objective::raw, k_cap, 0}));
    const auto fit = checked(fit_pm(*observations, {.lobes = 4, .starts = 4, .perturbations = 3}));
    std::mt19937_64 random(8);
    for (int i = 0; i < 20000; ++i) {
        const Vec3d wl = random_direction_within(random, 89.9 * k_degree),
                    wv = random_direction_within(random, 89.9 * k_degree);
        const double f = double(value(fit->model, to_float(wl), to_float(wv)).g) * wl.z * wv.z;
        EXPECT_TRUE(std::isfinite(f) && f <= 2 * peak) << f << ' ' << peak;
    }
}

/// A rough coat with Beckmann's distribution over a coloured base. The model that fills gaps is similar, but not
/// the same.
Rgb coated(Vec3d wl, Vec3d wv) {
    const Vec3d h = normalize(wl + wv);
    const double m2 = 0.004, cos2 = h.z * h.z, cos_d = dot(wl, h);
    const double distribution = elementary::exp((1 - 1 / cos2) / m2) / (k_pi * m2 * cos2 * cos2);
    const double coat = distribution * (0.04 + 0.96 * elementary::pow(1 - cos_d, 5)) / (4 * cos_d * cos_d);
    return {float(0.15 + coat), float(0.04 + coat), float(0.02 + coat)};
}

/// Samples like those of a goniometer: four angles of the light, viewers in the plane of incidence every 5°, and a
/// few out of it.
ScatteredSamples goniometer_samples(Rgb (*f)(Vec3d, Vec3d)) {
    ScatteredSamples samples;
    const auto add = [&](double theta_l, double theta_v, double azimuth) {
        const Vec3d wl = spherical(theta_l * k_degree, 0.0), wv = spherical(theta_v * k_degree, azimuth * k_degree);
        samples.wl.push_back(to_float(wl));
        samples.wv.push_back(to_float(wv));
        samples.colour.push_back(f(wl, wv));
    };
    for (const double theta_l : {10.0, 30.0, 50.0, 70.0}) {
        for (int theta_v = -80; theta_v <= 80; theta_v += 5) add(theta_l, std::abs(theta_v), theta_v < 0 ? 0 : 180);
        for (const double azimuth : {30.0, 60.0, 90.0, 120.0, 150.0})
            for (const double theta_v : {15.0, 30.0, 45.0, 60.0, 75.0}) add(theta_l, theta_v, azimuth);
    }
    make_index(samples);
    return samples;
}

TEST(GapFilledSamples, MatchTheSamplesAndAreBoundedElsewhere) {
    const ScatteredSamples samples = goniometer_samples(coated);
    const auto completed = checked(fill_gaps(samples, k_cap));
    double peak = 0;
    for (std::size_t i = 0; i < samples.wl.size(); ++i) {
        const Vec3f wl = samples.wl[i], wv = samples.wv[i];
        if (std::min(wl.z, wv.z) < sample_cap(k_cap)) continue;
        EXPECT_RGB_WITHIN_RELATIVE(value(*completed, wl, wv), samples.colour[i], 1e-3, 0);
        EXPECT_RGB_WITHIN_RELATIVE(value(*completed, wv, wl), samples.colour[i], 1e-3, 0);
        peak = std::max(peak, largest_of(samples.colour[i]) * cosines(wl, wv));
    }
    std::mt19937_64 random(10);
    for (int i = 0; i < 20000; ++i) {
        const Vec3f wl = to_float(random_direction_within(random, 89.9 * k_degree)),
                    wv = to_float(random_direction_within(random, 89.9 * k_degree));
        const Rgb f = value(*completed, wl, wv);
        double prior_bound = 1.8 * peak;
        for (const GgxModel& prior : completed->priors)
            prior_bound = std::min(prior_bound, largest_of(value(prior, wl, wv)) * cosines(wl, wv));
        EXPECT_TRUE(f.r >= 0 && f.g >= 0 && f.b >= 0);
        EXPECT_LE(largest_of(f) * cosines(wl, wv), 1.0001 * std::max(peak, prior_bound));
    }
    const auto one_lobe = checked(fill_gaps(samples, k_cap, 0, true));
    EXPECT_WITHIN(one_lobe->prior_limit, 1.6 * peak, 1e-5 * peak);
    EXPECT_EQ(one_lobe->min_bound, one_lobe->prior_limit);
}

TEST(GapFilledSamples, RecoverAMicrofacetModel) {
    static const GgxModel paint{{0.3f, 0.1f, 0.05f}, {{0.08f, {0.05f, 0.05f, 0.05f}, 0.8f}}};
    const ScatteredSamples samples =
        goniometer_samples([](Vec3d wl, Vec3d wv) { return value(paint, to_float(wl), to_float(wv)); });
    const auto completed = checked(fill_gaps(samples, k_cap));
    const auto error_of = [](const Evaluate& brdf) {
        return heldout_measures(evaluator(paint), brdf, k_cap, 20000).squared_error_ratio;
    };
    EXPECT_LT(error_of(evaluator(*completed)), 0.001);
    EXPECT_GT(error_of(evaluator(measured_of(samples))), 0.1);  // interpolated
}

/// Pairs of directions as instruments measure them, none at the mirror direction: a grid of angles, scans in the
/// plane of incidence, and a few random pairs.
std::vector<ScatteredSamples> layouts_without_mirror() {
    std::vector<ScatteredSamples> layouts(3);
    const auto add = [](ScatteredSamples& layout, double theta_l, double theta_v, double azimuth) {
        layout.wl.push_back(direction_at(theta_l, 180));
        layout.wv.push_back(direction_at(theta_v, azimuth));
    };
    for (const double theta_l : {0.0, 20.0, 40.0, 60.0})
        for (int theta_v = 5; theta_v < 80; theta_v += 10)
            for (int azimuth = 0; azimuth <= 180; azimuth += 30) add(layouts[0], theta_l, theta_v, azimuth);
    for (const double theta_l : {15.0, 45.0})
        for (int theta_v = -70; theta_v <= 70; theta_v += 10) add(layouts[1], theta_l, theta_v, 0);
    std::mt19937_64 random(12);
    while (layouts[2].wl.size() < 60)
        if (const Vec3d wl = random_direction_within(random, k_cap), wv = random_direction_within(random, k_cap);
            normalize(wl + wv).z < 0.999) {
            layouts[2].wl.push_back(to_float(wl));
            layouts[2].wv.push_back(to_float(wv));
        }
    return layouts;
}

/// Samples of f for the directions of `samples`, with independent noise in each channel.
ScatteredSamples with_noise(ScatteredSamples samples, const std::function<Rgb(Vec3d, Vec3d)>& f, double noise,
                            std::uint64_t seed) {
    std::mt19937_64 random(seed);
    for (std::size_t i = 0; i < samples.wl.size(); ++i) {
        Rgb value = f(to_double(samples.wl[i]), to_double(samples.wv[i]));
        for (int c = 0; c < 3; ++c) value[c] *= float(1 + noise * standard_normal(random));
        samples.colour.push_back(value);
    }
    make_index(samples);
    return samples;
}

// A lobe narrower than the gaps between samples would not increase the loss, but would be a highlight that nobody
// measured.
TEST(GapFilledSamples, HaveNoHighlightForAMatteSurface) {
    constexpr double noise = 0.01;
    const Rgb lambert{0.1592f, 0.1273f, 0.0955f};
    const auto matte = [&](Vec3d, Vec3d) { return lambert; };
    for (const ScatteredSamples& layout : layouts_without_mirror())
        for (std::uint64_t seed = 0; seed < 20; ++seed)
            for (const bool one_lobe : {false, true}) {
                const auto completed = checked(fill_gaps(with_noise(layout, matte, noise, seed), k_cap, 0, one_lobe));
                for (const GgxModel& prior : completed->priors) EXPECT_TRUE(prior.lobes.empty());
                for (int theta = 0; theta <= 75; theta += 15) {
                    const Rgb f = value(*completed, direction_at(theta, 180), direction_at(theta, 0));
                    EXPECT_RGB_WITHIN_RELATIVE(f, lambert, 3 * noise, 0) << seed << ' ' << theta;
                }
            }
}

TEST(GapFilledSamples, KeepAConstant) {
    ScatteredSamples samples;  // near the horizon, where f A is less than elsewhere
    for (int i = 0; i < 40; ++i) {
        samples.wl.push_back(to_float(spherical(1.25, 0.0)));
        samples.wv.push_back(to_float(spherical(1 + 0.01 * i, 1.0 * i)));
        samples.colour.push_back({0.1f, 0.2f, 0.3f});
    }
    for (const bool one_lobe : {false, true}) {
        const auto completed = checked(fill_gaps(samples, 80 * k_degree, 0, one_lobe));
        for (int i = 0; i < 15; ++i) {
            const Vec3f wl = to_float(spherical(0.1 * i, 1.0 * i)), wv = to_float(spherical(0.1 * i, 0.0));
            EXPECT_WITHIN(value(*completed, wl, wv).g, 0.2, 1e-3) << i;
        }
    }
}

/// Four wrong values hide the highlight from the completion, from the fit and from cross-validation.
TEST(FitSamples, IsJudgedAtItsSamplesToo) {
    ScatteredSamples samples = random_samples(250, 0, 3);
    for (const std::size_t i : {0, 60, 120, 180}) samples.colour[i] = {9999, 9999, 9999};
    const auto outcome = checked(fit({"", "", 0, samples}, {.model = GgxRequest{.lobes = 1}}));
    Comparison errors = *outcome->errors;
    EXPECT_GT(errors.samples_delta_e, 10);
    EXPECT_TRUE(headline(errors).starts_with("visible at once")) << headline(errors);
    // The worst counts, and where errors disagree that is said.
    errors.samples_delta_e = 3;
    errors.measure = &Measures::log10_rms;
    errors.appearance.mean.delta_e = 5;
    errors.heldout_appearance->mean.delta_e = 4;
    errors.matrix.log10_rms = errors.heldout.log10_rms = 0.44;
    EXPECT_EQ(headline_errors(errors).mean.delta_e, 5);
    EXPECT_LACKS(headline(errors), "apart");
    errors.matrix.log10_rms = 1.17;
    const auto ends =
        "3 at the samples; RMS of log10 f 1.17 at the samples, 0.44 in cross-validation, more than a factor of two "
        "apart";
    EXPECT_TRUE(headline(errors).ends_with(ends)) << headline(errors);
}

/// Lobes do not follow the noise of samples into gaps.
TEST(FitSamples, HasNoHighlightForAMatteSurface) {
    constexpr double noise = 0.01;
    const auto matte = [](Vec3d, Vec3d) { return Rgb{0.16f, 0.13f, 0.1f}; };
    for (const ScatteredSamples& layout : layouts_without_mirror())
        for (std::uint64_t seed = 0; seed < 2; ++seed) {
            const auto observations = checked(
                observe(with_noise(layout, matte, noise, seed), {.objective = Objective::appearance, .seed = seed}));
            const auto fit =
                checked(fit_pm(*observations, {.lobes = 4, .starts = 3, .perturbations = 4, .seed = seed}));
            for (int theta = 0; theta <= 75; theta += 5) {
                const Rgb f = value(fit->model, direction_at(theta, 180), direction_at(theta, 0));
                EXPECT_WITHIN_RELATIVE(f.g, 0.13, 3 * noise) << seed << ' ' << theta;
            }
        }
}

TEST(GapFilledSamples, PeakIsAtMostFourTimesTheLargestSample) {
    // The samples cover only the skirt of this highlight.
    static const GgxModel narrow{{0.1f, 0.1f, 0.1f}, {{0.02f, {0.05f, 0.05f, 0.05f}, 0.05f}}};
    const auto f = [](Vec3d wl, Vec3d wv) { return value(narrow, to_float(wl), to_float(wv)); };
    for (const ScatteredSamples& layout : layouts_without_mirror()) {
        const ScatteredSamples samples = with_noise(layout, f, 0.01, 1);
        const auto completed = checked(fill_gaps(samples, k_cap));
        double largest = 0;  // of f times the cosines
        for (std::size_t i = 0; i < samples.wl.size(); ++i)
            largest = std::max(largest, double(samples.colour[i].g) * double(samples.wl[i].z * samples.wv[i].z));
        for (const GgxModel& prior : completed->priors)
            for (const GgxModel::Lobe& lobe : prior.lobes)
                EXPECT_GE(lobe.roughness, 0.999 * min_roughness(samples.wl, samples.wv));
        for (int theta = 0; theta <= 60; theta += 15) {
            const Vec3f wl = direction_at(theta, 180), wv = direction_at(theta, 0);
            EXPECT_LE(double(value(*completed, wl, wv).g * wl.z * wv.z), 4.4 * largest) << theta;
        }
    }
}

TEST(GapFilledSamples, BoundRoughnessByTheirHalfVectors) {
    const auto min_roughness_of = [](std::initializer_list<double> theta_h) {
        std::vector<Vec3f> wl, wv;
        for (const double theta : theta_h) {  // each direction 30° from the half vector, across the plane of incidence
            const Vec3d h = spherical(theta * k_degree, 0.0), across{0, 0.5, 0};
            wl.push_back(to_float(std::sqrt(0.75) * h + across));
            wv.push_back(to_float(std::sqrt(0.75) * h - across));
        }
        return min_roughness(wl, wv);
    };
    const double tan2 = std::tan(2 * k_degree), tan12 = std::tan(12 * k_degree);
    EXPECT_WITHIN(min_roughness_of({5, 2, 7}), tan2, 1e-6);             // where GGX is a quarter of its peak
    EXPECT_WITHIN(min_roughness_of({0, 0, 0.1, 12}), tan12 / 4, 1e-6);  // the peak itself was measured
    EXPECT_WITHIN(min_roughness_of({2, 12}), std::max(tan2, tan12 / 4), 1e-6);
    EXPECT_EQ(min_roughness_of({}), 0);
}

/// Pictures of gaps between lights 20° apart, with few viewers out of the plane, and of the rim of a sphere beyond
/// the samples.
TEST(FitSamples, LooksLikeTheMaterialInGaps) {
    const ScatteredSamples samples = goniometer_samples(coated);
    const Evaluate truth = pairwise(
        [](Vec3f wl, Vec3f wv) { return wl.z > 0 && wv.z > 0 ? coated(to_double(wl), to_double(wv)) : Rgb{}; });
    // Means over three seeds, which differ by a factor of two. A fit to the samples and interpolated values has
    // 0.033, 0.09, 1.6 and 2.8.
    constexpr std::uint64_t seeds = 3;
    double cosine = 0, albedo = 0, delta_e = 0, worst = 0;
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
        const auto observations =
            checked(observe(samples, {.objective = Objective::appearance, .max_theta = k_cap, .seed = seed}));
        const auto fit = checked(fit_pm(*observations, {.starts = 6, .perturbations = 14, .seed = seed}));
        const Evaluate others[] = {evaluator(fit->model)};
        cosine += heldout_measures(truth, others[0], k_cap, 20000).squared_error_ratio_cosine / seeds;
        albedo += albedo_errors(truth, others, {k_cap})[0] / seeds;
        const Appearance appearance = compare_pictures(truth, others, {.size = 32})[0];
        delta_e += appearance.mean.delta_e / seeds;
        worst += appearance.worst_delta_e / seeds;
    }
    EXPECT_LT(cosine, 0.015);
    EXPECT_LT(albedo, 0.07);
    EXPECT_LT(delta_e, 1);
    EXPECT_LT(worst, 2);
}

/// Beyond the samples, near the horizon, unbounded lobes would exceed the gap-filled samples by 40 %.
TEST(FitSamples, HorizonHighlightsAreNoBrighterThanGapFilledSamples) {
    const ScatteredSamples samples = goniometer_samples(coated);
    const double max_theta = 89 * k_degree;
    const auto observations = checked(observe(samples, {.objective = Objective::appearance, .max_theta = max_theta}));
    const auto fit = checked(fit_pm(*observations, {.lobes = 8, .starts = 3, .perturbations = 4}));
    for (int theta = 70; theta <= 88; ++theta) {
        const Vec3f wl = direction_at(theta, 0), wv = direction_at(theta, 180);
        EXPECT_LT(value(fit->model, wl, wv).g, 1.2f * value(*observations->gap_filled, wl, wv).g) << theta;
    }
}

/// Bounds on lobes at pairs beyond the samples take few steps to satisfy, and the fit of the samples stays as good.
TEST(FitSamples, BoundsBarelyChangeAFitOfAMetal) {
    static const GgxModel metal{{0.003f, 0.002f, 0.002f}, {{0.0527f, {0.19f, 0.17f, 0.16f}, 0}}};
    const ScatteredSamples samples =
        goniometer_samples([](Vec3d wl, Vec3d wv) { return value(metal, to_float(wl), to_float(wv)); });
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
        const auto observations =
            checked(observe(samples, {.objective = Objective::appearance, .max_theta = 89 * k_degree, .seed = seed}));
        const auto fit = checked(fit_pm(*observations, {.lobes = 6, .starts = 2, .perturbations = 4, .seed = seed}));
        const Measures errors = errors_at(samples, samples.colour, evaluator(fit->model), 89 * k_degree);
        EXPECT_LT(errors.squared_error_ratio, 0.001) << seed;  // 0.0022 with only a few steps
    }
}

/// A spectral fit of a paint, evaluated as colours, is as good as the fit of its colours, and nearly the same.
TEST(FitSamples, SpectralAndColourFitsOfAPaintAgree) {
    const auto path = shared_data() / "cornell" / "krylon_blue.brdf";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
    const Measured paint = *load_measured(path.string());
    const auto& samples = std::get<ScatteredSamples>(paint.table);
    const auto fit = [&](bool spectral) {
        return fit_pm(*observe(samples, ObserveSamplesOptions{Objective::raw, 80 * k_degree, 0, spectral}),
                      {.lobes = 4, .starts = 12, .perturbations = 24});
    };
    const auto rgb = checked(fit(false)), spectral = checked(fit(true));
    EXPECT_EQ(spectral->model.wavelength, samples.wavelengths);
    EXPECT_EQ(payload_bytes(spectral->model), payload_bytes(rgb->model) + 2 * 4 * (31 - 3));
    const auto error_of = [&](const PmModel& model) {
        return errors_at(samples, samples.colour, evaluator(model), 80 * k_degree).squared_error_ratio;
    };
    std::vector<float> f(samples.spectrum.size());
    spectra(spectral->model).evaluate(samples.wl, samples.wv, f);
    const double spectral_error =
        measure_samples(samples.wl, samples.wv, samples.spectrum, f, 80 * k_degree).squared_error_ratio;
    std::vector<Rgb> rgb_values(samples.wl.size());
    evaluate(rgb->model, samples.wl, samples.wv, rgb_values);
    const double difference =
        errors_at(samples, rgb_values, evaluator(spectral->model), 80 * k_degree).squared_error_ratio;
    EXPECT_LT(error_of(spectral->model), 1.5 * error_of(rgb->model));
    EXPECT_LT(spectral_error, 5 * error_of(rgb->model));
    EXPECT_LT(difference, error_of(rgb->model));
}

/// A spectral fit has the lobes and the colours of the fit to colours where gaps are filled in colours.
TEST(FitSamples, GapsAreFilledForSpectraAsForColours) {
    ScatteredSamples samples = goniometer_samples(coated);
    samples.wavelengths = {450, 550, 650};
    const std::vector<Rgb> weights = rgb_weights(samples.wavelengths);
    for (Rgb& f : samples.colour) {
        const float spectrum[] = {f.b, f.g, f.r};
        samples.spectrum.insert(samples.spectrum.end(), std::begin(spectrum), std::end(spectrum));
        f = {};
        for (std::size_t i = 0; i < weights.size(); ++i)
            for (int c = 0; c < 3; ++c) f[c] += weights[i][c] * spectrum[i];
    }
    const auto fit = [&](bool spectral) {
        return fit_pm(*observe(samples, ObserveSamplesOptions{.spectral = spectral}),
                      {.lobes = 3, .starts = 2, .perturbations = 2});
    };
    const auto rgb = checked(fit(false)), spectral = checked(fit(true));
    EXPECT_EQ(spectral->model.wavelength, samples.wavelengths);
    EXPECT_EQ(spectral->model.parameterization, rgb->model.parameterization);
    std::vector<Rgb> colours(samples.wl.size());
    evaluate(rgb->model, samples.wl, samples.wv, colours);
    EXPECT_LT(errors_at(samples, colours, evaluator(spectral->model), k_cap).squared_error_ratio,
              1e-4);  // coefficients are rounded to 16 bits
}

TEST(FitSamples, TooFewOrUnusableSamplesAreAnError) {
    const auto error_message = [](const ScatteredSamples& samples, int lobes) {
        const auto observations = observe(samples, {Objective::raw, k_cap, 0});
        if (!observations) return error_text(observations);
        return error_text(fit_pm(*observations, {.lobes = lobes, .starts = 1, .perturbations = 0}));
    };
    EXPECT_CONTAINS(error_message(random_samples(20, 0, 9), 8), "samples: expected at least 96 values, found 60");
    EXPECT_EQ(error_message(random_samples(40, 0, 9), 2), "");
    ScatteredSamples black = random_samples(40, 0, 9);
    for (Rgb& f : black.colour) f = {0, -1, 0};
    EXPECT_CONTAINS(error_message(black, 1), "some above 0");
    ScatteredSamples grazing = random_samples(40, 0, 9);
    for (Vec3f& w : grazing.wl) w = to_float(spherical(88 * k_degree, 1.0));
    EXPECT_CONTAINS(error_message(grazing, 1), "within the largest angle");
}

}  // namespace
}  // namespace srbf::fit_samples_test
