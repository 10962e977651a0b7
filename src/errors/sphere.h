// Pictures of a sphere, and the differences of two of them.
#pragma once
#include <span>
#include <string_view>
#include <vector>

#include "errors/picture.h"
#include "errors/picture_errors.h"

namespace [[gnu::visibility("default")]] srbf {

/// Light on a sphere by formula: a sky above a ground, both distant, and sources. World axes: +x to the right, +y up,
/// +z to the viewer.
struct Lighting {
    /// A disc of uniform radiance with a soft edge, or, with radius 0, a direction.
    struct Source {
        Vec3d direction;  ///< to the source, unit
        double radius;    ///< as seen from the sphere [degrees], below 90
        Rgb power;        ///< radiance; of a direction its irradiance, π for the radiance 1 from a white surface
    };
    std::string_view name;
    Rgb zenith, horizon, ground;  ///< radiance; between them it changes smoothly with height
    std::vector<Source> sources;
};
/// The radiance from direction w, without sources of radius 0.
Rgb radiance(const Lighting& lighting, Vec3d w);

/// Eight lightings of which none is used by a fit: `overcast`, `window`, `sunset`, `studio`; and each by one distant
/// light `flash` beside the viewer, `lamp`, `side`, and `back` behind the sphere.
std::span<const Lighting> standard_lightings();

inline constexpr int k_mirror_points = 384;
/// The radiance of a sphere seen from far away by direct light alone, at the centres of `size` × `size` pixels of which
/// it touches the border; 0 outside of it. The same directions for every BRDF: points of `MirrorMixture`, and points on
/// the sources, weighted by their common density (balance heuristic of Veach 1997), without random numbers. Pairs at
/// which one of the BRDFs is not measured count as black for all of them: [lighting][BRDF]. `first_is_isotropic`:
/// views of the same polar angle share its values.
std::vector<std::vector<Image>> sphere_pictures(std::span<const Evaluate> brdfs, std::span<const Lighting> lightings,
                                                int size = k_sphere_pixels, int threads = 0,
                                                const ProgressToken& progress = {}, int mirror_points = k_mirror_points,
                                                bool first_is_isotropic = false);
/// True if pixel (x, y) of such a picture shows the sphere.
bool shows_sphere(int size, int x, int y);

/// A picture is exposed so that the 90th percentile of its lit pixels, by their largest channel, is this share of
/// white.
inline constexpr double k_exposed_value = 0.75;

PictureErrors picture_errors(const Image& reference, const Image& other);

/// ΔE_ITP of two linear sRGB colours in [0,1]³, displayed with white at 100 cd/m²: 720 times the distance of (I, C_T/2,
/// C_P) of ITU-R BT.2100.
double delta_e_itp(const Rgb& a, const Rgb& b);

}  // namespace srbf
