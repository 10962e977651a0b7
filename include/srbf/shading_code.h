// Models as source code that stands alone: for engines, ray tracers and anything else with a compiler.
// Component `srbf::shader` of the package.
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "srbf/map.h"
#include "srbf/model.h"

SRBF_BEGIN

enum class CodeLanguage {
    glsl,  ///< OpenGL ES 3.00, which later versions and desktop OpenGL accept as well
    hlsl,  ///< shader model 5
    wgsl,  ///< WebGPU
    msl,   ///< Metal, and anything else with its <metal_stdlib>
    c,     ///< a C99 header, also valid C++ and CUDA
};

struct CodeOptions {
    CodeLanguage language = CodeLanguage::glsl;
    bool sampling = false;               ///< also NAME_sample, NAME_pdf and NAME_value_pdf
    bool albedo = false;                 ///< also NAME_albedo
    bool blend = false;                  ///< also functions that mix two or three models by a mask
    std::vector<std::string> with = {};  ///< also functions of extras: "environment"
    int threads = 0;                     ///< number of threads; 0: all of the machine. The result does not depend on it
};

struct NamedModel {
    std::string name;  ///< an identifier, see `identifier`
    const Model* model = nullptr;
};

/// `text` as an identifier of all the languages: letters, digits and single underscores, and a letter first. It begins
/// with "brdf_" where it would begin otherwise, or is reserved.
std::string identifier(std::string_view text);

/// One source text with the functions of each model,
///   Vec3 NAME_brdf(Vec3 wl, Vec3 wv)   f_r [1/sr] for R, G, B; 0 where wl or wv is not above the horizon
///   Vec3 NAME_sample(Vec3 wv, float u1, float u2, float selector)   a direction to the light, for u1, u2, selector
///                                      uniform in [0,1); z <= 0 where the draw has none
///   float NAME_pdf(Vec3 wl, Vec3 wv)   its density [1/sr], 0 where wl or wv is not above the horizon
///   ValuePdf NAME_value_pdf(wl, wv)    both: value and pdf
///   Vec3 NAME_albedo(float cosine)     directional albedo of a view at that cosine to the normal
/// of unit vectors in the local frame: z along the normal, and of anisotropic models x along the tangent. Vec3 is the
/// language's vector of three floats, in C the structure srbf_vec3. The functions are printed from kernel.glsl, with
/// the numbers of the model as constants, equal to those of the model file, and contain only the functions that the
/// model needs. For a BSDF (brdf.h) the text has the functions of its parts, as NAME_transmission_front_brdf, and for
/// directions on either side
///   Vec3 NAME_bsdf(Vec3 wl, Vec3 wv)   f [1/sr] without beams; 0 where wl or wv lies in the surface
///   Vec3 NAME_beam(Vec3 wv)            the fraction of the light from -wv that passes unscattered; only if it has such
///   Vec3 NAME_mirror_beam(Vec3 wv)     the fraction of the light from the mirror direction; only if it has such
///   Vec3 NAME_sample, float NAME_pdf   as above for the front and the back, without beams; (0, 0, 0) if the draw has
///                                      no direction. They include the albedos of the parts.
/// With `blend` the text also has PREFIX_brdf, and PREFIX_sample, PREFIX_pdf and PREFIX_albedo where models have
/// theirs, with a last argument `Vec3 weights`: of a point, the fractions of the first, second and third model, at
/// least 0. PREFIX_brdf and PREFIX_albedo are the sums of the models' own by these weights; a sample is drawn from one
/// of the models, with probabilities in proportion to them, and PREFIX_pdf is its density. The names of functions that
/// several models share begin with `prefix`; with one model the name of the model is usual. The numbers of a
/// view-by-view model are too many for constants: before the text the host defines NAME_number(i), a function or macro,
/// as number i of `shading_data`. Returns an error with the code `argument` for a view-by-view model with plain
/// interpolation, with sampling, or for Metal, which has no global buffers; and with `blend` unless there are two or
/// three models and none is a BSDF.
Result<std::string> shading_code(std::span<const NamedModel> models, std::string_view prefix,
                                 const CodeOptions& options = {});

/// The lobes of a map (map.h) as one source text, for coefficients from textures:
///   struct NAME_Coefficients { Vec3 lobe[J]; }         a material: R, G, B of each lobe
///   Vec3 NAME_layer(int j, float u, float v)           the coefficient of lobe j at (u, v) of the map, which the host
///                                                      supplies: a look-up in layer j of its textures
///   NAME_Coefficients NAME_coefficients(float u, float v)   the coefficients of all lobes, by NAME_layer
///   Vec3 NAME_brdf(Vec3 wl, Vec3 wv, NAME_Coefficients)     f_r [1/sr], as above
///   and NAME_albedo and functions of extras, if they are wanted, with the coefficients as last argument
/// All are linear in the coefficients, so a texture's filter returns the mean of the texels' BRDFs. The text for Metal,
/// where a function reads only textures that are its arguments, lacks NAME_layer and NAME_coefficients. Returns an
/// error with the code `argument` for a sparse library, and for options with sampling or a blend.
Result<std::string> map_code(const TexelMap& map, std::string_view name, const CodeOptions& options = {});

/// The text of srbf_runtime.h, a header in C99 and C++ that loads any model file: pm, su, ggx, openpbr and bsdf, not
/// maps. Its formulas are printed from kernel.glsl.
std::string runtime_code();

/// The numbers that NAME_number of a view-by-view model returns.
std::vector<float> shading_data(const SuModel& model);

SRBF_END
