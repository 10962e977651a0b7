// Functions of extended light in exported code compute what the library computes.
#include "srbf/environment_code.h"

#include "brdf/directions.h"
#include "compiled_code.h"
#include "models.h"
#include "models/ggx/ggx_kind.h"
#include "properties.h"
#include "srbf/prepared.h"
#include "statistics.h"

namespace srbf::environment_code_test {
namespace {

class EnvironmentCode : public CodeTest {};

const std::string k_vector_in_c =
    "static srbf_vec3 vector(const float* p) { return srbf_vec3_of(p[0], p[1], p[2]); }\n";

/// The draws are from an environment whose radiance hardly changes over the solid angle of one.
TEST_F(EnvironmentCode, DrawsAreOfTheEnvironment) {
    const Model model{rounded(GgxModel{{0.3f, 0.2f, 0.1f}, {{0.3f, {0.3f, 0.2f, 0.1f}, 1}}}), {}};
    const NamedModel named{"glossy", &model};
    const auto text = [&](CodeLanguage language) {
        return *shading_code(std::span(&named, 1), "glossy", {.language = language, .with = {"environment-draws"}});
    };
    EXPECT_CONTAINS(text(CodeLanguage::wgsl), "fn glossy_environment_sampled(wv: vec3f, count: i32)");
    EXPECT_LACKS(text(CodeLanguage::msl), "glossy_environment_sampled(");
    EXPECT_CONTAINS(text(CodeLanguage::msl), "glossy_environment_draw(");
    void* const library = compile_and_load(
        SRBF_STRICT_C, "draws",
        text(CodeLanguage::c) +
            "static srbf_vec3 glossy_radiance_over(srbf_vec3 direction, float solid_angle) {\n"
            "    return srbf_vec3_of(1.0f + direction.x, 1.0f + direction.z, 1.0f / (1.0f + solid_angle));\n}\n" +
            c_function("void answer(const float* v, int count, float* to)",
                       "    srbf_vec3 wv = {v[0], v[1], v[2]}, f = glossy_environment_sampled(wv, count);\n"
                       "    to[0] = f.x, to[1] = f.y, to[2] = f.z;\n"));
    ASSERT_TRUE(library);
    const auto answer = function<void(const float*, int, float*)>(library, "answer");
    const PreparedBrdf brdf = prepare(model);
    std::mt19937_64 random(3);
    constexpr int k_views = 50;
    double squares = 0;  // of the relative errors of few draws
    for (int i = 0; i < k_views; ++i) {
        const Vec3f wv = to_float(random_direction(random, 0.1));
        const Quadrature points = MirrorMixture(k_pi / 2).quadrature(to_double(wv), 1 << 13);
        Rgb expected, found, found_by_many;
        for (std::size_t k = 0; k < points.w.size(); ++k) {
            const Vec3f wl = points.w[k];
            const Rgb f = value(brdf, wl, wv);
            const float weight = float(points.weight[k]) * wl.z;
            expected.r += weight * f.r * (1 + wl.x);
            expected.g += weight * f.g * (1 + wl.z);
            expected.b += weight * f.b;
        }
        answer(&wv.x, 64, &found.r);
        answer(&wv.x, 4096, &found_by_many.r);
        for (int c = 0; c < 2; ++c) {
            const double error = double(found[c]) / double(expected[c]) - 1;
            EXPECT_LT(std::abs(error), 0.12) << wv.z;
            squares += elementary::square(error);
        }
        EXPECT_RGB_WITHIN_RELATIVE(found_by_many, expected, 0.01, 0) << wv.z;
    }
    EXPECT_LT(std::sqrt(squares / (2 * k_views)), 0.03);
}

const Model& glossy() {
    static const Model model{rounded(GgxModel{{0.3f, 0.2f, 0.1f}, {{0.5f, {0.3f, 0.2f, 0.1f}, 1}}}), {}};
    return model;
}
const ExtendedLight& light_of_glossy() {
    static const ExtendedLight light = extended_light(prepare(glossy()));
    return light;
}

/// The code agrees with the library under an environment of the host whose radiance depends on direction and blur.
TEST_F(EnvironmentCode, EnvironmentsAreThoseOfTheLibrary) {
    const NamedModel named{"glossy", &glossy()};
    const auto text = [&](CodeLanguage language) {
        return *shading_code(std::span(&named, 1), "glossy", {.language = language, .with = {"environment"}});
    };
    EXPECT_CONTAINS(text(CodeLanguage::wgsl), "fn glossy_environment(wv: vec3f)");
    const std::string metal = text(CodeLanguage::msl);
    EXPECT_LACKS(metal, "glossy_environment(");
    EXPECT_CONTAINS(metal, "glossy_environment_lobe(");
    void* const library =
        compile_and_load(SRBF_STRICT_C, "environment",
                         text(CodeLanguage::c) +
                             "static srbf_vec3 glossy_radiance(srbf_vec3 direction, float roughness) {\n"
                             "    return srbf_vec3_of(1.0f + direction.x, 1.0f + direction.z, roughness);\n}\n" +
                             c_function("void answer(const float* v, float* to)",
                                        "    srbf_vec3 wv = {v[0], v[1], v[2]}, f = glossy_environment(wv);\n"
                                        "    to[0] = f.x, to[1] = f.y, to[2] = f.z;\n"));
    ASSERT_TRUE(library);
    const auto answer = function<void(const float*, float*)>(library, "answer");
    const ExtendedLight& light = light_of_glossy();
    std::mt19937_64 random(3);
    for (int i = 0; i < 200; ++i) {
        const Vec3f wv = to_float(random_direction(random, 1e-3));
        Rgb found, expected;
        answer(&wv.x, &found.r);
        for (const ExtendedLight::Lobe& lobe : lobes_at(light, wv.z)) {
            const Vec3f axis = axis_of(lobe, wv);
            expected.r += lobe.weight.r * (1 + axis.x);
            expected.g += lobe.weight.g * (1 + axis.z);
            expected.b += lobe.weight.b * lobe.roughness;
        }
        EXPECT_RGB_WITHIN(found, non_negative(expected), 1e-4f) << wv.z;
    }
}

/// GGX's kernel of a roughness, seen along the normal [1/sr].
double ggx_kernel(double roughness, double cosine) {
    const double a = std::pow(roughness, 4), b = 1 - a;
    const double integral = b < 1e-4 ? 1.0 / 8 : ((1 + a) / (2 * a) - 1 + std::log(2 * a / (1 + a))) / (b * b);
    return cosine > 0 ? cosine / (2 * k_pi * integral * std::pow(1 + a - b * cosine, 2)) : 0;
}

/// A parallelogram, by its middle and halves of its sides.
struct Quadrilateral {
    Vec3d middle, x, y;
    std::array<Vec3f, 4> corners(double scale = 1) const {
        return {to_float(scale * (middle - x - y)), to_float(scale * (middle + x - y)),
                to_float(scale * (middle + x + y)), to_float(scale * (middle - x + y))};
    }
};
Quadrilateral random_quadrilateral(std::mt19937_64& random, double size) {
    const Vec3d middle = random_direction(random, -0.2), x = size * random_direction(random, -1);
    return {middle, x, cross(middle, x)};
}

/// The integral of lobes over the directions of a quadrilateral, of the green channel.
struct LobeIntegral {
    double resolved = 0;               ///< of those that are not sharp
    double whole = 0, unresolved = 0;  ///< the weights of all lobes, and of the sharp ones
};
LobeIntegral lobe_integral(std::span<const ExtendedLight::Lobe> lobes, const Vec3f& wv, const Quadrilateral& over) {
    constexpr int steps = 60;
    constexpr float resolved = 0.16f;  // by these steps; sharper lobes, which hardly weigh here, are in or out
    LobeIntegral integral;
    for (int s = 0; s < steps; ++s)
        for (int t = 0; t < steps; ++t) {
            const Vec3d p = over.middle + ((2 * s + 1.0) / steps - 1) * over.x + ((2 * t + 1.0) / steps - 1) * over.y;
            const double far = std::sqrt(dot(p, p)),
                         solid = 4.0 / (steps * steps) * std::abs(dot(cross(over.x, over.y), p)) / (far * far * far);
            for (const ExtendedLight::Lobe& lobe : lobes) {
                const float cosine = dot(axis_of(lobe, wv), to_float((1 / far) * p));
                if (lobe.roughness < resolved) continue;
                integral.resolved += double(lobe.weight.g) * ggx_kernel(double(lobe.roughness), double(cosine)) * solid;
            }
        }
    for (const ExtendedLight::Lobe& lobe : lobes) {
        integral.whole += double(lobe.weight.g);
        if (lobe.roughness < resolved) integral.unresolved += std::abs(double(lobe.weight.g));
    }
    return integral;
}

/// The code's area lights agree with integrals of lobes over the directions of quadrilaterals near and far, some of
/// them across the horizon; small ones agree with the BRDF; all directions together give the albedo.
TEST_F(EnvironmentCode, AreaLightsAreIntegralsOfTheLobes) {
    const Model& model = glossy();
    const NamedModel named{"glossy", &model};
    void* const library = compile_and_load(
        SRBF_STRICT_C, "area",
        *shading_code(std::span(&named, 1), "glossy", {.language = CodeLanguage::c, .with = {"area"}}) + k_vector_in_c +
            c_function(
                "void answer(const float* v, const float* p, float* to)",
                "    srbf_vec3 f = glossy_area(vector(v), vector(p), vector(p + 3), vector(p + 6), vector(p + 9));\n"
                "    to[0] = f.x, to[1] = f.y, to[2] = f.z;\n"));
    ASSERT_TRUE(library);
    const auto called = function<void(const float*, const Vec3f*, float*)>(library, "answer");
    const auto green = [&](const Vec3f& wv, const std::array<Vec3f, 4>& corners) {
        Rgb found;
        called(&wv.x, corners.data(), &found.r);
        return double(found.g);
    };
    const ExtendedLight& light = light_of_glossy();
    const PreparedBrdf brdf = prepare(model);
    std::mt19937_64 random(3);
    for (int i = 0; i < 40; ++i) {
        const Vec3f wv = to_float(random_direction(random, 0.1));
        const Quadrilateral area = random_quadrilateral(random, 0.7);
        const LobeIntegral expected = lobe_integral(lobes_at(light, wv.z), wv, area);
        ASSERT_LT(expected.unresolved, 0.1 * expected.whole);
        EXPECT_WITHIN(green(wv, area.corners()), std::max(expected.resolved, 0.0),
                      0.04 * expected.whole + expected.unresolved)
            << i;
    }
    for (int i = 0; i < 20; ++i) {  // small ones show the BRDF itself
        const Vec3f wv = to_float(random_direction(random, 0.1));
        const Quadrilateral area = random_quadrilateral(random, 0.02);
        const double solid = 4 * std::abs(dot(cross(area.x, area.y), area.middle));
        const double expected = double(value(brdf, to_float(area.middle), wv).g) * std::max(area.middle.z, 0.0) * solid;
        EXPECT_WITHIN(green(wv, area.corners(2)), expected, 0.01 * expected + 1e-6) << i;
    }
    constexpr float wide = 1e4f;
    const std::array<Vec3f, 4> sky{Vec3f(-wide, -wide, 0.01f), Vec3f(wide, -wide, 0.01f), Vec3f(wide, wide, 0.01f),
                                   Vec3f(-wide, wide, 0.01f)};
    EXPECT_WITHIN(green({0, 0, 1}, sky), double(albedo(brdf, 1).g), 0.01);
}

TexelMap map_of(int lobes, std::size_t width) {
    std::mt19937_64 random(1);
    return random_map(random, {true, true, lobes, 3, 60, PmForm::extended}, width, 1);
}
std::string lit_code(const TexelMap& map, CodeLanguage language) {
    return *checked(map_code(map, "map", {.language = language, .albedo = true, .with = {"environment", "area"}}));
}

/// The radiance of a uniform environment is reflected by the albedo, and that of a large quadrilateral near the
/// surface; both of a mean of coefficients is the mean.
TEST_F(EnvironmentCode, LightOfMapsIsLinear) {
    const TexelMap map = map_of(5, 2);
    void* const library = compile_and_load(
        SRBF_STRICT_C, "light",
        lit_code(map, CodeLanguage::c) +
            "static const float* at;\n"
            "static srbf_vec3 map_layer(int j, float u, float v) {\n"
            "    (void)u, (void)v;\n    return srbf_vec3_of(at[3 * j], at[3 * j + 1], at[3 * j + 2]);\n}\n"
            "static srbf_vec3 map_radiance(srbf_vec3 w, float roughness) {\n"
            "    (void)w, (void)roughness;\n    return srbf_vec3_of(1, 1, 1);\n}\n" +
            c_function(
                "void answer(const float* coefficients, const float* w, float* to)",
                "    const float e = 50.0f;\n    map_Coefficients texel;\n    srbf_vec3 f, wv = {w[0], w[1], w[2]};\n"
                "    at = coefficients, texel = map_coefficients(0, 0);\n"
                "    f = map_albedo(wv.z, texel), to[0] = f.x, to[1] = f.y, to[2] = f.z;\n"
                "    f = map_environment(wv, texel), to[3] = f.x, to[4] = f.y, to[5] = f.z;\n"
                "    f = map_area(wv, srbf_vec3_of(-e, -e, 1), srbf_vec3_of(e, -e, 1), srbf_vec3_of(e, e, 1), "
                "srbf_vec3_of(-e, e, 1), texel);\n    to[6] = f.x, to[7] = f.y, to[8] = f.z;\n"));
    ASSERT_TRUE(library);
    const auto answer = function<void(const Rgb*, const Vec3f*, Rgb*)>(library, "answer");
    const std::size_t J = map.coefficient.size() / 2;
    std::vector<Rgb> mean(J);
    for (std::size_t j = 0; j < J; ++j) mean[j] = mixed(map.coefficient[j], map.coefficient[J + j], 0.5f);
    for (const double z : {0.1, 0.4, 0.75, 0.99}) {
        const Vec3f wv = to_float(spherical(std::acos(z), 0.3));
        std::array<std::array<Rgb, 3>, 3> colours;
        answer(map.coefficient.data(), &wv, colours[0].data());
        answer(&map.coefficient[J], &wv, colours[1].data());
        answer(mean.data(), &wv, colours[2].data());
        for (const std::size_t k : {0, 1, 2}) {
            EXPECT_RGB_WITHIN_RELATIVE(colours[2][k], mixed(colours[0][k], colours[1][k], 0.5f), 1e-5f, 1e-30) << k;
            EXPECT_RGB_WITHIN_RELATIVE(colours[0][k], colours[0][0], 0.05f, 1e-30) << k << ' ' << z;
        }
    }
}

TEST_F(EnvironmentCode, LightOfMapsCompiles) {
    EXPECT_TRUE(compiles_as_glsl(
        "light.frag",
        "#version 300 es\nprecision highp float;\nuniform highp sampler2DArray layers;\n" +
            lit_code(map_of(1, 1), CodeLanguage::glsl) +
            "vec3 map_layer(int j, float u, float v) { return texture(layers, vec3(u, v, float(j))).rgb; }\n"
            "vec3 map_radiance(vec3 w, float roughness) { return w; }\n"
            "in vec3 a, b; in vec2 uv; out vec4 c;\n"
            "void main() {\n    map_Coefficients texel = map_coefficients(uv.x, uv.y);\n"
            "    c = vec4(map_environment(a, texel) + map_area(a, b, b.yzx, b.zxy, b.xzy, texel), 1.0);\n}\n"));
}

/// Statements in the place of loops, with numbers in the place of tables, compute the same.
TEST_F(EnvironmentCode, UnrolledLoopsComputeTheSame) {
    std::mt19937_64 random(2);
    PmModel lobes =
        random_model(random, {.log_scale = true, .lobes = 4, .max_bandwidth = 40, .form = PmForm::reciprocal});
    lobes.bandwidth[1] = 0;
    lobes.coefficient[2].g = 0;
    const Model model{rounded(lobes), {}};
    const NamedModel named{"film", &model};
    std::string texts[2];
    std::array<void (*)(const Vec3f*, const Vec3f*, Rgb*), 2> answers{};
    for (const bool unrolled : {false, true}) {
        texts[unrolled] = *environment_code(std::span(&named, 1), "film", {.language = CodeLanguage::c},
                                            {.area = true, .lobes = 3, .fixed = true, .unrolled = unrolled});
        void* const library = compile_and_load(
            SRBF_STRICT_C, unrolled ? "unrolled" : "loops",
            texts[unrolled] + k_vector_in_c +
                c_function(
                    "void answer(const float* v, const float* p, float* to)",
                    "    srbf_vec3 f = film_brdf(vector(p), vector(v));\n    to[0] = f.x, to[1] = f.y, to[2] = f.z;\n"
                    "    f = film_area(vector(v), vector(p), vector(p + 3), vector(p + 6), vector(p + 9));\n"
                    "    to[3] = f.x, to[4] = f.y, to[5] = f.z;\n"));
        ASSERT_TRUE(library);
        answers[unrolled] = function<void(const Vec3f*, const Vec3f*, Rgb*)>(library, "answer");
    }
    EXPECT_LT(count_of(texts[1], "for (int "), count_of(texts[0], "for (int "));
    for (int i = 0; i < 50; ++i) {
        const Vec3f wv = to_float(random_direction(random, 0.05));
        const std::array<Vec3f, 4> corners = random_quadrilateral(random, 0.3).corners();
        std::array<Rgb, 2> by_loops, by_statements;  // values of the BRDF, and light of the area
        answers[0](&wv, corners.data(), by_loops.data());
        answers[1](&wv, corners.data(), by_statements.data());
        for (const std::size_t k : {0, 1})
            EXPECT_RGB_WITHIN_RELATIVE(by_statements[k], by_loops[k], 2e-4f, 1e-30) << k << ' ' << i;
    }
}

TEST_F(EnvironmentCode, UnknownFeaturesAreRefused) {
    const NamedModel named{"glossy", &glossy()};
    for (const char* unknown : {"sampling", "light", ""}) {
        const auto text = shading_code(std::span(&named, 1), "glossy", {.with = {unknown}});
        ASSERT_FALSE(text);
        EXPECT_EQ(text.error().code, ErrorCode::argument);
    }
    EXPECT_FALSE(map_code(map_of(1, 1), "map", {.with = {"environment-draws"}}));
}

}  // namespace
}  // namespace srbf::environment_code_test
