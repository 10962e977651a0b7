// Evaluation of surfaces of renderers' parameters on arrays of pairs, in SIMD batches.
#include <cstdint>
#include <utility>

#include "models/openpbr/openpbr_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "models/openpbr/evaluate_openpbr.cpp"
#include <hwy/foreach_target.h>

#include "base/floating_point.h"
#include "brdf/batch-inl.h"
#include "models/openpbr/openpbr_functions.h"

HWY_BEFORE_NAMESPACE();
namespace srbf {
namespace HWY_NAMESPACE {

using Formula = Formulas<Batch, PmModel>;
HWY_INLINE Batch spread(float x) { return Batch(double(x)); }
HWY_INLINE Vec3<Batch> spread(const Vec3f& c) { return {spread(c.x), spread(c.y), spread(c.z)}; }
HWY_INLINE Formula::OpenPbrSurface spread(const Kernel<float>::OpenPbrSurface& of) {
    return {spread(of.base_color),      spread(of.base_metalness), spread(of.base_diffuse_roughness),
            spread(of.specular_weight), spread(of.specular_color), spread(of.specular_roughness),
            spread(of.specular_ior),    spread(of.coat_weight),    spread(of.coat_color),
            spread(of.coat_roughness),  spread(of.coat_ior),       spread(of.coat_darkening),
            spread(of.fuzz_weight),     spread(of.fuzz_color),     spread(of.fuzz_roughness)};
}
HWY_INLINE Formula::OpenPbrFilm spread(const Kernel<float>::OpenPbrFilm& of) {
    return {spread(of.weight), spread(of.thickness), spread(of.ior)};
}
HWY_INLINE Formula::OpenPbrAnisotropy spread(const Kernel<float>::OpenPbrAnisotropy& of) {
    return {spread(of.amount), spread(of.cosine), spread(of.sine)};
}

void evaluate_surface(const OpenPbrModel& model, const Vec3f* wl, const Vec3f* wv, Rgb* f, std::size_t count) {
    const auto surface = spread(kernel_surface(model));
    const auto film = spread(kernel_film(model));
    const auto anisotropy = spread(kernel_anisotropy(model));
    if (model.specular_roughness_anisotropy > 0)
        evaluate_pairs(wl, wv, f, count, [&](Vec3<Batch> l, Vec3<Batch> v) HWY_ATTR {
            return Formula::openpbr_anisotropic_value(surface, film, anisotropy, l, v);
        });
    else if (model.thin_film_weight > 0)
        evaluate_pairs(wl, wv, f, count, [&](Vec3<Batch> l, Vec3<Batch> v) HWY_ATTR {
            return Formula::openpbr_film_value(surface, film, l, v);
        });
    else
        evaluate_pairs(wl, wv, f, count,
                       [&](Vec3<Batch> l, Vec3<Batch> v) HWY_ATTR { return Formula::openpbr_value(surface, l, v); });
}

}  // namespace HWY_NAMESPACE
}  // namespace srbf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace srbf {

HWY_EXPORT(evaluate_surface);

void evaluate(const OpenPbrModel& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
    const StandardArithmetic mode;
    require_equal_lengths(wl.size(), wv.size(), f.size());
    if (model.is_exchanged) std::swap(wl, wv);
    HWY_DYNAMIC_DISPATCH(evaluate_surface)(model, wl.data(), wv.data(), f.data(), f.size());
}

}  // namespace srbf
#endif
