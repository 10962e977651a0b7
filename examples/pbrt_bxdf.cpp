// A model as a BxDF of pbrt-v4, whose wo points to the viewer and wi to the light. The program samples it from both
// sides of a surface, and compares the mean of f cosθ / pdf with the albedo and each density with that of PDF.
//   pbrt_bxdf MODEL
// It compiles without pbrt, whose names then have the least definitions that the class needs. In pbrt put the class into
// a header and its functions into a file, and add it to the list of types of BxDF (pbrt/base/bxdf.h).
#if __cplusplus < 202002L
#error "srbf/srbf.h is C++20 and pbrt-v4 is C++17: compile this file alone with -std=c++20"
#endif
#include <cmath>
#include <cstdio>
#include <random>
#include <string>

#include "srbf/srbf.h"

#if __has_include(<pbrt/base/bxdf.h>)
#include <pbrt/base/bxdf.h>
#include <pbrt/util/colorspace.h>
#include <pbrt/util/spectrum.h>
#else
#include <optional>
namespace pstd = std;
namespace pbrt {
using Float = float;
struct Point2f {
    Float x, y;
};
struct Vector3f {
    Float x, y, z;
};
using RGB = srbf::Rgb;
using SampledSpectrum = RGB;  // at three wavelengths
struct SampledWavelengths {};
struct RGBColorSpace {
    inline static const RGBColorSpace* sRGB = nullptr;
};
struct RGBUnboundedSpectrum {
    RGB rgb;
    RGBUnboundedSpectrum(const RGBColorSpace&, RGB of) : rgb(of) {}
    SampledSpectrum Sample(const SampledWavelengths&) const { return rgb; }
};
enum class TransportMode { Radiance, Importance };
enum class BxDFReflTransFlags { Reflection = 1, All = 3 };
enum class BxDFFlags { GlossyReflection = 9 };
inline int operator&(BxDFReflTransFlags a, BxDFReflTransFlags b) { return int(a) & int(b); }
struct BSDFSample {
    SampledSpectrum f;
    Vector3f wi;
    Float pdf;
    BxDFFlags flags;
    BSDFSample(SampledSpectrum of, Vector3f to, Float density, BxDFFlags kind)
        : f(of), wi(to), pdf(density), flags(kind) {}
};
inline bool SameHemisphere(Vector3f w, Vector3f wp) { return w.z * wp.z > 0; }
}  // namespace pbrt
#endif

namespace pbrt {

// For a header of pbrt: C++17, which needs no header of srbf but the line `namespace srbf { class PreparedBrdf; }`.
class SrbfBxDF {
  public:
    /// With `two_sided` the back shows the same material, as if the surface were mirrored in its plane; without it the
    /// back is black. A surface with another material on its back needs a BxDF for each, chosen by the sign of wo.z.
    SrbfBxDF(const srbf::PreparedBrdf* brdf, const SampledWavelengths& lambda, bool two_sided = true)
        : brdf_(brdf), lambda_(lambda), two_sided_(two_sided) {}
    static constexpr const char* Name() { return "SrbfBxDF"; }
    BxDFFlags Flags() const { return BxDFFlags::GlossyReflection; }
    void Regularize() {}
    std::string ToString() const;
    SampledSpectrum f(Vector3f wo, Vector3f wi, TransportMode mode) const;
    pstd::optional<BSDFSample> Sample_f(Vector3f wo, Float uc, Point2f u, TransportMode mode = TransportMode::Radiance,
                                        BxDFReflTransFlags of = BxDFReflTransFlags::All) const;
    Float PDF(Vector3f wo, Vector3f wi, TransportMode mode = TransportMode::Radiance,
              BxDFReflTransFlags of = BxDFReflTransFlags::All) const;

