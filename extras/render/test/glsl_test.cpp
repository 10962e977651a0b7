// Compilers accept kernel.glsl and the shaders made of it as GLSL 4.50 and GLSL ES 3.00.
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <set>

#include "extras/render/pixel_shader.h"
#include "models.h"
#include "srbf/file.h"
#include "su_models.h"
#include "temporary_folder.h"

namespace srbf::glsl_test {
namespace {

/// Definitions of a shader before the included text: the model in uniform arrays, `Pm` is the index of its first lobe.
const std::string k_host = R"(
#define Real float
#define Vec3 vec3
#define Bool bool
#define SRBF_FN
struct Pm { int first; };
uniform int lobes, variates, features;
uniform bool axial, reciprocal;
uniform vec4 exponent_of_lobe[16];
uniform vec2 weight[8];
uniform vec4 variate_of_lobe[128];   // centre, log2_falloff
uniform vec4 coefficient_of_lobe[16];  // coefficient, scale
Real select(Bool condition, Real a, Real b) { return condition ? a : b; }
int pm_lobes(Pm pm) { return lobes; }
int pm_variates(Pm pm) { return variates; }
Real pm_weight_l(Pm pm, int n) { return weight[n].x; }
Real pm_weight_v(Pm pm, int n) { return weight[n].y; }
Vec3 pm_centre(Pm pm, int j, int n) { return variate_of_lobe[(pm.first + j) * 8 + n].xyz; }
Real pm_log2_falloff(Pm pm, int j, int n) { return variate_of_lobe[(pm.first + j) * 8 + n].w; }
Vec3 pm_coefficient(Pm pm, int j) { return coefficient_of_lobe[pm.first + j].rgb; }
bool pm_axial(Pm pm) { return axial; }
bool pm_reciprocal(Pm pm) { return reciprocal; }
bool pm_down(Pm pm, int j, int n) { return pm_centre(pm, j, n).z < 0.0; }
int pm_features(Pm pm) { return features; }
Real pm_exponent(Pm pm, int j, int k) { return exponent_of_lobe[pm.first + j][k]; }
Real pm_log2_scale(Pm pm, int j) { return coefficient_of_lobe[pm.first + j].w; }
struct Su { int lobes; };
struct SuNearest { uvec4 pairs; };  // a texel of eight 16-bit numbers
uniform highp sampler2D numbers_of_view;  // a lobe's coefficient and bandwidth, then its centre
uniform sampler2D direction_of_view;
int su_lobes(Su su) { return su.lobes; }
int su_views(Su su) { return textureSize(direction_of_view, 0).x; }
Vec3 su_direction(Su su, int view) { return texelFetch(direction_of_view, ivec2(view, 0), 0).xyz; }
Vec3 su_centre(Su su, int view, int j) { return texelFetch(numbers_of_view, ivec2(2 * j + 1, view), 0).xyz; }
Real su_bandwidth(Su su, int view, int j) { return texelFetch(numbers_of_view, ivec2(2 * j, view), 0).w; }
Real su_shape(Su su, int view, int j) { return texelFetch(numbers_of_view, ivec2(2 * j + 1, view), 0).w; }
Vec3 su_coefficient(Su su, int view, int j) { return texelFetch(numbers_of_view, ivec2(2 * j, view), 0).rgb; }
int su_nearest(SuNearest nearest, int k) { return int(nearest.pairs[k / 2] >> uint(16 * (k % 2)) & 0xffffu); }
)";

const std::string k_main = R"(
in vec3 wl, wv;
in vec2 u;
uniform highp usamplerCube index_of_direction;
out vec4 colour;
void main() {
    Vec3 f = pm_value(Pm(0), wl, wv);
    Vec3 w = sample_vmf(psi(wl, wv, 1.0, 1.0), 40.0, u.x, u.y);
    GaussianProduct product = gaussian_product(wl, 3.0, wv, u.x);
    f += from_frame(wl, u.x, u.y, one_minus_exp(u.x)) + psi_by_angle(wl, wv, u.x, u.y) + product.centre;
    f *= gaussian(w, wl, 2.0) * gaussian_exponent(w, wv, 2.0) * product.scale * product.bandwidth *
         shaped_exponent(wl - wv, dot(wl, tangent_across(wv)), slant(wl.z), 2.0, -1.0);
    PmFeatures x = pm_further_features(features, wl, wv);
    f += x.x[0] * x.x[1] + x.x[2] * x.x[SRBF_TERMS - 1];
    Real exponent = pm_with_variate(Pm(0), 0, 0, u.x, squared_distance_from_pole(axial_psi(wl, wv, u.x, u.y), 1.0));
    f += pm_power(pm_with_features(Pm(0), 0, exponent + squared_distance(wl, wv), x)) * exp_of_lobe(u.x) *
         pm_lobe(Pm(0), 0, u.y, pm_variates_of(Pm(0), wl, wv));
    SuNearest nearest = SuNearest(texture(index_of_direction, wv));
    SuNeighbour neighbour = su_rotated_neighbour(Su(5), wv, 0);
    f += su_view_value(Su(5), neighbour.view, turned(wl, neighbour.cosine, neighbour.sine)) * neighbour.weight;
    f += su_rotated_value(Su(5), wl, wv) + su_plain_value(Su(5), nearest, wl, wv, 3);
    f *= su_plain_weight(Su(5), nearest, wv, 3, 0) * su_rotated_part(Su(5), wl, wv, 0);
    GgxLobe sharp = GgxLobe(u.x, wl, u.y), broad = GgxLobe(ggx_facets(wl, wv, u.y), wv, schlick_weight(wl, wv));
    f += ggx_value(wl, sharp, broad, wl, wv) + ggx_lobe_value(broad, wl, wv);
    OpenPbrSurface surface = OpenPbrSurface(wl, u.x, u.y, u.x, wv, u.x, 1.5, u.x, wl, u.y, 1.6, u.x, u.y, wv, u.x);
    OpenPbrFilm film = OpenPbrFilm(u.x, u.y, 1.4);
    OpenPbrBase base = openpbr_base(surface);
    OpenPbrFacets facets = openpbr_facets(surface, base, wl, wv), filmed = openpbr_film_facets(surface, film, base, wl, wv);
    f += openpbr_value(surface, wl, wv) + openpbr_base_value(surface, base, facets, u.x, wl, wv);
    f += interpolated(product_of(wl, wv), wl, u.x) * ggx_stretched_facets(wl, wv, u.x, u.y);
    f += openpbr_anisotropic_value(surface, film, OpenPbrAnisotropy(u.x, u.y, 0.5), wl, wv);
    f += openpbr_film_value(surface, film, wl, wv) + openpbr_layers_value(surface, filmed.metal, wl, wv);
    f *= film_reflectance(film, wl, half_cosine(wl, wv)) + film_colour(u.x, wv) + multiple_scattering_by(wl, u.x);
    f *= film_order(film_base(u.x, 1.4, u.y), u.x, u.y, 0.5) + film_wave(u.x, 1.0, u.y, 0.5) + doubled(u.x) +
         one_minus_cos(u.y) + fifth_power(u.x);
    FacetAlbedo whole = facet_albedo(u.x, alpha_of(u.y));
    f *= lobe_albedo(whole, normal_reflectance(1.5)) + multiple_scattering(whole) + dielectric_reflectance(u.x, 1.5);
    f *= clamped_to_unit(polynomial(u.x, u.y, 1.0, 2.0)) + roughened(u.x, u.y, 0.5) + metal_reflectance(u.x, 0.1, u.y, 0.5);
    f += (eon_share(u.x, u.y) + eon_again(u.x, u.y) + darkened(u.x, 0.5, u.y)) * eon_value(wl, u.x, wl, wv);
    f *= fuzz_albedo(u.x, u.y) + fuzz_value(wl, wv, u.y);
    Stretch map = stretch_along(wv, 0.5);
    f += sample_cosine(u.x, u.y) * cosine_pdf(wl) * power_cosine_pdf(wl, 2.0) * below_power_cosine(0.5, u.x);
    f += visible_lobe(stretched(wv, map), map.inverse, 8.0, 2.0).centre;
    f += half_vector_pdf(wl, wv, 8.0, map, 2.0) * grown_along(wl, u.x, u.y, sample_below(0.1, 0.0, u.x));
    f += sample_half_vector(wv, 8.0, map, 2.0, u.x, u.y) *
         proposal_lobe_pdf(5, proposal_point(wl, wv, map, 2.0)) * proposal_bandwidth(1) * mixture_cosine(mixture_position(u.x));
    f += sample_proposal_lobe(2, wv, map, 2.0, u.x, u.y) * half_vector(wl, wv, map).factor;
    f += reflected_pdf(mirror_lobe(wl, 4.0), itself(wl), half_vector(wl, wv, map)) *
         half_vector_lobe(wv, 1.0, 8.0, 1.0).centre;
    f += reflected_up(light_of(sample_sharp_vmf(wl, 0.25, u.x, u.x, u.y), wv)) + off_centre(wl, u.x, u.y);
    OpenPbrRoughness roughness = openpbr_roughness(u.x, u.y);
    Facets normals = facets_along(0.6, 0.8, roughness.along, roughness.across);
    f += roughened_by(normals, wl) * visible_normals_pdf(wl, wv, normals) * facets_pdf(wl, wv, normals);
    f += sample_visible_normals(wv, normals, u.x, u.y) + sample_facets(wv, normals, u.x, u.y);
    colour = vec4(f, vmf_pdf(w, wl, 2.0) * gaussian_integral(u.y));
}
)";

