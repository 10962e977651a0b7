// Models as source code that stands alone: for engines, ray tracers and anything else with a compiler.
// Component `srbf::shader` of the package.
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "srbf/extended_light.h"
#include "srbf/library.h"
#include "srbf/model.h"

namespace [[gnu::visibility("default")]] srbf {

enum class CodeLanguage {
    glsl,  ///< OpenGL ES 3.00, which later versions and desktop OpenGL accept as well
    hlsl,  ///< shader model 5
    wgsl,  ///< WebGPU
    msl,   ///< Metal, and anything else with its <metal_stdlib>
    c,     ///< a C99 header, also valid C++ and CUDA
};

/// A language and its name for users.
struct CodeLanguageRow {
    CodeLanguage language;
    std::string_view name;
};
inline constexpr CodeLanguageRow k_code_languages[] = {{CodeLanguage::glsl, "glsl"},
                                                       {CodeLanguage::hlsl, "hlsl"},
                                                       {CodeLanguage::wgsl, "wgsl"},
                                                       {CodeLanguage::msl, "msl"},
                                                       {CodeLanguage::c, "c"}};

struct CodeOptions {
    CodeLanguage language = CodeLanguage::glsl;
    bool sampling = false;           ///< also NAME_sample and NAME_pdf
    bool albedo = false;             ///< also NAME_albedo
    bool environment = false;        ///< also NAME_environment and NAME_environment_lobe
    bool environment_draws = false;  ///< also NAME_environment_sampled, NAME_environment_draw and those of sampling
    bool area = false;               ///< also NAME_area and NAME_environment_lobe
    int extended_lobes = 6;          ///< look-ups for an environment, see extended_light.h
    MapLevels map_levels = MapLevels::root;  ///< of the map that they look up
    /// The host supplies the lobes of a model for each of `ExtendedLight::k_views` views, as it has them in a texture:
    /// Vec3 NAME_light_texel(int i, int view), of lobe k > 0 (p, roughness, width of the view) at i = 2 k - 2 and its
    /// share at i = 2 k - 1, and from i = 2 `extended_lobes` - 2 the albedos (`light_texels`).
    bool light_texels = false;
    int threads = 0;  ///< for weights of sampling, albedos and lobes of environments; 0: as many as the machine has
};

struct NamedModel {
    std::string name;  ///< an identifier, see `identifier`
    const Model* model = nullptr;
};

/// `text` as an identifier of all the languages: letters, digits and single underscores, and a letter first. It begins with
/// "brdf_" where it would begin otherwise, or is reserved.
std::string identifier(std::string_view text);

/// One source text with the functions of each model,
///   Vec3 NAME_brdf(Vec3 wl, Vec3 wv)   f_r [1/sr] for R, G, B; 0 where wl or wv is not above the horizon
///   Vec3 NAME_sample(Vec3 wv, float u1, float u2, float selector)   a direction to the light, for u1, u2, selector
///                                      uniform in [0,1); z <= 0 where the draw has none
///   float NAME_pdf(Vec3 wl, Vec3 wv)   its density [1/sr], 0 where wl or wv is not above the horizon
///   Vec3 NAME_albedo(float cosine)     directional albedo of a view at that cosine to the normal
///   Vec3 NAME_environment(Vec3 wv)     the radiance that leaves towards the viewer under an environment, of which the
///                                      host supplies Vec3 NAME_radiance(Vec3 direction, float roughness); not for Metal,
///                                      where a function sees no textures but its arguments
///   Vec3 NAME_environment_sampled(Vec3 wv, int count)   the same by so many draws of NAME_sample, of an environment that is
///                                      not filtered for them: the host supplies Vec3 NAME_radiance_over(Vec3 direction,
///                                      float solid_angle), a look-up in its mip levels; not for Metal
///   LightDraw NAME_environment_draw(Vec3 wv, int i, int count)   one of them: direction, solid angle [sr], weight
///   Vec3 NAME_area(Vec3 wv, Vec3 a, Vec3 b, Vec3 c, Vec3 d)   the radiance that leaves towards the viewer from a
///                                      quadrilateral of radiance 1, of corners about the point
///   LightLobe NAME_environment_lobe(Vec3 wv, int k)   of the `extended_lobes` terms of that sum one: axis, roughness and
///                                      weight, see extended_light.h
/// of unit vectors in the local frame: z along the normal, and of anisotropic models x along the tangent. Vec3 is the
/// language's vector of three floats, in C the structure srbf_vec3. The functions are printed from kernel.glsl, with
/// the numbers of the model as constants, equal to those of the model file, and contain what the model needs of them.
/// For a BSDF (bsdf.h) the text has the functions of its parts, as NAME_transmission_front_brdf, and for directions on either
/// side
///   Vec3 NAME_bsdf(Vec3 wl, Vec3 wv)   f [1/sr] without beams; 0 where wl or wv lies in the surface
///   Vec3 NAME_beam(Vec3 wv)            the share of the light from -wv that passes unscattered; only if it has such
///   Vec3 NAME_mirror_beam(Vec3 wv)     the share of the light from the mirror direction; only if it has such
///   Vec3 NAME_sample, float NAME_pdf   as above for the front and the back, without beams; (0, 0, 0) where the draw has none. They
///                                      include the albedos of the parts.
/// The names of functions that several models share begin with `prefix`; with one model the name of the model is usual.
/// The numbers of a view-by-view model are too many for constants: before the text the host defines NAME_number(i), a
/// function or macro, as number i of `shading_data`. Errors, of code `argument`: a view-by-view model with plain
/// interpolation, with sampling, or for Metal, which has no global buffers.
Result<std::string> shading_code(std::span<const NamedModel> models, std::string_view prefix,
                                 const CodeOptions& options = {});

/// The lobes of a dense library (library.h) as one source text, for coefficients from textures:
///   struct NAME_Coefficients { Vec3 lobe[J]; }         a material: R, G, B of each lobe
///   Vec3 NAME_layer(int j, float u, float v)           the coefficient of lobe j at (u, v) of the map, which the host
///                                                      supplies: a look-up in layer j of its textures
///   NAME_Coefficients NAME_coefficients(float u, float v)   those of all lobes, by NAME_layer
///   Vec3 NAME_brdf(Vec3 wl, Vec3 wv, NAME_Coefficients)     f_r [1/sr], as above
///   and NAME_albedo, NAME_environment, NAME_environment_lobe, NAME_area, if they are wanted, as above with the coefficients
///   as last argument; of the lobes of environments there are J + 1, the cosine about the normal and one of each lobe
/// All are linear in the coefficients, so that what a texture's filter makes of texels is the mean of their BRDFs. Not for
/// Metal, where a function sees no textures but its arguments: NAME_layer and NAME_coefficients. Errors, of code
/// `argument`: a sparse library; sampling.
Result<std::string> map_code(const Library& map, std::string_view name, const CodeOptions& options = {});

/// The functions of a model as Python for a library of arrays, see src/code/print_python.h: brdf(wl, wv),
/// chosen_lobe(wv, selector), sample_of_lobe(k, wv, u1, u2) for each of its 16 lobes k, light_pdf(wl, wv). The model's
/// numbers are tables: `lobes`, a row for each (coefficient, log scale, for each variate centre, unless the model is
/// axial, and bandwidth, negative if the centre is -z, then the exponents) and `variates`; or `facets` (diffuse, and of
/// each lobe roughness, F0, F90). Errors: a view-by-view model.
Result<std::string> python_code(const Model& model, int threads = 0);

/// The models as functions of Radiance's expression language, the text of a `.cal`: of each NAME(ix,iy,iz,ox,oy,oz), the
/// luminance of f [1/sr] for vectors to the light and to the viewer, and NAME_R, NAME_G, NAME_B, its channels. Positive z is
/// the front of a BRDF, and the back of a BSDF as in WINDOW's XML, whose x is mirrored. Without beams. Errors: a view-by-view
/// model.
Result<std::string> radiance_text(std::span<const NamedModel> models);

/// The numbers that NAME_number of a view-by-view model returns.
std::vector<float> shading_data(const SuModel& model);

/// The texels that NAME_light_texel(i, view) returns of those lobes, R, G, B at 3 (i + view columns).
struct LightTexels {
    std::size_t columns;
    std::vector<float> numbers;
};
LightTexels light_texels(const ExtendedLight& light);

/// The models as an ES module for three.js (release 187) and its WebGLRenderer: for each model a class, such as
/// FilmMaterial for "film". It extends MeshStandardMaterial and reflects all lights of three by the model, environment
/// maps and area lights too. Errors: those of `shading_code`.
Result<std::string> three_module(std::span<const NamedModel> models, std::string_view prefix, int threads = 0);
/// A dense library (library.h) as such a module: a class, FilmMaterial for "film", whose `coefficients` are a texture, and
/// a function `loadCoefficients` that reads it from a KTX 2 file, unless told another from `file` beside the module. Errors
/// as of `map_code`.
Result<std::string> three_map_module(const Library& map, const std::string& name, std::string_view file,
                                     int threads = 0);

}  // namespace srbf
