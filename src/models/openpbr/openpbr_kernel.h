// Surfaces as structures of kernel.glsl.
#pragma once
#include "srbf/elementary.h"
#include "srbf/kernel.h"
#include "srbf/models/openpbr.h"

namespace SRBF_NAMESPACE {

inline Kernel<float>::OpenPbrSurface kernel_surface(const OpenPbrModel& model) {
    const auto colour = [](const Rgb& c, float weight = 1) { return Vec3f{weight * c.r, weight * c.g, weight * c.b}; };
    return {colour(model.base_color, model.base_weight),
            model.base_metalness,
            model.base_diffuse_roughness,
            model.specular_weight,
            colour(model.specular_color),
            model.specular_roughness,
            model.specular_ior,
            model.coat_weight,
            colour(model.coat_color),
            model.coat_roughness,
            model.coat_ior,
            model.coat_darkening,
            model.fuzz_weight,
            colour(model.fuzz_color),
            model.fuzz_roughness};
}
inline Kernel<float>::OpenPbrFilm kernel_film(const OpenPbrModel& model) {
    return {model.thin_film_weight, model.thin_film_thickness, model.thin_film_ior};
}
inline Kernel<float>::OpenPbrAnisotropy kernel_anisotropy(const OpenPbrModel& model) {
    const double azimuth = 2 * k_pi * double(model.specular_rotation);
    return {model.specular_roughness_anisotropy, float(elementary::cos(azimuth)), float(elementary::sin(azimuth))};
}

}  // namespace