const std::array<std::string, 2> k_versions{"#version 450\n",
                                            "#version 300 es\nprecision highp float;\nprecision highp int;\n"};

std::string kernel_text() {
    std::string text;
    for (const char* part : {"elementary", "gaussian", "vmf", "proposal", "pm", "su", "ggx", "openpbr"}) {
        const auto bytes = read_file(fmt::format("{}/include/srbf/kernel/{}.glsl", SRBF_SOURCE_DIR, part));
        if (!bytes) return ADD_FAILURE() << message(bytes.error()), "";
        text.append(reinterpret_cast<const char*>(bytes->data()), bytes->size());
    }
    return text;
}

/// The messages of glslangValidator about a fragment shader, and whether it accepts it.
class Glsl : public testing::Test {
  protected:
    void SetUp() override {
        ASSERT_TRUE(std::filesystem::exists(SRBF_GLSLANG))
            << "glslangValidator (Debian: glslang-tools) was not found when this was configured: " << SRBF_GLSLANG;
    }

    testing::AssertionResult compiles(const std::string& shader, const std::string& stage = "frag") {
        const std::string path = (folder_ / ("shader." + stage)).string();
        if (!write_file(path, as_bytes(shader))) return testing::AssertionFailure() << "cannot write " << path;
        const std::string command = std::string("'") + SRBF_GLSLANG + "' '" + path + "' 2>&1";
        FILE* pipe = ::popen(command.c_str(), "r");
        if (!pipe) return testing::AssertionFailure() << "cannot run " << command;
        std::string output;
        for (char part[256]; std::fgets(part, sizeof part, pipe);) output += part;
        const int status = ::pclose(pipe);
        if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return testing::AssertionSuccess();
        return testing::AssertionFailure() << output;
    }

