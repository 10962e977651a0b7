// Compares the error measures with closed forms, and tests the properties that make them trustworthy.
#include "srbf/metrics.h"

#include "analytic_brdfs.h"
#include "brdf/directions.h"
#include "brdf_functions.h"
#include "properties.h"
#include "srbf/kernel.h"

namespace srbf::metrics_test {
namespace {

using analytic_brdfs::Lambert;

/// scale (0.1 + lobe G): a constant and a Gaussian lobe of a given bandwidth about the mirror direction.
struct Glossy {
    float scale = 1, bandwidth = 1000, lobe = 1;
};
Rgb value(const Glossy& brdf, Vec3f wl, Vec3f wv) {
    if (!(wl.z > 0 && wv.z > 0)) return {};
    const float f = brdf.scale * (0.1f + brdf.lobe * Kernel<float>::gaussian(wl, mirror(wv), brdf.bandwidth));
    return {f, 0.5f * f, 0.25f * f};
}

/// A BRDF without values for lights of negative x.
struct Holed {
    Glossy brdf;
};
Rgb value(const Holed& holed, Vec3f wl, Vec3f wv) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    return wl.x < 0 ? Rgb{nan, nan, nan} : value(holed.brdf, wl, wv);
}

constexpr double k_cap = 80 * k_degree;

Measures matrix(const auto& reference, const auto& other) {
    const Evaluate others[] = {evaluator(other)};
    return measure_matrix(rgb_channels(evaluator(reference)), rgb_channels(others), {k_cap},
                          fibonacci_directions(400, k_cap))[0];
}
double albedo_error(const Evaluate& reference, const Evaluate& other, double max_theta) {
    return albedo_errors(reference, {&other, 1}, {max_theta})[0];
}
Measures heldout(const auto& reference, const auto& other) {
    return heldout_measures(evaluator(reference), evaluator(other), k_cap, 50000);
}

TEST(Metrics, ErrorsOfABrdfAgainstItselfAreZero) {
    const Glossy glossy;
    for (const MeasureName& measure : k_measures) {
        EXPECT_EQ(matrix(glossy, glossy).*measure.member, 0);
        EXPECT_EQ(heldout(glossy, glossy).*measure.member, 0);
    }
    EXPECT_EQ(albedo_error(evaluator(glossy), evaluator(glossy), k_cap), 0);
}

TEST(Metrics, ErrorsOfAScaledBrdfMatchTheClosedForms) {
    const Glossy glossy, scaled{1.1f};
    for (const Measures& m : {matrix(glossy, scaled), heldout(glossy, scaled)}) {
        EXPECT_WITHIN_RELATIVE(m.squared_error_ratio, 0.01, 1e-5);
        EXPECT_WITHIN_RELATIVE(m.squared_error_ratio_cosine, 0.01, 1e-5);
        EXPECT_WITHIN_RELATIVE(m.cube_root_error_ratio, std::pow(std::cbrt(1.1) - 1, 2), 1e-4);
        EXPECT_WITHIN_RELATIVE(m.log10_rms, std::log10(1.1), 1e-4);
    }
    EXPECT_WITHIN_RELATIVE(albedo_error(evaluator(glossy), evaluator(scaled), k_cap), 0.1, 1e-4);
    EXPECT_WITHIN_RELATIVE(albedo_error(evaluator(scaled), evaluator(glossy), k_cap), 0.1 / 1.1, 1e-4);
}

TEST(Metrics, ErrorsOfBlackAreOne) {
    const Glossy glossy;
    const Lambert black{{0, 0, 0}};
    EXPECT_WITHIN(matrix(glossy, black).squared_error_ratio, 1, 1e-12);
    EXPECT_WITHIN(heldout(glossy, black).squared_error_ratio_cosine, 1, 1e-12);
    EXPECT_EQ(albedo_error(evaluator(glossy), evaluator(black), k_cap), 1);
    EXPECT_TRUE(std::isinf(matrix(black, glossy).squared_error_ratio));
    EXPECT_EQ(matrix(black, black).squared_error_ratio, 0);
}

// Over the cap with μ = cosθ uniform in [c, 1]: the mean of log²(1 + a μ) weighted by the other cosine, which cancels.
TEST(Metrics, LogarithmOfALambertianIsItsIntegral) {
    const double c = std::cos(k_cap), a = 0.6 / k_pi;
    double mean = 0;
    const int n = 20000;
    for (int i = 0; i < n; ++i) mean += std::pow(std::log1p(a * (c + (i + 0.5) / n * (1 - c))), 2) / n;
    const Lambert grey{{0.6f, 0.6f, 0.6f}}, black{{0, 0, 0}};
    EXPECT_WITHIN_RELATIVE(matrix(grey, black).log_rms_cosine, std::sqrt(mean), 1e-3);
    EXPECT_WITHIN_RELATIVE(heldout(grey, black).log_rms_cosine, std::sqrt(mean), 1e-2);
}

// Σ (f−f̂)² / Σ f² for f = .1 + G, f̂ = .1: the integrals of G and G² about the mirror direction are 2π/λ and 2π/2λ if
// the cap contains the lobe. A cap of 80° loses little of a lobe of bandwidth 2000, whose radius is 1.3°.
TEST(Metrics, HeldOutPairsResolveSharpLobes) {
    const float bandwidth = 2000;
    const Glossy sharp{1, bandwidth, 20}, flat{1, bandwidth, 0};
    const double cap = 2 * k_pi * (1 - std::cos(k_cap));
    const double lobe = 2 * k_pi / bandwidth * 20, lobe_squared = k_pi / bandwidth * 400;
    const double expected = lobe_squared / (0.01 * cap + 0.2 * lobe + lobe_squared);
    EXPECT_WITHIN_RELATIVE(heldout(sharp, flat).squared_error_ratio, expected, 0.02);
}

TEST(Metrics, MatrixAndHeldOutPairsAgreeOnSmoothBrdfs) {
    const Glossy wide{1, 5, 1}, other{1, 8, 1};
    for (const MeasureName& measure : k_measures)
        EXPECT_WITHIN_RELATIVE(matrix(wide, other).*measure.member, heldout(wide, other).*measure.member, 0.02);
}

TEST(Metrics, MissingValuesAreOmittedAndCounted) {
    const Glossy glossy, other{1, 100, 1};
    const Measures complete = matrix(glossy, other), half = matrix(Holed{glossy}, other);
    EXPECT_EQ(complete.pairs, 400u * 400u);
    EXPECT_EQ(complete.masked, 0u);
    EXPECT_EQ(half.pairs + half.masked, 400u * 400u);
    EXPECT_WITHIN_RELATIVE(double(half.masked), 80000, 0.02);
    EXPECT_WITHIN_RELATIVE(half.squared_error_ratio, complete.squared_error_ratio, 0.02);
    const Measures swapped = matrix(glossy, Holed{other});
    EXPECT_EQ(swapped.masked, half.masked);
}

// The samples have values over many magnitudes, fill no whole number of blocks, and some of them are not measured.
TEST(Metrics, ErrorsOfSamplesMatchTheFormulas) {
    std::mt19937_64 random(3);
    const auto is_root = [](std::size_t k) { return !k_measures[k].is_ratio; };
    for (const std::size_t count : {1u, 7u, 1000u}) {
        std::vector<Vec3f> wl, wv;
        std::vector<float> f, g;
        std::array<double, 6> squared_errors{}, squares{};
        for (std::size_t i = 0; i < count; ++i) {
            wl.push_back(to_float(spherical(1.3 * uniform(random), 1.0)));
            wv.push_back(to_float(spherical(1.3 * uniform(random), 2.0)));
            f.push_back(i % 10 == 9 ? 0 : float(std::exp(80 * uniform(random) - 60)));
            g.push_back(i % 10 == 4 ? std::numeric_limits<float>::quiet_NaN() : float(1 + uniform(random)) * f[i]);
            if (std::isnan(g[i])) continue;
            const double l = double(wl[i].z), v = double(wv[i].z), a = double(f[i]), b = double(g[i]);
            const bool is_lit = a > 0;
            const struct {
                double weight, reference, other;
            } terms[] = {{1, a, b},
                         {v, a * l, b * l},
                         {v, std::log1p(a * l), std::log1p(b * l)},
                         {1, std::cbrt(a), std::cbrt(b)},
                         {v, std::sqrt(std::cbrt(a * l)), std::sqrt(std::cbrt(b * l))},
                         {is_lit ? 1.0 : 0.0, is_lit ? std::log10(a) : 0, is_lit ? std::log10(b) : 0}};
            for (std::size_t k = 0; k < 6; ++k) {
                const auto& [weight, reference, other] = terms[k];
                squared_errors[k] += weight * std::pow(reference - other, 2);
                squares[k] += weight * (is_root(k) ? 1 : reference * reference);
            }
        }
        const Measures measures = measure_samples(wl, wv, f, g, 80 * k_degree);
        EXPECT_EQ(measures.masked, (count + 5) / 10);
        EXPECT_EQ(measures.pairs + measures.masked, count);
        for (std::size_t k = 0; k < 6; ++k) {
            const double ratio = squared_errors[k] / squares[k], expected = is_root(k) ? std::sqrt(ratio) : ratio;
            // Logarithms from −60 on are rounded to 4e-6; they differ by up to 0.7.
            const double bound = k_measures[k].member == &Measures::log10_rms ? 1e-4 : 2e-6;
            EXPECT_WITHIN_RELATIVE(measures.*k_measures[k].member, expected, bound) << count << " " << k;
        }
    }
}

// The logarithm of 1 + x is that of x, not of the rounded sum: as good for dark BRDFs as for bright ones.
TEST(Metrics, LogarithmsOfSmallNumbersAreExact) {
    const std::vector<Vec3f> up(1, Vec3f(0, 0, 1));
    for (const float f : {1e-12f, 1e-8f, 3e-7f, 1e-4f, 0.01f}) {
        const std::vector<float> a{f}, b{0};
        EXPECT_WITHIN_RELATIVE(measure_samples(up, up, a, b, k_cap).log_rms_cosine, std::log1p(double(f)), 1e-6) << f;
        EXPECT_EQ(measure_samples(up, up, a, a, k_cap).log_rms_cosine, 0);
    }
}

TEST(Metrics, LogarithmsUsePositiveValuesAndAreLimited) {
    const std::vector<Vec3f> up(4, Vec3f(0, 0, 1));
    const std::vector<float> f{1e-3f, 1e4f, 0, 2}, g{1e-2f, 0, 5, 2};
    EXPECT_WITHIN_RELATIVE(measure_samples(up, up, f, g, k_cap).log10_rms, std::sqrt((1 + 36 + 0) / 3.0), 1e-6);
}

TEST(Metrics, InfiniteValuesAreNeverNear) {
    const std::vector<Vec3f> up(2, Vec3f(0, 0, 1));
    const std::vector<float> f{1, 2}, g{1, std::numeric_limits<float>::infinity()};
    const Measures measures = measure_samples(up, up, f, g, k_cap);
    for (const MeasureName& measure : k_measures) EXPECT_TRUE(std::isinf(measures.*measure.member)) << measure.name;
}

/// Channel c of C is c + 1 times cosθl, and the other's off by a tenth of it.
Channels ramp(std::size_t C, float factor) {
    Channels channels;
    for (std::size_t c = 0; c < C; ++c) channels.wavelengths.push_back(400 + float(c));
    channels.evaluate = [C, factor](auto wl, auto, auto f) {
        for (std::size_t i = 0; i < f.size(); ++i) f[i] = factor * float(i % C + 1) * wl[i / C].z;
    };
    return channels;
}

TEST(Metrics, AnyNumberOfChannelsIsMeasured) {
    for (const std::size_t C : {1u, 4u, 31u}) {
        const Channels others[] = {ramp(C, 0.9f), ramp(C, 0)};
        const auto directions = fibonacci_directions(64, 80 * k_degree);
        for (const auto& measures : {measure_matrix(ramp(C, 1), others, {80 * k_degree, 1}, directions),
                                     measure_heldout(ramp(C, 1), others, {80 * k_degree, 1}, 5000)}) {
            EXPECT_WITHIN(measures[0].squared_error_ratio, 0.01, 1e-6);
            EXPECT_WITHIN(measures[0].squared_error_ratio_cosine, 0.01, 1e-6);
            EXPECT_WITHIN(measures[0].cube_root_error_ratio, std::pow(1 - std::cbrt(0.9), 2), 1e-6);
            EXPECT_WITHIN(measures[1].squared_error_ratio, 1, 1e-9);
            EXPECT_EQ(measures[0].masked, 0u);
        }
    }
}

TEST(Albedo, ALambertianHasItsColourTimesTheCap) {
    const Lambert lambert{{0.2f, 0.5f, 0.9f}};
    for (const double theta : k_albedo_theta)
        for (const double cap : {k_cap, k_pi / 2}) {
            const Rgb a = albedo(evaluator(lambert), theta * k_degree, cap);
            const double fraction = std::pow(std::sin(cap), 2);
            EXPECT_WITHIN_RELATIVE(a.r, 0.2 * fraction, 1e-4) << theta << " " << cap;
            EXPECT_WITHIN_RELATIVE(a.b, 0.9 * fraction, 1e-4);
        }
}

// ∫ G(ωl·ξ | λ) cosθl dωl = 2π cosθ_ξ (1/λ − 1/λ²) up to e^−2λ, where the horizon is far.
TEST(Albedo, ResolvesSharpLobes) {
    for (const double bandwidth : {100.0, 1000.0, 10000.0, 60000.0}) {
        const Glossy all{1, float(bandwidth), 1000}, base{1, float(bandwidth), 0};
        for (const double theta : {0.0, 30.0, 60.0}) {
            const double with_lobe = albedo(evaluator(all), theta * k_degree, k_pi / 2).r;
            const double without_lobe = albedo(evaluator(base), theta * k_degree, k_pi / 2).r;
            const double lobe =
                1000 * 2 * k_pi * std::cos(theta * k_degree) * (1 / bandwidth - 1 / (bandwidth * bandwidth));
            EXPECT_WITHIN_RELATIVE(with_lobe - without_lobe, lobe, 1e-4) << bandwidth << " at " << theta;
        }
    }
}

TEST(Albedo, ErrorsOfSeveralModelsAreThoseOfEach) {
    const Evaluate reference = evaluator(Glossy{}),
                   others[] = {evaluator(Glossy{1.1f}), evaluator(Glossy{1, 30, 2}), reference};
    const auto errors = albedo_errors(reference, others, {k_cap, 1});
    EXPECT_EQ(errors, albedo_errors(reference, others, {k_cap, 3}));
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(errors[k], albedo_error(reference, others[k], k_cap));
    EXPECT_EQ(errors[2], 0);
}

TEST(Albedo, ComparesOnlyAnglesWithinTheCap) {
    const Glossy glossy;
    const Lambert white{{1, 1, 1}};
    EXPECT_GT(albedo_error(evaluator(white), evaluator(glossy), 10 * k_degree), 0);
    // Within 10° only θv = 0 counts.
    const double a = luminance(albedo(evaluator(white), 0, 10 * k_degree)),
                 b = luminance(albedo(evaluator(glossy), 0, 10 * k_degree));
    EXPECT_WITHIN_RELATIVE(albedo_error(evaluator(white), evaluator(glossy), 10 * k_degree), std::abs(b - a) / a, 1e-4);
}

// A peak about the mirror direction of a view near the horizon, narrower still in azimuth, whose albedo has closed
// form.
TEST(Metrics, AlbedosOfNarrowHighlightsAreExact) {
    for (const double c : {0.2, 0.05, 0.01}) {
        const double w = 0.1 * c, a = 0.01 * c;  // half widths of the peak in cosθl and azimuth
        const Evaluate peak = pairwise([=](Vec3f wl, Vec3f) {
            const double z = (double(wl.z) - c) / w, phi = std::atan2(double(wl.y), -double(wl.x)) / a;
            return Rgb{0, float(1 / ((1 + z * z) * (1 + phi * phi))), 0};
        });
        const double over_z = w * c * (std::atan((1 - c) / w) + std::atan(c / w)) +
                              w * w / 2 * std::log((w * w + (1 - c) * (1 - c)) / (w * w + c * c));
        EXPECT_WITHIN_RELATIVE(albedo(peak, std::acos(c), k_pi / 2).g, over_z * 2 * a * std::atan(k_pi / a), 1e-3);
    }
}

}  // namespace
}  // namespace srbf::metrics_test
