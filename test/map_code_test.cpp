// Maps of shared lobes: their code and their textures together are the models of their texels, and what filters make of
// texels is the mean of the BRDFs.
#include "app/map_layers.h"
#include "brdf/colour.h"
#include "compiled_code.h"
#include "models.h"
#include "properties.h"
#include "srbf/elementary.h"
#include "srbf/prepared.h"
#include "srbf/sampling.h"
#include "srbf/shading_code.h"
#ifdef SRBF_RASTER
#include "compute_program.h"
#include "extras/render/offscreen.h"
#endif

namespace srbf::map_code_test {
namespace {

constexpr std::size_t k_width = 8, k_height = 4;
constexpr double k_least = 1e-30;  ///< tolerance of values that are 0

/// A random map, of axial lobes or of general ones.
TexelMap map_of(bool axial, std::size_t width = k_width, std::size_t height = k_height) {
    std::mt19937_64 random(axial ? 1 : 2);
    return random_map(random, {axial, true, 5, 3, 60, PmForm::extended}, width, height);
}

std::string code(const TexelMap& map, CodeLanguage language, bool albedo = true) {
    const auto text = map_code(map, "map", {.language = language, .albedo = albedo});
    return text ? *text : (ADD_FAILURE() << message(text.error()), "");
}

/// A file of KTX 2.0 as its specification describes it: the numbers of its header, and levels of its texels.
template <typename Number> struct TextureOf {
    std::vector<std::uint32_t> header;
    std::vector<std::vector<Number>> levels;
    std::map<std::string, std::string> metadata = {};
};
using Texture = TextureOf<std::uint16_t>;
template <typename Number = std::uint16_t> TextureOf<Number> texture_of(std::span<const std::byte> bytes) {
    const auto number = [&](std::size_t offset, auto read) {
        EXPECT_LE(offset + sizeof read, bytes.size());
        std::memcpy(&read, &bytes[offset], sizeof read);
        return read;
    };
    TextureOf<Number> texture;
    EXPECT_EQ(std::memcmp(bytes.data(), "\xabKTX 20\xbb\r\n\x1a\n", 12), 0);
    for (std::size_t i = 0; i < 13; ++i) texture.header.push_back(number(12 + 4 * i, std::uint32_t()));
    std::uint64_t after = bytes.size();  // the largest level is the last
    for (std::size_t k = 0; k < texture.header[7]; ++k) {
        const std::uint64_t begin = number(80 + 24 * k, std::uint64_t()), size = number(88 + 24 * k, std::uint64_t());
        EXPECT_EQ(begin % (4 * sizeof(Number)), 0u);
        EXPECT_EQ(begin + size, after);
        EXPECT_EQ(number(96 + 24 * k, std::uint64_t()), size);
        after = begin;
        texture.levels.emplace_back(size / sizeof(Number));
        std::memcpy(texture.levels.back().data(), &bytes[begin], size);
    }
    const std::size_t end = texture.header[11] + texture.header[12];  // the metadata
    EXPECT_LE(end, after);
    for (std::size_t offset = texture.header[11], size = 0; offset < end; offset += 4 + (size + 3) / 4 * 4) {
        size = number(offset, std::uint32_t());
        const std::string entry(reinterpret_cast<const char*>(&bytes[offset + 4]), size);
        texture.metadata[entry.c_str()] = entry.substr(entry.find('\0') + 1);
    }
    return texture;
}

struct DirectionPair {
    Vec3f wl, wv;
};
std::vector<DirectionPair> pairs(std::size_t count) {
    std::mt19937_64 random(3);
    std::vector<DirectionPair> pairs;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3d wv = random_direction(random, 0.01), mirrored = mirror(wv);
        const Vec3d wl = i % 2 ? random_direction(random, 0.01) : normalize(mirrored + 0.05 * random_direction(random));
        pairs.push_back({to_float(wl), to_float(wv)});
    }
    return pairs;
}

using MapCode = CodeTest;

TEST_F(MapCode, HasTheValuesOfTheTexels) {
    for (const bool axial : {true, false}) {
        const TexelMap map = map_of(axial);
        const Texture texture = texture_of(map_ktx2(map));
        std::vector<float> texels;
        for (const std::uint16_t half : texture.levels[0]) texels.push_back(from_half(half));
        void* const library = compile_and_load(
            SRBF_COMPILER " -x c -std=c99 -pedantic -Wall -Wextra -Wconversion -Werror", axial ? "axial" : "general",
            code(map, CodeLanguage::c) +
                fmt::format("static const float* layers;\n"
                            "static srbf_vec3 map_layer(int j, float u, float v) {{\n"
                            "    const float* at = layers + 4 * (({0} * j + (int)({0} * v)) * {1} + (int)({1} * u));\n"
                            "    return srbf_vec3_of(at[0], at[1], at[2]);\n}}\n",
                            k_height, k_width) +
                "void answer(const float* l, const float* w, const float* uv, float* to);\n"
                "void answer(const float* l, const float* w, const float* uv, float* to) {\n"
                "    map_Coefficients texel;\n    srbf_vec3 f, wl = {w[0], w[1], w[2]}, wv = {w[3], w[4], w[5]};\n"
                "    layers = l, texel = map_coefficients(uv[0], uv[1]);\n"
                "    f = map_brdf(wl, wv, texel), to[0] = f.x, to[1] = f.y, to[2] = f.z;\n"
                "    f = map_albedo(wv.z, texel), to[3] = f.x, to[4] = f.y, to[5] = f.z;\n}\n");
        ASSERT_TRUE(library);
        const auto answer = function<void(const float*, const DirectionPair*, const float*, Rgb*)>(library, "answer");
        const std::vector<DirectionPair> at = pairs(40 * map.count());
        for (std::size_t t = 0; t < map.count(); ++t) {
            const Model model = texel(map, t);
            std::optional<PreparedBrdf> prepared;  // of some, since it takes long
            if (t % 11 == 0) prepared = prepare(model, CosineProposal{});
            const std::array<float, 2> uv{(float(t % k_width) + 0.5f) / k_width,
                                          (float(t / k_width) + 0.5f) / k_height};
            for (std::size_t i = 40 * t; i < 40 * (t + 1); ++i) {
                std::array<Rgb, 2> found;
                answer(texels.data(), &at[i], uv.data(), found.data());
                EXPECT_RGB_WITHIN_RELATIVE(found[0], value(model, at[i].wl, at[i].wv), 2e-4, k_least);
                if (!prepared) continue;
                EXPECT_RGB_WITHIN_RELATIVE(found[1], albedo(*prepared, at[i].wv.z), 2e-4, k_least);
            }
        }
    }
}

/// Level k holds the result of `coarser` applied k times, layer by layer, with alpha 1.
TEST_F(MapCode, LevelsAreMeans) {
    for (const auto& [width, height] : {std::pair<std::size_t, std::size_t>{8, 4}, {5, 3}, {1, 7}}) {
        const TexelMap map = map_of(true, width, height);
        const auto J = std::size_t(map.basis.lobes);
        const Texture texture = texture_of(map_ktx2(map));
        EXPECT_EQ((std::vector(texture.header.begin(), texture.header.begin() + 9)),
                  (std::vector<std::uint32_t>{97, 2, std::uint32_t(width), std::uint32_t(height), 0, std::uint32_t(J),
                                              1, std::uint32_t(texture.levels.size()), 0}));
        MapLevel level{width, height, map.coefficient};
        for (std::size_t k = 0; k < texture.levels.size(); level = coarser(level), ++k) {
            const std::size_t texels = level.width * level.height;
            ASSERT_EQ(texture.levels[k].size(), 4 * J * texels);
            std::vector<double> mean(3 * J), finest_mean(3 * J);
            for (std::size_t t = 0; t < texels; ++t)
                for (std::size_t j = 0; j < J; ++j)
                    for (std::size_t c = 0; c < 4; ++c) {
                        const float number = c < 3 ? level.coefficient[t * J + j][int(c)] : 1;
                        EXPECT_EQ(texture.levels[k][4 * (j * texels + t) + c], to_half(number));
                        if (c < 3) mean[3 * j + c] += double(number) / double(texels);
                    }
            for (std::size_t i = 0; i < map.coefficient.size(); ++i)
                for (std::size_t c = 0; c < 3; ++c)
                    finest_mean[3 * (i % J) + c] += double(map.coefficient[i][int(c)]) / double(map.count());
            for (std::size_t i = 0; i < 3 * J; ++i) EXPECT_WITHIN(mean[i], finest_mean[i], 1e-6);
        }
        EXPECT_EQ(texture.levels.back().size(), 4 * J);  // of one texel
    }
}

/// Each byte is the sRGB code nearest to coefficient / scale; the scale is the lobe's largest coefficient. No level
/// saturates, and white is only where a coefficient is the largest.
TEST_F(MapCode, BytesAreNearestFractionsOfTheScale) {
    TexelMap map = map_of(true, 5, 3);
    const auto J = std::size_t(map.basis.lobes);
    for (std::size_t i = 1; i < map.coefficient.size(); i += J)
        map.coefficient[i] = {1000 * map.coefficient[i].r, 0, 1};
    const auto texture = texture_of<std::uint8_t>(map_ktx2(map, LayerNumbers::bytes));
    EXPECT_EQ(texture.header[0], 43u);
    EXPECT_EQ(texture.header[1], 1u);
    std::vector<Rgb> scales(J);
    ASSERT_EQ(texture.metadata.at(k_scale_key).size(), J * sizeof(Rgb));
    std::memcpy(scales.data(), texture.metadata.at(k_scale_key).data(), J * sizeof(Rgb));
    MapLevel level{5, 3, map.coefficient};
    for (std::size_t k = 0; k < texture.levels.size(); level = coarser(level), ++k) {
        const std::size_t texels = level.width * level.height;
        ASSERT_EQ(texture.levels[k].size(), 4 * J * texels);
        std::size_t white = 0;
        for (std::size_t i = 0; i < J * texels; ++i) {
            const std::uint8_t* const rgba = &texture.levels[k][4 * (i % J * texels + i / J)];
            EXPECT_EQ(rgba[3], 255);
            for (int c = 0; c < 3; ++c) {
                const double scale = double(scales[i % J][c]), exact = double(level.coefficient[i][c]);
                const auto difference = [&](int byte) { return std::abs(scale * srgb_decoded(byte / 255.0) - exact); };
                EXPECT_LE(exact, scale * (1 + 1e-6));
                for (const int other : {std::max(rgba[c] - 1, 0), std::min(rgba[c] + 1, 255)})
                    EXPECT_LE(difference(rgba[c]), difference(other) + 1e-6 * scale);
                white += rgba[c] == 255;
            }
        }
        if (k > 0) continue;
        EXPECT_EQ(white, 3 * J - 1 + map.count() - 1);  // lobe 1 is constant in blue, and has no green
    }
}

/// Against data with noise of 2 %, as instruments have, coefficients in bytes have at most 1.1 times the error of those
/// in halves, though they range over two decades: of the cube root error.
TEST_F(MapCode, BytesHardlyAddToTheErrorOfData) {
    TexelMap map = map_of(true, 8, 8);
    const auto J = std::size_t(map.basis.lobes);
    std::mt19937_64 random(5);
    std::normal_distribution<float> noise(0, 0.02f);
    for (Rgb& beta : map.coefficient)
        for (int c = 0; c < 3; ++c) beta[c] = float(std::pow(10, -2 * uniform(random)));
    TexelMap byte_map = map;
    const std::vector<Rgb> scales = layer_scales(map);
    const auto texture = texture_of<std::uint8_t>(map_ktx2(map, LayerNumbers::bytes));
    for (std::size_t i = 0; i < map.coefficient.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            const std::uint8_t byte = texture.levels[0][4 * (i % J * map.count() + i / J) + std::size_t(c)];
            byte_map.coefficient[i][c] = scales[i % J][c] * float(srgb_decoded(byte / 255.0));
        }
    double half_error = 0, both_errors = 0;
    for (std::size_t t = 0; t < map.count(); ++t)
        for (const DirectionPair& at : pairs(64)) {
            const Rgb f = value(texel(map, t), at.wl, at.wv), g = value(texel(byte_map, t), at.wl, at.wv);
            for (int c = 0; c < 3; ++c) {
                const float measured = std::cbrt(f[c] * (1 + noise(random)));
                half_error += elementary::square(std::cbrt(f[c]) - measured);
                both_errors += elementary::square(std::cbrt(g[c]) - measured);
            }
        }
    EXPECT_GT(half_error, 0);
    EXPECT_LT(both_errors, 1.1 * half_error);
}

#ifdef SRBF_RASTER
/// The mean BRDF of these texels.
Rgb mean(const TexelMap& map, const std::vector<std::size_t>& texels, const DirectionPair& at) {
    Rgb sum;
    for (const std::size_t t : texels) {
        const Rgb f = value(texel(map, t), at.wl, at.wv);
        for (int c = 0; c < 3; ++c) sum[c] += f[c] / float(texels.size());
    }
    return sum;
}
/// Texels of a map, and where a level of its texture shows their mean.
struct TexelArea {
    std::vector<std::size_t> texels;
    std::array<float, 4> uv;  // and the level
};
TexelArea texel_area(std::size_t x0, std::size_t y0, std::size_t size, float level) {
    TexelArea area{{}, {(float(x0) + float(size) / 2) / k_width, (float(y0) + float(size) / 2) / k_height, level, 0}};
    for (std::size_t y = y0; y < y0 + size; ++y)
        for (std::size_t x = x0; x < x0 + size; ++x) area.texels.push_back(y * k_width + x);
    return area;
}
/// Corners of texels, where a filter takes the mean of four, and middles of texels of the coarser levels.
std::vector<TexelArea> texel_areas() {
    std::vector<TexelArea> all;
    for (std::size_t i = 0; i < 7; ++i) all.push_back(texel_area(i, i % 3, 2, 0));
    for (std::size_t i = 0; i < 8; ++i) all.push_back(texel_area(2 * (i % 4), 2 * (i / 4), 2, 1));
    all.push_back(texel_area(4, 0, 4, 2));
    return all;
}

GLuint program_of(const TexelMap& map) {
    return compute_program(
        "#version 450\nlayout(local_size_x = 64) in;\n"
        "layout(std430, binding = 0) readonly buffer Questions { vec4 questions[]; };\n"
        "layout(std430, binding = 1) writeonly buffer Answers { vec4 answers[]; };\n"
        "layout(binding = 0) uniform sampler2DArray layers;\nfloat level;\n"
        "vec3 map_layer(int j, float u, float v) { return textureLod(layers, vec3(u, v, float(j)), level).rgb; "
        "}\n" +
        code(map, CodeLanguage::glsl) +
        "void main() {\n    uint i = gl_GlobalInvocationID.x;\n    level = questions[3 * i + 2].z;\n"
        "    map_Coefficients texel = map_coefficients(questions[3 * i + 2].x, questions[3 * i + 2].y);\n"
        "    answers[i] = vec4(map_brdf(questions[3 * i].xyz, questions[3 * i + 1].xyz, texel), 1.0);\n}\n");
}

/// Binds a texture array with the levels of the file.
void bind_layers(const TexelMap& map) {
    const Texture texture = texture_of(map_ktx2(map));
    GLuint layers = 0;
    glGenTextures(1, &layers);
    glBindTexture(GL_TEXTURE_2D_ARRAY, layers);
    for (std::size_t k = 0; k < texture.levels.size(); ++k)
        glTexImage3D(GL_TEXTURE_2D_ARRAY, GLint(k), GL_RGBA16F, GLsizei(std::max<std::size_t>(k_width >> k, 1)),
                     GLsizei(std::max<std::size_t>(k_height >> k, 1)), map.basis.lobes, 0, GL_RGBA, GL_HALF_FLOAT,
                     texture.levels[k].data());
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_NEAREST);
}

