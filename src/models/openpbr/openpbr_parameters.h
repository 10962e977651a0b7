// The parameters of surfaces: names, ranges, and which are stored.
#pragma once
#include <array>
#include <cstddef>
#include <optional>

#include "models/kind/numbers.h"
#include "srbf/models/openpbr.h"

SRBF_BEGIN

using OpenPbrParameter = Member<OpenPbrModel>;
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
/// True if a parameter is stored. Parameters of a film are stored if there is one, parameters of anisotropy likewise.
constexpr bool is_stored(const OpenPbrModel& model, const OpenPbrParameter& row) {
    if (row.name.starts_with("thin_film_")) return model.thin_film_weight > 0;
    const bool is_of_anisotropy = row.name == "specular_roughness_anisotropy" || row.name == "specular_rotation";
    return !is_of_anisotropy || model.specular_roughness_anisotropy > 0;
}

inline constexpr std::array<std::string_view, 3> k_openpbr_surfaces{"openpbr", "gltf", "principled"};
constexpr std::string_view name(OpenPbrSurfaceKind kind) { return k_openpbr_surfaces[std::size_t(kind)]; }
std::optional<OpenPbrSurfaceKind> openpbr_surface_named(std::string_view name);

SRBF_END
