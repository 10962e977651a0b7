// Anisotropic data: detection, and fits with general lobes.
#include "brdf/directions.h"
#include "brdf_functions.h"
#include "measured/tables.h"
#include "models/pm/pm_functions.h"
#include "models/pm/search/fit_pm.h"
#include "properties.h"
#include "srbf/kernel.h"
#include "srbf/measured.h"
#include "srbf/metrics.h"

namespace srbf::isotropy_test {
namespace {

/// A synthetic rough conductor with the Beckmann distribution, of roughness ax along x and ay along y, over a diffuse
/// part.
Evaluate brushed(double ax, double ay) {
    return pairwise([=](Vec3f wl, Vec3f wv) {
        const Vec3d l = to_double(wl), v = to_double(wv), h = normalize(l + v);
        const double tan2 = (h.x * h.x / (ax * ax) + h.y * h.y / (ay * ay)) / (h.z * h.z);
        const double d = elementary::exp(-tan2) / (k_pi * ax * ay * elementary::pow(h.z, 4));
        const double g = std::min({1.0, 2 * h.z * l.z / dot(h, l), 2 * h.z * v.z / dot(h, v)});
        const auto facets = float(d * g / (4 * l.z * v.z));
        return Rgb{0.05f + 0.9f * facets, 0.03f + 0.7f * facets, 0.02f + 0.4f * facets};
    });
}

/// A generator seeded by the pair: independent numbers for each pair.
std::mt19937_64 random_at(Vec3f wl, Vec3f wv) {
    std::seed_seq seed{std::uint32_t(1e6f * (2 + wl.x)), std::uint32_t(1e6f * (2 + wl.y)),
                       std::uint32_t(1e6f * (2 + wv.x)), std::uint32_t(1e6f * (2 + wv.y))};
    return std::mt19937_64(seed);
}

/// `f` with each value replaced by change(value, random), where the pair seeds the generator.
template <typename Change> Evaluate with_noise(Evaluate f, Change change) {
    return [=](auto wl, auto wv, auto values) {
        f(wl, wv, values);
        for (std::size_t i = 0; i < values.size(); ++i) {
            std::mt19937_64 random = random_at(wl[i], wv[i]);
            values[i] = change(values[i], random);
        }
    };
}

/// A number uniform about 0, with standard deviation 1.
double uniform_noise(std::mt19937_64& random) { return std::sqrt(12.0) * (uniform(random) - 0.5); }

/// `f` times random factors with standard deviation `noise`, independent at every pair.
Evaluate noisy(Evaluate f, double noise) {
    return with_noise(
        f, [=](const Rgb& value, auto& random) { return scaled(float(1 + noise * uniform_noise(random)), value); });
}

/// `f` plus independent numbers of these standard deviations.
Evaluate plus_noise(Evaluate f, const Rgb& deviation) {
    return with_noise(f, [=](Rgb value, auto& random) {
        for (int c = 0; c < 3; ++c) value[c] += deviation[c] * float(uniform_noise(random));
        return value;
    });
}

TEST(Isotropy, IsDetectedDespiteNoise) {
    const double cap = 80 * k_degree;
    EXPECT_TRUE(is_isotropic(brushed(0.2, 0.2), cap));
    EXPECT_TRUE(is_isotropic(brushed(0.01, 0.01), cap));
    EXPECT_TRUE(is_isotropic(noisy(brushed(0.2, 0.2), 0.05), cap));
    EXPECT_FALSE(is_isotropic(brushed(0.2, 0.21), cap));
    EXPECT_FALSE(is_isotropic(brushed(0.1, 0.3), cap));
    EXPECT_FALSE(is_isotropic(brushed(0.02, 0.5), cap));
    EXPECT_FALSE(is_isotropic(noisy(brushed(0.1, 0.3), 0.05), cap));
    // Noise four times as large as the diffuse part, of a known deviation.
    const Rgb noise{0.2f, 0.12f, 0.08f};
    EXPECT_FALSE(is_isotropic(plus_noise(brushed(0.2, 0.2), noise), cap));
    EXPECT_TRUE(is_isotropic(plus_noise(brushed(0.2, 0.2), noise), cap, noise));
    EXPECT_FALSE(is_isotropic(plus_noise(brushed(0.1, 0.3), noise), cap, noise));
}

/// √ of the change of f's samples for lights and viewers at these azimuths [°], at polar angles of 10 to 70°.
double change(const Evaluate& f, const std::vector<int>& lights, const std::vector<int>& viewers,
              bool is_above = false) {
    ScatteredSamples samples;
    for (const int phi_l : lights)
        for (const int phi_v : viewers)
            for (int l = 10; l <= 70; l += 20)
                for (int v = is_above ? 0 : 10; v <= (is_above ? 0 : 70); v += 10) {
                    samples.wl.push_back(direction_at(l, phi_l));
                    samples.wv.push_back(direction_at(v, phi_v));
                }
    samples.colour.resize(samples.wl.size());
    f(samples.wl, samples.wv, samples.colour);
    return change_by_azimuth(samples);
}

TEST(Isotropy, SamplesAreComparedAtRotatedPairs) {
    const std::vector<int> azimuths{0, 30, 60, 90, 120, 150, 180, 210, 240, 270, 300, 330};
    const Evaluate round = brushed(0.25, 0.25), along = brushed(0.15, 0.5), tilted = [&](auto wl, auto wv, auto f) {
        round(wl, wv, f);
        for (std::size_t i = 0; i < f.size(); ++i) f[i].g *= 1 + wl[i].x;
    };
    // A fixed light or viewer, and a plane, in which a tilted sample is not symmetric, tell nothing.
    for (const Evaluate& f : {round, along, tilted})
        EXPECT_EQ(change(f, {0}, azimuths) + change(f, azimuths, {0}) + change(f, {40, 220}, {40, 220}), 0);
    for (const auto& lights : std::vector<std::vector<int>>{{0, 90}, {0, 45}, {20, 60, 100}, azimuths}) {
        EXPECT_EQ(change(round, lights, azimuths), 0) << lights[1];
        EXPECT_GT(change(along, lights, azimuths), 0.5) << lights[1];
    }
    const Evaluate chiral = pairwise([](Vec3f wl, Vec3f) {
        return Rgb{0, float(1 + 0.8 * std::cos(2 * (std::atan2(double(wl.y), double(wl.x)) - k_pi / 6))), 0};
    });
    EXPECT_GT(change(chiral, azimuths, azimuths), 0.4);
    EXPECT_GT(change(brushed(0.2, 0.25), azimuths, azimuths), 0.1);  // no more than noise, but of the azimuth
    EXPECT_EQ(change(noisy(round, 0.05), azimuths, azimuths), 0);
    EXPECT_EQ(change(round, azimuths, {0}, true), 0);  // a viewer above
    EXPECT_GT(change(along, azimuths, {0}, true), 0.5);
}

TEST(Isotropy, GeneralLobesFitWhatAxialOnesCannot) {
    const Evaluate f = brushed(0.15, 0.4);
    const Observations observations = *observe(f, {.objective = Objective::raw});
    const auto error_with = [&](PmForm form, bool axial) {
        const auto fit = checked(fit_pm(observations, {.form = form, .axial = axial, .variates = 3}));
        EXPECT_EQ(fit->model.axial, axial);
        EXPECT_FALSE(is_reciprocal(fit->model));
        if (form == PmForm::extended && !axial) {
            EXPECT_EQ(payload_bytes(fit->model), 2u * (8 * (3 + 9 + 5) + 6));
        }
        return heldout_measures(f, evaluator(fit->model)).squared_error_ratio;
    };
    EXPECT_LE(error_with(PmForm::extended, false), 0.001);
    EXPECT_LE(error_with(PmForm::gaussian, false), 0.004);
    EXPECT_GE(error_with(PmForm::extended, true), 0.1);
}

}  // namespace
}  // namespace srbf::isotropy_test