/// Returns the program's answers to questions of three vectors each, in groups of 64.
std::vector<std::array<float, 4>> answers_of(GLuint program, const std::vector<std::array<float, 4>>& questions) {
    std::vector<std::array<float, 4>> answers(questions.size() / 3);
    std::array<GLuint, 2> buffers;
    glGenBuffers(2, buffers.data());
    for (GLuint i = 0; i < 2; ++i) {
        const auto& numbers = i == 0 ? questions : answers;
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, i, buffers[i]);
        glBufferData(GL_SHADER_STORAGE_BUFFER, GLsizeiptr(16 * numbers.size()), numbers.data(), GL_STATIC_DRAW);
    }
    glUseProgram(program);
    glDispatchCompute(GLuint(answers.size() / 64), 1, 1);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, GLsizeiptr(16 * answers.size()), answers.data());
    return answers;
}

/// At corners of texels the filter's BRDF is the mean of four, at the middle of a texel of level k that of the 4ᵏ under
/// it.
TEST_F(MapCode, FilteredTexturesAreMeansOfBrdfs) {
    const std::vector<TexelArea> all = texel_areas();
    const std::vector<DirectionPair> at = pairs(64);
    const auto context = OffscreenContext::make(Dialect::gl_450);
    if (!context) GTEST_SKIP() << message(context.error());
    for (const bool axial : {true, false}) {
        const TexelMap map = map_of(axial);
        const GLuint program = program_of(map);
        ASSERT_NE(program, 0u);
        bind_layers(map);
        std::vector<std::array<float, 4>> questions;
        for (const TexelArea& area : all)
            for (const DirectionPair& pair : at) {
                questions.push_back({pair.wl.x, pair.wl.y, pair.wl.z, 0});
                questions.push_back({pair.wv.x, pair.wv.y, pair.wv.z, 0});
                questions.push_back(area.uv);
            }
        const auto answers = answers_of(program, questions);
        EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
        for (std::size_t i = 0; i < answers.size(); ++i) {
            const TexelArea& area = all[i / at.size()];
            EXPECT_RGB_WITHIN_RELATIVE(answers[i], mean(map, area.texels, at[i % at.size()]), 1e-3, k_least)
                << "level " << area.uv[2];
        }
    }
}
#endif

