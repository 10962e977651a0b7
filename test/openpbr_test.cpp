// Models with the parameters of renderers' surfaces: the formula, the file, the fit.
#include "brdf/directions.h"
#include "errors/picture_errors.h"
#include "models/ggx/ggx_kind.h"
#include "models/openpbr/openpbr_kernel.h"
#include "models/openpbr/openpbr_kind.h"
#include "models/openpbr/openpbr_parameters.h"
#include "properties.h"
#include "srbf/metrics.h"
#include "srbf/model.h"

namespace srbf::pbr_test {
namespace {

using K = Kernel<float>;

OpenPbrModel random_openpbr(std::mt19937_64& random) {
    OpenPbrModel model;
    for (const OpenPbrParameter& parameter : k_openpbr_parameters)
        for (int c = 0; c < parameter.count(); ++c)
            number(model, parameter, c) =
                float(double(parameter.min) + uniform(random) * double(parameter.max - parameter.min));
    return model;
}
OpenPbrModel diffuse_alone(Rgb colour, float roughness) {
    OpenPbrModel model;
    model.base_color = colour;
    model.base_diffuse_roughness = roughness;
    model.specular_weight = 0;
    return model;
}
Vec3f above(std::mt19937_64& random) {
    const Vec3d w = random_direction(random);
    return to_float({w.x, w.y, std::abs(w.z)});
}

/// The layers of a synthetic surface.
enum class Surface { metal, coated, fuzzy, film, brushed };
/// A coloured surface with the given layers.
OpenPbrModel synthetic_surface(Surface surface) {
    OpenPbrModel truth;
    const bool is_metal = surface == Surface::metal || surface == Surface::film || surface == Surface::brushed;
    truth.base_color = is_metal ? Rgb{0.9f, 0.6f, 0.3f} : Rgb{0.5f, 0.15f, 0.1f};
    truth.base_metalness = is_metal ? 1.f : 0.f;
    truth.specular_roughness = is_metal ? 0.35f : 0.25f;
    if (surface == Surface::coated) {
        truth.coat_weight = 0.6f;
        truth.coat_roughness = 0.1f;
    }
    if (surface == Surface::fuzzy)
        truth.fuzz_weight = 0.7f, truth.fuzz_color = {0.8f, 0.8f, 0.3f}, truth.fuzz_roughness = 0.4f,
        truth.specular_roughness = 0.4f;
    if (surface == Surface::film) {
        truth.thin_film_weight = 1;
        truth.thin_film_thickness = 0.35f;
    }
    if (surface == Surface::brushed) {
        truth.specular_roughness_anisotropy = 0.6f;
        truth.specular_rotation = 0.4f;
    }
    return truth;
}

TEST(OpenPbr, RotatesWithItsTangentAndIsFiniteAndNotNegative) {
    std::mt19937_64 random(1);
    for (int i = 0; i < 2000; ++i) {
        OpenPbrModel model = random_openpbr(random);
        if (i % 2) model.specular_roughness_anisotropy = 0;
        const Vec3f wl = above(random), wv = above(random);
        const Rgb f = value(model, wl, wv);
        const double rotation = 6 * uniform(random);
        model.specular_rotation += float(rotation / (2 * k_pi));
        const Rgb g = value(model, rotate(wl, rotation), rotate(wv, rotation));
        for (int c = 0; c < 3; ++c) {
            EXPECT_GE(f[c], 0);
            EXPECT_WITHIN(f[c], g[c], 1e-3 * double(f[c]) + 1e-6);
        }
    }
    EXPECT_EQ(value(OpenPbrModel{}, {0, 0, -1}, {0, 0, 1}), Rgb{});
}

/// D G / (4 cosθl cosθv) of GGX facets with separate roughnesses along x and y, as in the literature.
double stretched_facets(Vec3d l, Vec3d v, double along, double across) {
    const Vec3d h = normalize(l + v);
    const auto tan2 = [&](Vec3d w) { return (along * along * w.x * w.x + across * across * w.y * w.y) / (w.z * w.z); };
    const double slope = h.x * h.x / (along * along) + h.y * h.y / (across * across) + h.z * h.z;
    const double d = 1 / (k_pi * along * across * slope * slope);
    const auto lambda = [&](Vec3d w) { return (std::sqrt(1 + tan2(w)) - 1) / 2; };
    return d / ((1 + lambda(l) + lambda(v)) * 4 * l.z * v.z);
}
TEST(OpenPbr, FacetsAreRougherAlongTheTangent) {
    std::mt19937_64 random(6);
    for (int i = 0; i < 300; ++i) {
        const Vec3f wl = above(random), wv = above(random);
        const double along = 0.1 + 0.8 * uniform(random), across = along * (0.2 + 0.8 * uniform(random));
        const double facets = stretched_facets({wl.x, wl.y, wl.z}, {wv.x, wv.y, wv.z}, along, across);
        EXPECT_WITHIN(K::ggx_stretched_facets(wl, wv, float(along), float(across)), facets, 2e-4 * facets) << i;
        EXPECT_WITHIN(K::ggx_stretched_facets(wl, wv, float(along), float(along)), K::ggx_facets(wl, wv, float(along)),
                      1e-4 * double(K::ggx_facets(wl, wv, float(along))));
    }
    // A metal with F0 = 1 has the value of its facets plus multiple scattering, whose ratio to the facets does not
    // depend on azimuth.
    OpenPbrModel white;
    white.base_color = {1, 1, 1}, white.base_metalness = 1, white.specular_roughness = 0.5f;
    white.specular_roughness_anisotropy = 0.5f;
    white.specular_rotation = 0.125f;
    const double along = 0.25 * std::sqrt(2 / 1.25), across = along / 2;
    const auto ratio_to_facets = [&](double azimuth, double rotation) {
        const Vec3d w = spherical(0.4, azimuth);
        const double facets = stretched_facets(spherical(0.4, azimuth - 2 * k_pi * rotation), {0, 0, 1}, along, across);
        return double(value(white, to_float(w), {0, 0, 1}).g) / facets;
    };
    for (const double azimuth : {0.3, 0.8, 2.0, 4.0})
        EXPECT_WITHIN(ratio_to_facets(azimuth, 0.125), ratio_to_facets(0, 0.125), 1e-3) << azimuth;
    // A slight anisotropy gives nearly the isotropic value.
    OpenPbrModel slightly_anisotropic = synthetic_surface(Surface::coated);
    const OpenPbrModel isotropic = slightly_anisotropic;
    slightly_anisotropic.specular_roughness_anisotropy = 1e-4f;
    for (int i = 0; i < 100; ++i) {
        const Vec3f wl = above(random), wv = above(random);
        EXPECT_RGB_WITHIN_RELATIVE(value(slightly_anisotropic, wl, wv), value(isotropic, wl, wv), 1e-3, 0);
    }
}

TEST(OpenPbr, ExchangingSwapsLightAndViewer) {
    std::mt19937_64 random(2);
    Model model{random_openpbr(random), {}};
    const Vec3f wl = above(random), wv = above(random);
    const Rgb f = value(model, wl, wv);
    exchange(model);
    EXPECT_EQ(value(model, wv, wl), f);
    EXPECT_NE(value(model, wl, wv), f);  // layers scale by the albedo at the viewer
}

TEST(OpenPbr, DoesNotReflectMoreThanItReceives) {
    OpenPbrModel white;
    white.base_color = {1, 1, 1};
    for (const float metalness : {0.f, 1.f})
        for (const float roughness : {0.1f, 0.4f, 0.8f})
            for (const float coat : {0.f, 1.f})
                for (const float fuzz : {0.f, 1.f}) {
                    OpenPbrModel model = white;
                    model.base_metalness = metalness;
                    model.specular_roughness = roughness;
                    model.coat_weight = coat;
                    model.coat_roughness = 0.2f;
                    model.fuzz_weight = fuzz;
                    for (const double theta : {0.0, 0.8, 1.2})
                        EXPECT_LT(albedo(evaluator(model), theta, k_pi / 2).g, 1.04)
                            << metalness << ' ' << roughness << ' ' << coat << ' ' << fuzz << ' ' << theta << ' '
                            << albedo(evaluator(model), theta, k_pi / 2).g;
                }
}

TEST(OpenPbr, IsLambertOrEonWithoutSpecular) {
    const Rgb colour{0.2f, 0.5f, 0.9f};
    EXPECT_WITHIN(value(diffuse_alone(colour, 0), {0.6f, 0, 0.8f}, {0, 0, 1}).g, 0.5 / k_pi, 1e-6);
    for (const double theta : {0.0, 1.0, 1.4}) {
        EXPECT_RGB_WITHIN(albedo(evaluator(diffuse_alone(colour, 0)), theta, k_pi / 2), colour, 1e-3);
        for (const float roughness : {0.5f, 1.f})
            EXPECT_WITHIN(albedo(evaluator(diffuse_alone({1, 1, 1}, roughness)), theta, k_pi / 2).g, 1, 3e-3)
                << roughness << ' ' << theta;
    }
    // Single scattering is that of Fujii's Oren-Nayar: for l = v and r = 1, 1 / π (1 + sin²θ / cosθ) divided by
    // 1.2878.
    const float z = 0.6f;
    const Vec3f w{0.8f, 0, z};
    const auto eon = [&](float r) { return K::eon_value({1e-3f, 1e-3f, 1e-3f}, r, w, w).x; };
    EXPECT_WITHIN(eon(1), 1e-3 / k_pi * (1 + 0.64 / 0.6) / (1.5 - 2 / (3 * k_pi)), 2e-7);
}

TEST(OpenPbr, FresnelTermsMatchTheirEquations) {
    EXPECT_WITHIN(K::normal_reflectance(1.5f), 0.04, 1e-7);
    EXPECT_WITHIN(K::dielectric_reflectance(1, 1.5f), 0.04, 1e-6);
    EXPECT_WITHIN(K::dielectric_reflectance(0, 1.5f), 1, 1e-6);
    const double ci = 0.5, ct = std::sqrt(1 - (1 - ci * ci) / (1.5 * 1.5));
    const double s = (ci - 1.5 * ct) / (ci + 1.5 * ct), p = (1.5 * ci - ct) / (1.5 * ci + ct);
    EXPECT_WITHIN(K::dielectric_reflectance(0.5f, 1.5f), (s * s + p * p) / 2, 1e-6);
    const auto schlick = [](float c) { return std::pow(1 - c, 5.f); };
    EXPECT_WITHIN(K::metal_reflectance(1, schlick(1), 0.7f, 0.5f), 0.7, 1e-6);
    EXPECT_WITHIN(K::metal_reflectance(0, schlick(0), 0.7f, 0.5f), 1, 1e-6);
    const float at_82 = 1.f / 7, plain = K::metal_reflectance(at_82, schlick(at_82), 0.7f, 1);
    EXPECT_WITHIN(K::metal_reflectance(at_82, schlick(at_82), 0.7f, 0.5f), 0.5 * double(plain), 1e-5);
    EXPECT_WITHIN(plain, 0.7 + 0.3 * std::pow(6.0 / 7, 5), 1e-6);
}

TEST(OpenPbr, AlbedosOfLayersAreTheirIntegrals) {
    for (const float alpha : {0.01f, 0.1f, 0.3f, 1.f})
        for (const float cosine : {0.2f, 0.5f, 1.f}) {
            const GgxModel white{{}, {{alpha, {1, 1, 1}, 1}}};
            const double theta = std::acos(double(cosine));
            const K::FacetAlbedo facet_albedo = K::facet_albedo(cosine, alpha);
            EXPECT_WITHIN(double(facet_albedo.scale + facet_albedo.bias),
                          double(albedo(evaluator(white), theta, k_pi / 2).g), cosine < 0.5f ? 0.03 : 0.02)
                << alpha << ' ' << cosine;
        }
    OpenPbrModel fuzz = diffuse_alone({0, 0, 0}, 0);
    fuzz.fuzz_weight = 1;
    for (const float roughness : {0.2f, 0.5f, 1.f}) {
        fuzz.fuzz_roughness = roughness;
        for (const float cosine : {0.3f, 0.6f, 1.f})
            EXPECT_WITHIN(albedo(evaluator(fuzz), std::acos(double(cosine)), k_pi / 2).g,
                          double(K::fuzz_albedo(cosine, roughness)), 0.01)
                << roughness << ' ' << cosine;
    }
}

TEST(OpenPbr, FilesStoreAllNumbers) {
    std::mt19937_64 random(3);
    for (int i = 0; i < 20; ++i) {
        Model model{rounded(random_openpbr(random)), {{"source", "made up"}}};
        if (i % 2) exchange(model);
        const auto read = checked(read_model(write_model(model), "a"));
        EXPECT_EQ(std::get<OpenPbrModel>(read->model), std::get<OpenPbrModel>(model.model));
        EXPECT_EQ(read->provenance, model.provenance);
    }
    EXPECT_EQ(payload_bytes(OpenPbrModel{}), 48u);
    EXPECT_EQ(payload_bytes(synthetic_surface(Surface::film)), 54u);
    EXPECT_EQ(payload_bytes(synthetic_surface(Surface::brushed)), 52u);
}

TEST(OpenPbr, DamagedFilesAreRejected) {
    for (const OpenPbrModel& model :
         {OpenPbrModel{}, synthetic_surface(Surface::film), synthetic_surface(Surface::brushed)}) {
        const std::vector<std::byte> bytes = write_model({model, {}});
        for (std::size_t size = 0; size < bytes.size(); ++size)
            EXPECT_FALSE(read_model(std::span(bytes).first(size), "a").ok()) << size;
        int rejected = 0;
        const std::size_t numbers = bytes.size() - payload_bytes(model);
        for (std::size_t i = numbers + 1; i < bytes.size(); i += 2) {
            auto flipped = bytes;
            flipped[i] = std::byte(0xc4);  // about −4, which is invalid for every parameter
            rejected += !read_model(flipped, "a").ok();
        }
        EXPECT_EQ(rejected, int(number_count(model)));
    }
}

TEST(OpenPbr, RecoversSyntheticSurfaces) {
    for (const Surface surface : {Surface::coated, Surface::fuzzy, Surface::film, Surface::brushed}) {  // two metals
        const OpenPbrModel truth = synthetic_surface(surface);
        const auto observed = checked(observe(evaluator(truth), {.count = 8192}));
        const auto fit = checked(Kind<OpenPbrModel>::fit(*observed, {}, {.is_isotropic = surface != Surface::brushed}));
        const std::vector<Evaluate> fits{evaluator(fit->model)};
        EXPECT_LT(compare_pictures(evaluator(truth), fits)[0].mean.delta_e, 0.3) << int(surface);
        for (const OpenPbrParameter& parameter : k_openpbr_parameters)
            for (int c = 0; c < parameter.count(); ++c)
                EXPECT_WITHIN(number(fit->model, parameter, c), number(truth, parameter, c),
                              0.05 * std::max(double(number(truth, parameter, c)), 0.01))
                    << int(surface) << ' ' << parameter.name;
        EXPECT_EQ(fit->model.base_metalness, truth.base_metalness);
        // Layers without a visible effect are absent.
        EXPECT_EQ(fit->model.coat_weight > 0, surface == Surface::coated);
        EXPECT_EQ(fit->model.fuzz_weight > 0, surface == Surface::fuzzy);
        EXPECT_EQ(fit->model.thin_film_weight > 0, surface == Surface::film);
    }
}

TEST(OpenPbr, FilmColoursMatchTheirEquations) {
    // The equations of Belcour & Barla 2017, in metres, with the C library's functions.
    for (const double path : {0.05e-6, 0.3e-6, 1e-6, 4e-6}) {
        const double phase = 2 * k_pi * path;
        const auto wave = [&](double size, double position, double variance, double shift) {
            return size * std::sqrt(2 * k_pi * variance) * std::cos(position * phase + shift) *
                   std::exp(-variance * phase * phase) / 1.0685e-7;
        };
        for (const double shift : {0.0, k_pi}) {
            const double x = wave(5.4856e-13, 1.6810e6, 4.3278e9, shift) + wave(9.7470e-14, 2.2399e6, 4.5282e9, shift),
                         y = wave(4.4201e-13, 1.7953e6, 9.3046e9, shift),
                         z = wave(5.2481e-13, 2.2084e6, 6.6121e9, shift);
            const auto cos_shift = float(std::cos(shift));
            const Vec3f colour = K::film_colour(float(1e6 * path), {cos_shift, cos_shift, cos_shift});
            EXPECT_WITHIN(colour.x, 3.2404542 * x - 1.5371385 * y - 0.4985314 * z, 2e-5) << path;
            EXPECT_WITHIN(colour.y, -0.9692660 * x + 1.8760108 * y + 0.0415560 * z, 2e-5) << path;
            EXPECT_WITHIN(colour.z, 0.0556434 * x - 0.2040259 * y + 1.0572252 * z, 2e-5) << path;
        }
    }
    for (const float x : {0.f, 1e-3f, 1.f, 3.f, 40.f, 200.f})
        EXPECT_WITHIN(K::one_minus_cos(x), 1 - std::cos(double(x)), 1e-4 + 1e-7 * double(x) * double(x)) << x;
}

TEST(OpenPbr, AFilmOfAirHasNoEffect) {
    OpenPbrModel plain = synthetic_surface(Surface::film), film = plain;
    plain.thin_film_weight = 0;
    film.thin_film_ior = 1;
    std::mt19937_64 random(4);
    for (int i = 0; i < 300; ++i) {
        const Vec3f wl = above(random), wv = above(random);
        if (K::half_cosine(wl, wv) < 0.85f) continue;  // Schlick's term reflects at grazing angles for any index
        const Rgb a = value(plain, wl, wv), b = value(film, wl, wv);
        EXPECT_RGB_WITHIN_RELATIVE(b, a, 0.05, 0);
    }
}

TEST(OpenPbr, ParametersThatASurfaceLacksKeepTheirDefaults) {
    const auto observed = checked(
        observe(evaluator(synthetic_surface(Surface::coated)), {.objective = Objective::cosine, .count = 1024}));
    const auto fit = checked(Kind<OpenPbrModel>::fit(*observed, {.surface = OpenPbrSurfaceKind::gltf}));
    EXPECT_EQ(fit->model.coat_color, (Rgb{1, 1, 1}));
    EXPECT_EQ(fit->model.base_diffuse_roughness, 0);
}

TEST(OpenPbr, FitsPairsWithoutPictures) {
    const OpenPbrModel truth = synthetic_surface(Surface::metal);
    const auto observed = checked(observe(evaluator(truth), {.objective = Objective::cosine, .count = 4096}));
    const auto fit = checked(Kind<OpenPbrModel>::fit(*observed));
    EXPECT_LT(fit->loss, 1e-3);
}

}  // namespace
}  // namespace srbf::pbr_test
