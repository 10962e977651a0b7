// Materials as shaders: their text, and their numbers as a graphics library takes them. Needs no such library: level 6.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "srbf/measured.h"
#include "srbf/model.h"

namespace srbf {

/// One colour, whatever the light: a picture of it costs what all pictures do.
struct Flat {};
/// What a surface may be made of.
using Material = std::variant<Flat, MerlTable, PmModel, SuModel>;

/// The shading languages that the text is written in.
enum class Dialect {
    gl_450,  ///< of OpenGL 4.5
    es_300,  ///< of OpenGL ES 3.0 and WebGL 2
};
std::string_view name(Dialect dialect);

/// What a pixel holds.
enum class PixelOutput {
    shown,     ///< tone_map(radiance, exposure) as sRGB
    radiance,  ///< and 1 for coverage; NaN where nothing was measured
    normal,    ///< as interpolated over the triangle, turned to the viewer where its back is seen
    position,  ///< likewise
};

struct ShaderOptions {
    Dialect dialect = Dialect::gl_450;
    PixelOutput output = PixelOutput::shown;
    int lights = 3;  ///< directional lights, ≥ 1
};

/// The shader of vertices: attributes 0 `position` and 1 `normal`; uniform `to_clip`.
std::string vertex_shader(Dialect dialect);
/// The shader of pixels, complete: version, a material's shape (counts of lobes and the like, so that loops unroll), and the
/// texts host.glsl, kernel.glsl, shading.glsl and pixel.glsl. Uniforms: `eye`, `light_direction`, `light_irradiance`, `exposure`; a
/// block `PmNumbers` of `pm_numbers`; samplers `su_numbers`, `su_directions`, `su_index`, `merl_table`.
/// Two materials of one text differ in numbers alone.
std::string fragment_shader(const Material& material, const ShaderOptions& options);

using Float4 = std::array<float, 4>;
/// The contents of the block `PmNumbers` (std140): colours and log2 scales, exponents, kernels, weights of the parameterization.
std::vector<Float4> pm_numbers(const PmModel& model);

/// The texels of a view-by-view model's textures, a row of them for each view.
struct SuTexels {
    /// RGBA16F, n × 2J: a lobe's (β, λ), then its ξ less the mirrored view direction.
    std::vector<std::array<std::uint16_t, 4>> numbers;
    /// RGBA32F, n × 1: halves would not tell elevations apart that are 1/n from each other in z.
    std::vector<Float4> directions;
};
SuTexels su_texels(const SuModel& model);

/// The texels of a table's texture (RGBA32F), φ_d fastest: f_r, 1; 0 in every channel where nothing was measured, so that interpolation is
/// over what was.
std::vector<Float4> merl_texels(const MerlTable& table);

}  // namespace srbf
