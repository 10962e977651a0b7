// Surfaces by the parameters that renderers share.
#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "srbf/brdf.h"

namespace [[gnu::visibility("default")]] srbf {

/// The parameters of OpenPBR Surface 1.1 that an opaque surface has, with the specification's names and defaults
/// (Academy Software Foundation 2025): fuzz over a coat over a base that blends a metal with a dielectric over rough
/// diffuse reflection. Evaluated by `openpbr_value` of kernel.glsl. Where the specification leaves a choice, layers
/// scale what lies below by their directional albedo at the viewer, so that the surface is not reciprocal. Of the
/// parameters of a base under a coat, the base's index of refraction is relative to the coat's. Colours are linear, in
/// Rec.709 primaries. `write_model` describes the file encoding.
struct OpenPbrModel {
    float base_weight = 1;
    Rgb base_color{0.8f, 0.8f, 0.8f};  ///< albedo of the diffuse part, F0 of the metal
    float base_metalness = 0;
    float base_diffuse_roughness = 0;  ///< of EON
    float specular_weight = 1;         ///< scales F0 of the dielectric, and the metal
    Rgb specular_color{1, 1, 1};       ///< of the dielectric; of the metal the tint at 82°
    float specular_roughness = 0.3f;   ///< the root of α
    float specular_ior = 1.5f;
    float coat_weight = 0;
    Rgb coat_color{1, 1, 1};  ///< passes twice through the coat
    float coat_roughness = 0;
    float coat_ior = 1.6f;
    float coat_darkening = 1;  ///< share of the light lost between base and coat
    float fuzz_weight = 0;
    Rgb fuzz_color{1, 1, 1};
    float fuzz_roughness = 0.5f;
    float thin_film_weight = 0;        ///< of the base that the film covers; see `film_reflectance` of kernel.glsl
    float thin_film_thickness = 0.5f;  ///< [1e-6 m]
    float thin_film_ior = 1.4f;
    float specular_roughness_anisotropy = 0;  ///< see `openpbr_anisotropic_value` of kernel.glsl
    float specular_rotation = 0;              ///< of the tangent, along which facets are rougher, from x to y [turns]
    bool is_exchanged = false;                ///< light and viewer: ρ(wl, wv) is the formula's of (wv, wl)
    friend bool operator==(const OpenPbrModel&, const OpenPbrModel&) = default;
};

/// A parameter of `OpenPbrModel`: its name, its range, and which member it is.
struct OpenPbrParameter {
    std::string_view name;
    float least, most;
    float OpenPbrModel::*number = nullptr;  ///< or
    Rgb OpenPbrModel::*colour = nullptr;
    constexpr int count() const { return colour ? 3 : 1; }
};
inline constexpr std::array<OpenPbrParameter, 21> k_openpbr_parameters{{
    {"base_weight", 0, 1, &OpenPbrModel::base_weight},
    {"base_color", 0, 1, nullptr, &OpenPbrModel::base_color},
    {"base_metalness", 0, 1, &OpenPbrModel::base_metalness},
    {"base_diffuse_roughness", 0, 1, &OpenPbrModel::base_diffuse_roughness},
    {"specular_weight", 0, 1, &OpenPbrModel::specular_weight},
    {"specular_color", 0, 1, nullptr, &OpenPbrModel::specular_color},
    {"specular_roughness", 0, 1, &OpenPbrModel::specular_roughness},
    {"specular_ior", 1, 3, &OpenPbrModel::specular_ior},
    {"coat_weight", 0, 1, &OpenPbrModel::coat_weight},
    {"coat_color", 0, 1, nullptr, &OpenPbrModel::coat_color},
    {"coat_roughness", 0, 1, &OpenPbrModel::coat_roughness},
    {"coat_ior", 1, 3, &OpenPbrModel::coat_ior},
    {"coat_darkening", 0, 1, &OpenPbrModel::coat_darkening},
    {"fuzz_weight", 0, 1, &OpenPbrModel::fuzz_weight},
    {"fuzz_color", 0, 1, nullptr, &OpenPbrModel::fuzz_color},
    {"fuzz_roughness", 0, 1, &OpenPbrModel::fuzz_roughness},
    {"thin_film_weight", 0, 1, &OpenPbrModel::thin_film_weight},
    {"thin_film_thickness", 0, 1, &OpenPbrModel::thin_film_thickness},
    {"thin_film_ior", 1, 3, &OpenPbrModel::thin_film_ior},
    {"specular_roughness_anisotropy", 0, 1, &OpenPbrModel::specular_roughness_anisotropy},
    {"specular_rotation", 0, 1, &OpenPbrModel::specular_rotation},
}};
/// Number c of a parameter, 0 ≤ c < count.
inline float& number(OpenPbrModel& model, const OpenPbrParameter& of, int c) {
    return of.colour ? (model.*of.colour)[c] : model.*of.number;
}
inline float number(const OpenPbrModel& model, const OpenPbrParameter& of, int c) {
    return of.colour ? (model.*of.colour)[c] : model.*of.number;
}
/// True if a parameter is stored: those of a film and of anisotropy only if there is one.
constexpr bool is_stored(const OpenPbrModel& model, const OpenPbrParameter& of) {
    if (of.name.starts_with("thin_film_")) return model.thin_film_weight > 0;
    const bool is_of_anisotropy = of.name == "specular_roughness_anisotropy" || of.name == "specular_rotation";
    return !is_of_anisotropy || model.specular_roughness_anisotropy > 0;
}
/// How many numbers a model has.
constexpr std::size_t openpbr_number_count(const OpenPbrModel& model) {
    std::size_t count = 0;
    for (const OpenPbrParameter& of : k_openpbr_parameters) count += is_stored(model, of) ? std::size_t(of.count()) : 0;
    return count;
}

/// The surface models that a fit may be restricted to: the parameters that each has, at their other defaults.
enum class OpenPbrSurfaceKind {
    openpbr,     ///< all of them
    gltf,        ///< glTF 2.0 with its extensions for specular, ior, clearcoat, sheen, iridescence and anisotropy
    principled,  ///< Blender's Principled BSDF
};
inline constexpr std::array<std::string_view, 3> k_openpbr_surfaces{"openpbr", "gltf", "principled"};
constexpr std::string_view name(OpenPbrSurfaceKind kind) { return k_openpbr_surfaces[std::size_t(kind)]; }
std::optional<OpenPbrSurfaceKind> openpbr_surface_named(std::string_view name);

/// A request for its fit.
struct OpenPbrRequest {
    using Model = OpenPbrModel;
    static constexpr std::string_view k_name = "openpbr";
    static constexpr std::string_view k_about = "a surface by the parameters of OpenPBR, which renderers share";
    OpenPbrSurfaceKind surface = {};  ///< whose parameters are fitted; others keep their defaults
};

/// ρ(wl, wv) in single precision; 0 below the horizon.
Rgb value(const OpenPbrModel& model, Vec3f wl, Vec3f wv);
/// f[i] = value(model, wl[i], wv[i]). The spans have the same length.
void evaluate(const OpenPbrModel& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f);
/// `model` as an `Evaluate`. It keeps a reference to `model`.
Evaluate evaluator(const OpenPbrModel& model);

/// Isotropy, and the exchange of light and viewer, as of a `Model` (model.h).
inline bool is_isotropic(const OpenPbrModel& model) { return model.specular_roughness_anisotropy == 0; }
inline void exchange(OpenPbrModel& model) { model.is_exchanged = !model.is_exchanged; }

/// Size of the stored numbers, two bytes each.
constexpr std::size_t payload_bytes(const OpenPbrModel& model) { return 2 * openpbr_number_count(model); }
constexpr std::size_t auxiliary_bytes(const OpenPbrModel&) { return 0; }
/// `model` with every number rounded to its stored precision.
OpenPbrModel rounded(const OpenPbrModel& model);

}  // namespace srbf
