// Sums of closures: their formula and their fit.
#include "extras/blender/closures.h"

#include "brdf_functions.h"
#include "errors/picture_errors.h"
#include "extras/blender/closure_terms.h"
#include "properties.h"
#include "srbf/load.h"
#include "srbf/models/openpbr.h"

namespace srbf::closures_test {
namespace {

/// Returns a sum that has the same closure at each of `knots` knots.
ClosureSum constant(const Closure& closure, const Rgb& diffuse, std::size_t knots) {
    return {1, std::vector<Rgb>(knots, diffuse), std::vector<Closure>(knots, closure), 1};
}

double delta_e(const Evaluate& reference, const Evaluate& other) {
    return compare_pictures(reference, {&other, 1}, {.is_isotropic = true})[0].mean.delta_e;
}

/// Without a tilt and with one α the term is Beckmann's surface of facets.
TEST(Closures, EqualTheClosedFormula) {
    std::mt19937_64 random(1);
    const float alpha = 0.3f;
    const ClosureSum sum = constant({0, std::sqrt(alpha), 0, {0.5f, 0.25f, 1}}, {0.1f, 0.2f, 0.3f}, 5);
    const auto lambda = [&](double cosine) {
        const double a = cosine / (double(alpha) * std::sqrt(1 - cosine * cosine));
        return a >= 1.6 ? 0 : (1 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a);
    };
    for (int i = 0; i < 1000; ++i) {
        const Vec3d wl = random_direction(random, 0.05), wv = random_direction(random, 0.05), h = normalize(wl + wv);
        const double tan2 = 1 / (h.z * h.z) - 1, a2 = double(alpha) * double(alpha),
                     D = std::exp(-tan2 / a2) / (k_pi * a2 * std::pow(h.z, 4)),
                     f = D / (4 * wl.z * wv.z * (1 + lambda(wl.z) + lambda(wv.z)));
        const Rgb found = value(sum, to_float(wl), to_float(wv));
        EXPECT_WITHIN_RELATIVE(found.r, 0.5 * f + 0.1 / k_pi, 2e-3) << i;
        EXPECT_WITHIN_RELATIVE(found.b, f + 0.3 / k_pi, 2e-3) << i;
    }
}

/// A tilted normal, both α and rotation about the normal: against the formula about N' and T'.
TEST(Closures, AreTiltedInThePlaneOfIncidence) {
    std::mt19937_64 random(2);
    const Closure closure{0.4f, 0.5f, 0.3f, {1, 1, 1}};
    const ClosureSum sum = constant(closure, {}, 3);
    for (int i = 0; i < 1000; ++i) {
        const double theta = 1.2 * uniform(random), phi = 2 * k_pi * uniform(random), turn = uniform(random);
        const Vec3d wv = spherical(theta, phi), wl = random_direction(random, 0.05);
        const Vec3d away{-std::cos(phi), -std::sin(phi), 0}, side = cross(Vec3d{0, 0, 1}, away);
        const Vec3d N = normalize(Vec3d{0, 0, 1} + 0.4 * away), T = normalize(away - dot(away, N) * N);
        const Rgb found = value(sum, to_float(wl), to_float(wv));
        if (dot(N, wv) < 0.05 || dot(N, wl) <= 0.01) continue;
        const double ax = 0.25 * 0.7, ay = 0.25 / 0.7;
        const Vec3d h = normalize(wl + wv);
        const double nh = dot(N, h),
                     D = std::exp(-(std::pow(dot(T, h) / ax, 2) + std::pow(dot(side, h) / ay, 2)) / (nh * nh)) /
                         (k_pi * ax * ay * std::pow(nh, 4));
        const double without_shadow = D / (4 * dot(N, wv) * wl.z);
        EXPECT_LE(found.r, 1.0001 * without_shadow + 1e-6);
        EXPECT_WITHIN(value(sum, to_float(rotate(wl, turn)), to_float(rotate(wv, turn))).r, found.r,
                      1e-4 * found.r + 1e-6);
        const Vec3d light{dot(wl, away), dot(wl, side), wl.z}, viewer{-std::sin(theta), 0, std::cos(theta)};
        const double term = ClosureTerm({0.4f, 0.5, 0.3f}, viewer).value({light, viewer});
        EXPECT_WITHIN(found.r * wl.z, term, 1e-3 * term + 1e-6);
    }
    EXPECT_EQ(value(sum, {0, 0, -1}, {0, 0, 1}), Rgb{});
}

/// Derivatives of a term by its shape are those of differences, for directions with and without a blur.
TEST(Closures, HaveTheDerivativesOfTheirShapes) {
    std::mt19937_64 random(5);
    int compared = 0;
    for (int i = 0; i < 2000; ++i) {
        const double theta = 1.5 * uniform(random);
        const Vec3d viewer{-std::sin(theta), 0, std::cos(theta)};
        const ClosureLight light(random_direction(random, 0.01), viewer, i % 2 * 0.02);
        const ClosureShape shape{2 * uniform(random) - 1, 0.2 + 0.8 * uniform(random), 1.6 * uniform(random) - 0.8};
        ClosureShape found;
        const double value = ClosureTerm(shape, viewer).value(light, &found);
        EXPECT_EQ(value, ClosureTerm(shape, viewer).value(light));
        for (std::size_t p = 0; p < 3; ++p) {
            constexpr double k_step = 1e-5;
            const auto changed = [&](double step) {
                ClosureShape other = shape;
                other[p] += step;
                return ClosureTerm(other, viewer).value(light);
            };
            const double below = changed(-k_step), above = changed(k_step);
            if (!(below > 0 && above > 0) || std::abs(shape[2]) < 2 * k_step) continue;
            EXPECT_WITHIN(found[p], (above - below) / (2 * k_step), 2e-3 * std::abs(found[p]) + 1e-4 * value);
            ++compared;
        }
    }
    EXPECT_GT(compared, 2000);
}

/// A ramp along cosθl is Lambert's BRDF, and a fit with a ramp is at least as near as one without.
TEST(Closures, HaveADiffuseRamp) {
    ClosureSum sum{0, {}, {}, 7};
    for (int i = 0; i < 7 * 5; ++i) {
        const float cosine = float(i % 7 + 1) / 7;
        sum.diffuse.push_back({0.2f * cosine, 0.4f * cosine, 0.6f * cosine});
    }
    ASSERT_EQ(sum.knots(), 5u);
    std::mt19937_64 random(3);
    for (int i = 0; i < 100; ++i) {
        const Rgb found =
            value(sum, to_float(random_direction(random, 0.01)), to_float(random_direction(random, 0.01)));
        EXPECT_RGB_WITHIN_RELATIVE(found, scaled(float(0.2 / k_pi), {1, 2, 3}), 1e-4, 0);
    }
    for (std::size_t i = 0; i < sum.diffuse.size(); ++i)
        if (i % 7 > 3) sum.diffuse[i] = {0.3f, 0.3f, 0.3f};  // a surface that is flatter than Lambert's
    const Evaluate flat = evaluator(sum);
    const auto fit = checked(fit_closures(flat, {.terms = 1, .ramp = 7, .knots = 8})),
               without = checked(fit_closures(flat, {.terms = 1, .knots = 8}));
    EXPECT_LT(delta_e(flat, evaluator(*fit)), std::min(0.5, delta_e(flat, evaluator(*without))));
}

TEST(Closures, RecoverASurfaceOfFacets) {
    const Evaluate facets = evaluator(constant({0, 0.45f, 0, {0.5f, 0.4f, 0.2f}}, {0.05f, 0.1f, 0.2f}, 16));
    const auto fit = checked(fit_closures(facets, {.terms = 1, .knots = 16}));
    EXPECT_LT(delta_e(facets, evaluator(*fit)), 0.5);
    const auto again = fit_closures(facets, {.terms = 1, .knots = 16, .threads = 1});
    EXPECT_EQ(fit->diffuse, again->diffuse) << "the number of threads changes a fit";
}

TEST(Closures, ShowAMeasurementAndReflectNoMoreThanAllLight) {
    const auto paper = checked(load_brdf(bundled_data() / "paper_white_rgb.bsdf"));
    const Evaluate f = evaluator(std::get<Measured>(*paper));
    const auto fit = checked(fit_closures(f, {.terms = 2, .knots = 16}));
    const Evaluate fitted = evaluator(*fit);
    EXPECT_LT(delta_e(f, fitted), 3);
    for (const double theta : {0.0, 20.0, 45.0, 70.0, 80.0, 84.0, 86.0, 88.0}) {
        const Rgb light = albedo(fitted, theta * k_degree, k_pi / 2);
        EXPECT_LT(largest_of(light), 1.01) << theta;
        // The paper reflects .83 of the light at 80 degrees and more beyond.
        if (theta >= 80) {
            EXPECT_GT(light.g, 0.75) << theta;
        }
    }
    for (const Closure& closure : fit->closures)
        for (int c = 0; c < 3; ++c) EXPECT_GE(closure.weight[c], 0);
}

/// A narrow highlight is not lost between directions of a fit, and further terms do not hide there.
TEST(Closures, ShowMirrorLikeAndMatteSurfaces) {
    struct Surface {
        OpenPbrModel model;
        double max_error;
    };
    const Surface surfaces[] = {{{.base_color = {0.2f, 0.1f, 0.05f}, .specular_roughness = 0.14f}, 1},
                                {{.base_color = {0, 0, 0}, .specular_roughness = 0.14f}, 6},
                                {{.base_color = {0.8f, 0.4f, 0.1f}, .specular_weight = 0}, 0.2}};
    for (const auto& [model, max_error] : surfaces) {
        const Evaluate surface = evaluator(model);
        const auto fit = checked(fit_closures(surface, {.terms = 2, .knots = 12}));
        const Evaluate fitted = evaluator(*fit);
        EXPECT_LT(delta_e(surface, fitted), max_error);
        for (const double theta : {5.0, 40.0, 65.0})
            EXPECT_WITHIN_RELATIVE(albedo(fitted, theta * k_degree, k_pi / 2).g,
                                   albedo(surface, theta * k_degree, k_pi / 2).g, 0.1)
                << theta;
    }
}

TEST(Closures, AreRefusedForBlackAndBadOptions) {
    const Evaluate black = constant_brdf({});
    EXPECT_EQ(fit_closures(black).error().code, ErrorCode::no_data);
    EXPECT_EQ(fit_closures(black, {.terms = 0}).error().code, ErrorCode::argument);
    EXPECT_EQ(fit_closures(black, {.knots = 2}).error().code, ErrorCode::argument);
}

}  // namespace
}  // namespace srbf::closures_test
