// Materials as shaders: the text of a BRDF, and its numbers as a graphics library takes them: level 4. Needs no such
// library. The component `srbf::shader` of the package.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
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

/// The first lines of a shader: its version, in OpenGL ES also the precisions.
std::string version_text(Dialect dialect);

/// The text, after `version_text`, that defines
///   vec3 brdf(vec3 wl, vec3 wv)   f_r [1/sr] for R, G, B, of unit vectors in the local frame, both above the horizon
///   bool is_measured              whether the last value of `brdf` was measured: false only of tables
/// It consists of the material's shape (numbers of lobes and the like, so that loops unroll), what kernel.glsl takes of
/// a shader, kernel.glsl, and the material's own part, and is the same in every dialect. It reads the material's numbers
/// from uniforms: a multivariate model's from the block `PmNumbers` (`pm_numbers`); a view-by-view model's from the
/// samplers `su_numbers` and `su_directions` (`su_texels`), and `su_index`; a table's from the sampler `merl_table`
/// (`merl_texels`); Lambert and GGX's from `ggx_numbers`. Materials of the same text differ in these alone; which
/// centres of axial lobes are −z is part of the text.
///
/// The open text is the same for all multivariate models of at most `k_most_open_lobes` lobes that are likewise axial
/// or general and have up to four, or five to eight, variates: a model that changes every second needs no new
/// compilation. With `open`, other materials have their own text still.
std::string brdf_text(const Material& material, bool open = false);
inline constexpr int k_most_open_lobes = 32;

using Float4 = std::array<float, 4>;
/// The contents of the block `PmNumbers` (std140): colours and log2 scales, exponents, kernels, weights of the
/// parameterization; `open`: those of the model's open text, if it has one.
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

/// The texels of a table's texture (RGBA32F), φ_d fastest: f_r, 1; 0 in every channel where nothing was measured, so
/// that interpolation is over what was.
std::vector<Float4> merl_texels(const MerlTable& table);

}  // namespace srbf
