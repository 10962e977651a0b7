// A mock of those parts of pbrt-v4 that srbf_pbrt.h needs, for the test without pbrt. Do not copy it into pbrt.
#pragma once
#include <optional>
#include <string>

namespace pstd = std;
namespace pbrt {

using Float = float;
struct Point2f {
    Float x, y;
};
struct Vector3f {
    Float x, y, z;
    Vector3f(Float of_x, Float of_y, Float of_z) : x(of_x), y(of_y), z(of_z) {}
};
inline bool SameHemisphere(Vector3f w, Vector3f wp) { return w.z * wp.z > 0; }

/// Three wavelengths, at which the spectrum of a colour has its three values.
struct SampledWavelengths {};
struct RGB {
    Float channel[3];
    RGB(Float r, Float g, Float b) : channel{r, g, b} {}
    explicit RGB(Float grey) : channel{grey, grey, grey} {}
    Float operator[](int i) const { return channel[i]; }
};
using SampledSpectrum = RGB;
struct RGBColorSpace {
    static inline const RGBColorSpace* sRGB = nullptr;
};
struct RGBUnboundedSpectrum {
    RGB rgb;
    RGBUnboundedSpectrum(const RGBColorSpace&, RGB value) : rgb(value) {}
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
    BSDFSample(SampledSpectrum value, Vector3f to, Float density, BxDFFlags kind)
        : f(value), wi(to), pdf(density), flags(kind) {}
};

struct MaterialEvalContext {};
struct FloatTexture {};
class Image;
struct FileLoc {};
struct Allocator {
    template <typename T, typename... Arguments> T* new_object(Arguments... arguments) { return new T(arguments...); }
};
struct TextureParameterDictionary {
    std::string GetOneString(const std::string&, const std::string& otherwise) const { return otherwise; }
    bool GetOneBool(const std::string&, bool otherwise) const { return otherwise; }
    FloatTexture GetFloatTextureOrNull(const std::string&, Allocator) const { return {}; }
};
inline std::string ResolveFilename(const std::string& name) { return name; }
inline void ErrorExit(const FileLoc*, const char*, const std::string&) {}

}  // namespace pbrt
