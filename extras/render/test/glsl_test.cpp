// A compiler accepts kernel.glsl and the shaders made of it as GLSL 4.50 and GLSL ES 3.00.
#include "compiled_code.h"
#include "extras/render/pixel_shader.h"
#include "models.h"
#include "su_models.h"

namespace srbf::glsl_test {
namespace {

class Glsl : public CodeTest {
  protected:
    testing::AssertionResult compiles(const std::string& shader, const std::string& stage = "frag") const {
        return compiles_as_glsl("shader." + stage, shader);
    }
};

/// One material of each kind.
std::vector<Material> materials() {
    std::mt19937_64 random(1);
    std::vector<Material> materials{Flat{}, MerlTable{{90, 90, 180}, {}, 0}};
    for (const PmForm form : k_forms)
        for (const bool axial : {true, false})
            materials.push_back(random_model(random, {.axial = axial, .form = form}));
    SuModel su = random_su(random, 100, 2);
    materials.push_back(su);
    su.interpolation = SuInterpolation::plain;
    for (const DirectionMap map : {DirectionMap::cube, DirectionMap::parabolic}) {
        su.index = IndexTexture{map, 8, {}};
        materials.push_back(su);
    }
    materials.push_back(GgxModel{{0.1f, 0.2f, 0.3f}, {{0.3f, {0.04f, 0.04f, 0.04f}, 1}}});
    materials.push_back(OpenPbrModel{});
    return materials;
}

TEST_F(Glsl, EveryMaterialCompiles) {
    for (const Dialect dialect : {Dialect::gl_450, Dialect::es_300}) {
        for (const Material& material : materials()) {
            const ShaderText text = shader_text(material, {.dialect = dialect, .lights = 2});
            EXPECT_TRUE(compiles(text.fragment)) << text.fragment.substr(0, 500);
            const ShaderText lit = shader_text(material, {.dialect = dialect, .lights = 2, .environment = true});
            EXPECT_TRUE(compiles(lit.fragment)) << lit.fragment.substr(0, 500);
        }
        for (const PixelOutput output : {PixelOutput::shown, PixelOutput::radiance})
            for (const PixelInput input : {PixelInput::triangles, PixelInput::surface}) {
                const ShaderText text =
                    shader_text(Flat{}, {.dialect = dialect, .output = output, .input = input, .lights = 1});
                EXPECT_TRUE(compiles(text.vertex, "vert")) << text.vertex;
                EXPECT_TRUE(compiles(text.fragment)) << text.fragment.substr(0, 500);
            }
        EXPECT_TRUE(compiles(surface_shader_text(dialect).vertex, "vert"));
        EXPECT_TRUE(compiles(surface_shader_text(dialect).fragment));
        EXPECT_TRUE(compiles(develop_shader_text(dialect).fragment));
    }
}

// All that an external program needs from the component. It has the whole of kernel.glsl.
TEST_F(Glsl, ABrdfStandsByItself) {
    for (const Dialect dialect : {Dialect::gl_450, Dialect::es_300})
        for (const Material& material : materials()) {
            const std::string text = version_text(dialect) + brdf_text(material);
            const std::string main =
                "in vec3 wl, wv;\nout vec4 pixel;\n"
                "void main() { pixel = vec4(brdf(wl, wv), is_measured ? 1.0 : 0.0); }\n";
            EXPECT_TRUE(compiles(text + main)) << text.substr(0, 500);
            for (const char c : text) ASSERT_TRUE(c == '\n' || (c >= 0x20 && c < 0x7f)) << int(c);
        }
}

TEST_F(Glsl, NumbersFillTheBlockOfTheText) {
    std::mt19937_64 random(2);
    for (const PmForm form : k_forms)
        for (const bool axial : {true, false})
            for (const int lobes : {3, 33}) {
                const PmModel model = random_model(random, {.axial = axial, .lobes = lobes, .form = form});
                const std::string text = brdf_text(model);
                const auto number = [&](const std::string& macro) {
                    return std::size_t(std::stoi(text.substr(text.find("#define " + macro) + 9 + macro.size())));
                };
                EXPECT_EQ(number("PM_LOBES"), std::size_t(lobes));
                EXPECT_EQ(pm_numbers(model).size(), std::size_t(lobes) * (1 + (number("PM_FEATURES") + 3) / 4) +
                                                        number("PM_KERNELS") + number("PM_VARIATES"));
            }
}

}  // namespace
}  // namespace srbf::glsl_test
