// Surfaces by the parameters that renderers share.
#pragma once
#include <string_view>

#include "srbf/brdf.h"

SRBF_BEGIN

/// The parameters of OpenPBR Surface 1.1 that an opaque surface has, with the specification's names and defaults
/// (Academy Software Foundation 2025): fuzz over a coat over a base that blends a metal with a dielectric over rough
/// diffuse reflection. Evaluated by `openpbr_value` of kernel.glsl. Where the specification leaves a choice, layers
/// scale what lies below by their directional albedo at the viewer, so that the surface is not reciprocal. Of the
/// parameters of a base under a coat, the base's index of refraction is relative to the coat's. Colours are linear, in
/// Rec.709 primaries. docs/formats.md describes the file encoding.
struct OpenPbrModel {
    float base_weight = 1;
    Rgb base_color{0.8f, 0.8f, 0.8f};  ///< albedo of the diffuse part, F0 of the metal
    float base_metalness = 0;
    float base_diffuse_roughness = 0;  ///< roughness of EON, the diffuse reflection
    float specular_weight = 1;         ///< scales F0 of the dielectric, and the metal
    Rgb specular_color{1, 1, 1};       ///< colour of the dielectric's reflection; tint of the metal at 82°
    float specular_roughness = 0.3f;   ///< the root of α
    float specular_ior = 1.5f;
    float coat_weight = 0;
    Rgb coat_color{1, 1, 1};  ///< colour of light that passes twice through the coat
    float coat_roughness = 0;
    float coat_ior = 1.6f;
    float coat_darkening = 1;  ///< share of the light lost between base and coat
    float fuzz_weight = 0;
    Rgb fuzz_color{1, 1, 1};
    float fuzz_roughness = 0.5f;
    float thin_film_weight = 0;  ///< fraction of the base that the film covers; see `film_reflectance` of kernel.glsl
    float thin_film_thickness = 0.5f;  ///< [1e-6 m]
    float thin_film_ior = 1.4f;
    float specular_roughness_anisotropy = 0;  ///< see `openpbr_anisotropic_value` of kernel.glsl
    float specular_rotation = 0;  ///< angle from x to y of the tangent, along which facets are rougher [turns]
    bool is_exchanged = false;    ///< true if light and viewer are exchanged: ρ(wl, wv) is the formula at (wv, wl)
    friend bool operator==(const OpenPbrModel&, const OpenPbrModel&) = default;
};

/// The surface models that a fit may be restricted to: the parameters that each has, at their other defaults.
enum class OpenPbrSurfaceKind {
    openpbr,     ///< all of them
    gltf,        ///< glTF 2.0 with its extensions for specular, ior, clearcoat, sheen, iridescence and anisotropy
    principled,  ///< Blender's Principled BSDF
};

/// A request for the fit of a surface.
struct OpenPbrRequest {
    using Model = OpenPbrModel;
    static constexpr std::string_view k_name = "openpbr";
    static constexpr std::string_view k_about = "a surface by the parameters of OpenPBR, which renderers share";
    OpenPbrSurfaceKind surface = {};  ///< the surface whose parameters are fitted; others keep their defaults
};

/// ρ(wl, wv) in single precision; 0 below the horizon.
Rgb value(const OpenPbrModel& model, Vec3f wl, Vec3f wv);
/// `model` as an `Evaluate`. It keeps a reference to `model`.
Evaluate evaluator(const OpenPbrModel& model);

SRBF_END
