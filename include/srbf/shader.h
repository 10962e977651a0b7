// Materials as shaders: the shader text of a BRDF, and its numbers in the layout of a graphics library: level 4. It
// does not depend on a graphics library. Component `srbf::shader` of the package.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "srbf/measured.h"
#include "srbf/model.h"
#include "srbf/sampling.h"

namespace [[gnu::visibility("default")]] srbf {

/// A constant f_r, to measure the cost of a picture without a material.
struct Flat {
    static constexpr float k_value = float(1 / k_pi);  ///< [1/sr]
};
/// The material of a surface.
using Material = std::variant<Flat, MerlTable, PmModel, SuModel, GgxModel>;

/// The dialects of the shader text.
enum class Dialect {
    gl_450,  ///< OpenGL 4.5
    es_300,  ///< OpenGL ES 3.0 and WebGL 2
};
std::string_view name(Dialect dialect);

/// The first lines of a shader: the version, and in OpenGL ES the precisions.
std::string version_text(Dialect dialect);

/// The text, to follow `version_text`, that defines
///   vec3 brdf(vec3 wl, vec3 wv)   f_r [1/sr] for R, G, B, of unit vectors in the local frame, both above the horizon
///   bool is_measured              whether the last value of `brdf` was measured: false only for tables
/// It consists of the material's sizes (numbers of lobes and the like, so that loops unroll), the definitions that
/// kernel.glsl requires, kernel.glsl, and the material's own part. It is the same in every dialect. The numbers of the
/// material are uniforms: for a multivariate model the block `PmNumbers` (`pm_numbers`); for a view-by-view model the
/// samplers `su_numbers` and `su_directions` (`su_texels`), and `su_index`; for a table the sampler `merl_table`
/// (`merl_texels`); for Lambert and GGX `ggx_numbers`. Materials with the same text differ only in these. The text
/// includes which centres of axial lobes are −z.
///
/// With `open`, the text is the same for all multivariate models of at most `k_most_open_lobes` lobes that are all
/// axial or all general and have up to four, or five to eight, variates. A model that changes frequently then needs no
/// new compilation. Other materials have their own text even with `open`.
std::string brdf_text(const Material& material, bool open = false);
inline constexpr int k_most_open_lobes = 32;

/// The text, to follow `brdf_text`, that defines
///   vec3 sample_light(vec3 wv, float u1, float u2, float selector)   a direction to the light for u1, u2 and selector
///                                                uniform in [0,1); z <= 0 where the draw has none
///   float light_pdf(vec3 wl, vec3 wv)            its density [1/sr]; 0 where either is not above the horizon
/// Its numbers are the uniforms `mixture_numbers` and `mixture_grain` (`ProposalNumbers`).
std::string proposal_text();
/// The numbers of a mixture's nodes, of each in `k_node_vectors` vectors of four; the cosine and sine of its grain's
/// azimuth, 0 and 0 without one.
inline constexpr int k_node_vectors = (MixtureProposal::k_numbers + 3) / 4;
struct ProposalNumbers {
    std::array<float, 4 * k_node_vectors * MixtureProposal::k_nodes> nodes;
    std::array<float, 2> grain;
};
ProposalNumbers proposal_numbers(const MixtureProposal& proposal);

using Float4 = std::array<float, 4>;
/// The contents of the block `PmNumbers` (std140): colours and log2 scales, exponents, kernels, weights of the
/// parameterization. With `open`, those for the open text, if the model has one.
std::vector<Float4> pm_numbers(const PmModel& model, bool open = false);

/// The uniform `ggx_numbers`: (kd, F90 of the first lobe), (F0, α) of the first lobe, (F0, α) of the second, (0, 0, 0,
/// F90 of the second).
std::array<Float4, 4> ggx_numbers(const GgxModel& model);

/// The texels of a view-by-view model's textures, one row per view.
struct SuTexels {
    /// RGBA16F, n × 2J: a lobe's (β, λ), then its ξ minus the mirrored view direction.
    std::vector<std::array<std::uint16_t, 4>> numbers;
    /// RGBA32F, n × 1: half precision cannot distinguish elevations 1/n apart in z.
    std::vector<Float4> directions;
};
SuTexels su_texels(const SuModel& model);

/// The texels of a table's texture (RGBA32F), φ_d fastest: (f_r, 1), or 0 in every channel where nothing was measured,
/// so that interpolation uses only measured nodes.
std::vector<Float4> merl_texels(const MerlTable& table);

}  // namespace srbf
