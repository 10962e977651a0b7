// Compilers accept the exported code of BSDFs, and its values in reflection and transmission are the library's.
#include "brdf/parts.h"
#include "compiled_code.h"
#include "models.h"
#include "models/bsdf/bsdf_functions.h"
#include "models/ggx/ggx_kind.h"
#include "properties.h"
#include "srbf/brdf.h"
#include "srbf/shading_code.h"
#include "statistics.h"

namespace srbf::bsdf_code_test {
namespace {

using BsdfCode = CodeTest;

/// BSDFs with parts of their own, with parts that their counterparts answer for, and with one that is 0.
std::vector<Model> bsdfs() {
    std::vector<Model> all(3, Model{lobe_bsdf_with_beams(), {}});
    auto& sharing = std::get<BsdfModel>(all[1].model);
    sharing.part[1].reset();
    sharing.part[3].reset();
    sharing.beam = {};
    sharing.beam[1] = {{0.2f, float(k_pi / 2)}, {{0.3f, 0.2f, 0.1f}, {0.1f, 0.2f, 0.3f}}};
    auto& one_way = std::get<BsdfModel>(all[2].model);
    one_way.part[0].reset();
    one_way.part[1].reset();
    one_way.part[2] = std::make_shared<const Model>(
        Model{GgxModel{{}, {{0.1f, {0.9f, 0.5f, 0.2f}, 1}, {0.5f, {0, 0.03f, 0.2f}, 0.4f}}}, {}});
    for (Model& model : all) model = *read_model(write_model(model), "m");
    return all;
}

/// The code of these BSDFs and of a BRDF.
std::string code_of_bsdfs(const std::vector<Model>& all, CodeLanguage language) {
    std::vector<NamedModel> named;
    for (std::size_t i = 0; i < all.size(); ++i) named.push_back({fmt::format("b{}", i), &all[i]});
    std::mt19937_64 random(1);
    const Model brdf{rounded(random_model(random, {})), {}};
    named.push_back({"brdf", &brdf});
    const auto text = shading_code(named, "all", {.language = language, .sampling = true});
    if (!text) return ADD_FAILURE() << message(text.error()), "";
    return *text;
}

/// One C function that calls the exported function that its argument names.
enum Question { value_of, beam, mirror_beam, drawn, density };
const char* const k_answer_text =
    "enum { VALUE, BEAM, MIRROR_BEAM, SAMPLE, PDF };\n"
    "void answer(int m, int what, const float* l, const float* v, float* to);\n"
    "void answer(int m, int what, const float* l, const float* v, float* to) {\n"
    "    srbf_vec3 a = {l[0], l[1], l[2]}, wv = {v[0], v[1], v[2]}, w = {0.0f, 0.0f, 0.0f};\n"
    "    if (what == VALUE) w = m == 0 ? b0_bsdf(a, wv) : m == 1 ? b1_bsdf(a, wv) : b2_bsdf(a, wv);\n"
    "    if (what == BEAM && m != 1) w = m == 0 ? b0_beam(wv) : b2_beam(wv);\n"
    "    if (what == MIRROR_BEAM) w = m == 0 ? b0_mirror_beam(wv) : m == 1 ? b1_mirror_beam(wv) : "
    "b2_mirror_beam(wv);\n"
    "    if (what == SAMPLE)\n"
    "        w = m == 0   ? b0_sample(wv, a.x, a.y, a.z)\n            : m == 1 ? b1_sample(wv, a.x, a.y, a.z)\n"
    "                     : b2_sample(wv, a.x, a.y, a.z);\n"
    "    if (what == PDF) w.x = m == 0 ? b0_pdf(a, wv) : m == 1 ? b1_pdf(a, wv) : b2_pdf(a, wv);\n"
    "    to[0] = w.x, to[1] = w.y, to[2] = w.z;\n}\n";
/// The answers of one BSDF's code.
using Answer = std::function<Rgb(Question what, Vec3f l, Vec3f v)>;

void expect_nothing_of_nan(const Answer& answer) {
    for (const Vec3f none : {Vec3f(NAN, NAN, NAN), {NAN, 0, 1}, {0, NAN, -1}, {0, 0, NAN}})
        for (const Question what : {value_of, density, beam, mirror_beam}) {
            EXPECT_EQ(answer(what, {0, 0.6f, 0.8f}, none), Rgb()) << what;
            if (what == beam || what == mirror_beam) continue;
            EXPECT_EQ(answer(what, none, {0, 0.6f, -0.8f}), Rgb()) << what;
        }
}

void expect_values(const Answer& answer, const Model& model, std::mt19937_64& random) {
    const auto& bsdf = std::get<BsdfModel>(model.model);
    const Beams beams = complete_beams(bsdf.part, bsdf.beam);
    for (int i = 0; i < 4000; ++i) {
        const Vec3f wl = to_float(random_direction(random)), wv = to_float(random_direction(random));
        const Rgb f = answer(value_of, wl, wv), expected = value(model, wl, wv);
        const Rgb through = answer(beam, wl, wv), mirror_value = answer(mirror_beam, wl, wv);
        const Vec3f from = mirror(wv);
        const Part through_part = wv.z > 0 ? Part::transmission_back : Part::transmission_front,
                   mirror_part = wv.z > 0 ? Part::reflection_front : Part::reflection_back;
        ASSERT_RGB_WITHIN_RELATIVE(f, expected, 1e-4, 1e-6);
        ASSERT_RGB_WITHIN(through, fraction_at(beams, through_part, from), 1e-4);
        ASSERT_RGB_WITHIN(mirror_value, fraction_at(beams, mirror_part, from), 1e-4);
    }
    const Vec3f in_surface{1, 0, 0}, up{0, 0, 1};
    EXPECT_EQ(answer(value_of, in_surface, up), Rgb{});
    EXPECT_EQ(answer(value_of, up, in_surface), Rgb{});
}

/// The density integrates to 1 with the draws that have no direction, draws follow it, and their weights are unbiased.
void expect_draws(const Answer& answer, const Model& model, Vec3f wv, std::mt19937_64& random) {
    const PolarBins bins = sphere_bins();
    const auto mass = bins.integrals([&](Vec3d w) { return double(answer(density, to_float(w), wv).r); }, 48);
    std::vector<double> observed(bins.size());
    constexpr int count = 50000;
    int lost = 0;
    double sum = 0, squares = 0;
    for (int i = 0; i < count; ++i) {
        const auto u = [&] { return std::min(float(uniform(random)), 0x1.fffffep-1f); };
        const Vec3f numbers{u(), u(), u()};
        const Rgb drawn_light = answer(drawn, numbers, wv);
        const Vec3f wl{drawn_light.r, drawn_light.g, drawn_light.b};
        const float draw_density = answer(density, wl, wv).r;
        if (!(draw_density > 0)) {
            ++lost;
            continue;
        }
        observed[bins.index(to_double(wl))] += 1;
        const double weight = double(answer(value_of, wl, wv).g * std::abs(wl.z) / draw_density);
        sum += weight;
        squares += weight * weight;
    }
    EXPECT_WITHIN(sum_of(mass) + double(lost) / count, 1, 7e-3);
    constexpr int k_tests = 3 * 4;  // BSDFs and views
    EXPECT_GT(chi2_p_value_of_shape(observed, mass), sidak(0.01, k_tests));
    const double reflected =
        sum_of(bins.integrals([&](Vec3d w) { return double(value(model, to_float(w), wv).g) * std::abs(w.z); }, 48));
    const double mean = sum / count, deviation = std::sqrt((squares / count - mean * mean) / count);
    EXPECT_WITHIN(mean, reflected, 4 * deviation + 3e-3 * reflected);
}

/// On both sides of a BSDF, values and beams are the library's, and samples follow their density.
TEST_F(BsdfCode, AnswersAsTheLibrary) {
    const std::vector<Model> all = bsdfs();
    void* const library = compile_and_load(
        SRBF_COMPILER " -x c -std=c99 -pedantic -Wall -Wextra -Wconversion -Wno-unused-function -Werror", "both",
        code_of_bsdfs(all, CodeLanguage::c) + k_answer_text);
    ASSERT_TRUE(library);
    const auto called = function<void(int, int, const float*, const float*, float*)>(library, "answer");
    std::mt19937_64 random(7);
    for (std::size_t m = 0; m < all.size(); ++m) {
        SCOPED_TRACE(m);
        const Answer answer = [&](Question what, Vec3f l, Vec3f v) {
            const std::array<float, 3> a{l.x, l.y, l.z}, b{v.x, v.y, v.z};
            std::array<float, 3> to{};
            called(int(m), what, a.data(), b.data(), to.data());
            return Rgb{to[0], to[1], to[2]};
        };
        expect_nothing_of_nan(answer);
        expect_values(answer, all[m], random);
        for (const double theta : {10.0, 55.0, 125.0, 165.0}) {
            SCOPED_TRACE(theta);
            expect_draws(answer, all[m], to_float(spherical(theta * k_degree, 0.7)), random);
        }
    }
}

TEST_F(BsdfCode, CompilesInShaders) {
    const std::vector<Model> all = bsdfs();
    EXPECT_TRUE(compiles_as_glsl("both.frag",
                                 "#version 300 es\nprecision highp float;\n" + code_of_bsdfs(all, CodeLanguage::glsl) +
                                     "in vec3 a, b; out vec4 c;\nvoid main() { c = vec4(b0_bsdf(a, b) + b0_beam(b), "
                                     "b0_pdf(b0_sample(b, a.x, a.y, a.z), b)); }\n"));
    EXPECT_TRUE(
        compiles_as_hlsl("frag", "both",
                         code_of_bsdfs(all, CodeLanguage::hlsl) +
                             "float4 main(float3 a : A, float3 b : B) : SV_Target { return float4(b0_bsdf(a, b) + "
                             "b0_beam(b), b0_pdf(b0_sample(b, a.x, a.y, a.z), b)); }\n"));
}

}  // namespace
}  // namespace srbf::bsdf_code_test
