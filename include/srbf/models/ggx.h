// Lambert and GGX, the baseline model.
#pragma once
#include <string_view>
#include <vector>

#include "srbf/brdf.h"

SRBF_BEGIN

/// A diffuse term and one or two microfacet lobes, isotropic and reciprocal:
///   ρ(wl,wv) = kd/π + Σ_i D_i G_i (F0_i + (F90_i − F0_i)(1 − l·h)⁵) / (4 cosθl cosθv) [1/sr],
/// with the GGX distribution D and the height-correlated masking-shadowing function G of roughness α_i (Walter et al.
/// 2007, Heitz 2014), and Schlick's Fresnel term. See `ggx_value` of kernel.glsl. docs/formats.md describes the
/// file encoding.
struct GgxModel {
    struct Lobe {
        float roughness = 1;  ///< α, k_min_roughness..1
        Rgb f0;               ///< F0 ≥ 0
        float f90 = 0;        ///< F90 ≥ 0, the same for all channels
        friend bool operator==(const Lobe&, const Lobe&) = default;
    };
    Rgb diffuse;              ///< kd ≥ 0
    std::vector<Lobe> lobes;  ///< 1..k_max_ggx_lobes
    friend bool operator==(const GgxModel&, const GgxModel&) = default;
};
inline constexpr int k_max_ggx_lobes = 2;
inline constexpr float k_min_roughness = 1.f / 1024;

/// A request for the fit of Lambert and GGX.
struct GgxRequest {
    using Model = GgxModel;
    static constexpr std::string_view k_name = "ggx", k_about = "Lambert and GGX, the baseline";
    int lobes = 1;  ///< 1..k_max_ggx_lobes
};

/// ρ(wl, wv) in single precision; 0 below the horizon.
Rgb value(const GgxModel& model, Vec3f wl, Vec3f wv);
/// `model` as an `Evaluate`. It keeps a reference to `model`.
Evaluate evaluator(const GgxModel& model);

SRBF_END
