// A SIMD batch of floats, and the formulas of kernel.glsl on it. Included once per instruction set, within a file that
// Highway includes repeatedly; hence no ordinary include guard.
//
// A `Batch` gives the same bits on every processor: each operation is rounded once, as IEEE 754 defines it, functions
// consist of such operations, minima and maxima are comparisons, and sums run over sixteen lanes whatever the width of
// a vector. A `Group` is for renderers: it fuses products with sums, and its 1/√ begins with the processor's estimate,
// if the processor has such instructions.
#if defined(SRBF_BATCH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SRBF_BATCH_INL_H
#undef SRBF_BATCH_INL_H
#else
#define SRBF_BATCH_INL_H
#endif

#include <hwy/highway.h>

#include <cstddef>

#include "srbf/kernel.h"

HWY_BEFORE_NAMESPACE();
namespace SRBF_NAMESPACE {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::ScalableTag<float>;

template <typename Real> struct Vec3;

// The product a b, not yet evaluated: adding to it gives a fused multiply-add, the same one with every compiler. B has
// product, multiply_add, multiply_subtract and subtract_product.
template <typename B> struct Product {
    B a, b;
    HWY_INLINE Product(B a_, B b_) : a(a_), b(b_) {}
    HWY_INLINE operator B() const { return product(a, b); }
    HWY_INLINE void store(float* p) const { product(a, b).store(p); }
    friend HWY_INLINE B operator+(Product p, B c) { return multiply_add(p.a, p.b, c); }
    friend HWY_INLINE B operator+(B c, Product p) { return multiply_add(p.a, p.b, c); }
    friend HWY_INLINE B operator+(Product p, Product q) { return multiply_add(q.a, q.b, product(p.a, p.b)); }
    friend HWY_INLINE B operator-(Product p, B c) { return multiply_subtract(p.a, p.b, c); }
    friend HWY_INLINE B operator-(B c, Product p) { return subtract_product(c, p.a, p.b); }
    friend HWY_INLINE B operator-(Product p, Product q) { return subtract_product(product(p.a, p.b), q.a, q.b); }
};

// The product s v of a number and a vector, with fused multiply-adds as for `Product`.
template <typename B> struct Scaled {
    B s;
    Vec3<B> v;
    HWY_INLINE Scaled(B s_, Vec3<B> v_) : s(s_), v(v_) {}
    HWY_INLINE operator Vec3<B>() const { return {s * v.x, s * v.y, s * v.z}; }
    friend HWY_INLINE Vec3<B> operator+(Vec3<B> u, Scaled p) {
        return {u.x + p.s * p.v.x, u.y + p.s * p.v.y, u.z + p.s * p.v.z};
    }
    friend HWY_INLINE Vec3<B> operator-(Vec3<B> u, Scaled p) {
        return {u.x - p.s * p.v.x, u.y - p.s * p.v.y, u.z - p.s * p.v.z};
    }
    friend HWY_INLINE Vec3<B> operator-(Scaled p, Vec3<B> u) {
        return {p.s * p.v.x - u.x, p.s * p.v.y - u.y, p.s * p.v.z - u.z};
    }
    friend HWY_INLINE Vec3<B> operator+(Scaled p, Scaled q) { return Vec3<B>(p) + q; }
    friend HWY_INLINE Vec3<B> operator-(Scaled p, Scaled q) { return Vec3<B>(p) - q; }
};

// c_0 + x (c_1 + x (c_2 + ...))
template <typename B> HWY_INLINE B polynomial(B, double c) { return B(c); }
template <typename B, typename... More> HWY_INLINE B polynomial(B x, double c, More... more) {
    return B(c) + x * polynomial(x, more...);
}

// A vector of floats; Highway's tag D states the number of lanes.
template <typename D, bool is_fused = false> struct BatchOf {
    using Tag = D;
    using Bits = hn::RebindToSigned<D>;
    using Mask = hn::Mask<D>;
    hn::Vec<D> v;
    BatchOf() = default;  // uninitialised, like a float
    HWY_INLINE BatchOf(hn::Vec<D> x) : v(x) {}
    HWY_INLINE explicit BatchOf(double x) : v(hn::Set(D(), float(x))) {}
    static HWY_INLINE BatchOf load(const float* p) { return hn::Load(D(), p); }
    HWY_INLINE void store(float* p) const { hn::Store(v, D(), p); }
    static HWY_INLINE std::size_t size() { return hn::Lanes(D()); }
    HWY_INLINE float sum() const requires is_fused { return hn::GetLane(hn::SumOfLanes(D(), v)); }
    HWY_INLINE float largest() const { return hn::GetLane(hn::MaxOfLanes(D(), v)); }

    friend HWY_INLINE BatchOf multiply_add(BatchOf a, BatchOf b, BatchOf c) requires is_fused {  // a b + c
        return hn::MulAdd(a.v, b.v, c.v);
    }
    friend HWY_INLINE BatchOf multiply_subtract(BatchOf a, BatchOf b, BatchOf c) requires is_fused {  // a b - c
        return hn::MulSub(a.v, b.v, c.v);
    }
    friend HWY_INLINE BatchOf subtract_product(BatchOf c, BatchOf a, BatchOf b) requires is_fused {  // c - a b
        return hn::NegMulAdd(a.v, b.v, c.v);
    }
    friend HWY_INLINE BatchOf product(BatchOf a, BatchOf b) { return hn::Mul(a.v, b.v); }
    friend HWY_INLINE BatchOf operator+(BatchOf a, BatchOf b) { return hn::Add(a.v, b.v); }
    friend HWY_INLINE BatchOf operator-(BatchOf a, BatchOf b) { return hn::Sub(a.v, b.v); }
    friend HWY_INLINE BatchOf operator*(BatchOf a, BatchOf b) requires(!is_fused) { return product(a, b); }
    friend HWY_INLINE Product<BatchOf> operator*(BatchOf a, BatchOf b) requires is_fused { return {a, b}; }
    friend HWY_INLINE Scaled<BatchOf> operator*(BatchOf s, Vec3<BatchOf> v) requires is_fused { return {s, v}; }
    friend HWY_INLINE BatchOf operator/(BatchOf a, BatchOf b) { return hn::Div(a.v, b.v); }
    friend HWY_INLINE BatchOf operator-(BatchOf a) { return hn::Neg(a.v); }
    friend HWY_INLINE Mask operator<(BatchOf a, BatchOf b) { return hn::Lt(a.v, b.v); }
    // a < b ? a : b and b < a ? a : b, also for NaN and zeros of either sign, as the instructions of x86.
#if HWY_ARCH_X86
    friend HWY_INLINE BatchOf min(BatchOf a, BatchOf b) { return hn::Min(a.v, b.v); }
    friend HWY_INLINE BatchOf max(BatchOf a, BatchOf b) { return hn::Max(a.v, b.v); }
#else
    friend HWY_INLINE BatchOf min(BatchOf a, BatchOf b) { return hn::IfThenElse(hn::Lt(a.v, b.v), a.v, b.v); }
    friend HWY_INLINE BatchOf max(BatchOf a, BatchOf b) { return hn::IfThenElse(hn::Lt(b.v, a.v), a.v, b.v); }
#endif
    friend HWY_INLINE BatchOf sqrt(BatchOf a) { return hn::Sqrt(a.v); }
    friend HWY_INLINE BatchOf select(Mask condition, BatchOf a, BatchOf b) {
        return hn::IfThenElse(condition, a.v, b.v);
    }

    // 2^a = 2^n 2^r for a < 127.5, with n the nearest integer and a minimax polynomial for 2^r. The relative error is
    // 2e-7 for a >= -126. The result falls to 0 at -127 and stays 0 below.
    friend HWY_INLINE BatchOf exp2(BatchOf a) {
        const Bits bits;
        const BatchOf shift(12582912.0);  // adding 1.5 * 2^23 rounds to an integer, in the low bits of the sum
        const BatchOf x = max(a, BatchOf(-127.0));
        const BatchOf sum = x + shift;
        const BatchOf r = x - (sum - shift);
        const BatchOf power = polynomial(r, 1.0, 0.6931469768716529, 0.24022241112231937, 0.05550734515316676,
                                         0.009671576407961614, 0.0013264645359974006);
        const auto n = hn::ShiftLeft<23>(hn::BitCast(bits, sum.v));
        return hn::BitCast(D(), hn::Add(hn::BitCast(bits, power.v), n));
    }
    // e^a. The relative error is 2e-7 (1 + |a| / 2), since half an ulp of the exponent grows with it.
    friend HWY_INLINE BatchOf exp(BatchOf a) { return exp2(BatchOf(1.4426950408889634) * a); }

    // The natural logarithm of a normal positive number: e log(2) + log(m), m in [sqrt(1/2), sqrt(2)), with a minimax
    // polynomial. The relative error is 4e-7.
    friend HWY_INLINE BatchOf log(BatchOf a) {
        const Bits bits;
        const auto x = hn::BitCast(bits, a.v);
        const auto e = hn::ShiftRight<23>(hn::Sub(x, hn::Set(bits, 0x3f3504f3)));  // the bits of sqrt(1/2)
        const BatchOf m = hn::BitCast(D(), hn::Sub(x, hn::ShiftLeft<23>(e)));
        const BatchOf r = m - BatchOf(1.0);
        const BatchOf log_m =
            r * polynomial(r, 1.0, -0.5000032343267086, 0.3333471490238037, -0.24971228722553673, 0.19906883134210476,
                           -0.17243221986349655, 0.1618050203316588, -0.1008238917029115);
        return log_m + BatchOf(hn::ConvertTo(D(), e)) * BatchOf(0.6931471805599453);
    }

    // log(1 + a) for a > -1; the second term corrects the rounding error of the sum. The relative error is 5e-7.
    friend HWY_INLINE BatchOf log1p(BatchOf a) {
        const BatchOf u = BatchOf(1.0) + a;
        return log(u) + (a - (u - BatchOf(1.0))) / u;
    }

    friend HWY_INLINE BatchOf inversesqrt(BatchOf a) requires(!is_fused) { return BatchOf(1.0) / sqrt(a); }
#if HWY_TARGET <= HWY_SSSE3  // x86 estimates at least 12 bits; with one Newton step the relative error is 3e-7
    friend HWY_INLINE BatchOf inversesqrt(BatchOf a) requires is_fused {
        const BatchOf x = hn::ApproximateReciprocalSqrt(a.v);
        return x + BatchOf(0.5) * x * (BatchOf(1.0) - a * x * x);
    }
#else
    friend HWY_INLINE BatchOf inversesqrt(BatchOf a) requires is_fused { return BatchOf(1.0) / sqrt(a); }
#endif

    // cos(a) and sin(a), |a| <= 2 pi, with an absolute error of 2e-7. The angle is reduced by the nearest multiple
    // of pi / 2. The multiple selects one of two polynomials, and the sign.
    friend HWY_INLINE BatchOf cos(BatchOf a) { return shifted_sine(a, 1); }
    friend HWY_INLINE BatchOf sin(BatchOf a) { return shifted_sine(a, 0); }

  private:
    static HWY_INLINE BatchOf shifted_sine(BatchOf a, int quarters) {  // sin(a + quarters pi / 2)
        const Bits bits;
        const BatchOf shift(12582912.0);  // the shift of exp2
        const BatchOf sum = a * BatchOf(0.6366197723675814) + shift;
        const BatchOf n = sum - shift;
        // pi / 2 is the sum of three numbers; the first two have so few bits that their products with n are exact.
        const BatchOf r =
            a - n * BatchOf(1.5703125) - n * BatchOf(4.837512969970703e-4) - n * BatchOf(7.54978995489188e-8);
        const BatchOf r2 = r * r;
        const BatchOf odd = r + r * r2 * polynomial(r2, -0.16666654611, 8.3321608736e-3, -1.9515295891e-4);
        const BatchOf even =
            polynomial(r2, 1.0, -0.5, 4.166664568298827e-2, -1.388731625493765e-3, 2.443315711809948e-5);
        const auto q = hn::Add(hn::BitCast(bits, sum.v), hn::Set(bits, quarters));
        const auto is_odd = hn::Eq(hn::And(q, hn::Set(bits, 1)), hn::Zero(bits));
        const BatchOf magnitude = hn::IfThenElse(hn::RebindMask(D(), is_odd), odd.v, even.v);
        return hn::Xor(magnitude.v, hn::BitCast(D(), hn::ShiftLeft<30>(hn::And(q, hn::Set(bits, 2)))));
    }
};

// The widest vectors of the target.
using Batch = BatchOf<Lanes>;
using BatchMask = Batch::Mask;
// Up to eight lanes, for the lobes of a single pair of directions.
using Group = BatchOf<hn::CappedTag<float, 8>, true>;

// A column is summed in sixteen lanes, which `k_sum_parts` vectors hold: lane k sums the numbers k, k + 16, k + 32, ...
// Then halves of the lanes are added to each other until one lane is left.
constexpr std::size_t k_sum_lanes = 16, k_width = hn::MaxLanes(Lanes());
static_assert(!HWY_HAVE_SCALABLE && k_sum_lanes % k_width == 0);
constexpr std::size_t k_sum_parts = k_sum_lanes / k_width;

// Adds halves of `count` parts to each other until one part is left.
template <std::size_t count = k_sum_parts, std::size_t stride = 1> HWY_INLINE Batch reduce_parts(const Batch* parts) {
    if constexpr (count == 1)
        return *parts;
    else
        return reduce_parts<count / 2, 2 * stride>(parts) + reduce_parts<count / 2, 2 * stride>(parts + stride);
}

#include "srbf/vec3.inl"

// Adds halves of a vector's lanes to each other until one lane is left.
#if HWY_TARGET == HWY_SCALAR
HWY_INLINE float reduce_lanes(Batch x) { return hn::GetLane(x.v); }
#else
template <typename D> HWY_INLINE auto fold_to_four(D, hn::Vec<D> x) {
    if constexpr (hn::MaxLanes(D()) <= 4) {
        return x;
    } else {
        const hn::Half<D> half;
        return fold_to_four(half, hn::Add(hn::LowerHalf(half, x), hn::UpperHalf(half, x)));
    }
}
HWY_INLINE float reduce_lanes(Batch x) {
    HWY_ALIGN float four[4];
    hn::Store(fold_to_four(Lanes(), x.v), hn::CappedTag<float, 4>(), four);
    return (four[0] + four[2]) + (four[1] + four[3]);
}
#endif

// The sum of a column of `count` numbers, a multiple of sixteen. `term(i)` gives the batch that begins with number i.
template <typename Term> HWY_INLINE float summed(std::size_t count, const Term& term) {
    Batch sum[k_sum_parts];
    for (Batch& part : sum) part = Batch(0.0);
    for (std::size_t i = 0; i < count; i += k_sum_lanes)
        for (std::size_t p = 0; p < k_sum_parts; ++p) sum[p] = sum[p] + term(i + p * k_width);
    return reduce_lanes(reduce_parts(sum));
}

template <typename B> HWY_INLINE Vec3<B> select(typename B::Mask where, const Vec3<B>& a, const Vec3<B>& b) {
    return {select(where, a.x, b.x), select(where, a.y, b.y), select(where, a.z, b.z)};
}

// Calls evaluate(wl, wv, f, n) for the largest multiple of `width` pairs, then for the remaining pairs, padded with the
// normal to `width`, which is at most two batches.
template <typename Pair, typename Value, typename Evaluate>
HWY_INLINE void evaluate_padded(std::size_t width, const Pair* wl, const Pair* wv, Value* f, std::size_t count,
                                const Evaluate& evaluate) {
    constexpr std::size_t most = 2 * HWY_MAX_BYTES / sizeof(float);
    const std::size_t rest = count % width, whole = count - rest;
    if (whole > 0) evaluate(wl, wv, f, whole);
    if (rest == 0) return;
    Pair last_wl[most], last_wv[most];
    Value last_f[most];
    for (std::size_t k = 0; k < width; ++k) {
        last_wl[k] = k < rest ? wl[whole + k] : Pair(0, 0, 1);
        last_wv[k] = k < rest ? wv[whole + k] : Pair(0, 0, 1);
    }
    evaluate(last_wl, last_wv, last_f, width);
    for (std::size_t k = 0; k < rest; ++k) f[whole + k] = last_f[k];
}

// Batches of x, y, z that are interleaved in memory as x y z x y z ...
HWY_INLINE Vec3<Batch> load_triples(const float* p) {
    Vec3<Batch> w;
    hn::LoadInterleaved3(Lanes(), p, w.x.v, w.y.v, w.z.v);
    return w;
}
HWY_INLINE void store_triples(const Vec3<Batch>& w, float* p) {
    hn::StoreInterleaved3(w.x.v, w.y.v, w.z.v, Lanes(), p);
}

// `above_horizon` of srbf/brdf.h for each lane.
HWY_INLINE BatchMask above_horizon(const Vec3<Batch>& wl, const Vec3<Batch>& wv) {
    const Batch sum = (wl.x + wl.y) + (wv.x + wv.y) + (wl.z + wv.z);
    const Batch below = Batch(0x1.fffffcp-127) + Batch(0.0) * sum;  // the largest subnormal number, or NaN
    return hn::And(below < wl.z, below < wv.z);
}

// Evaluates value(wl, wv), a function of batches, for all pairs; f is 0 unless both directions are above the horizon.
template <typename Pair, typename Colour, typename Value>
HWY_INLINE void evaluate_pairs(const Pair* wl, const Pair* wv, Colour* f, std::size_t count, const Value& value) {
    const Vec3<Batch> normal(Batch(0.0), Batch(0.0), Batch(1.0)), none(Batch(0.0), Batch(0.0), Batch(0.0));
    const auto evaluate = [&](const Pair* batch_wl, const Pair* batch_wv, Colour* result, std::size_t n) HWY_ATTR {
        for (std::size_t i = 0; i < n; i += Batch::size()) {
            const Vec3<Batch> l = load_triples(&batch_wl[i].x), v = load_triples(&batch_wv[i].x);
            const BatchMask above = above_horizon(l, v);
            const Vec3<Batch> values = value(select(above, l, normal), select(above, v, normal));
            store_triples(select(above, values, none), &result[i].r);
        }
    };
    evaluate_padded(Batch::size(), wl, wv, f, count, evaluate);
}
template <typename Real> using Triple = Vec3<Real>;
#define SRBF_FN static HWY_INLINE
#include "srbf/kernel/host.inl"

}  // namespace HWY_NAMESPACE
}  // namespace
HWY_AFTER_NAMESPACE();

#endif
