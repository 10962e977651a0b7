// Evaluation of surfaces of renderers' parameters on arrays of pairs, in SIMD batches.
#include <cassert>
#include <cstdint>
#include <utility>

#include "model/pbr_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "model/evaluate_pbr.cpp"
#include <hwy/foreach_target.h>

#include "batch-inl.h"
#include "floating_point.h"

HWY_BEFORE_NAMESPACE();
namespace srbf {
namespace HWY_NAMESPACE {

using Formula = Formulas<Batch, PmModel>;
HWY_INLINE Batch spread(float x) { return Batch(double(x)); }
HWY_INLINE Vec3<Batch> spread(const Vec3f& c) { return {spread(c.x), spread(c.y), spread(c.z)}; }
HWY_INLINE Formula::PbrSurface spread(const Kernel<float>::PbrSurface& of) {
    return {spread(of.base_color),      spread(of.metalness),      spread(of.diffuse_roughness),
            spread(of.specular_weight), spread(of.specular_color), spread(of.specular_roughness),
            spread(of.specular_ior),    spread(of.coat_weight),    spread(of.coat_color),
            spread(of.coat_roughness),  spread(of.coat_ior),       spread(of.coat_darkening),
            spread(of.fuzz_weight),     spread(of.fuzz_color),     spread(of.fuzz_roughness)};
}
HWY_INLINE Formula::PbrFilm spread(const Kernel<float>::PbrFilm& of) {
    return {spread(of.weight), spread(of.thickness), spread(of.ior)};
}

template <bool has_film>
HWY_INLINE void evaluate_as(const PbrModel& model, const Vec3f* wl, const Vec3f* wv, Rgb* f, std::size_t count) {
    const auto surface = spread(kernel_surface(model));
    [[maybe_unused]] const auto film = spread(kernel_film(model));
    const Interleaved interleaved;
    const Batch zero(0.0);
    in_whole_batches(Batch::size(), wl, wv, f, count,
                     [&](const Vec3f* from_wl, const Vec3f* from_wv, Rgb* to, std::size_t n) HWY_ATTR {
                         for (std::size_t i = 0; i < n; i += Batch::size()) {
                             const Vec3<Batch> l = interleaved.load(&from_wl[i].x), v = interleaved.load(&from_wv[i].x);
                             Vec3<Batch> value;
                             if constexpr (has_film)
                                 value = Formula::pbr_film_value(surface, film, l, v);
                             else
                                 value = Formula::pbr_value(surface, l, v);
                             const BatchMask above = zero < min(l.z, v.z);
                             interleaved.store({select(above, value.x, zero), select(above, value.y, zero),
                                                select(above, value.z, zero)},
                                               &to[i].r);
                         }
                     });
}

void evaluate_surface(const PbrModel& model, const Vec3f* wl, const Vec3f* wv, Rgb* f, std::size_t count) {
    if (model.thin_film_weight > 0)
        evaluate_as<true>(model, wl, wv, f, count);
    else
        evaluate_as<false>(model, wl, wv, f, count);
}

}  // namespace HWY_NAMESPACE
}  // namespace srbf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace srbf {

HWY_EXPORT(evaluate_surface);

void evaluate(const PbrModel& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
    const StandardArithmetic mode;
    assert(wl.size() == wv.size() && wl.size() == f.size());
    if (model.is_exchanged) std::swap(wl, wv);
    HWY_DYNAMIC_DISPATCH(evaluate_surface)(model, wl.data(), wv.data(), f.data(), f.size());
}

}  // namespace srbf
#endif