  private:
    const TemporaryFolder folder_;
};

TEST_F(Glsl, TheTextCompilesAsAShader) {
    for (const std::string& version : k_versions)
        EXPECT_TRUE(compiles(version + k_host + kernel_text() + k_main)) << version;
}

/// One material of each kind.
std::vector<Material> materials() {
    std::mt19937_64 random(1);
    std::vector<Material> materials{Flat{}, MerlTable{{90, 90, 180}, {}, 0}};
    for (const PmForm form : k_forms)
        for (const bool axial : {true, false})
            materials.push_back(random_model(random, {.axial = axial, .form = form}));
    SuModel su = random_su(random, 100, 2, true);
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

// All that an external program needs from the component.
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

TEST_F(Glsl, EveryFunctionIsUsed) {
    const std::string text = kernel_text();
    std::set<std::string> functions;  // SRBF_FN TYPE NAME(
    const std::string mark = "\nSRBF_FN ";
    for (auto at = text.find(mark); at != std::string::npos; at = text.find(mark, at + 1)) {
        const auto type_end = text.find(' ', at + mark.size()), end = text.find('(', at);
        functions.insert(text.substr(type_end + 1, end - type_end - 1));
    }
    EXPECT_GE(functions.size(), 11u);
    for (const std::string& f : functions) EXPECT_NE(k_main.find(f + "("), std::string::npos) << f;
}

TEST_F(Glsl, TheTextIsAscii) {
    // GLSL ES 3.00 allows other characters only in comments, some drivers not even there.
    for (const char c : kernel_text()) ASSERT_TRUE(c == '\n' || (c >= 0x20 && c < 0x7f)) << int(c);
}

}  // namespace
}  // namespace srbf::glsl_test
