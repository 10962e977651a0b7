#include <utility>

#include "models/openpbr/openpbr_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "models/openpbr/evaluate_openpbr.cpp"
#include <hwy/foreach_target.h>

#include "base/floating_point.h"
#include "brdf/batch-inl.h"

HWY_BEFORE_NAMESPACE();
namespace SRBF_NAMESPACE {
namespace HWY_NAMESPACE {

using Formula = Formulas<Batch, PmModel>;
HWY_INLINE Batch spread(float x) { return Batch(double(x)); }
HWY_INLINE Vec3<Batch> spread(const Vec3f& c) { return {spread(c.x), spread(c.y), spread(c.z)}; }
HWY_INLINE Formula::OpenPbrSurface spread(const Kernel<float>::OpenPbrSurface& surface) {
    return {spread(surface.base_color),      spread(surface.base_metalness), spread(surface.base_diffuse_roughness),
            spread(surface.specular_weight), spread(surface.specular_color), spread(surface.specular_roughness),
            spread(surface.specular_ior),    spread(surface.coat_weight),    spread(surface.coat_color),
            spread(surface.coat_roughness),  spread(surface.coat_ior),       spread(surface.coat_darkening),
            spread(surface.fuzz_weight),     spread(surface.fuzz_color),     spread(surface.fuzz_roughness)};
}
HWY_INLINE Formula::OpenPbrFilm spread(const Kernel<float>::OpenPbrFilm& film) {
    return {spread(film.weight), spread(film.thickness), spread(film.ior)};
}
HWY_INLINE Formula::OpenPbrAnisotropy spread(const Kernel<float>::OpenPbrAnisotropy& anisotropy) {
    return {spread(anisotropy.amount), spread(anisotropy.cosine), spread(anisotropy.sine)};
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
}  // namespace
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace SRBF_NAMESPACE {

HWY_EXPORT(evaluate_surface);

void evaluate(const OpenPbrModel& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
    const StandardArithmetic mode;
    require_equal_lengths(wl.size(), wv.size(), f.size());
    if (model.is_exchanged) std::swap(wl, wv);
    HWY_DYNAMIC_DISPATCH(evaluate_surface)(model, wl.data(), wv.data(), f.data(), f.size());
}

}  // namespace
#endif
