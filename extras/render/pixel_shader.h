// Shaders for surfaces with a material.
#pragma once
#include <string>

#include "srbf/shader.h"

namespace srbf {

/// The content of a pixel.
enum class PixelOutput {
    shown,     ///< tone_map(radiance, exposure) as sRGB
    radiance,  ///< radiance, and coverage 1; NaN where nothing was measured
};
/// The source of a pixel's position and normal.
enum class PixelInput {
    /// Interpolated over the triangle. Also shades what is hidden later; samples of a pixel are shaded separately.
    triangles,
    /// From a `RasterSurface` of an earlier pass. Shades each pixel once, however small the triangles are.
    surface,
};

/// Which directions a pixel adds up the environment's light from.
enum class LightDraws {
    both,      ///< two by the environment and one by the BRDF, combined with the power heuristic (Veach & Guibas 1995)
    material,  ///< one by the BRDF
    light,     ///< one by the environment
};
/// Samples that a picture begins with, and is drawn by while it moves.
inline constexpr int k_first_samples = 4;

struct ShaderOptions {
    Dialect dialect = Dialect::gl_450;
    PixelOutput output = PixelOutput::shown;
    PixelInput input = PixelInput::triangles;
    int lights = 3;  ///< directional lights, ≥ 1
    /// True if the light is an environment's, and `lights` are beside it: environment_pixel.glsl instead of pixel.glsl,
    /// for radiance from a surface.
    bool environment = false;
    /// Use the open text of a multivariate model (`brdf_text`): compilation of another text takes longer than a fit.
    bool open = false;
    bool two_sided = false;  ///< the material; `shader_text` sets it
};

struct ShaderText {
    std::string vertex, fragment;
};
/// The complete shaders of a material: `version_text`, `brdf_text` and `pixel_text`. Their inputs are attributes 0
/// `position` and 1 `normal` and the uniform `to_clip`, or samplers `surface_positions` and `surface_normals`; uniforms
/// `eye`, `light_direction`, `light_irradiance` and `exposure`; and those of `brdf_text`. Those with an environment are
/// in environment_pixel.glsl, environment.glsl and `proposal_text`.
ShaderText shader_text(const Material& material, const ShaderOptions& options);
/// The part of a fragment shader that follows the text of a material: shading.glsl, and pixel.glsl or its like.
std::string pixel_text(const ShaderOptions& options);
/// The shaders of a `RasterSurface`: positions to colour 0, normals to colour 1.
ShaderText surface_shader_text(Dialect dialect);
/// The shaders of a `RasterDevelopment`, see extras/render/develop.glsl.
ShaderText develop_shader_text(Dialect dialect);

}  // namespace srbf
