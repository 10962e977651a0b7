// Shaders for surfaces with a material.
#pragma once
#include "srbf/shader.h"

namespace SRBF_NAMESPACE {

/// The content of a pixel.
enum class PixelOutput {
    shown,     ///< tone_map(radiance, exposure) as sRGB
    radiance,  ///< radiance, and coverage 1; NaN where nothing was measured
};
/// The source of a pixel's position and normal.
enum class PixelInput {
    /// Interpolated over the triangle. Also shades surfaces that are hidden later; the samples of a pixel are
    /// shaded separately.
    triangles,
    /// A `RasterSurface` of an earlier pass is read. Each pixel is shaded once, however small the triangles are.
    surface,
};

/// The number of samples with which a picture begins, and with which it is drawn while it moves.
inline constexpr int k_first_samples = 4;

struct ShaderOptions {
    Dialect dialect = Dialect::gl_450;
    PixelOutput output = PixelOutput::shown;
    PixelInput input = PixelInput::triangles;
    int lights = 3;  ///< directional lights, ≥ 1
    /// True if the light is an environment's, with `lights` beside it: environment_pixel.glsl instead of
    /// pixel.glsl, for radiance from a surface.
    bool environment = false;
    bool two_sided = false;  ///< true for a material with two sides; `shader_text` sets it
};

struct ShaderText {
    std::string vertex, fragment;
};
/// The complete shaders of a material: `version_text`, `brdf_text` and `pixel_text`. Their inputs are attributes 0
/// `position` and 1 `normal` and the uniform `to_clip`, or samplers `surface_positions` and `surface_normals`;
/// uniforms `eye`, `light_direction`, `light_irradiance` and `exposure`; and those of `brdf_text`. Shaders with an
/// environment have the inputs of environment_pixel.glsl, environment.glsl and `proposal_text`.
ShaderText shader_text(const Material& material, const ShaderOptions& options);
/// The part of a fragment shader that follows the text of a material: shading.glsl, and pixel.glsl or
/// environment_pixel.glsl.
std::string pixel_text(const ShaderOptions& options);
/// The shaders of a `RasterSurface`: positions to colour 0, normals to colour 1.
ShaderText surface_shader_text(Dialect dialect);
/// The shaders that display radiances, see extras/render/develop.glsl.
ShaderText develop_shader_text(Dialect dialect);

}  // namespace
