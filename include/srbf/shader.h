// Materials as shaders: the shader text of a BRDF, and its numbers in the layout of a graphics library. It
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

SRBF_BEGIN

/// A constant f_r, to measure the cost of a picture without a material.
struct Flat {
    static constexpr float k_value = float(1 / k_pi);  ///< [1/sr]
};
/// The parts of a BSDF (brdf.h) as tables of one size, and its beams.
struct BsdfTables {
    Parts<MerlTable> part;
    Beams beam;
};
template <typename> struct WithTables;
template <typename... M> struct WithTables<std::variant<M...>> {
    using type = std::variant<Flat, MerlTable, BsdfTables, M...>;
};
/// The material of a surface: a BRDF, or a BSDF without view-by-view parts.
using Material = WithTables<AnyModel>::type;
/// True if the front, the back and the light behind the surface are visible.
inline bool is_two_sided(const Material& material) {
    return std::holds_alternative<BsdfModel>(material) || std::holds_alternative<BsdfTables>(material);
}

/// The dialects of the shader text.
enum class Dialect {
    gl_450,  ///< OpenGL 4.5
    es_300,  ///< OpenGL ES 3.0 and WebGL 2
};
std::string_view name(Dialect dialect);

/// The first lines of a shader: the version, and in OpenGL ES the precisions.
std::string version_text(Dialect dialect);

/// The text, to follow `version_text`, that defines
///   SIDES                         1 for a BRDF, 2 for a BSDF
///   vec3 bsdf(vec3 wl, vec3 wv)   f [1/sr] for R, G, B, without beams, of unit vectors in the local frame, which are
///                                 above the horizon if there is one side
///   bool is_measured              whether the last value was measured: false only for tables
/// and with one side the same as `brdf`, with two
///   vec3 straight_beam(vec3 wv)   the fraction of the light from -wv that passes unscattered
///   vec3 mirror_beam(vec3 wv)     the fraction of the light from the mirror direction that is reflected unscattered
/// It consists of the material's sizes (numbers of lobes and the like, so that loops unroll), the definitions that
/// kernel.glsl requires, kernel.glsl, and the material's own part. It is the same in every dialect. The numbers of the
/// material are uniforms: for a multivariate model the block `PmNumbers` (`pm_numbers`); for a view-by-view model the
/// samplers `su_numbers` and `su_directions` (`su_texels`), and `su_index`; for a table the sampler `merl_table`
/// (`merl_texels`); for models of few numbers a uniform (`uniform_of`). Materials with the same text differ only in
/// these. The text includes which centres of axial lobes are −z. A BSDF's model is in the text, with its numbers as
/// constants.
///
/// If the host writes a line `#define PM_EDITED` before the text of a multivariate model, its functions evaluate only
/// one part of it: the highlight if the uniform int edited_part is 0, the body if it is 1. Further uniforms are float
/// edited_shares[], the `body_fractions` of edit.h, and vec2 edited_roughness, the factor of the highlight's roughness
/// and its own α. Pictures of tints and saturations are linear combinations of the pictures of both parts.
std::string brdf_text(const Material& material);

/// The text, to follow `brdf_text`, that defines
///   vec3 sample_light(vec3 wv, float u1, float u2, float selector)   a direction to the light for u1, u2 and selector
///                                                uniform in [0,1); z <= 0 where the draw has none
///   float light_pdf(vec3 wl, vec3 wv)            its density [1/sr]; 0 where either is not above the horizon
/// Its numbers are the uniforms `mixture_numbers` and `mixture_grain` (`ProposalNumbers`). With `parts` mixtures the
/// global `int mixture_part` chooses the one that is meant; directions are in the frame of that part.
std::string proposal_text(int parts = 1);
/// The densities from which the light is drawn: one mixture for a BRDF, one for each part of a BSDF in the order of
/// `Part`.
struct Proposals {
    std::vector<MixtureProposal> by_part;
    Proposals(const MixtureProposal& single) : by_part{single} {}
    explicit Proposals(std::vector<MixtureProposal> several) : by_part(std::move(several)) {}
};
/// The mixtures for a BSDF's parts; `bsdf` is asked at the front and the back.
Proposals propose_parts(const Evaluate& bsdf, const ProposeOptions& options);
/// The numbers of mixtures, one mixture after the other. `nodes` has the numbers of each node, filled up to whole
/// vectors of four. `grains` has the cosine and the sine of the azimuth of each mixture's axis, or 0 and 0 if it has
/// none.
struct ProposalNumbers {
    std::vector<float> nodes;
    std::vector<std::array<float, 2>> grains;
};
ProposalNumbers proposal_numbers(const Proposals& proposals);

using Float4 = std::array<float, 4>;
/// The contents of the block `PmNumbers` (std140): colours and log2 scales, exponents, kernels, weights of the
/// parameterization.
std::vector<Float4> pm_numbers(const PmModel& model);

/// A uniform of vectors by its name; of some materials none.
struct Uniform {
    std::string name;
    std::vector<Float4> numbers;
};
/// The numbers of a model that has few, in the order in which `brdf_text` reads them. The uniform of Lambert and GGX is
/// `ggx_numbers`, with kd, then α, F0 and F90 of each lobe. The uniform of a surface is `openpbr_numbers`, with the
/// numbers of OpenPbrSurface in kernel.glsl. A surface with a film or anisotropy adds those of OpenPbrFilm, and one
/// with anisotropy also those of OpenPbrAnisotropy.
Uniform uniform_of(const Material& material);

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
/// The texels of the parts of a BSDF, one after the other; 0 where there is none.
std::vector<Float4> merl_texels(const BsdfTables& tables);
/// The size of these tables.
std::array<std::uint32_t, 3> size_of(const BsdfTables& tables);

SRBF_END