  private:
    bool reflects(Vector3f wo, Vector3f wi) const { return SameHemisphere(wo, wi) && (two_sided_ || wo.z > 0); }
    const srbf::PreparedBrdf* brdf_;
    SampledWavelengths lambda_;
    bool two_sided_;
};

// For a file of pbrt that is compiled as C++20.
static srbf::Vec3f front(Vector3f w) { return {w.x, w.y, std::abs(w.z)}; }

// Linear sRGB at the wavelengths of the path. The spectrum is unbounded, since f may exceed 1.
static SampledSpectrum spectrum(srbf::Rgb f, const SampledWavelengths& lambda) {
    return RGBUnboundedSpectrum(*RGBColorSpace::sRGB, RGB{f.r, f.g, f.b}).Sample(lambda);
}

std::string SrbfBxDF::ToString() const {
    return std::string("[ SrbfBxDF two_sided: ") + (two_sided_ ? "true ]" : "false ]");
}

SampledSpectrum SrbfBxDF::f(Vector3f wo, Vector3f wi, TransportMode) const {
    return spectrum(reflects(wo, wi) ? value(*brdf_, front(wi), front(wo)) : srbf::Rgb{}, lambda_);
}

pstd::optional<BSDFSample> SrbfBxDF::Sample_f(Vector3f wo, Float uc, Point2f u, TransportMode,
                                              BxDFReflTransFlags of) const {
    if (!(of & BxDFReflTransFlags::Reflection) || !reflects(wo, wo)) return {};
    const srbf::LightSample light = sample(*brdf_, front(wo), {u.x, u.y}, uc);
    if (!(light.pdf > 0)) return {};
    const float scale = light.pdf / light.wl.z;  // of the weight f cosθ / pdf, to f
    const srbf::Rgb f{scale * light.weight.r, scale * light.weight.g, scale * light.weight.b};
    const Vector3f wi{light.wl.x, light.wl.y, std::copysign(light.wl.z, wo.z)};
    return BSDFSample(spectrum(f, lambda_), wi, light.pdf, BxDFFlags::GlossyReflection);
}

Float SrbfBxDF::PDF(Vector3f wo, Vector3f wi, TransportMode, BxDFReflTransFlags of) const {
    return of & BxDFReflTransFlags::Reflection && reflects(wo, wi) ? pdf(*brdf_, front(wi), front(wo)) : 0;
}

}  // namespace pbrt

int main(int count, char** arguments) {
    using namespace pbrt;
    if (count != 2) return std::puts("usage: pbrt_bxdf MODEL"), 2;
    const auto model = srbf::load(arguments[1]);
    if (!model) return std::puts(message(model.error()).c_str()), 1;
    const srbf::PreparedBrdf brdf = prepare(*model);
    const SrbfBxDF bxdf(&brdf, SampledWavelengths()), one_sided(&brdf, SampledWavelengths(), false);
    std::mt19937 random(1);
    std::uniform_real_distribution<float> uniform(0.f, 0.99999994f);
    bool agree =
        !one_sided.Sample_f({0.6f, 0, -0.8f}, 0.5f, {0.3f, 0.7f}, TransportMode::Radiance, BxDFReflTransFlags::All);
    for (const float z : {0.8f, -0.8f}) {
        const Vector3f wo{0.6f, 0, z};
        double sum = 0, error = 0;
        constexpr int k_samples = 100000;
        for (int i = 0; i < k_samples; ++i) {
            const float uc = uniform(random), u = uniform(random), v = uniform(random);
            const auto s = bxdf.Sample_f(wo, uc, {u, v}, TransportMode::Radiance, BxDFReflTransFlags::All);
            if (!s) continue;
            const float density = bxdf.PDF(wo, s->wi, TransportMode::Radiance, BxDFReflTransFlags::All);
            sum += double(s->f[1] * std::abs(s->wi.z) / s->pdf);
            error = std::fmax(error, std::fabs(double(density / s->pdf) - 1));
        }
        const double mean = sum / k_samples, expected = double(albedo(brdf, std::abs(z)).g);
        std::printf("%s from z = %g: mean f cos / pdf %.4f, albedo %.4f\n", bxdf.ToString().c_str(), double(z), mean,
                    expected);
        agree = agree && std::fabs(mean - expected) < 0.03 * expected && error < 1e-3;
    }
    return agree ? 0 : 1;
}
