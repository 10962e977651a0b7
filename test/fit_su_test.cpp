// The view-by-view fit: recovery of synthetic models, accuracy for measurements, errors.
#include <gtest/gtest.h>

#include <limits>

#include "brdf_functions.h"
#include "errors/picture_errors.h"
#include "measured_files.h"
#include "models/su/fit_su.h"
#include "models/su/su_functions.h"
#include "srbf/measured.h"
#include "srbf/metrics.h"
#include "srbf/model.h"
#include "su_models.h"

namespace srbf::fit_su_test {
namespace {

constexpr double k_cap = 80 * k_degree;
const SuFitOptions k_raw{.lobes = 4, .objective = Objective::raw};

/// The raw matrix of a bundled measurement, by default with 384 directions.
RawMatrix matrix_of(const std::string& name, int directions = 384) {
    return *tabulate(signed_evaluator(bundled(name)), {.directions = directions});
}

double matrix_error(const Evaluate& reference, const SuModel& model,
                    double Measures::*measure = &Measures::squared_error_ratio) {
    const Evaluate others[] = {evaluator(model)};
    return measure_matrix(rgb_channels(reference), rgb_channels(others), {k_cap, 0}, model.direction)[0].*measure;
}
double heldout_error(const Evaluate& reference, const SuModel& model) {
    return heldout_measures(reference, evaluator(model), k_cap, 50000).squared_error_ratio;
}

/// A model with J well separated lobes for each view in the upper hemisphere. If `isotropic`, the lobes are the same
/// for each view relative to its azimuth, otherwise independent.
SuModel separated_lobes(int lobes, bool isotropic, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    SuModel model;
    model.lobes = lobes;
    model.direction = fibonacci_directions(256, k_pi / 2);
    std::vector<double> azimuth_offset, theta, bandwidth;
    std::vector<Rgb> colour;
    for (std::size_t i = 0; i < model.direction.size(); ++i) {
        if (i == 0 || !isotropic) {
            azimuth_offset.clear();
            theta.clear();
            bandwidth.clear();
            colour.clear();
            const double first = 2 * k_pi * uniform(random);
            for (int j = 0; j < lobes; ++j) {
                azimuth_offset.push_back(first + 2 * k_pi * j / lobes);
                theta.push_back((25 + 30 * uniform(random)) * k_degree);
                bandwidth.push_back(8 * elementary::pow(8, uniform(random)));
                colour.push_back(
                    {float(0.3 + uniform(random)), float(0.3 + uniform(random)), float(0.3 + uniform(random))});
            }
        }
        const double azimuth = elementary::atan2(double(model.direction[i].y), double(model.direction[i].x));
        for (std::size_t j = 0; j < std::size_t(lobes); ++j) {
            model.coefficient.push_back(colour[j]);
            model.centre.push_back(to_float(spherical(theta[j], azimuth_offset[j] + azimuth)));
            model.bandwidth.push_back(float(bandwidth[j]));
        }
    }
    return model;
}

TEST(FitSu, RecoversSeparatedLobes) {
    for (int lobes = 1; lobes <= 4; ++lobes)
        for (const bool isotropic : {true, false}) {
            const SuModel truth = separated_lobes(lobes, isotropic, std::uint64_t(lobes));
            SuFitOptions options = k_raw;
            options.lobes = lobes;
            // Interpolation between independent views is not meaningful.
            const auto matrix =
                checked(tabulate(evaluator(truth), {.directions = 256, .between = isotropic ? 128 : 0}));
            const auto fit = checked(fit_su(*matrix, options));
            EXPECT_LE(matrix_error(evaluator(truth), fit->unrounded), 1e-6) << lobes << isotropic;
            EXPECT_LE(matrix_error(evaluator(truth), fit->model), 1e-5) << lobes << isotropic;
            EXPECT_EQ(fit->empty, 0);
        }
}

TEST(FitSu, ApproximatesMeasurements) {
    const struct {
        const char* name;
        double matrix, heldout;
    } bounds[] = {{"paper_white_rgb", 0.005, 0.005}, {"cc_ibiza_sunset_rgb", 0.0012, 0.006}};
    for (const auto& bound : bounds) {
        const auto fit = checked(fit_su(matrix_of(bound.name, 1536), k_raw));
        EXPECT_EQ(payload_bytes(fit->model), 73728u);
        const Evaluate reference = evaluator(bundled(bound.name));
        const double error = matrix_error(reference, fit->model), unrounded = matrix_error(reference, fit->unrounded);
        EXPECT_LE(error, bound.matrix) << bound.name;
        EXPECT_LE(error, 1.01 * unrounded) << bound.name;
        EXPECT_LE(heldout_error(reference, fit->model), bound.heldout) << bound.name;
        SuModel plain = fit->model;
        plain.interpolation = SuInterpolation::plain;
        EXPECT_LE(matrix_error(reference, plain), bound.matrix) << bound.name;  // the same at the samples
        if (bound.heldout > bound.matrix) {
            EXPECT_GT(heldout_error(reference, plain), 5 * bound.heldout)
                << bound.name;  // a highlight that moves with the view
        }
    }
}

TEST(FitSu, FollowsTheAlbedoIfPicturesCount) {
    const std::string name = "cc_ibiza_sunset_rgb";
    const RawMatrix matrix = matrix_of(name);
    const auto error = [&](Objective objective) {
        const auto fit = fit_su(matrix, {.lobes = 4, .objective = objective, .max_theta = k_cap});
        const Evaluate others[] = {evaluator(fit->model)};
        return albedo_errors(evaluator(bundled(name)), others, {k_cap})[0];
    };
    const double appearance_error = error(Objective::appearance);
    EXPECT_LT(appearance_error, 0.04);
    EXPECT_LT(appearance_error, 0.7 * error(Objective::cube_root));  // which gives highlights less weight
}

TEST(FitSu, ErrorFallsWithTheNumberOfLobes) {
    for (const char* name : {"paper_white_rgb", "cc_ibiza_sunset_rgb"}) {
        const RawMatrix matrix = matrix_of(name);
        double last = 1;
        for (const int lobes : {1, 2, 4, 8}) {
            SuFitOptions options = k_raw;
            options.lobes = lobes;
            const double error = matrix_error(evaluator(bundled(name)), fit_su(matrix, options)->model);
            EXPECT_LT(error, 0.97 * last) << name << lobes;
            last = error;
        }
    }
}

TEST(FitSu, ScalesWithItsData) {
    // Three lobes are fitted with two, so that the error is not 0.
    RawMatrix matrix = *tabulate(evaluator(separated_lobes(3, true, 7)), {.directions = 128});
    SuFitOptions options = k_raw;
    options.lobes = 2;
    const auto fit = checked(fit_su(matrix, options));
    for (Rgb& f : matrix.f) f = scaled(4, f);
    for (auto& between : matrix.between) between.f = scaled(4, between.f);
    const auto fourfold = checked(fit_su(matrix, options));
    std::mt19937_64 random(1);
    for (int i = 0; i < 500; ++i) {
        const Vec3f wl = to_float(random_direction(random, 0.2)), wv = to_float(random_direction(random, 0.2));
        EXPECT_WITHIN_RELATIVE(value(fourfold->unrounded, wl, wv).g, 4 * value(fit->unrounded, wl, wv).g, 1e-3);
    }
}

TEST(FitSu, DiscretisesEitherDirection) {
    const Evaluate f = signed_evaluator(bundled("cc_ibiza_sunset_rgb"));
    const auto view_fit = checked(fit_su(*tabulate(exchanged(f), {.directions = 128}), k_raw));
    const auto light_fit = checked(fit_su(*tabulate(f, {.directions = 128, .discretise = Discretise::light}), k_raw));
    EXPECT_EQ(light_fit->model.discretise, Discretise::light);
    std::mt19937_64 random(2);
    for (int i = 0; i < 500; ++i) {
        const Vec3f a = to_float(random_direction(random, 0)), b = to_float(random_direction(random, 0));
        EXPECT_EQ(value(light_fit->model, a, b), value(view_fit->model, b, a));
    }
    EXPECT_LE(matrix_error(evaluator(bundled("cc_ibiza_sunset_rgb")), light_fit->model), 0.002);
}

TEST(FitSu, EachObjectiveIsBestInItsOwnMeasure) {
    const Measured& film = bundled("cc_ibiza_sunset_rgb");
    const auto matrix = checked(tabulate(signed_evaluator(film), {.directions = 256, .between = 0}));
    std::vector<SuModel> models;
    for (const auto& [objective, measure] : k_objective_measures)
        models.push_back(fit_su(*matrix, {.lobes = 2, .objective = objective, .max_theta = k_cap})->model);
    for (std::size_t k = 0; k < models.size(); ++k)
        for (std::size_t other = 0; other < models.size(); ++other) {
            const auto error = [&](std::size_t i) {
                return matrix_error(evaluator(film), models[i], k_objective_measures[k].second);
            };
            EXPECT_LE(error(k), 1.005 * error(other)) << k << other;
        }
}

TEST(FitSu, StaysBoundedUpToTheHorizon) {
    for (const char* name : {"paper_white_rgb", "cc_ibiza_sunset_rgb"}) {
        SuFitOptions options = k_raw;
        options.lobes = 6;
        const auto fit = checked(fit_su(matrix_of(name, 768), options));
        std::mt19937_64 random(3);
        double measured = 0, largest = 0;
        for (int i = 0; i < 200000; ++i) {
            const auto direction = [&] {
                const double z = elementary::cos(89.9 * k_degree) *
                                 elementary::pow(1 / elementary::cos(89.9 * k_degree), uniform(random));
                return to_float(spherical(elementary::acos(z), i % 4 ? 2 * k_pi * uniform(random) : i % 8 ? 0 : k_pi));
            };
            const Vec3f wl = direction(), wv = direction();
            const auto area = [&](const Rgb& f) {
                return double(std::max({f.r, f.g, f.b})) * double(wl.z) * double(wv.z);
            };
            measured = std::max(measured, area(value(bundled(name), wl, wv)));
            const Rgb f = value(fit->model, wl, wv);
            ASSERT_TRUE(is_finite(f) && std::min({f.r, f.g, f.b}) >= 0);
            largest = std::max(largest, area(f));
        }
        EXPECT_LE(largest, 2 * measured) << name;
    }
}

constexpr float k_nan = std::numeric_limits<float>::quiet_NaN();

TEST(FitSu, ViewsWithoutDataAreEmpty) {
    RawMatrix matrix = matrix_of("paper_white_rgb", 64);
    for (std::size_t l = 0; l < 64; ++l) {
        matrix.f[10 * 64 + l] = {k_nan, k_nan, k_nan};  // a view that was not measured
        matrix.f[11 * 64 + l] = {};                     // a black view
        if (l > 10) matrix.f[12 * 64 + l] = {};         // a view that is black within 80°
    }
    const auto fit = checked(fit_su(matrix, k_raw));
    EXPECT_EQ(fit->empty, 3);
    for (std::size_t view = 0; view < 64; ++view)
        for (std::size_t l = 11; l < 64; ++l) {
            const Rgb f = value(fit->model, matrix.direction[l], matrix.direction[view]);
            EXPECT_TRUE(is_finite(f));
            EXPECT_EQ(f == Rgb{}, view >= 10 && view <= 12) << view;
        }
    // A matrix without any data.
    for (Rgb& f : matrix.f) f = {k_nan, k_nan, k_nan};
    const auto none = checked(fit_su(matrix, k_raw));
    EXPECT_EQ(none->empty, 64);
    EXPECT_EQ(value(none->model, {0, 0, 1}, {0, 0, 1}), Rgb{});
    // A matrix with some missing values.
    matrix = matrix_of("paper_white_rgb", 64);
    for (std::size_t i = 0; i < matrix.f.size(); i += 3) matrix.f[i].g = k_nan;
    EXPECT_TRUE(fit_su(matrix, k_raw));
}

TEST(FitSu, RefusesBadOptionsAndMatrices) {
    const RawMatrix good = matrix_of("paper_white_rgb", 64);
    const auto option_error = [&](auto change) {
        SuFitOptions options = k_raw;
        change(options);
        return error_text(fit_su(good, options));
    };
    EXPECT_EQ(option_error([](SuFitOptions& o) { o.lobes = 0; }), "fit: number of lobes: expected 1 to 64, found 0");
    for (const int bad : {-1, 65, 1 << 30}) EXPECT_NE(option_error([&](SuFitOptions& o) { o.lobes = bad; }), "") << bad;
    for (const int bad : {0, 8}) EXPECT_NE(option_error([&](SuFitOptions& o) { o.neighbours = bad; }), "") << bad;
    for (const double bad : {-1.0, 0.001, 1.6, std::nan("")})
        EXPECT_NE(option_error([&](SuFitOptions& o) { o.max_theta = bad; }), "") << bad;
    EXPECT_NE(option_error([](SuFitOptions& o) { o.threads = -1; }), "");
    // 53 of the 64 directions are within 80°.
    EXPECT_CONTAINS(option_error([](SuFitOptions& o) { o.lobes = 60; }), "expected none or at least 60");

    const auto matrix_error_message = [&](auto change) {
        RawMatrix bad = good;
        change(bad);
        return error_text(fit_su(bad, k_raw));
    };
    EXPECT_CONTAINS(matrix_error_message([](RawMatrix& m) {
                        for (std::size_t l = 0; l < 61; ++l) m.f[20 * 64 + l].r = k_nan;
                    }),
                    "directions with data in sampled view 20");
    EXPECT_NE(matrix_error_message([](RawMatrix& m) { m.f.pop_back(); }), "");
    EXPECT_NE(matrix_error_message([](RawMatrix& m) { m.between.pop_back(); }), "");
    EXPECT_NE(matrix_error_message([](RawMatrix& m) { m = {}; }), "");
    for (const int bad : {-1, 0, 7, 8193, 1 << 30})
        EXPECT_FALSE(tabulate(signed_evaluator(bundled("paper_white_rgb")), {.directions = bad})) << bad;
    // The smallest number of directions.
    const RawMatrix few = matrix_of("paper_white_rgb", k_min_views);
    const auto fit = checked(fit_su(few, {.lobes = 2, .objective = Objective::raw}));
    EXPECT_TRUE(is_finite(value(fit->model, {0, 0, 1}, {0, 0.6f, 0.8f})));
}

TEST(Tabulate, SamplesTheFunctionAndCountsInvalidValues) {
    const Evaluate f = pairwise([](Vec3f wl, Vec3f wv) {
        return wl.x < -0.9f ? Rgb{1, k_nan, 1} : Rgb{wl.x, wv.z, wl.y + 2 * wv.y};
    });
    for (const auto discretise : {Discretise::view, Discretise::light}) {
        const auto matrix = checked(tabulate(f, {.directions = 50, .between = 40, .discretise = discretise}));
        std::uint64_t masked = 0, clamped = 0;
        const auto check = [&](Vec3f wl, Vec3f wv, const Rgb& tabulated, bool counts) {
            Rgb expected;
            f({&wl, 1}, {&wv, 1}, {&expected, 1});
            if (!is_finite(expected)) {
                masked += counts;
                EXPECT_FALSE(is_finite(tabulated));
                return;
            }
            for (int c = 0; c < 3; ++c) {
                clamped += counts && expected[c] < 0;
                EXPECT_EQ(tabulated[c], std::max(expected[c], 0.f));
            }
        };
        for (std::size_t v = 0; v < 50; ++v) {
            for (std::size_t l = 0; l < 50; ++l)
                check(matrix->direction[l], matrix->direction[v], matrix->f[v * 50 + l], true);
            for (std::size_t k = v * 40; k < (v + 1) * 40; ++k) {
                const auto& between = matrix->between[k];
                const bool views_are_sampled = discretise == Discretise::view;
                check(views_are_sampled ? between.direction : matrix->direction[v],
                      views_are_sampled ? matrix->direction[v] : between.direction, between.f, false);
                EXPECT_WITHIN_RELATIVE(
                    double(between.pdf),
                    MirrorMixture(k_pi / 2).pdf(to_double(between.direction), to_double(matrix->direction[v])), 0.05);
            }
        }
        EXPECT_EQ(matrix->masked, masked);
        EXPECT_EQ(matrix->clamped, clamped);
        EXPECT_GT(masked, 0u);
    }
}

}  // namespace
}  // namespace srbf::fit_su_test
