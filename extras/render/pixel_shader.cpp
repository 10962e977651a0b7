#include "extras/render/pixel_shader.h"
#include "generated/render/shader_text.h"

#include <fmt/format.h>

#include <cassert>

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
            version + brdf_text(material) + pixel_text(options)};
}

ShaderText surface_shader_text(Dialect dialect) {
    return {version_text(dialect) + k_surface_text, version_text(dialect) + k_surface_pixel_text};
}

ShaderText develop_shader_text(Dialect dialect) {
    return {version_text(dialect) + k_whole_text,
            version_text(dialect) + brdf_text(Flat{}) + k_shading_text + k_develop_text};
}

}  // namespace
