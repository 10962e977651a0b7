// Fits of both sides: closed forms, averages over patches, a real roller shade, and light behind it.
#include "srbf/fit_bsdf.h"
#include "bsdf_files.h"
#include "properties.h"
#include "srbf/file.h"
#include "srbf/kernel.h"
#include "srbf/prepared_bsdf.h"
#ifdef SRBF_RENDER
#include "extras/render/path.h"
#endif

namespace srbf::fit_bsdf_test {
namespace {

using K = Kernel<float>;
using ValueOf = std::function<Rgb(Vec3f wl, Vec3f wv)>;

Evaluate evaluate_by(ValueOf value_of) {
    return [value_of](auto wl, auto wv, auto f) {
        for (std::size_t i = 0; i < f.size(); ++i) f[i] = wl[i].z > 0 && wv[i].z > 0 ? value_of(wl[i], wv[i]) : Rgb{};
    };
}
Rgb grey(float f) { return {f, f, f}; }
Rgb times(float s, Rgb c) { return {s * c.r, s * c.g, s * c.b}; }

float cosine_to_half(Vec3f wl, Vec3f wv) { return 0.5f * std::sqrt(dot(wl + wv, wl + wv)); }

/// Fresnel's reflectance of unpolarised light, from outside of a dielectric.
float fresnel(float cosine, float index) {
    const float across = std::sqrt(index * index - 1 + cosine * cosine);
    const float s = (cosine - across) / (cosine + across),
                p = (index * index * cosine - across) / (index * index * cosine + across);
    return 0.5f * (s * s + p * p);
}
/// Both faces of a slab, with all that goes to and fro between them.
float slab_reflectance(float cosine) {
    const float F = fresnel(cosine, 1.5f);
    return 2 * F / (1 + F);
}

/// A thin slab with rough faces whose refractions cancel: the light is spread about the mirror direction and about the
/// one straight through. The two sides are alike.
std::array<Evaluate, k_parts> rough_slab() {
    const auto reflected = evaluate_by([](Vec3f wl, Vec3f wv) {
        return grey(K::ggx_facets(wl, wv, 0.25f) * slab_reflectance(cosine_to_half(wl, wv)));
    });
    const auto transmitted = evaluate_by([](Vec3f wl, Vec3f wv) {
        return grey(K::ggx_facets(wl, wv, 0.15f) * (1 - slab_reflectance(cosine_to_half(wl, wv))));
    });
    return {reflected, reflected, transmitted, transmitted};
}

/// A leaf: a cuticle over a diffuse body, another one at the back, and diffuse green transmission that loses light at
/// both faces.
std::array<Evaluate, k_parts> leaf() {
    const auto side = [](float roughness, Rgb body) {
        return evaluate_by([=](Vec3f wl, Vec3f wv) {
            const K::GgxLobe cuticle{roughness, {0.04f, 0.04f, 0.04f}, 1};
            const Vec3f f = K::ggx_value({body.r, body.g, body.b}, cuticle, {1, {0, 0, 0}, 0}, wl, wv);
            return Rgb{f.x, f.y, f.z};
        });
    };
    const auto through = evaluate_by([](Vec3f wl, Vec3f wv) {
        const auto face = [](float cosine) { return 1 - elementary::pow(1 - 0.5f * cosine, 5.f); };
        return times(float(1.2 / k_pi) * face(wl.z) * face(wv.z), {0.06f, 0.16f, 0.03f});
    });
    return {side(0.3f, {0.05f, 0.09f, 0.03f}), side(0.5f, {0.1f, 0.15f, 0.08f}), through, through};
}

FitRequest five_lobes() {
    PmRequest pm;
    pm.size = LobeCount{5};
    pm.variates = 3;
    FitRequest request;
    request.model = pm;
    request.objective = Objective::cosine;
    return request;
}

#ifdef SRBF_RENDER
/// A thin sphere in even light of radiance 1, seen from far away: after one bounce without occlusion, or as many as it
/// takes with it.
PathPicture furnace(const PreparedBsdf& bsdf, bool whole) {
    static const Environment even_light(Image(8, 4, {1, 1, 1}));
    static const Mesh mesh = sphere(64);
    const PathScene scene{{{&mesh, 0}}, {bsdf}, {{0, 0, 400}, {0, 0, 0}, {0, 1, 0}, 0.0052}, {}, {}, &even_light};
    PathOptions options;
    options.width = options.height = 32, options.samples = whole ? 64 : 256;
    options.bounces = whole ? 64 : 1, options.occlusion = whole;
    return render_paths(scene, options);
}
/// Whether a pixel lies within the sphere, and the cosine of its normal to the viewer there.
std::optional<double> cosine_at(const PathPicture& picture, std::size_t pixel) {
    const Rgb n = picture.first.normal.pixels[pixel];
    const double length = std::sqrt(double(n.r * n.r + n.g * n.g + n.b * n.b));
    return length > 0.99 && n.b > 0.3f ? std::optional(double(n.b) / length) : std::nullopt;
}
double mean_of(const PathPicture& picture) {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < picture.first.depth.size(); ++i)
        if (cosine_at(picture, i)) sum += double(picture.rendering.radiance.pixels[i].g), ++count;
    EXPECT_GT(count, 300);
    return sum / count;
}
/// What a model sends to its viewer in even light: after one bounce the sum of its parts' albedos and beams, along the
/// middle of the picture; in all no more than that, since it is not brighter within than around it.
double expect_furnace(const Model& model) {
    const auto& bsdf = std::get<BsdfModel>(model.model);
    const PreparedBsdf prepared = prepare_bsdf(model, {.threads = 1});
    const PathPicture once = furnace(prepared, false);
    const Evaluate values = evaluator(model);
    double sum = 0, expected = 0, most_apart = 0;
    for (std::size_t i = 15 * 32; i < 17 * 32; ++i) {
        const auto cosine = cosine_at(once, i);
        if (!cosine) continue;
        double due = 0;
        const Vec3f from = to_float(spherical(elementary::acos(*cosine), 0.0));
        for (const Part part : {Part::reflection_front, Part::transmission_back})
            due += double(share_at(bsdf.beam, part, from).g) +
                   double(albedo(part_of(values, part), elementary::acos(*cosine), k_pi / 2).g);
        const double seen = double(once.rendering.radiance.pixels[i].g);
        sum += seen, expected += due;
        most_apart = std::max(most_apart, std::abs(seen - due));
    }
    EXPECT_PRED3(near_relative, sum, expected, 0.01);
    EXPECT_LT(most_apart, 0.05);  // with the noise of a pixel
    const double all = mean_of(furnace(prepared, true));
    EXPECT_LE(all, std::min(1.0, 1.002 * mean_of(once)));
    return all;
}
#endif

/// At most 0.5 % in at most 400 bytes, and light that is neither lost nor made.
void expect_good(const std::array<Evaluate, k_parts>& parts, bool sides_are_alike) {
    const auto fitted = fit_bsdf(parts, five_lobes());
    ASSERT_TRUE(fitted.ok()) << message(fitted.error());
    EXPECT_LE(payload_bytes(fitted->model), 400u);
    for (const PartFit& part : fitted->parts) {
        EXPECT_PRED3(near, part.squared_error_ratio, 0, 0.005) << name(part.part);
        EXPECT_EQ(part.answered_by.has_value(), is_back(part.part) && (sides_are_alike || is_transmission(part.part)));
        for (const Hemispherical& sum : part.hemispherical)
            EXPECT_PRED3(near, sum.fitted, sum.measured, std::max(0.02 * sum.measured, 0.005))
                << name(part.part) << " " << sum.theta / k_degree;
    }
    EXPECT_PRED3(near, fitted->most_fitted, fitted->most_measured, 0.01);
    EXPECT_LE(fitted->most_fitted, 1.01);
#ifdef SRBF_RENDER
    EXPECT_GT(expect_furnace(fitted->model), 0.1);
#endif
}

TEST(FitBsdf, RoughDielectricSlab) { expect_good(rough_slab(), true); }
TEST(FitBsdf, Leaf) { expect_good(leaf(), false); }

/// Averages over patches of a smooth function are fitted as such: the fit is nearer to the function than the patches
/// are.
TEST(FitBsdf, AveragesOverPatches) {
    const AngleBasis basis = small_basis();
    const auto f = [](Vec3d wl, Vec3d wv) { return 0.1 + 0.3 * elementary::exp(8 * (normalize(wl + wv).z - 1)); };
    const auto mean = [&](std::size_t o, std::size_t i) {
        double sum = 0;
        constexpr int n = 6;
        for (int k = 0; k < n * n * n * n; ++k) {
            const auto u = [&](int d) { return (k / int(std::pow(n, d)) % n + 0.5) / n; };
            const Vec3d in = basis.point_of(i, u(0), u(1)), out = basis.point_of(o, u(2), u(3));
            sum += f({in.x, -in.y, in.z}, {-out.x, out.y, out.z});
        }
        return sum / (n * n * n * n);
    };
    const auto measured = read_measured(
        as_bytes(bsdf_xml(small_basis_xml(), matrix_xml("Reflection Front", "small", basis.patches(), mean))), "f");
    ASSERT_TRUE(measured.ok()) << message(measured.error());
    PmRequest pm;
    pm.size = LobeCount{2}, pm.variates = 1, pm.form = PmForm::gaussian;
    const auto fitted = fit_bsdf(*measured, {.model = pm});
    ASSERT_TRUE(fitted.ok()) << message(fitted.error());
    EXPECT_LT(fitted->parts[0].squared_error_ratio, 1e-2);
    std::mt19937_64 random(4);
    double of_fit = 0, of_patches = 0;
    for (int k = 0; k < 2000; ++k) {
        const Vec3d wl = random_direction(random, 0.2), wv = random_direction(random, 0.2);
        const Vec3f l = to_float(wl), v = to_float(wv);
        of_fit += elementary::pow(double(value(fitted->model, l, v).r) - f(wl, wv), 2);
        of_patches += elementary::pow(double(value(*measured, l, v).r) - f(wl, wv), 2);
    }
    EXPECT_LT(of_fit, 0.2 * of_patches);
}

/// What fits one side refuses both.
TEST(FitBsdf, IsAskedForByName) {
    const auto shade = read_measured(as_bytes(small_shade()), "shade.xml");
    ASSERT_TRUE(shade.ok()) << message(shade.error());
    const std::string expected = "fit: measurement: expected a BRDF, found reflection and transmission, for fit_bsdf";
    const auto fitted = fit(*shade, {});
    ASSERT_FALSE(fitted.ok());
    EXPECT_EQ(message(fitted.error()), expected);
    EXPECT_EQ(message(Fitter(*shade).draft({}, 0).error()), expected);
}

TEST(FitBsdf, SmallShade) {
    const std::string text = small_shade();
    const auto measured = read_measured(as_bytes(text), "f");
    ASSERT_TRUE(measured.ok());
    FitRequest request;
    request.model = PmRequest{.variates = 2, .size = LobeCount{2}};
    const auto fitted = fit_bsdf(*measured, request);
    ASSERT_TRUE(fitted.ok()) << message(fitted.error());
    ASSERT_EQ(fitted->parts.size(), 4u);
    EXPECT_FALSE(fitted->parts[1].answered_by.has_value());
    EXPECT_EQ(fitted->parts[3].answered_by, Part::transmission_front);
    EXPECT_PRED3(near, fitted->parts[2].hemispherical[0].fitted, 0.05 * k_pi + 0.08, 1e-3);
    request.threads = 1;
    const auto again = fit_bsdf(*measured, request);
    EXPECT_EQ(write_model(again->model), write_model(fitted->model));
    // What is measured of one side only.
    EXPECT_FALSE(fit_bsdf(Measured{"f", "CSV", 0, ScatteredSamples{}}, {.model = PmRequest{}}).ok());
}

/// A matrix that few lobes cannot follow.
TEST(FitPatches, WhatNoLobesFollowHasAnAnswer) {
    const std::string text = small_shade();
    const auto measured = read_measured(as_bytes(text), "f");
    ASSERT_TRUE(measured.ok());
    const auto& part = std::get<BsdfTable>(measured->table).band().part[std::size_t(Part::transmission_front)];
    KlemsTable table = std::get<KlemsTable>(part->table);
    for (std::size_t i = 0; i < table.cells.size(); ++i) table.cells[i] = i % 7 == 0 ? Rgb{5, 5, 5} : Rgb{};
    const auto one = fit_patches(table, {.model = PmRequest{.variates = 1, .size = LobeCount{1}}}),
               any = fit_patches(table, {.model = PmRequest{}});
    ASSERT_TRUE(one.ok()) << message(one.error());
    ASSERT_TRUE(any.ok()) << message(any.error());
    EXPECT_EQ(std::get<PmModel>(one->model.model).lobes, 1);
    const PatchSums sums = sums_of(table, k_measured_points);
    EXPECT_LE(sums.error_ratio(evaluator(any->model)), sums.error_ratio(evaluator(one->model)));
}

// ---- The roller shade ----

struct Shade {
    Measured measured;
    BsdfOutcome fitted;
};
const Shade* shade() {
    static const std::optional<Shade> made = []() -> std::optional<Shade> {
        auto measured = load_measured(shared_data() / "klems" / "2011-SA1.xml");
        if (!measured) return {};
        auto fitted = fit_bsdf(*measured, {.model = PmRequest{}});
        if (!fitted) return {};
        return Shade{*std::move(measured), *std::move(fitted)};
    }();
    return made ? &*made : nullptr;
}

/// The light that passes to the back for light from these directions, per area: of the function and of the beam.
double light_behind(const Evaluate& f, const Beam& beam, const std::vector<std::pair<Vec3f, double>>& sky) {
    constexpr int n = 2000;
    const auto views = fibonacci_directions(n, k_pi / 2);
    double sum = 0;
    for (const auto& [wl, irradiance] : sky) {  // irradiance on the surface
        std::vector<Vec3f> below;
        for (const Vec3f& v : views) below.push_back(to_side(v, -1));
        std::vector<Rgb> values(below.size());
        f(std::vector<Vec3f>(below.size(), wl), below, values);
        double through = double(share_at(beam, wl).g);
        for (std::size_t k = 0; k < values.size(); ++k)
            through += double(values[k].g) * double(views[k].z) * 2 * k_pi / n;
        sum += irradiance * through;
    }
    return sum;
}

TEST(FitBsdf, RollerShade) {
    const Shade* of = shade();
    if (!of) GTEST_SKIP() << "no klems/2011-SA1.xml";
    EXPECT_LE(payload_bytes(of->fitted.model), 400u);  // of 2 MB
    ASSERT_EQ(of->fitted.parts.size(), 4u);
    for (const PartFit& part : of->fitted.parts) {
        EXPECT_PRED3(near, part.squared_error_ratio, 0, 2e-3) << name(part.part);
        ASSERT_EQ(part.hemispherical.size(), 9u);
        for (const Hemispherical& sum : part.hemispherical)
            EXPECT_PRED3(near, sum.fitted, sum.measured, std::max(0.02 * sum.measured, 0.002)) << name(part.part);
    }
    EXPECT_LE(of->fitted.most_fitted, 1);
    EXPECT_PRED3(near, of->fitted.most_fitted, of->fitted.most_measured, 0.005);
}

/// Behind a window with the shade, under the standard overcast sky of the CIE and under suns.
TEST(FitBsdf, LightBehindTheRollerShade) {
    const Shade* of = shade();
    if (!of) GTEST_SKIP() << "no klems/2011-SA1.xml";
    const Beam &a = std::get<BsdfTable>(of->measured.table).band().beam[2],
               &b = std::get<BsdfModel>(of->fitted.model.model).beam[2];
    std::vector<std::vector<std::pair<Vec3f, double>>> skies(1);
    constexpr int n = 300;
    for (const Vec3f& w : fibonacci_directions(n, 89.9 * k_degree))  // y is up
        if (w.y > 0) skies[0].emplace_back(w, double((1 + 2 * w.y) / 3 * w.z));
    for (const double altitude : {5.0, 25.0, 45.0, 65.0, 75.0})
        skies.push_back({{to_float(spherical(altitude * k_degree, k_pi / 2)), 1}});
    for (const auto& sky : skies) {
        const double matrix = light_behind(evaluator(of->measured), a, sky),
                     model = light_behind(evaluator(of->fitted.model), b, sky);
        // Suns fall between the angles of the matrix, which has steps of 10°.
        EXPECT_PRED3(near_relative, model, matrix, &sky == &skies[0] ? 0.02 : 0.07);
    }
}

TEST(FitBsdf, RollerShadeInEvenLight) {
    const Shade* of = shade();
    if (!of) GTEST_SKIP() << "no klems/2011-SA1.xml";
#ifdef SRBF_RENDER
    const double matrix = mean_of(furnace(prepare_bsdf(of->measured, {.threads = 1}), true));
    EXPECT_PRED3(near_relative, expect_furnace(of->fitted.model), matrix, 0.01);
#endif
}

TEST(FitBsdf, RollerShadeIsDrawnWithLittleNoise) {
    const Shade* of = shade();
    if (!of) GTEST_SKIP() << "no klems/2011-SA1.xml";
    const PreparedBsdf bsdf = prepare_bsdf(of->fitted.model, {.threads = 1});
    std::mt19937_64 random(1);
    for (const double theta : {45.0, 135.0}) {
        double sum = 0, squares = 0;
        constexpr int count = 20000;
        for (int i = 0; i < count; ++i) {
            const Vec2f u{float(uniform(random)), float(uniform(random))};
            const double weight =
                luminance(sample(bsdf, to_float(spherical(theta * k_degree, 0.3)), u, float(uniform(random))).weight);
            sum += weight, squares += weight * weight;
        }
        EXPECT_LE(squares * count / (sum * sum) - 1, 0.1) << theta;
    }
}

}  // namespace
}  // namespace srbf::fit_bsdf_test
