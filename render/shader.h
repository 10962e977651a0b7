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

/// A constant f_r: what a picture of it costs, every picture does.
struct Flat {
    static constexpr float k_value = float(1 / k_pi);  ///< [1/sr]
};
/// What a surface may be made of.
using Material = std::variant<Flat, MerlTable, PmModel, SuModel, GgxModel>;

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
};
/// Where a pixel's position and normal come from.
enum class PixelInput {
    triangles,  ///< interpolated over the triangle that is drawn: shades what is hidden later, too, and samples of a pixel apart
    surface,  ///< what an earlier pass left in a `RasterSurface`: each pixel is shaded once, however small the triangles
};

struct ShaderOptions {
    Dialect dialect = Dialect::gl_450;
    PixelOutput output = PixelOutput::shown;
    PixelInput input = PixelInput::triangles;
    int lights = 3;  ///< directional lights, ≥ 1
    /// A multivariate model of up to `k_most_open_lobes` lobes in the text of all such models, but for their lobes' being axial and four or
    /// eight variates: what changes by the second, as under a slider, is not compiled anew, which takes longer than to fit it.
    bool open = false;
};
inline constexpr int k_most_open_lobes = 32;
/// Whether the options have the model in an open text.
inline bool is_open(const PmModel& model, const ShaderOptions& options) {
    return options.open && model.lobes <= k_most_open_lobes;
}

struct ShaderText {
    std::string vertex, fragment;
};
/// A material's shaders, complete: version, the material's shape (counts of lobes and the like, so that loops unroll), and the
/// texts host.glsl, kernel.glsl, shading.glsl and pixel.glsl. Attributes 0 `position` and 1 `normal` and uniform `to_clip`, or samplers
/// `surface_positions` and `surface_normals`; uniforms `eye`, `light_direction`, `light_irradiance`, `exposure`; a block `PmNumbers`
/// of `pm_numbers`; samplers `su_numbers`, `su_directions`, `su_index`, `merl_table`; uniform `ggx_numbers`.
/// Two materials of one text differ in numbers alone; which centres of axial lobes are −z is part of it.
ShaderText shader_text(const Material& material, const ShaderOptions& options);
/// The shaders of a `RasterSurface`: positions to colour 0, normals to colour 1.
ShaderText surface_shader_text(Dialect dialect);
/// The shaders of a `RasterDevelopment`, as render/develop.glsl.
ShaderText develop_shader_text(Dialect dialect);

using Float4 = std::array<float, 4>;
/// The contents of the block `PmNumbers` (std140): colours and log2 scales, exponents, kernels, weights of the parameterization.
std::vector<Float4> pm_numbers(const PmModel& model, bool open = false);

/// The uniform `ggx_numbers`: (kd, F90 of the first lobe), (F0, α) of it, (F0, α) of the second, (0, 0, 0, its F90).
std::array<Float4, 4> ggx_numbers(const GgxModel& model);

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
