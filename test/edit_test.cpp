// Edits of models against the materials that they should become.
#include "srbf/edit.h"

#include <fmt/format.h>

#include <map>

#include "brdf_functions.h"
#include "edit/lobes.h"
#include "errors/picture_errors.h"
#include "microsurface_walk.h"
#include "models.h"
#include "observe/albedo_bound.h"
#include "properties.h"
#include "srbf/kernel.h"
#include "srbf/sampling.h"
#include "statistics.h"

namespace srbf::edit_test {
namespace {

/// A material of facets, and the model that `srbf fit` fitted to it: test/edit/NAME.srbf.
struct Material {
    const char* name;
    GgxModel truth;

    Model fit() const { return *load_model(std::string(SRBF_SOURCE_DIR) + "/test/edit/" + name + ".srbf"); }
};
const GgxModel::Lobe k_dielectric{0.3f, {0.04f, 0.04f, 0.04f}, 1};
const Material k_materials[] = {
    {"dielectric", {{0.4f, 0.25f, 0.1f}, {k_dielectric}}},
    {"metal", {{}, {{0.3f, {0.9f, 0.6f, 0.3f}, 1}}}},
    {"two_lobes", {{0.1f, 0.05f, 0.05f}, {{0.1f, {0.04f, 0.04f, 0.04f}, 1}, {0.4f, {0.1f, 0.1f, 0.1f}, 1}}}},
};

/// The mean ΔE_ITP of small pictures, of which 1 is just noticeable.
double visible_error(const Evaluate& truth, const Evaluate& other) {
    constexpr int k_pixels = 32;
    return compare_pictures(truth, {&other, 1}, {.size = k_pixels, .is_isotropic = true})[0].mean.delta_e;
}
const PmModel& pm(const Model& model) { return std::get<PmModel>(model.model); }

/// An edit of a lawful reciprocal model is lawful and reciprocal, and its file is that of any model.
void expect_lawful(const Model& model) {
    EXPECT_LE(AlbedoBound(1, 1).excess(evaluator(model)), 1.0);
    EXPECT_EQ(pm(model).form, PmForm::reciprocal);
    const auto read = checked(read_model(write_model(model), ""));
    EXPECT_TRUE(pm(*read) == pm(model));
    EXPECT_TRUE(model.provenance.contains("edits"));
    EXPECT_FALSE(model.provenance.contains("delta_e_itp"));
}

Model with_edit(const Model& model, const Edit& edit) {
    auto result = edit_model(model, std::span(&edit, 1));
    EXPECT_TRUE(result.ok()) << text(edit) << ": " << message(result.error());
    return *std::move(result);
}

TEST(Edit, SeparatesHighlightAndBody) {
    const Model fit = k_materials[0].fit();
    const Rgb body = albedo(evaluator(separate_highlight(pm(fit)).body), 0.5, k_pi / 2);
    EXPECT_RGB_WITHIN_RELATIVE(body, k_materials[0].truth.diffuse, 0.05, 0);
    const Model metal = k_materials[1].fit();
    EXPECT_LT(albedo(evaluator(separate_highlight(pm(metal)).body), 0.5, k_pi / 2).r, 0.02f);
}

TEST(Edit, RoughensFacetsExactly) {
    std::mt19937_64 random(1);
    for (const float alpha : {0.05f, 0.3f}) {
        const GgxModel facets{{}, {{alpha, {0.9f, 0.6f, 0.3f}, 1}}};
        const double found = roughness_of(evaluator(facets));
        EXPECT_WITHIN_RELATIVE(found, double(alpha), 0.05);
        for (const float factor : {0.5f, 1.f, 2.f}) {
            GgxModel rough = facets;
            rough.lobes[0].roughness *= factor;
            const Evaluate by_directions = apply_roughening(evaluator(facets), double(factor), double(alpha));
            for (int i = 0; i < 500; ++i) {
                const Vec3f wl = to_float(random_direction(random, 0.02)),
                            wv = to_float(random_direction(random, 0.02));
                std::array<Rgb, 2> f;
                by_directions(std::array{wl, wv}, std::array{wv, wl}, f);
                const Rgb expected = value(rough, wl, wv);
                EXPECT_WITHIN_RELATIVE(f[0].g, expected.g, 2e-3);
                EXPECT_WITHIN_RELATIVE(f[0].g, f[1].g, 2e-3);
            }
        }
    }
}

TEST(Edit, RoughenedFitsLookLikeRougherFacets) {
    for (const Material& material : k_materials)
        for (const double factor : {0.7, 2.0}) {
            GgxModel truth = material.truth;
            for (GgxModel::Lobe& lobe : truth.lobes) lobe.roughness *= float(factor);
            const Model rough = with_edit(material.fit(), Roughen{factor});
            EXPECT_LE(visible_error(evaluator(truth), evaluator(rough)), 2.5) << material.name << ' ' << factor;
            expect_lawful(rough);
        }
}

TEST(Edit, TintedFitsLookLikeFacetsOfThoseColours) {
    const Rgb highlight{1, 0.8f, 0.6f}, body{0.5f, 1, 0.8f};
    for (const Material& material : k_materials) {
        const GgxModel facets{{}, material.truth.lobes}, diffuse{material.truth.diffuse, {{1, {}, 0}}};
        const Evaluate truth = pairwise([&](Vec3f wl, Vec3f wv) {
            Rgb sum, a = value(facets, wl, wv), b = value(diffuse, wl, wv);
            for (int c = 0; c < 3; ++c) sum[c] = a[c] * highlight[c] + b[c] * body[c];
            return sum;
        });
        const Model fit = material.fit(), tint = with_edit(fit, Tint{highlight, body});
        EXPECT_LE(visible_error(truth, evaluator(tint)), 1.5) << material.name;
        expect_lawful(tint);
    }
}

TEST(Edit, HueKeepsLuminanceAndSaturationEndsInGrey) {
    std::mt19937_64 random(2);
    const Model model{random_model(random, {.form = PmForm::reciprocal}), {}};
    const PmModel grey = saturated(pm(model), 0), whole_turn = turn_hue(pm(model), 2 * k_pi),
                  short_turn = turn_hue(pm(model), 0.3);
    for (std::size_t j = 0; j < grey.coefficient.size(); ++j) {
        const Rgb colour = pm(model).coefficient[j];
        EXPECT_WITHIN(grey.coefficient[j].r, luminance(colour), 1e-6);
        EXPECT_WITHIN(grey.coefficient[j].b, luminance(colour), 1e-6);
        EXPECT_RGB_WITHIN(whole_turn.coefficient[j], colour, 1e-6);
        const Rgb moved = short_turn.coefficient[j];
        EXPECT_TRUE(std::min({moved.r, moved.g, moved.b}) == 0 || near(luminance(moved), luminance(colour), 1e-6));
    }
    // Red becomes green and green blue by a third of a turn, but for grey.
    PmModel red = pm(model);
    red.coefficient.assign(red.coefficient.size(), {0.3f, 0, 0});
    const Rgb green = turn_hue(red, 2 * k_pi / 3).coefficient[0];
    EXPECT_GT(green.g, green.r);
    EXPECT_GT(green.g, green.b);
}

TEST(Edit, RotatesTheTangent) {
    std::mt19937_64 random(3);
    const Model model{random_model(random, {.axial = false, .form = PmForm::extended}), {}};
    const PmModel rotated_model = rotated(pm(model), 0.7);
    for (int i = 0; i < 100; ++i) {
        const Vec3f wl = to_float(random_direction(random, 0.05)), wv = to_float(random_direction(random, 0.05));
        EXPECT_WITHIN_RELATIVE(value(rotated_model, rotate(wl, 0.7), rotate(wv, 0.7)).g, value(model, wl, wv).g, 1e-3);
    }
}

TEST(Edit, BlendsAreMeansAndAreReduced) {
    const Model a = k_materials[0].fit(), b = k_materials[1].fit();
    const auto blend = checked(blend_models(a, b, 0.5));
    std::mt19937_64 random(4);
    for (int i = 0; i < 500; ++i) {
        const Vec3f wl = to_float(random_direction(random, 0.02)), wv = to_float(random_direction(random, 0.02));
        const Rgb f = value(*blend, wl, wv), value_a = value(a, wl, wv), value_b = value(b, wl, wv);
        EXPECT_RGB_WITHIN_RELATIVE(f, mixed(value_a, value_b, 0.5f), 1e-4, 0);
    }
    expect_lawful(*blend);
    const Evaluate truth = pairwise([](Vec3f wl, Vec3f wv) {
        return mixed(value(k_materials[0].truth, wl, wv), value(k_materials[1].truth, wl, wv), 0.5f);
    });
    const Model few = with_edit(*blend, Reduce{8});
    EXPECT_EQ(pm(few).lobes, 8);
    const double fit_errors = 0.5 * (visible_error(evaluator(k_materials[0].truth), evaluator(a)) +
                                     visible_error(evaluator(k_materials[1].truth), evaluator(b)));
    EXPECT_LE(visible_error(truth, evaluator(few)), 1.5 * fit_errors);
    expect_lawful(few);
}

TEST(Edit, BlendsOfDifferentFormsAreMeans) {
    std::mt19937_64 random(5);
    const Model reciprocal{rounded(random_model(random, {.form = PmForm::reciprocal})), {}};
    for (const PmForm form : {PmForm::gaussian, PmForm::extended}) {
        const Model other{rounded(random_model(random, {.variates = 2, .form = form})), {}};
        const auto blend = checked(blend_models(other, reciprocal, 0.25));
        for (int i = 0; i < 100; ++i) {
            const Vec3f wl = to_float(random_direction(random, 0.05)), wv = to_float(random_direction(random, 0.05));
            const double f = 0.75 * double(value(other, wl, wv).g) + 0.25 * double(value(reciprocal, wl, wv).g);
            EXPECT_WITHIN_RELATIVE(value(*blend, wl, wv).g, f, 3e-3);  // coefficients are rounded
        }
    }
    const Model many{random_model(random, {.variates = 5}), {}};
    EXPECT_FALSE(blend_models(reciprocal, many, 0.5).ok());
}

TEST(Edit, CoatsReflectAllThatWhiteBasesDo) {
    const GgxModel white{{1, 1, 1}, {{1, {}, 0}}}, black{{0, 0, 0}, {{1, {}, 0}}};
    const Coat coat{0.05, 1.5, {1, 1, 1}};
    for (const double theta : {0.1, 0.8, 1.3}) {
        EXPECT_WITHIN(albedo(apply_coat(evaluator(white), coat), theta, k_pi / 2).g, 1, 0.02) << theta;
        const double cosine = std::cos(theta);
        const double fresnel = Kernel<double>::dielectric_reflectance(cosine, 1.5);
        EXPECT_WITHIN(albedo(apply_coat(evaluator(black), coat), theta, k_pi / 2).g, fresnel, 0.02) << theta;
    }
}

/// The fit of a material under a white coat of that roughness, made once.
const Model& coated_fit(std::size_t material, double roughness) {
    static std::map<std::pair<std::size_t, double>, Model> made;
    const std::pair key(material, roughness);
    if (!made.contains(key)) made[key] = with_edit(k_materials[material].fit(), Coat{roughness, 1.5, {1, 1, 1}});
    return made[key];
}

TEST(Edit, CoatedFitsAreLawful) {
    for (const std::size_t m : {0, 1}) {
        const Material& material = k_materials[m];
        const Model& coat = coated_fit(m, 0.1);
        expect_lawful(coat);
        EXPECT_EQ(pm(coat).lobes, pm(material.fit()).lobes + 3);
        GgxModel wide = material.truth;
        wide.lobes[0].roughness *= float(std::hypot(1, 0.1 / 3 / std::sqrt(2.0) / 0.3));
        EXPECT_LE(visible_error(apply_coat(evaluator(wide), {0.1, 1.5, {1, 1, 1}}), evaluator(coat)), 2.5)
            << material.name;
    }
}

/// Coated models agree with simulated paths in bins of directions, of which each gets hundreds of paths.
TEST(Edit, CoatsLookLikeWalksBetweenTheirLayers) {
    constexpr int k_paths = 60000;
    for (const auto& [material, roughness] : {std::pair(std::size_t(0), 0.1), {1, 0.1}, {1, 0.3}}) {
        const GgxModel& base = k_materials[material].truth;
        const Coat coat{roughness, 1.5, {1, 1, 1}};
        const SimulatedCoat simulated(MicrosurfaceWalk(base, roughness, coat.ior), apply_coat(evaluator(base), coat),
                                      k_paths);
        const Evaluate truth = pairwise([&](Vec3f wl, Vec3f wv) { return simulated.value(wl, wv); });
        const Model fit = k_materials[material].fit();
        const double error = visible_error(truth, evaluator(coated_fit(material, roughness)));
        EXPECT_LE(error, 4) << k_materials[material].name << ' ' << roughness;
        EXPECT_LT(error, 0.5 * visible_error(truth, evaluator(fit)));
        fmt::print("{} under a coat of {}: {:.2f}\n", k_materials[material].name, roughness, error);
    }
}

TEST(Edit, NamesTheLimitThatWasReached) {
    const Model fit = k_materials[1].fit();
    const Model brighter = with_edit(fit, Tint{{10, 10, 10}, {1, 1, 1}}),
                darker = with_edit(fit, Tint{{0.5f, 1, 1}, {}});
    ASSERT_TRUE(brighter.provenance.contains("limited"));
    EXPECT_CONTAINS(brighter.provenance.at("limited"), ", to tint highlight ");
    EXPECT_FALSE(darker.provenance.contains("limited"));
    const Edit tiny = Tint{{1e-9f, 1e-9f, 1e-9f}, {1, 1, 1}};
    EXPECT_FALSE(edit_model(fit, std::span(&tiny, 1)).ok());  // 16-bit floats would make it black
}

TEST(Edit, RefusesModelsItCannotEdit) {
    std::mt19937_64 random(7);
    const Model colours{random_model(random, {}), {}}, spectral{spectral_model(random, {}, 5), {}},
        facets{k_materials[0].truth, {}};
    const auto refused = [](const Model& model, const Edit& edit) {
        const auto result = edit_model(model, std::span(&edit, 1));
        return !result.ok() && result.error().code == ErrorCode::argument;
    };
    EXPECT_TRUE(refused(facets, TurnHue{10}));
    EXPECT_TRUE(refused(spectral, TurnHue{10}));
    EXPECT_TRUE(refused(colours, Roughen{0}));
    EXPECT_TRUE(refused(colours, Roughen{std::nan("")}));
    EXPECT_TRUE(refused(colours, Tint{{1, 1, -1}}));
    EXPECT_TRUE(refused(colours, Tint{{1, std::nanf(""), 1}}));
    EXPECT_TRUE(refused(colours, Coat{0.1, 1, {1, 1, 1}}));
    EXPECT_TRUE(refused(colours, Reduce{0}));
    EXPECT_FALSE(blend_models(colours, spectral, 0.5).ok());
    EXPECT_FALSE(blend_models(colours, colours, 1.5).ok());
}

}  // namespace
}  // namespace srbf::edit_test
