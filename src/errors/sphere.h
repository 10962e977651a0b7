// Pictures of a sphere, and their errors.
#pragma once
#include "errors/picture.h"
#include "errors/picture_errors.h"

SRBF_BEGIN

/// Distant light on a sphere: a sky, a ground, and sources. World axes: +x to the right, +y up, +z to the viewer.
struct Lighting {
    /// A disc of uniform radiance with a soft edge, or, with radius 0, a directional light.
    struct Source {
        Vec3d direction;  ///< unit vector to the source
        double radius;    ///< angular radius [degrees], below 90
        Rgb power;        ///< radiance, or irradiance of a directional light: π gives a white surface the radiance 1
    };
    std::string_view name;
    Rgb zenith, horizon, ground;  ///< radiance; between them it changes smoothly with height
    std::vector<Source> sources;
};
/// The radiance from direction w, without sources of radius 0.
Rgb radiance(const Lighting& lighting, Vec3d w);
/// The fractions of zenith, horizon and ground in the radiance of any sky from a direction with y = `height`.
Vec3d sky_fractions(double height);

/// Eight lightings that no fit uses: `overcast`, `window`, `sunset`, `studio`; and four of one directional light each:
/// `flash` beside the viewer, `lamp`, `side`, and `back` behind the sphere.
std::span<const Lighting> standard_lightings();

inline constexpr int k_mirror_points = 384;
/// Pictures [lighting][BRDF] of a distant sphere in direct light, which touches the borders of `size` × `size` pixels;
/// 0 outside of the sphere. All BRDFs are evaluated at the same directions: points of `MirrorMixture` and points on the
/// sources, weighted by their common density (balance heuristic, Veach 1997), without random numbers. Pairs at which
/// one of the BRDFs is not measured count as black for all of them. If `is_isotropic`, all BRDFs are, and views of the
/// same polar angle share their values, which saves most of the time.
std::vector<std::vector<Image>> sphere_pictures(std::span<const Evaluate> brdfs, std::span<const Lighting> lightings,
                                                int size = k_sphere_pixels, int threads = 0,
                                                const ProgressToken& progress = {}, int mirror_points = k_mirror_points,
                                                bool is_isotropic = false);
/// True if pixel (x, y) of such a picture shows the sphere.
bool shows_sphere(int size, int x, int y);

/// `exposure_to` maps the quantile of a picture to this fraction of white.
inline constexpr double k_exposed_value = 0.75;

PictureErrors picture_errors(const Image& reference, const Image& other);

/// ΔE_ITP of two linear sRGB colours in [0,1]³, displayed with white at 100 cd/m²: 720 times the distance of (I, C_T/2,
/// C_P) of ITU-R BT.2100.
double delta_e_itp(const Rgb& a, const Rgb& b);

SRBF_END
