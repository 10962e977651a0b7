// Shaders that draw a surface of a material: level 6.
#pragma once
#include <string>

#include "srbf/shader.h"

namespace srbf {

/// What a pixel holds.
enum class PixelOutput {
    shown,     ///< tone_map(radiance, exposure) as sRGB
    radiance,  ///< and 1 for coverage; NaN where nothing was measured
};
/// Where a pixel's position and normal come from.
enum class PixelInput {
    /// Interpolated over the triangle that is drawn: shades what is hidden later, too, and samples of a pixel apart.
    triangles,
    /// What an earlier pass left in a `RasterSurface`: each pixel is shaded once, however small the triangles.
    surface,
};

struct ShaderOptions {
    Dialect dialect = Dialect::gl_450;
    PixelOutput output = PixelOutput::shown;
    PixelInput input = PixelInput::triangles;
    int lights = 3;  ///< directional lights, ≥ 1
    /// A multivariate model in its open text (`brdf_text`): to compile another text takes longer than to fit a model.
    bool open = false;
};

struct ShaderText {
    std::string vertex, fragment;
};
/// A material's shaders, complete: `version_text`, `brdf_text`, shading.glsl and pixel.glsl. They take attributes 0
/// `position` and 1 `normal` and the uniform `to_clip`, or samplers `surface_positions` and `surface_normals`; uniforms
/// `eye`, `light_direction`, `light_irradiance` and `exposure`; and those of `brdf_text`.
ShaderText shader_text(const Material& material, const ShaderOptions& options);
/// The shaders of a `RasterSurface`: positions to colour 0, normals to colour 1.
ShaderText surface_shader_text(Dialect dialect);
/// The shaders of a `RasterDevelopment`, as render/develop.glsl.
ShaderText develop_shader_text(Dialect dialect);

}  // namespace srbf
