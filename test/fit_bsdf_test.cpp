// Fits of both sides: closed forms, and light that is neither lost nor made.
#include "brdf_functions.h"
#include "furnace.h"
#include "srbf/fit.h"
#include "srbf/kernel.h"

namespace srbf::fit_bsdf_test {
namespace {

using K = Kernel<float>;

/// The BRDF with this value where both directions are above the horizon.
template <typename F> Evaluate above_horizon_only(F f) {
    return pairwise([f](Vec3f wl, Vec3f wv) { return wl.z > 0 && wv.z > 0 ? f(wl, wv) : Rgb{}; });
}
Rgb grey(float f) { return {f, f, f}; }

float cosine_to_half(Vec3f wl, Vec3f wv) { return 0.5f * std::sqrt(dot(wl + wv, wl + wv)); }

/// Fresnel's reflectance of unpolarised light, from outside of a dielectric.
float fresnel(float cosine, float index) {
    const float across = std::sqrt(index * index - 1 + cosine * cosine);
    const float s = (cosine - across) / (cosine + across),
                p = (index * index * cosine - across) / (index * index * cosine + across);
    return 0.5f * (s * s + p * p);
}
/// The reflectance of both faces of a slab, with all reflections between them.
float slab_reflectance(float cosine) {
    const float F = fresnel(cosine, 1.5f);
    return 2 * F / (1 + F);
}

/// A thin slab with rough faces whose refractions cancel: the light is spread about the mirror direction and about the
/// direction straight through. The two sides are alike.
std::array<Evaluate, k_parts> rough_slab() {
    const auto reflected = above_horizon_only([](Vec3f wl, Vec3f wv) {
        return grey(K::ggx_facets(wl, wv, 0.25f) * slab_reflectance(cosine_to_half(wl, wv)));
    });
    const auto transmitted = above_horizon_only([](Vec3f wl, Vec3f wv) {
        return grey(K::ggx_facets(wl, wv, 0.15f) * (1 - slab_reflectance(cosine_to_half(wl, wv))));
    });
    return {reflected, reflected, transmitted, transmitted};
}

/// A leaf: a cuticle over a diffuse body, another one at the back, and diffuse green transmission that loses light at
/// both faces.
std::array<Evaluate, k_parts> leaf() {
    const auto side = [](float roughness, Rgb body) {
        return above_horizon_only([=](Vec3f wl, Vec3f wv) {
            const K::GgxLobe cuticle{roughness, {0.04f, 0.04f, 0.04f}, 1};
            const Vec3f f = K::ggx_value({body.r, body.g, body.b}, cuticle, {1, {0, 0, 0}, 0}, wl, wv);
            return Rgb{f.x, f.y, f.z};
        });
    };
    const auto through = above_horizon_only([](Vec3f wl, Vec3f wv) {
        const auto face = [](float cosine) { return 1 - elementary::pow(1 - 0.5f * cosine, 5.f); };
        return scaled(float(1.2 / k_pi) * face(wl.z) * face(wv.z), {0.06f, 0.16f, 0.03f});
    });
    return {side(0.3f, {0.05f, 0.09f, 0.03f}), side(0.5f, {0.1f, 0.15f, 0.08f}), through, through};
}

FitRequest five_lobes() {
    return {.model = PmRequest{.variates = 3, .size = LobeCount{5}, .effort = 0.25}, .objective = Objective::cosine};
}

enum class Sides { alike, different };
/// Expects a fit in at most 400 bytes, whose error is at most 0.5 % and which neither loses nor makes light.
void expect_good(const std::array<Evaluate, k_parts>& parts, Sides sides) {
    const auto fitted = checked(fit_bsdf(parts, five_lobes()));
    EXPECT_LE(payload_bytes(fitted->model), 400u);
    for (const PartFit& part : fitted->parts) {
        EXPECT_WITHIN(part.squared_error_ratio, 0, 0.005) << name(part.part);
        EXPECT_EQ(part.answered_by.has_value(),
                  is_back(part.part) && (sides == Sides::alike || is_transmission(part.part)));
        for (const Hemispherical& sum : part.hemispherical)
            EXPECT_WITHIN(sum.fitted, sum.measured, std::max(0.02 * sum.measured, 0.005))
                << name(part.part) << " " << sum.theta / k_degree;
    }
    EXPECT_WITHIN(fitted->max_fitted, fitted->max_measured, 0.01);
    EXPECT_LE(fitted->max_fitted, 1.01);
    EXPECT_GT(expect_energy_conserved(fitted->model), 0.1);
}

TEST(FitBsdf, KeepsTheAlbedosOfARoughSlab) { expect_good(rough_slab(), Sides::alike); }
TEST(FitBsdf, KeepsTheAlbedosOfALeaf) { expect_good(leaf(), Sides::different); }

/// `fit` refuses a measurement of two sides, and `fit_bsdf` one of a single side.
TEST(FitBsdf, IsRequestedByItsOwnFunction) {
    const Measured sides{"f", "CSV", 0, BsdfTable{{{}}, 0, {}}};
    const std::string expected = "measurement: expected a BRDF, found reflection and transmission, for fit_bsdf";
    const auto fitted = fit(sides, {});
    ASSERT_FALSE(fitted.ok());
    EXPECT_EQ(message(fitted.error()), "f: " + expected);
    EXPECT_EQ(message(Fitter(sides).draft({}).error()), "fit: " + expected);
    EXPECT_FALSE(fit_bsdf(Measured{"f", "CSV", 0, ScatteredSamples{}}, {.model = PmRequest{}}).ok());
}

}  // namespace
}  // namespace srbf::fit_bsdf_test
