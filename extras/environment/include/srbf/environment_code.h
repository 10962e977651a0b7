// Functions of extended light in the code of models: environments and area lights; and models as materials of three.js.
// Part of the component `srbf::shader`.
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "srbf/extended_light.h"
#include "srbf/shading_code.h"

namespace [[gnu::visibility("default")]] srbf {

/// Functions that are added to those of `shading_code`: with "environment", "environment-draws" and "area" of
/// `CodeOptions::with`, the first members by themselves; others by the functions below.
struct EnvironmentCode {
    bool environment = false;            ///< NAME_environment and NAME_environment_lobe
    bool draws = false;                  ///< NAME_environment_sampled, NAME_environment_draw and those of sampling
    bool area = false;                   ///< NAME_area and NAME_environment_lobe
    int lobes = 6;                       ///< look-ups for an environment, see extended_light.h
    MapLevels levels = MapLevels::root;  ///< of the map that they look up
    /// The host supplies the lobes of a model for each of `ExtendedLight::k_views` views, as it has them in a texture:
    /// Vec3 NAME_light_texel(int i, int view), of lobe k > 0 (p, roughness, width of the view) at i = 2 k - 2 and its
    /// share at i = 2 k - 1, and from i = 2 `lobes` - 2 the albedos (`light_texels`).
    bool texels = false;
};

/// The text of `shading_code` with these functions of each model:
///   Vec3 NAME_environment(Vec3 wv)     the radiance that leaves towards the viewer under an environment, of which the
///                                      host supplies Vec3 NAME_radiance(Vec3 direction, float roughness); not for Metal,
///                                      where a function sees no textures but its arguments
///   Vec3 NAME_environment_sampled(Vec3 wv, int count)   the same by so many draws of NAME_sample, of an environment that is
///                                      not filtered for them: the host supplies Vec3 NAME_radiance_over(Vec3 direction,
///                                      float solid_angle), a look-up in its mip levels; not for Metal
///   LightDraw NAME_environment_draw(Vec3 wv, int i, int count)   one of them: direction, solid angle [sr], weight
///   Vec3 NAME_area(Vec3 wv, Vec3 a, Vec3 b, Vec3 c, Vec3 d)   the radiance that leaves towards the viewer from a
///                                      quadrilateral of radiance 1, of corners about the point
///   LightLobe NAME_environment_lobe(Vec3 wv, int k)   of the `lobes` terms of that sum one: axis, roughness and
///                                      weight, see extended_light.h
/// Errors: those of `shading_code`.
Result<std::string> environment_code(std::span<const NamedModel> models, std::string_view prefix,
                                     const CodeOptions& options, const EnvironmentCode& added);
/// The text of `map_code` with those but the draws, and the coefficients as last argument. Of the lobes of environments there
/// are J + 1, the cosine about the normal and one of each lobe. Errors: those of `map_code`.
Result<std::string> environment_map_code(const Library& map, std::string_view name, const CodeOptions& options,
                                         const EnvironmentCode& added);

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
