// A model of srbf as a material of pbrt-v4: Material "srbf" "string filename" "film.srbf". C++17, and no header of srbf.
// It is for pbrt's CPU build, and was run in its commit 5f7a606; its GPU build is not supported. ball.pbrt is a scene.
// To add it to pbrt:
//   1. Copy srbf_plain.h, srbf_plain.cpp and this file into src/pbrt.
//   2. base/bxdf.h and base/material.h: declare `class SrbfBxDF;` and `class SrbfMaterial;` before `class BxDF` and
//      `class Material`, and add the names to the lists of types of their TaggedPointers.
//   3. bxdfs.h: `#include <pbrt/srbf_pbrt.h>` after the other headers.
//   4. materials.cpp, Material::Create: `else if (name == "srbf")
//      material = SrbfMaterial::Create(parameters, normalMap, loc, alloc);`
//   5. CMakeLists.txt, at the end; the library of its own keeps pbrt itself C++17:
//        find_package(srbf 0.1 REQUIRED)
//        add_library(srbf_plain STATIC src/pbrt/srbf_plain.cpp)
//        set_target_properties(srbf_plain PROPERTIES CXX_STANDARD 20)
//        target_link_libraries(srbf_plain PRIVATE srbf::srbf)
//        target_link_libraries(pbrt_lib PUBLIC srbf_plain)
//      Pass -DCMAKE_PREFIX_PATH=PREFIX to CMake if srbf is not installed in /usr/local or /usr.
#pragma once
#include <pbrt/base/bxdf.h>
#include <pbrt/base/material.h>
#include <pbrt/paramdict.h>
#include <pbrt/util/colorspace.h>
#include <pbrt/util/file.h>
#include <pbrt/util/spectrum.h>

#include <cmath>
#include <string>

#include "srbf_plain.h"

namespace pbrt {

/// pbrt's wo points to the viewer and its wi to the light. The TransportMode is not used, which is correct for
/// reciprocal models only: with a measurement, or with a model of `srbf fit --as-measured`, light paths of BDPT and SPPM
/// need the directions exchanged.
class SrbfBxDF {
  public:
    SrbfBxDF() = default;
    /// With `two_sided` the back shows the same material, as if the surface were mirrored in its plane; without it the
    /// back is black.
    SrbfBxDF(const srbf_plain::Brdf* brdf, const SampledWavelengths& lambda, bool two_sided)
        : brdf_(brdf), lambda_(lambda), two_sided_(two_sided) {}

    SampledSpectrum f(Vector3f wo, Vector3f wi, TransportMode) const {
        if (!reflects(wo, wi)) return SampledSpectrum(0.f);
        float f[3];
        srbf_plain::value(*brdf_, Front(wi).w, Front(wo).w, f);
        return spectrum(f);
    }
    pstd::optional<BSDFSample> Sample_f(Vector3f wo, Float uc, Point2f u, TransportMode,
                                        BxDFReflTransFlags flags) const {
        if (!(flags & BxDFReflTransFlags::Reflection) || !reflects(wo, wo)) return {};
        const float numbers[2] = {float(u.x), float(u.y)};
        float wl[3], f[3];
        const float density = srbf_plain::sample(*brdf_, Front(wo).w, float(uc), numbers, wl, f);
        if (!(density > 0)) return {};
        return BSDFSample(spectrum(f), Vector3f(wl[0], wl[1], std::copysign(wl[2], wo.z)), density, Flags());
    }
    Float PDF(Vector3f wo, Vector3f wi, TransportMode, BxDFReflTransFlags flags) const {
        if (!(flags & BxDFReflTransFlags::Reflection) || !reflects(wo, wi)) return 0;
        return srbf_plain::pdf(*brdf_, Front(wi).w, Front(wo).w);
    }
    BxDFFlags Flags() const { return BxDFFlags::GlossyReflection; }
    void Regularize() {}
    static constexpr const char* Name() { return "SrbfBxDF"; }
    std::string ToString() const { return two_sided_ ? "[ SrbfBxDF two-sided ]" : "[ SrbfBxDF one-sided ]"; }

  private:
    struct Front {
        float w[3];
        explicit Front(Vector3f v) : w{float(v.x), float(v.y), float(std::abs(v.z))} {}
    };
    bool reflects(Vector3f wo, Vector3f wi) const { return SameHemisphere(wo, wi) && (two_sided_ || wo.z > 0); }
    /// Linear sRGB at the wavelengths of the path. The spectrum is unbounded, since f may exceed 1.
    SampledSpectrum spectrum(const float f[3]) const {
        return RGBUnboundedSpectrum(*RGBColorSpace::sRGB, RGB(f[0], f[1], f[2])).Sample(lambda_);
    }
    const srbf_plain::Brdf* brdf_ = nullptr;
    SampledWavelengths lambda_;
    bool two_sided_ = true;
};

/// Parameters: `filename`, a model file or a measurement; `exchange`, false without it: light and viewer are exchanged,
/// as pbrt's `measured` has them of an RGL file; `twosided`, true without it; `displacement`.
class SrbfMaterial {
  public:
    using BxDF = SrbfBxDF;
    using BSSRDF = void;
    SrbfMaterial(const srbf_plain::Brdf* brdf, bool two_sided, FloatTexture displacement, Image* normal_map)
        : brdf_(brdf), two_sided_(two_sided), displacement_(displacement), normal_map_(normal_map) {}

    static SrbfMaterial* Create(const TextureParameterDictionary& parameters, Image* normal_map, const FileLoc* loc,
                                Allocator alloc) {
        std::string error;
        const std::string file = ResolveFilename(parameters.GetOneString("filename", ""));
        const srbf_plain::Brdf* brdf = srbf_plain::open(file, parameters.GetOneBool("exchange", false), error);
        if (!brdf) ErrorExit(loc, "%s", error);
        return alloc.new_object<SrbfMaterial>(brdf, parameters.GetOneBool("twosided", true),
                                              parameters.GetFloatTextureOrNull("displacement", alloc), normal_map);
    }
    // The context is taken by reference because this header does not define it.
    template <typename Evaluator>
    SrbfBxDF GetBxDF(Evaluator, const MaterialEvalContext&, SampledWavelengths& lambda) const {
        return SrbfBxDF(brdf_, lambda, two_sided_);
    }
    template <typename Evaluator>
    void GetBSSRDF(Evaluator, const MaterialEvalContext&, SampledWavelengths&, void*) const {}
    template <typename Evaluator> bool CanEvaluateTextures(Evaluator) const { return true; }
    FloatTexture GetDisplacement() const { return displacement_; }
    const Image* GetNormalMap() const { return normal_map_; }
    static constexpr bool HasSubsurfaceScattering() { return false; }
    static const char* Name() { return "SrbfMaterial"; }
    std::string ToString() const { return "[ SrbfMaterial ]"; }

  private:
    const srbf_plain::Brdf* brdf_;
    bool two_sided_;
    FloatTexture displacement_;
    Image* normal_map_;
};

}  // namespace pbrt
