#include "extras/render/pixel_shader.h"

#include <fmt/format.h>

#include <cassert>

#include "render/shader_text.h"

namespace SRBF_NAMESPACE {

std::string pixel_text(const ShaderOptions& options) {
    assert(options.lights >= 1);
    if (options.environment) {
        return proposal_text(options.two_sided ? int(k_parts) : 1) + k_shading_text + k_environment_text +
               fmt::format("#define LIGHTS {}\n", options.lights) + k_environment_pixel_text;
    }
    std::string each_light;
    for (int k = 0; k < options.lights; ++k) each_light += fmt::format(" f({})", k);
    return fmt::format("#define LIGHTS {}\n#define EACH_LIGHT(f){}\n#define DEFERRED {:d}\n#define SHOWN {:d}\n",
                       options.lights, each_light, options.input == PixelInput::surface,
                       options.output == PixelOutput::shown) +
           k_shading_text + k_pixel_text;
}

ShaderText shader_text(const Material& material, const ShaderOptions& requested) {
    ShaderOptions options = requested;
    options.two_sided = is_two_sided(material);
    const bool covers_picture = options.environment || options.input == PixelInput::surface;
    const std::string version = version_text(options.dialect);
    return {version + (covers_picture ? k_whole_text : k_surface_text),
            version + brdf_text(material, options.open) + pixel_text(options)};
}

ShaderText map_shader_text(const std::string& map_code, const ShaderOptions& options) {
    const std::string version = version_text(options.dialect);
    std::string vertex = version + "#define TEXTURED\n" + k_surface_text,
                fragment = version + "precision highp sampler2DArray;\nuniform sampler2DArray map_layers;\n";
    if (options.environment) {  // samples are all over a pixel, so that their mean filters the finest level
        vertex = version + k_whole_text;
        fragment += "#define map_layer(j, u, v) textureLod(map_layers, vec3(u, v, float(j)), 0.0).rgb\n" +
                    brdf_text(Flat{}) + map_code +
                    "map_Coefficients surface_texel;\n"
                    "#define PLACE(uv) surface_texel = map_coefficients((uv).x, (uv).y)\n"
                    "vec3 map_bsdf(vec3 wl, vec3 wv) { return map_brdf(wl, wv, surface_texel); }\n";
    } else {  // half a level finer than one texel a pixel: linear filters are wider than a pixel
        fragment +=
            "in vec2 surface_texture;\n"
            "#define map_layer(j, u, v) texture(map_layers, vec3(u, v, float(j)), -0.5).rgb\n" +
            brdf_text(Flat{}) + map_code +
            "vec3 map_bsdf(vec3 wl, vec3 wv) {\n"
            "    return map_brdf(wl, wv, map_coefficients(surface_texture.x, surface_texture.y));\n}\n";
    }
    return {vertex, fragment + "#define bsdf map_bsdf\n" + pixel_text(options)};
}

ShaderText surface_shader_text(Dialect dialect, bool textured) {
    const std::string head = version_text(dialect) + (textured ? "#define TEXTURED\n" : "");
    return {head + k_surface_text, head + k_surface_pixel_text};
}

ShaderText develop_shader_text(Dialect dialect) {
    return {version_text(dialect) + k_whole_text,
            version_text(dialect) + brdf_text(Flat{}) + k_shading_text + k_develop_text};
}

}  // namespace srbf
