// A model on arrays of pairs: the formulas of kernel.glsl on batches as wide as the machine's vectors.
#include <algorithm>
#include <cassert>

#include "srbf/model.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "model/evaluate.cpp"
#include <hwy/foreach_target.h>

#include "batch-inl.h"
#include "floating_point.h"

HWY_BEFORE_NAMESPACE();
namespace srbf {
namespace HWY_NAMESPACE {

// Two batches at once: a machine that waits for the one has the other to work on.
struct Both {
    Batch a, b;
    Both() = default;
    HWY_INLINE Both(Batch a_, Batch b_) : a(a_), b(b_) {}
    HWY_INLINE explicit Both(double x) : a(x), b(x) {}
};
struct BothMasks {
    BatchMask a, b;
};
HWY_INLINE Both product(Both x, Both y) { return {product(x.a, y.a), product(x.b, y.b)}; }
HWY_INLINE Both multiply_add(Both x, Both y, Both z) {
    return {multiply_add(x.a, y.a, z.a), multiply_add(x.b, y.b, z.b)};
}
HWY_INLINE Both multiply_subtract(Both x, Both y, Both z) {
    return {multiply_subtract(x.a, y.a, z.a), multiply_subtract(x.b, y.b, z.b)};
}
HWY_INLINE Both subtract_product(Both z, Both x, Both y) {
    return {subtract_product(z.a, x.a, y.a), subtract_product(z.b, x.b, y.b)};
}
HWY_INLINE Both operator+(Both x, Both y) { return {x.a + y.a, x.b + y.b}; }
HWY_INLINE Both operator-(Both x, Both y) { return {x.a - y.a, x.b - y.b}; }
HWY_INLINE Product<Both> operator*(Both x, Both y) { return {x, y}; }
HWY_INLINE Scaled<Both> operator*(Both s, Vec3<Both> v) { return {s, v}; }
HWY_INLINE Both operator/(Both x, Both y) { return {x.a / y.a, x.b / y.b}; }
HWY_INLINE Both operator-(Both x) { return {-x.a, -x.b}; }
HWY_INLINE BothMasks operator<(Both x, Both y) { return {x.a < y.a, x.b < y.b}; }
HWY_INLINE Both exp(Both x) { return {exp(x.a), exp(x.b)}; }
HWY_INLINE Both exp2(Both x) { return {exp2(x.a), exp2(x.b)}; }
HWY_INLINE Both log(Both x) { return {log(x.a), log(x.b)}; }
HWY_INLINE Both sqrt(Both x) { return {sqrt(x.a), sqrt(x.b)}; }
HWY_INLINE Both inversesqrt(Both x) { return {inversesqrt(x.a), inversesqrt(x.b)}; }
HWY_INLINE Both min(Both x, Both y) { return {min(x.a, y.a), min(x.b, y.b)}; }
HWY_INLINE Both max(Both x, Both y) { return {max(x.a, y.a), max(x.b, y.b)}; }
HWY_INLINE Both select(BothMasks where, Both x, Both y) {
    return {select(where.a, x.a, y.a), select(where.b, x.b, y.b)};
}

// A model as pm_value takes it, of which the compiler knows the number of variates and the kind: it lays out the loops flat.
template <int N, bool is_axial> struct Sized {
    static constexpr int variates = N;
    static constexpr bool axial = is_axial;
    PmForm form;
    int lobes;
    const Rgb* coefficient;
    const Vec3f* centre;
    const Parameterization* parameterization;
    float log_scale[k_most_lobes];  // of each array only what the model has is touched
    float bandwidth[k_most_lobes * N];
    float exponent[k_most_lobes * 4];
    bool down[k_most_lobes * N];

    explicit Sized(const PmModel& model)
        : form(model.form),
          lobes(model.lobes),
          coefficient(model.coefficient.data()),
          centre(model.centre.data()),
          parameterization(model.parameterization.data()) {
        const auto in_bits = [](const std::vector<float>& from, float* to, double factor) {
            for (const float x : from) *to++ = float(factor * 1.4426950408889634 * double(x));
        };
        in_bits(model.log_scale, log_scale, 1);
        in_bits(model.bandwidth, bandwidth, 0.5);
        in_bits(model.exponent, exponent, 1);
        for (std::size_t i = 0; i < model.centre.size(); ++i) down[i] = model.centre[i].z < 0;
    }
};

static_assert(sizeof(Vec3f) == 3 * sizeof(float) && sizeof(Rgb) == 3 * sizeof(float));

// `count` is a multiple of two batches.
template <int N, bool axial>
void evaluate_sized(const PmModel& model, const Vec3f* wl, const Vec3f* wv, Rgb* f, std::size_t count) {
    const Sized<N, axial> sized(model);
    const Interleaved interleaved;
    const std::size_t width = Batch::size();
    const Both zero(0.0);
    for (std::size_t i = 0; i < count; i += 2 * width) {
        const Vec3<Batch> la = interleaved.load(&wl[i].x), lb = interleaved.load(&wl[i + width].x),
                          va = interleaved.load(&wv[i].x), vb = interleaved.load(&wv[i + width].x);
        const Vec3<Both> l({la.x, lb.x}, {la.y, lb.y}, {la.z, lb.z}), v({va.x, vb.x}, {va.y, vb.y}, {va.z, vb.z});
        const BothMasks above = zero < min(l.z, v.z);
        const Vec3<Both> value = Formulas<Both, Sized<N, axial>>::pm_value(sized, l, v);
        const Both r = select(above, value.x, zero), g = select(above, value.y, zero), b = select(above, value.z, zero);
        interleaved.store({r.a, g.a, b.a}, &f[i].r);
        interleaved.store({r.b, g.b, b.b}, &f[i + width].r);
    }
}

using Evaluator = void (*)(const PmModel&, const Vec3f*, const Vec3f*, Rgb*, std::size_t);
template <int N = 1> Evaluator evaluator_of(const PmModel& model) {
    if constexpr (N < k_most_variates)
        if (model.variates > N) return evaluator_of<N + 1>(model);
    return model.axial ? evaluate_sized<N, true> : evaluate_sized<N, false>;
}

void evaluate(const PmModel& model, const Vec3f* wl, const Vec3f* wv, Rgb* f, std::size_t count) {
    assert(1 <= model.variates && model.variates <= k_most_variates);
    const Evaluator evaluator = evaluator_of(model);
    const std::size_t width = 2 * Batch::size(), rest = count % width, whole = count - rest;
    if (whole > 0) evaluator(model, wl, wv, f, whole);
    if (rest == 0) return;
    // The rest, filled up with the normal.
    constexpr std::size_t most = 2 * HWY_MAX_BYTES / sizeof(float);
    Vec3f last_wl[most], last_wv[most];
    Rgb last_f[most];
    for (std::size_t k = 0; k < width; ++k) {
        last_wl[k] = k < rest ? wl[whole + k] : Vec3f(0, 0, 1);
        last_wv[k] = k < rest ? wv[whole + k] : Vec3f(0, 0, 1);
    }
    evaluator(model, last_wl, last_wv, last_f, width);
    std::copy_n(last_f, rest, f + whole);
}

}  // namespace HWY_NAMESPACE
}  // namespace srbf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace srbf {

