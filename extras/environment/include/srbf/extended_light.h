// BRDFs under environments and area lights, as a few lobes for each view that hosts look up in filtered maps. Part
// of the target `srbf::srbf`.
#pragma once
#include <vector>

#include "srbf/prepared.h"

SRBF_BEGIN

/// The lobes of f(wl, wv) cosθl as a function of the light wl, for views wv at some cosines to the normal:
///   f cosθl ≈ Σ_k weight_k K(roughness_k, axis_k · wl)
///   axis_k = (−p_k wv.x, −p_k wv.y, √(1 − p_k² (1 − wv.z²)))
/// K is the kernel of a filtered environment map, so that the light that leaves towards wv is a sum of look-ups,
/// Σ_k weight_k radiance(axis_k, roughness_k). At the roughness r of one of the map's `k_levels` levels
/// (MapLevels), it is the filter that engines use for GGX with this roughness viewed along the normal (Karis 2013),
///   K(r, c) ∝ c / (1 + α² − (1 − α²) c)² for c > 0 and 0 below, α = r², ∫ K dω = 1 [1/sr].
/// Between two levels it is linear in the level, like the look-up of a graphics library.
///
/// The axes lie in the plane of incidence: p = 1 is the mirror direction, 0 the normal, −1 the viewer. The first
/// lobe of each view is the cosine around the normal, p = 0 and r = 1, which is irradiance / π. Weights are
/// fractions, with sum 1, of the directional albedo, or of 1 if the BRDF reflects more. Some are negative, so that
/// the sum of look-ups can be negative in an environment that is dark except for a few lights; it then counts as 0.
struct ExtendedLight {
    static constexpr int k_views = 32;
    struct Lobe {
        float axis;       ///< p
        float roughness;  ///< r, from `k_min_roughness` to 1
        Rgb weight;       ///< fraction of the albedo
    };
    static constexpr float k_min_roughness = 0.05f;
    static constexpr int k_levels = 6;  ///< number of levels of a filtered map
    int lobes = 0;
    std::vector<Lobe> lobe;  ///< k_views × lobes, the views from the horizon to the normal
    /// ∫ f cosθl dωl / max f cosθl of each view [sr], in the mean of R, G, B. A light that covers much less of the
    /// hemisphere is evaluated at points of it.
    std::vector<float> width;
    PreparedBrdf brdf;  ///< the BRDF whose albedos the fractions refer to

    /// cosθv of a node: nodes are uniform in ∜cosθv − √(1 − cosθv), like those of directional albedo.
    static double cosine(int node);
};
/// The lobes of a view: p, r and fractions are linear in the coordinate of the nodes. Requires 0 < cos_v ≤ 1.
std::vector<ExtendedLight::Lobe> lobes_at(const ExtendedLight& light, float cos_v);
/// The axis of a lobe for a view.
Vec3f axis_of(const ExtendedLight::Lobe& lobe, const Vec3f& wv);
/// The roughnesses for which a filtered map has levels: level = (k_levels − 1) x.
enum class MapLevels {
    root,  ///< x = √r, r = 0, 0.04, 0.16, 0.36, 0.64, 1
    /// x = r (2 − r), r = 0, 0.11, 0.23, 0.37, 0.55, 1: those of three.js 187 for environments up to 2047 × 1023
    three
};
double level_of_roughness(double roughness, MapLevels levels = MapLevels::root);
double roughness_of_level(double level, MapLevels levels = MapLevels::root);
/// K(r, c) [1/sr].
float filter_kernel(float roughness, float cosine, MapLevels levels = MapLevels::root);

inline constexpr int k_min_extended_lobes = 2, k_max_extended_lobes = 8;
struct ExtendedLightOptions {
    int lobes = 6;          ///< including the cosine, from `k_min_extended_lobes` to `k_max_extended_lobes`
    bool isotropic = true;  ///< false: lobes of the BRDF's mean over azimuths
    MapLevels levels = MapLevels::root;
    bool fixed = false;  ///< the roughness of a lobe is the same for all views
    int threads = 0;     ///< number of threads; 0: all of the machine. The result does not depend on it
};
/// The lobes of a BRDF. The fit minimises the error under lights of several sizes everywhere, relative to the
/// radiance under them.
ExtendedLight extended_light(const PreparedBrdf& brdf, const ExtendedLightOptions& options = {});

/// The lobes of sums Σ_j β_j E_j of the lobes E_j of a model, for any β_j (the texels of a map). They share axes and
/// roughnesses, and the weights are linear in β_j: weight_k = Σ_j β_j weight_jk. That of the first lobe, the cosine, is
/// the albedo minus all others.
struct SharedLight {
    struct Shape {
        float axis, roughness;
    };
    int lobes = 0;              ///< K, including the cosine
    std::vector<Shape> shape;   ///< k_views × (K − 1), for k > 0
    std::vector<float> weight;  ///< k_views × (K − 1) × J: weight_jk, for β_j = 1
    std::vector<float> width;   ///< least width of the lobes of each view [sr]
};
/// The axes and roughnesses are those of `extended_light` for `model`, and the weights minimise errors relative to its
/// radiance: its coefficients are therefore typical ones.
SharedLight shared_light(const PmModel& model, const ExtendedLightOptions& options = {});

SRBF_END
