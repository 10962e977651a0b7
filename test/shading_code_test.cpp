// Compilers of each language accept the exported code, and it computes the same values as the library.
#include "srbf/shading_code.h"

#include <cstdlib>

#include "brdf/directions.h"
#include "code/offered_code.h"
#include "compiled_code.h"
#include "models.h"
#include "models/openpbr/openpbr_kind.h"
#include "script.h"
#include "srbf/prepared.h"
#include "srbf/sampling.h"
#include "statistics.h"
#include "su_models.h"
#ifdef SRBF_RASTER
#include "compute_program.h"
#include "extras/render/offscreen.h"
#include "models/su/su_functions.h"
#endif

namespace srbf::shading_code_test {
namespace {

using Float4 = std::array<float, 4>;

/// One model of each form and kind, rounded as in a model file. Axial and general lobes alternate; the default form
/// has both.
const std::vector<Model>& models() {
    static const std::vector<Model> list = [] {
        std::mt19937_64 random(1);
        std::vector<Model> models;
        const auto add = [&](PmForm form, bool axial) {
            const int variates = form == PmForm::extended ? 4 : 3;
            RandomModelOptions options{axial, form != PmForm::gaussian, 3, variates, 60, form};
            models.push_back({rounded(random_model(random, options)), {}});
        };
        bool axial = true;
        for (const PmForm form : k_forms) {
            add(form, axial);
            axial = !axial;
        }
        add(PmForm::extended, false);
        models.push_back({rounded(GgxModel{{0.1f, 0.2f, 0.3f}, {{0.3f, {0.04f, 0.05f, 0.06f}, 1}}}), {}});
        models.push_back({rounded(GgxModel{{}, {{0.1f, {0.9f, 0.5f, 0.2f}, 1}, {0.5f, {0, 0.03f, 0.2f}, 0.4f}}}), {}});
        OpenPbrModel film{.base_metalness = 0.7f, .thin_film_weight = 0.8f};
        film.specular_roughness_anisotropy = 0.6f;
        film.specular_rotation = 0.3f;
        models.push_back({rounded(film), {}});
        models.push_back(
            {rounded(OpenPbrModel{.base_color = {0.5f, 0.3f, 0.1f}, .coat_weight = 0.5f, .fuzz_weight = 0.3f}), {}});
        models.back().provenance["note"] = "a */ comment \\\nthat */ would end # early \\";
        return models;
    }();
    return list;
}
std::string name_of(std::size_t i) { return fmt::format("m{}", i); }

/// Functions that the host has to supply for exported features of extras: an environment's radiance, filtered or in
/// one direction.
std::string host_radiance(CodeLanguage language) {
    switch (language) {
        case CodeLanguage::glsl:
            return "vec3 lit_radiance_over(vec3 w, float s) { return s * w; }\n"
                   "vec3 lit_radiance(vec3 w, float r) { return r * w; }\n";
        case CodeLanguage::hlsl:
            return "float3 lit_radiance_over(float3 w, float s) { return s * w; }\n"
                   "float3 lit_radiance(float3 w, float r) { return r * w; }\n";
        case CodeLanguage::wgsl:
            return "fn lit_radiance_over(w: vec3f, s: f32) -> vec3f { return s * w; }\n"
                   "fn lit_radiance(w: vec3f, r: f32) -> vec3f { return r * w; }\n";
        case CodeLanguage::msl:
        case CodeLanguage::c:
            break;
    }
    return "";
}

/// The exported code of one model.
std::string code_of(const Model& model, const std::string& name, const CodeOptions& options) {
    const NamedModel named{name, &model};
    return *checked(shading_code(std::span(&named, 1), name, options));
}

/// The functions of extras. They are compiled but not run unless a test runs them in C.
std::string code_of_extras(CodeLanguage language) {
    if (code_features().empty()) return "";
    std::vector<std::string> features;
    for (const CodeFeature& feature : code_features()) features.emplace_back(feature.name);
    return host_radiance(language) + code_of(models().back(), "lit", {.language = language, .with = features});
}

/// The exported code of all models.
std::string code(CodeLanguage language, bool sampling = true) {
    std::vector<NamedModel> named;
    for (std::size_t i = 0; i < models().size(); ++i) named.push_back({name_of(i), &models()[i]});
    return *checked(shading_code(named, "all", {.language = language, .sampling = sampling, .albedo = sampling}));
}

const std::string& code_in_c() {
    static const std::string text = code(CodeLanguage::c);
    return text;
}

/// The input of one evaluation: two directions and three uniform numbers.
struct Question {
    Float4 wl, wv, uniform;
};
/// The output of one evaluation: f_r and the density of the light; a sample of the light and its density;
/// directional albedo.
struct Answer {
    Float4 value, sample, albedo;
};

/// A third of the pairs has a grazing direction and a third is close to the mirror direction. A few are below the
/// horizon or contain a NaN.
const std::vector<Question>& questions() {
    static const std::vector<Question> list = [] {
        std::mt19937_64 random(2);
        std::vector<Question> questions(768);  // a multiple of 64
        for (std::size_t i = 0; i < questions.size(); ++i) {
            Vec3d wl = random_direction(random, 1e-4), wv = random_direction(random, 1e-4);
            if (i % 3 == 1) wl = spherical((0.5 - 0.01 * uniform(random)) * k_pi, 2 * k_pi * uniform(random));
            if (i % 3 == 2) wl = normalize(mirror(wv) + 0.05 * random_direction(random));
            if (i % 50 == 0) wl.z = -wl.z;
            const auto padded = [](Vec3d w) { return Float4{float(w.x), float(w.y), float(w.z), 0}; };
            const auto u = [&] { return float(int(uniform(random) * 4096)) / 4096 + 1.f / 8192; };
            questions[i] = {padded(wl), padded(wv), {u(), u(), u(), 0}};
            if (i % 100 == 7) (i % 200 == 7 ? questions[i].wl : questions[i].wv)[i / 200 % 3] = NAN;
        }
        return questions;
    }();
    return list;
}

using Answers = std::vector<Answer>;  ///< questions × models

/// The results of the library.
Answers expected() {
    Answers answers(questions().size() * models().size());
    for (std::size_t m = 0; m < models().size(); ++m) {
        const Proposal proposal = propose(models()[m], {.azimuths = azimuths_for(is_isotropic(models()[m]))});
        const PreparedBrdf prepared = prepare(models()[m], CosineProposal{});
        for (std::size_t i = 0; i < questions().size(); ++i) {
            const auto& [l, v, u] = questions()[i];
            const Vec3f wl(l[0], l[1], l[2]), wv(v[0], v[1], v[2]);
            const Rgb f = value(models()[m], wl, wv), directional_albedo = albedo(prepared, wv.z);
            const DirectionSample sample = sample_with_pdf(proposal, wv, {u[0], u[1]}, u[2]);
            answers[i * models().size() + m] = {
                {f.r, f.g, f.b, pdf(proposal, wl, wv)},
                {sample.wl.x, sample.wl.y, sample.wl.z, sample.wl.z > 0 ? sample.pdf : 0},
                {directional_albedo.r, directional_albedo.g, directional_albedo.b, 0}};
        }
    }
    return answers;
}

/// The tolerance is ten times the usual one for thin films, because a phase of tens of radians loses a digit in
/// shaders that fuse other products.
double tolerance(const Model& model) {
    const auto* const openpbr = std::get_if<OpenPbrModel>(&model.model);
    return openpbr && openpbr->thin_film_weight > 0 ? 10 : 1;
}

/// Compares answers with the library's. Tolerances: values within 1e-4 or 1e-6 of the peak, also for albedos;
/// densities within 1e-3; samples within 0.002, except the few whose selector falls between two lobes.
void expect_equal(const Answers& answers, const std::string& language) {
    static const Answers library = expected();
    ASSERT_EQ(answers.size(), library.size()) << language;
    const std::size_t count = models().size();
    std::vector<float> peak(count), largest_albedo(count);
    for (std::size_t i = 0; i < library.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            peak[i % count] = std::max(peak[i % count], library[i].value[c]);
            largest_albedo[i % count] = std::max(largest_albedo[i % count], library[i].albedo[c]);
        }
    std::size_t wrong = 0, wrong_samples = 0;
    double largest_difference = 0;
    for (std::size_t i = 0; i < library.size(); ++i) {
        const auto& [x, y, z, unused] = questions()[i / count].wv;
        const bool has_view = std::isfinite(x + y + z);  // without a view, samples are meaningless
        const Answer &a = answers[i], &b = library[i];
        for (std::size_t c = 0; c < 3; ++c) {
            const double bound =
                tolerance(models()[i % count]) * std::max(1e-4 * double(b.value[c]), 1e-6 * double(peak[i % count]));
            largest_difference =
                std::max(largest_difference, std::abs(double(a.value[c]) - double(b.value[c])) / bound);
            wrong += !near(double(a.value[c]), double(b.value[c]), bound);
            wrong += !near(double(a.albedo[c]), double(b.albedo[c]),
                           1e-4 * double(b.albedo[c]) + 1e-5 * double(largest_albedo[i % count]));
        }
        wrong += !near(double(a.value[3]), double(b.value[3]), 1e-3 * double(b.value[3]) + 1e-6);
        double distance = 0;
        for (std::size_t c = 0; c < 3; ++c)
            distance = std::max(distance, std::abs(double(a.sample[c]) - double(b.sample[c])));
        const bool same =
            distance < 0.002 && near(double(a.sample[3]), double(b.sample[3]), 0.02 * double(b.sample[3]));
        wrong_samples += !same && has_view;
    }
    EXPECT_EQ(wrong, 0u) << language << ", of " << library.size() << "; values differ by up to " << largest_difference
                         << " tolerances";
    EXPECT_LE(double(wrong_samples), 0.001 * double(library.size())) << language;
}

/// Statements that evaluate a model: `store(k, vector, number)` stores answer k of three.
std::string answer_text(std::size_t m, const std::string& zero, const auto& store) {
    const std::string name = name_of(m);
    return store(0, name + "_value_pdf(wl, wv).value", name + "_value_pdf(wl, wv).pdf") +
           store(1, fmt::format("{0}_sample(wv, u.x, u.y, u.z)", name),
                 fmt::format("{0}_pdf({0}_sample(wv, u.x, u.y, u.z), wv)", name)) +
           store(2, name + "_albedo(wv.z)", zero);
}
/// Returns the text of the answers for all models, which are numbered consecutively.
std::string answers_text(const std::string& zero, const auto& store) {
    std::string text;
    for (std::size_t m = 0; m < models().size(); ++m)
        text += answer_text(m, zero, [&](std::size_t k, const std::string& three, const std::string& number) {
            return store(3 * m + k, three, number);
        });
    return text;
}

class ShadingCode : public CodeTest {
  protected:
    /// Compiles the code as a C or C++ program, runs it and compares the answers. Optimised once, since warnings depend
    /// on it.
    void expect_compiled(const std::string& compiler, const std::string& header, const std::string& vector,
                         const std::string& name, const std::string& level = "-O0") {
        const auto store = [](std::size_t k, const std::string& three, const std::string& number) {
            return fmt::format(
                "        w = {}; r[4 * {} + 3] = {};\n        r[4 * {}] = w.x; r[4 * {} + 1] = w.y; r[4 * {} + 2] = "
                "w.z;\n",
                three, k, number, k, k, k);
        };
        void* const library = compile_and_load(
            compiler + " -Wall -Wextra -Wconversion -Werror", name,
            header + fmt::format("#ifdef __cplusplus\nextern \"C\"\n#endif\n"
                                 "void answer(const float* q, float* r, int n);\n"
                                 "void answer(const float* q, float* r, int n) {{\n"
                                 "    int i;\n    for (i = 0; i < n; ++i) {{\n"
                                 "        {0} wl, wv, u, w;\n"
                                 "        wl.x = q[0], wl.y = q[1], wl.z = q[2], wv.x = q[4], wv.y = q[5];\n"
                                 "        wv.z = q[6], u.x = q[8], u.y = q[9], u.z = q[10];\n{1}"
                                 "        q += 12, r += {2};\n    }}\n}}\n",
                                 vector, answers_text("0.0f", store), 12 * models().size()),
            level);
        ASSERT_TRUE(library);
        const auto answer = function<void(const float*, float*, int)>(library, "answer");
        Answers answers(questions().size() * models().size());
        answer(questions()[0].wl.data(), answers[0].value.data(), int(questions().size()));
        expect_equal(answers, name);
    }
};

TEST_F(ShadingCode, RunsAsCAndCpp) {
    const std::string& header = code_in_c();
    expect_compiled(SRBF_COMPILER " -x c -std=c99 -pedantic -Wstrict-prototypes", header, "srbf_vec3", "c", "-O1");
    expect_compiled(SRBF_COMPILER " -x c++ -std=c++11 -pedantic", header, "srbf_vec3", "cpp");
    const std::string plain = write_source("plain.h", code(CodeLanguage::c, false)),
                      checks = " -x c -std=c99 -pedantic -Wall -Wextra -Werror -Wno-unused-function -fsyntax-only '{}'";
    EXPECT_TRUE(runs(SRBF_COMPILER + fmt::format(fmt::runtime(checks), plain)));
    if (!std::strlen(SRBF_CLANG)) GTEST_SKIP() << "no clang (Debian: clang)";
    EXPECT_TRUE(runs(SRBF_CLANG + fmt::format(fmt::runtime(checks), plain)));
    expect_compiled(SRBF_CLANG " -x c -std=c99 -pedantic", header, "srbf_vec3", "c_of_clang", "-Ofast");
}

/// Renderers are often compiled with -ffast-math, which reorders sums and takes all numbers for finite.
TEST_F(ShadingCode, FastMathKeepsItsValues) {
    expect_compiled(SRBF_COMPILER " -x c -std=c99", code_in_c(), "srbf_vec3", "c_fast", "-O2 -ffast-math");
    void* const headers = compile_and_load(
        SRBF_COMPILER " -x c++ -std=c++20 -I'" SRBF_SOURCE_DIR "/include'", "headers",
        "#include \"srbf/handles.h\"\n"
        "extern \"C\" int above(float x, float y, float z) {\n"
        "    return srbf::above_horizon({x, y, z}, {0, 0, 1}) + 2 * srbf::is_finite(srbf::Rgb{x, y, z});\n}\n",
        "-Ofast");
    const auto above = function<int(float, float, float)>(headers, "above");
    EXPECT_EQ(above(0, 0.6f, 0.8f), 3);
    for (const float x : {float(NAN), float(INFINITY), -float(INFINITY)})
        EXPECT_EQ(above(x, 0, 1) + above(0, x, 1) + above(0, 0, x), 0);
}

TEST_F(ShadingCode, CompilesAsCuda) {
    if (!std::strlen(SRBF_NVCC)) GTEST_SKIP() << "no nvcc";
    const std::string source = write_source(
        "code.cu", code(CodeLanguage::c, false) +
                       "__global__ void answer(srbf_vec3 wl, srbf_vec3 wv, float* f) { *f = m0_brdf(wl, wv).x + "
                       "m3_brdf(wl, wv).y; }\nsrbf_vec3 on_host(srbf_vec3 w) { return m0_brdf(w, w); }\n");
    EXPECT_TRUE(runs(fmt::format("'{}' --Werror all-warnings -diag-suppress 177 -c '{}' -o '{}'", SRBF_NVCC, source,
                                 path("code.o"))));
}

/// The exported code of a map.
std::string map_code_in(CodeLanguage language) {
    std::mt19937_64 random(4);
    const TexelMap map = random_map(random, {.lobes = 3, .form = PmForm::extended}, 2, 2);
    return *checked(map_code(map, "map", {.language = language, .albedo = true}));
}

/// Metal's compiler exists only on Apple's systems. Its language is C++14; a small replacement stands for its
/// vector library.
TEST_F(ShadingCode, RunsAsMetal) {
    write_source("metal_stdlib", R"(#pragma once
#include <cmath>
#define constant static const
namespace metal {
struct float3 {
    float x, y, z;
    float3() {}
    float3(float x, float y, float z) : x(x), y(y), z(z) {}
};
inline float3 operator+(float3 a, float3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline float3 operator-(float3 a, float3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline float3 operator*(float s, float3 a) { return {s * a.x, s * a.y, s * a.z}; }
inline float dot(float3 a, float3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline float rsqrt(float x) { return 1 / std::sqrt(x); }
inline float min(float a, float b) { return a < b ? a : b; }
inline float max(float a, float b) { return a > b ? a : b; }
using std::exp; using std::exp2; using std::log; using std::sqrt; using std::abs; using std::sin; using std::cos;
using std::acos;
}
)");
    expect_compiled(fmt::format("{} -x c++ -std=c++14 -I'{}'", SRBF_COMPILER, folder_.path.string()),
                    code(CodeLanguage::msl), "metal::float3", "msl");
    EXPECT_TRUE(runs(
        fmt::format("{} -x c++ -std=c++14 -I'{}' -fsyntax-only '{}'", SRBF_COMPILER, folder_.path.string(),
                    write_source("plain.metal", code(CodeLanguage::msl, false) + code_of_extras(CodeLanguage::msl) +
                                                    map_code_in(CodeLanguage::msl)))));
}

#ifdef SRBF_RASTER
/// The exported code of one model, with sampling and albedo. All models together have too many constants for some
/// drivers.
std::string code_of_model(std::size_t m, CodeLanguage language) {
    return code_of(models()[m], name_of(m), {.language = language, .sampling = true, .albedo = true});
}

/// Runs one OpenGL 4.5 compute shader for each model. The questions are an array of vec4 at binding 0, the answers
/// at binding 1.
Answers run_shaders(const std::vector<std::string>& shaders) {
    Answers answers(questions().size() * models().size()), model_answers(questions().size());
    std::array<GLuint, 2> buffers;
    glGenBuffers(2, buffers.data());
    const auto fill = [&](GLuint binding, std::size_t bytes, const void* data) {
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, buffers[binding]);
        glBufferData(GL_SHADER_STORAGE_BUFFER, GLsizeiptr(bytes), data, GL_STATIC_DRAW);
    };
    fill(0, questions().size() * sizeof(Question), questions().data());
    fill(1, model_answers.size() * sizeof(Answer), nullptr);
    for (std::size_t m = 0; m < shaders.size(); ++m) {
        const GLuint program = compute_program(shaders[m]);
        if (program == 0) continue;
        glUseProgram(program);
        glDispatchCompute(GLuint(questions().size() / 64), 1, 1);
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        glGetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, GLsizeiptr(model_answers.size() * sizeof(Answer)),
                           model_answers.data());
        for (std::size_t i = 0; i < model_answers.size(); ++i) answers[i * models().size() + m] = model_answers[i];
        glDeleteProgram(program);
    }
    EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
    glDeleteBuffers(2, buffers.data());
    return answers;
}

/// The body of such a shader's main function.
std::string shader_body(std::size_t m, const std::string& vec3, const std::string& vec4) {
    const auto store = [&](std::size_t k, const std::string& three, const std::string& number) {
        return fmt::format("    answers[3 * i + {}] = {}({}, {});\n", k, vec4, three, number);
    };
    return fmt::format(
               "    {0} wl = questions[3 * i].xyz, wv = questions[3 * i + 1].xyz, u = questions[3 * i + 2].xyz;\n",
               vec3) +
           answer_text(m, "0.0", store);
}

TEST_F(ShadingCode, RunsAsGlsl) {
    const std::string plain = code(CodeLanguage::glsl, false), extras = code_of_extras(CodeLanguage::glsl);
    std::vector<std::string> texts;
    for (std::size_t m = 0; m < models().size(); ++m) texts.push_back(code_of_model(m, CodeLanguage::glsl));
    for (const std::string version : {"#version 300 es\nprecision highp float;\n", "#version 330\n"}) {
        const auto compiles = [&](const std::string& text, const std::string& name) {
            return compiles_as_glsl("code.frag", version + text + "in vec3 a, b; out vec4 c;\nvoid main() { c = vec4(" +
                                                     name + "_brdf(a, b), 1.0); }\n");
        };
        EXPECT_TRUE(compiles(plain + extras, "m0"));
        for (std::size_t m = 0; m < models().size(); ++m) EXPECT_TRUE(compiles(texts[m], name_of(m)));
    }
    const auto context = OffscreenContext::make(Dialect::gl_450);
    if (!context) GTEST_SKIP() << message(context.error());
    std::vector<std::string> shaders;
    for (std::size_t m = 0; m < models().size(); ++m)
        shaders.push_back(
            "#version 450\nlayout(local_size_x = 64) in;\n"
            "layout(std430, binding = 0) readonly buffer Questions { vec4 questions[]; };\n"
            "layout(std430, binding = 1) writeonly buffer Answers { vec4 answers[]; };\n" +
            texts[m] + "void main() {\n    uint i = gl_GlobalInvocationID.x;\n" + shader_body(m, "vec3", "vec4") +
            "}\n");
    expect_equal(run_shaders(shaders), "glsl");
}

/// glslang compiles the HLSL to SPIR-V, which is translated to GLSL for OpenGL.
TEST_F(ShadingCode, RunsAsHlsl) {
    EXPECT_TRUE(compiles_as_hlsl("frag", "plain",
                                 code(CodeLanguage::hlsl, false) + code_of_extras(CodeLanguage::hlsl) +
                                     "float4 main() : SV_Target { return 1.0; }\n"));
    if (!std::strlen(SRBF_SPIRV_CROSS)) GTEST_SKIP() << "compiled, not run: no spirv-cross (Debian: spirv-cross)";
    const auto context = OffscreenContext::make(Dialect::gl_450);
    if (!context) GTEST_SKIP() << message(context.error());
    std::vector<std::string> shaders;
    for (std::size_t m = 0; m < models().size(); ++m) {
        ASSERT_TRUE(compiles_as_hlsl(
            "comp", "code",
            "StructuredBuffer<float4> questions : register(t0);\n"
            "RWStructuredBuffer<float4> answers : register(u1);\n" +
                code_of_model(m, CodeLanguage::hlsl) +
                "[numthreads(64, 1, 1)] void main(uint3 at : SV_DispatchThreadID) {\n    uint i = at.x;\n" +
                shader_body(m, "float3", "float4") + "}\n"));
        ASSERT_TRUE(runs(fmt::format("'{}' '{}' --version 450 --no-es --output '{}'", SRBF_SPIRV_CROSS,
                                     path("code.spv"), path("code.glsl"))));
        shaders.push_back(read_text(path("code.glsl")));
    }
    expect_equal(run_shaders(shaders), "hlsl");
}
#endif

/// Runs in a browser's WebGPU.
TEST_F(ShadingCode, RunsAsWgsl) {
    const auto store = [&](std::size_t k, const std::string& three, const std::string& number) {
        return fmt::format("    answers[{}u * i + {}u] = vec4f({}, {});\n", 3 * models().size(), k, three, number);
    };
    write_source(
        "code.wgsl",
        "@group(0) @binding(0) var<storage, read> questions: array<vec4f>;\n"
        "@group(0) @binding(1) var<storage, read_write> answers: array<vec4f>;\n" +
            code(CodeLanguage::wgsl) +
            "@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) at: vec3u) {\n    let i = at.x;\n"
            "    let wl = questions[3 * i].xyz;\n    let wv = questions[3 * i + 1].xyz;\n"
            "    let u = questions[3 * i + 2].xyz;\n" +
            answers_text("0.0", store) + "}\n");
    const Model bsdf{lobe_bsdf_with_beams(), {}};
    write_source(
        "plain.wgsl",
        code(CodeLanguage::wgsl, false) + code_of_extras(CodeLanguage::wgsl) +
            code_of(bsdf, "b", {.language = CodeLanguage::wgsl, .sampling = true}) + map_code_in(CodeLanguage::wgsl) +
            "@group(0) @binding(0) var layers: texture_2d_array<f32>;\n"
            "@group(0) @binding(1) var linear: sampler;\n"
            "fn map_layer(j: i32, u: f32, v: f32) -> vec3f {\n"
            "    return textureSampleLevel(layers, linear, vec2f(u, v), j, 0.0).rgb;\n}\n"
            "@fragment fn main(@location(0) wl: vec3f, @location(1) wv: vec3f, @location(2) uv: vec2f)\n"
            "    -> @location(0) vec4f { return vec4f(map_brdf(wl, wv, map_coefficients(uv.x, uv.y)), 1.0); }\n");
    std::string bytes(questions().size() * sizeof(Question), '\0');
    std::memcpy(bytes.data(), questions().data(), bytes.size());
    write_source("questions", bytes);
    const ScriptRun run = run_script(
        "test/wgsl.py", {folder_.path.string(), std::to_string(models().size() * sizeof(Answer) / sizeof(Question))});
    SKIP_IF_UNAVAILABLE(run);
    ASSERT_EQ(run.status, 0) << run.text;
    bytes = read_text(path("answers"));
    Answers answers(bytes.size() / sizeof(Answer));
    std::memcpy(answers.data(), bytes.data(), answers.size() * sizeof(Answer));
    expect_equal(answers, "wgsl");
}

/// A blend is the weighted sum of its models, and is drawn from one of them.
TEST_F(ShadingCode, BlendsAreSums) {
    const std::vector<NamedModel> named{{"a", &models()[0]}, {"b", &models()[1]}, {"c", &models()[6]}};
    const auto text = [&](CodeLanguage language) {
        return *shading_code(named, "mix", {.language = language, .sampling = true, .albedo = true, .blend = true});
    };
    const auto three = [](const char* call) {
        return fmt::format(
            "    w = mix_{0}{1}, m[0] = a_{0}), m[1] = b_{0}), m[2] = c_{0});\n"
            "    f[0] = w.x;\n    for (i = 0; i < 3; ++i) f[i + 1] = m[i].x;\n    f += 4;\n",
            call, ", s)");
    };
    void* const library = compile_and_load(
        SRBF_COMPILER " -x c -std=c99 -pedantic -Wall -Wextra -Wconversion -Wno-unused-function -Werror", "blend",
        text(CodeLanguage::c) +
            c_function("void answer(const float* q, const float* weights, float* f)",
                       "    srbf_vec3 l = {q[0], q[1], q[2]}, v = {q[4], q[5], q[6]}, s = {weights[0], weights[1], "
                       "weights[2]}, "
                       "w, m[3];\n    int i;\n" +
                           three("brdf(l, v") + three("albedo(v.z") +
                           "    f[0] = mix_pdf(l, v, s), f[1] = a_pdf(l, v), f[2] = b_pdf(l, v), f[3] = c_pdf(l, v);\n"
                           "    w = mix_sample(v, q[8], q[9], q[10], s), m[0] = b_sample(v, q[8], q[9], (q[10] - s.x) "
                           "/ s.y);\n"
                           "    f[4] = w.z, f[5] = m[0].z;\n"));
    ASSERT_TRUE(library);
    const auto answer = function<void(const float*, const float*, float*)>(library, "answer");
    constexpr std::array<float, 3> weights{0.25f, 0.5f, 0.25f};
    for (const Question& q : questions()) {
        if (!(q.wv[2] > 0)) continue;  // or a NaN
        std::array<float, 14> f{};
        answer(q.wl.data(), weights.data(), f.data());
        for (std::size_t i = 0; i < 12; i += 4) {
            const float sum = 0.25f * f[i + 1] + 0.5f * f[i + 2] + 0.25f * f[i + 3];
            ASSERT_WITHIN(f[i], sum, 1e-5f * std::abs(sum)) << i;
        }
        if (q.uniform[2] >= 0.25f && q.uniform[2] < 0.75f && f[13] == f[13]) {
            ASSERT_WITHIN(f[12], f[13], 1e-3f);
        }
    }
    EXPECT_TRUE(
        compiles_as_glsl("blend.frag", "#version 300 es\nprecision highp float;\n" + text(CodeLanguage::glsl) +
                                           "in vec3 a, b, c; out vec4 d;\nvoid main() { d = vec4(mix_brdf(a, b, c) + "
                                           "mix_albedo(b.z, c), mix_pdf(mix_sample(b, a.x, a.y, a.z, c), b, c)); }\n"));
    EXPECT_TRUE(compiles_as_hlsl("frag", "blend",
                                 text(CodeLanguage::hlsl) +
                                     "float4 main(float3 a : A, float3 b : B, float3 c : C) : SV_Target { return "
                                     "float4(mix_brdf(a, b, c), mix_pdf(mix_sample(b, a.x, a.y, a.z, c), b, c)); }\n"));
    EXPECT_FALSE(shading_code(std::span(named).first(1), "mix", {.blend = true}));
    EXPECT_FALSE(shading_code(named, "a", {.blend = true}));  // two functions a_brdf
}

TEST(ShadingCodeText, ContainsOnlyWhatTheModelNeeds) {
    const std::string plain = code_of(models()[0], "m", {}), sampled = code_of(models()[0], "m", {.sampling = true});
    EXPECT_LACKS(plain, "PmFeatures");  // this form has none
    EXPECT_LACKS(plain, "m_sample(");
    EXPECT_CONTAINS(sampled, "m_sample(");
    EXPECT_LACKS(sampled, "m_albedo(");
    for (const CodeLanguage language :
         {CodeLanguage::glsl, CodeLanguage::hlsl, CodeLanguage::wgsl, CodeLanguage::msl, CodeLanguage::c})
        for (const char c : code(language, false)) ASSERT_TRUE(c == '\n' || (c >= ' ' && c < 0x7f)) << int(c);
}

TEST(ShadingCodeText, StoredNumbersAreConstants) {
    const auto& pm = std::get<PmModel>(models()[1].model);
    const std::string text = code_of(models()[1], "m", {});
    const std::string rows = text.substr(text.find("m_lobes["));
    for (const float number : pm.exponent) EXPECT_CONTAINS(rows, fmt::format(" {}", number)) << number;
    for (const float number : pm.bandwidth) EXPECT_CONTAINS(rows, fmt::format("{}", number)) << number;
}

TEST(ShadingCodeText, NamesAreIdentifiers) {
    EXPECT_EQ(identifier("cc_ibiza sunset-rgb"), "cc_ibiza_sunset_rgb");
    EXPECT_EQ(identifier("__a__b__"), "a_b");
    EXPECT_EQ(identifier("2nd"), "brdf_2nd");
    EXPECT_EQ(identifier(""), "brdf");
    EXPECT_EQ(identifier("gl_x"), "brdf_gl_x");
    EXPECT_EQ(identifier("webgl_x"), "brdf_webgl_x");
    EXPECT_EQ(identifier("mesh-Standard"), "brdf_mesh_Standard");
    EXPECT_EQ(identifier("measured"), "brdf_measured");
    EXPECT_EQ(identifier("\xc3\xa9t\xc3\xa9"), "t");
}

/// The host supplies the numbers of a view-by-view model, here from an array in C.
TEST_F(ShadingCode, RunsViewByView) {
    const Model model{isotropic_su(256), {}};
    const auto& su = std::get<SuModel>(model.model);
    const std::vector<float> data = shading_data(su);
    void* const library = compile_and_load(
        SRBF_COMPILER " -x c -std=c99 -pedantic -Wall -Wextra -Werror", "su",
        "static const float* data;\n#define su_number(i) data[i]\n" +
            code_of(model, "su", {.language = CodeLanguage::c}) +
            c_function("void answer(const float* numbers, const float* q, float* f)",
                       "    srbf_vec3 wl = {q[0], q[1], q[2]}, wv = {q[4], q[5], q[6]}, w;\n"
                       "    data = numbers, w = su_brdf(wl, wv);\n    f[0] = w.x, f[1] = w.y, f[2] = w.z;\n"));
    ASSERT_TRUE(library);
    const auto answer = function<void(const float*, const float*, float*)>(library, "answer");
    float peak = 0;
    for (const Rgb& beta : su.coefficient) peak = std::max({peak, beta.r, beta.g, beta.b});
    for (const Question& q : questions()) {
        std::array<float, 3> f{};
        answer(data.data(), q.wl.data(), f.data());
        const Rgb expected = value(su, {q.wl[0], q.wl[1], q.wl[2]}, {q.wv[0], q.wv[1], q.wv[2]});
        for (int c = 0; c < 3; ++c)
            ASSERT_WITHIN(f[std::size_t(c)], expected[c], std::max(1e-4f * expected[c], 1e-6f * peak));
    }

    EXPECT_TRUE(compiles_as_glsl(
        "su.frag",
        "#version 300 es\nprecision highp float;\nuniform highp sampler2D data;\n"
        "float su_number(int i) { return texelFetch(data, ivec2(i % 1024, i / 1024), 0).x; }\n" +
            code_of(model, "su", {.albedo = true}) +
            "in vec3 a, b; out vec4 c;\nvoid main() { c = vec4(su_brdf(a, b) * su_albedo(b.z), 1.0); }\n"));
    EXPECT_TRUE(compiles_as_hlsl(
        "frag", "su",
        "StructuredBuffer<float> data : register(t0);\nfloat su_number(int i) { return data[i]; }\n" +
            code_of(model, "su", {.language = CodeLanguage::hlsl}) +
            "float4 main(float3 a : A, float3 b : B) : SV_Target { return float4(su_brdf(a, b), 1.0); }\n"));
}

TEST(ShadingCodeText, RejectsUnsupportedModels) {
    Model model{isotropic_su(256), {}};
    const std::vector<NamedModel> named{{"su", &model}};
    const auto expect_error = [&](const Result<std::string>& text) {
        ASSERT_FALSE(text);
        EXPECT_EQ(text.error().code, ErrorCode::argument);
    };
    expect_error(shading_code(named, "su", {.sampling = true}));
    expect_error(shading_code(named, "su", {.language = CodeLanguage::msl}));
    const Model bsdf{lobe_bsdf_with_beams(), {}};
    for (const CodeModule& module : code_modules()) {
        expect_error(module.text(named, "su", 0));
        if (module.by_part) expect_error(module.text(std::vector<NamedModel>{{"bsdf", &bsdf}}, "bsdf", 0));
    }
    std::get<SuModel>(model.model).interpolation = SuInterpolation::plain;
    expect_error(shading_code(named, "su", {}));
}

}  // namespace
}  // namespace srbf::shading_code_test