TEST_F(MapCode, CompilesWithTexturesOfItsLanguages) {
    const TexelMap map = map_of(true);
    for (const bool albedo : {false, true}) {
        EXPECT_TRUE(
            compiles_as_glsl("map.frag",
                             "#version 300 es\nprecision highp float;\n"
                             "uniform highp sampler2DArray layers;\n" +
                                 code(map, CodeLanguage::glsl, albedo) +
                                 "vec3 map_layer(int j, float u, float v) {\n"
                                 "    return texture(layers, vec3(u, v, float(j))).rgb;\n}\n"
                                 "in vec3 a, b; in vec2 uv; out vec4 c;\n"
                                 "void main() { c = vec4(map_brdf(a, b, map_coefficients(uv.x, uv.y)), 1.0); }\n"));
        EXPECT_TRUE(compiles_as_hlsl("frag", "map",
                                     "Texture2DArray layers : register(t0);\nSamplerState linear_ : register(s0);\n" +
                                         code(map, CodeLanguage::hlsl, albedo) +
                                         "float3 map_layer(int j, float u, float v) {\n"
                                         "    return layers.Sample(linear_, float3(u, v, j)).rgb;\n}\n"
                                         "float4 main(float3 a : A, float3 b : B, float2 uv : C) : SV_Target {\n"
                                         "    return float4(map_brdf(a, b, map_coefficients(uv.x, uv.y)), 1.0);\n}\n"));
    }
    const std::string metal = code(map, CodeLanguage::msl), wgsl = code(map, CodeLanguage::wgsl);
    EXPECT_LACKS(metal, "map_layer(");  // its functions see no textures
    EXPECT_CONTAINS(metal, "struct map_Coefficients");
    EXPECT_CONTAINS(wgsl, "fn map_coefficients(u: f32, v: f32) -> map_Coefficients {");
}

TEST_F(MapCode, RefusesOtherModels) {
    const auto expect_refused = [](const auto& made) {
        ASSERT_FALSE(made);
        EXPECT_EQ(made.error().code, ErrorCode::argument);
    };
    TexelMap map = map_of(true);
    EXPECT_TRUE(check_layers(map, "a"));
    expect_refused(map_code(map, "map", {.sampling = true}));
    map.basis.lobes = k_max_layers + 1;
    expect_refused(check_layers(map, "a"));
    map = map_of(true, k_longest_side + 1, 1);
    expect_refused(check_layers(map, "a"));
}

}  // namespace
}  // namespace srbf::map_code_test