HWY_EXPORT(evaluate);

void evaluate(const PmModel& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
    const FlushSubnormals mode;
    assert(wl.size() == wv.size() && wl.size() == f.size());
    HWY_DYNAMIC_DISPATCH(evaluate)(model, wl.data(), wv.data(), f.data(), f.size());
}

void evaluate(const Model& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
    std::visit([&](const auto& m) { evaluate(m, wl, wv, f); }, model.model);
}

Evaluate evaluator(const PmModel& model) {
    return [&model](auto wl, auto wv, auto f) { evaluate(model, wl, wv, f); };
}

Channels spectra(const PmModel& model) {
    return {model.wavelength, [&model](auto wl, auto wv, auto f) {
                const std::size_t C = model.wavelength.size();
                PmModel three = model;  // of whose wavelengths R, G, B are three
                std::vector<Rgb> rgb(wl.size());
                for (std::size_t first = 0; first < C; first += 3) {
                    const std::size_t count = std::min<std::size_t>(3, C - first);
                    for (std::size_t j = 0; j < three.coefficient.size(); ++j)
                        for (std::size_t c = 0; c < count; ++c)
                            three.coefficient[j][int(c)] = model.spectrum[j * C + first + c];
                    evaluate(three, wl, wv, rgb);
                    for (std::size_t i = 0; i < rgb.size(); ++i)
                        for (std::size_t c = 0; c < count; ++c) f[i * C + first + c] = rgb[i][int(c)];
                }
            }};
}

Evaluate evaluator(const Model& model) {
    return [&model](auto wl, auto wv, auto f) { evaluate(model, wl, wv, f); };
}

}  // namespace srbf
#endif
