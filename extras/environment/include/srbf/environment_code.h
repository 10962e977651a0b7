// Functions of extended light (environments and area lights) in the code of models, and models as materials of
// three.js. Part of the component `srbf::shader`.
#pragma once
#include "srbf/extended_light.h"
#include "srbf/shading_code.h"

SRBF_BEGIN

/// Functions that are added to those of `shading_code`. "environment", "environment-draws" and "area" of
/// `CodeOptions::with` select the first members; the functions below select the others too.
struct EnvironmentCode {
    bool environment = false;            ///< NAME_environment and NAME_environment_lobe
    bool draws = false;                  ///< NAME_environment_sampled, NAME_environment_draw and those of sampling
    bool area = false;                   ///< NAME_area and NAME_environment_lobe
    bool views = false;                  ///< NAME_lobes_about(wv), whose member `lobe` has all lobes of a view
    int lobes = 6;                       ///< number of look-ups for an environment, see extended_light.h
    MapLevels levels = MapLevels::root;  ///< levels of the map in which they are looked up
    bool fixed = false;  ///< the roughness of a lobe is the same for all views: some samplers are slow if it varies
    /// The host supplies the lobes of a model for each of `ExtendedLight::k_views` views, for example in a texture:
    /// Vec3 NAME_light_texel(int i, int view). Lobe k > 0 has (p, roughness, width of the view) at i = 2 k - 2 and
    /// its fraction at i = 2 k - 1; from i = 2 `lobes` - 2 on follow the albedos (`light_texels`). With `fixed` also
    /// float NAME_lobe_roughness(int k).
    bool texels = false;
    /// The host supplies Vec3 NAME_reflected(Vec3 weight, Vec3 light): the product of a lobe's weight, in colours
    /// that the host may change, and the radiance of the environment.
    bool colours = false;
    bool unrolled = false;  ///< loops over lobes are unrolled, for compilers of shaders that do not
};

/// The text of `shading_code` with these functions of each model:
///   Vec3 NAME_environment(Vec3 wv)
///       the radiance that leaves towards the viewer under an environment, for which the host supplies
///       Vec3 NAME_radiance(Vec3 direction, float roughness); not for Metal, where functions access only textures that
///       are their arguments
///   Vec3 NAME_environment_sampled(Vec3 wv, int count)
///       the same from `count` samples of NAME_sample, for an unfiltered environment: the host supplies
///       Vec3 NAME_radiance_over(Vec3 direction, float solid_angle), a look-up in its mip levels; not for Metal
///   LightDraw NAME_environment_draw(Vec3 wv, int i, int count)
///       one of these samples: direction, solid angle [sr], weight
///   Vec3 NAME_area(Vec3 wv, Vec3 a, Vec3 b, Vec3 c, Vec3 d)
///       the radiance that leaves towards the viewer from a quadrilateral of radiance 1, with corners relative to the
///       point
///   LightLobe NAME_environment_lobe(Vec3 wv, int k)
///       one of the `lobes` terms of that sum: axis, roughness and weight, see extended_light.h
/// Returns an error if `shading_code` does.
Result<std::string> environment_code(std::span<const NamedModel> models, std::string_view prefix,
                                     const CodeOptions& options, const EnvironmentCode& added);
/// The text of `map_code` with these functions except the samples, and with the coefficients as the last argument.
/// The axes and roughnesses of its lobes are common to all materials (`SharedLight`). Returns an error if `map_code`
/// does.
Result<std::string> environment_map_code(const TexelMap& map, std::string_view name, const CodeOptions& options,
                                         const EnvironmentCode& added);

/// The texels that NAME_light_texel(i, view) returns for these lobes, R, G, B at 3 (i + view columns).
struct LightTexels {
    std::size_t columns;
    std::vector<float> numbers;
};
LightTexels light_texels(const ExtendedLight& light);

/// The models as an ES module for three.js (release 187) and its WebGLRenderer. Each model gets a class, such as
/// FilmMaterial for "film". It extends MeshStandardMaterial and reflects all lights of three.js by the model,
/// including environment maps and area lights. Returns an error if `shading_code` does.
Result<std::string> three_module(std::span<const NamedModel> models, std::string_view prefix, int threads = 0);
/// Such a module for the WebGPURenderer (run with release 185). Its classes extend MeshStandardNodeMaterial. Returns an
/// error if `shading_code` does.
Result<std::string> three_webgpu_module(std::span<const NamedModel> models, std::string_view prefix, int threads = 0);
/// One model as a shader for the Universal Render Pipeline of Unity 6, whose name is Measured/Film (URP) for "film". It
/// reflects lamps with their shadows, the reflection probe, ambient light and light probes. It was not run in Unity.
/// Returns an error if `shading_code` does, or if there is not exactly one model.
Result<std::string> unity_shader(std::span<const NamedModel> models, int threads = 0);
/// A map (map.h) as a module for WebGLRenderer. It has a class, FilmMaterial for "film", whose `coefficients` are
/// a texture, and a function `loadCoefficients` that reads the texture from a KTX 2 file, by default `file` beside
/// the module. Returns an error if `map_code` does.
Result<std::string> three_map_module(const TexelMap& map, const std::string& name, std::string_view file,
                                     int threads = 0);

SRBF_END
