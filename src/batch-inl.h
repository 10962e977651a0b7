// A batch of floats as wide as the machine's vectors, and the formulas of kernel.glsl on it. Included once
// for each instruction set, inside of a file that Highway includes again and again; hence no ordinary include
// guard.
#if defined(SRBF_BATCH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SRBF_BATCH_INL_H
#undef SRBF_BATCH_INL_H
#else
#define SRBF_BATCH_INL_H
#endif

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "srbf/kernel.h"

HWY_BEFORE_NAMESPACE();
namespace srbf {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::ScalableTag<float>;

struct Batch {
    hn::Vec<Lanes> v;
    Batch() = default;  // of no value yet, like a float
    HWY_INLINE Batch(hn::Vec<Lanes> x) : v(x) {}
    HWY_INLINE explicit Batch(double x) : v(hn::Set(Lanes(), float(x))) {}
    static HWY_INLINE Batch load(const float* p) { return hn::Load(Lanes(), p); }
    HWY_INLINE void store(float* p) const { hn::Store(v, Lanes(), p); }
    static HWY_INLINE std::size_t size() { return hn::Lanes(Lanes()); }
    HWY_INLINE float sum() const { return hn::GetLane(hn::SumOfLanes(Lanes(), v)); }
    HWY_INLINE float largest() const { return hn::GetLane(hn::MaxOfLanes(Lanes(), v)); }
};
using BatchMask = hn::Mask<Lanes>;

HWY_INLINE Batch multiply_add(Batch a, Batch b, Batch c) { return hn::MulAdd(a.v, b.v, c.v); }         // a b + c
HWY_INLINE Batch multiply_subtract(Batch a, Batch b, Batch c) { return hn::MulSub(a.v, b.v, c.v); }    // a b - c
HWY_INLINE Batch subtract_product(Batch c, Batch a, Batch b) { return hn::NegMulAdd(a.v, b.v, c.v); }  // c - a b
HWY_INLINE Batch product(Batch a, Batch b) { return hn::Mul(a.v, b.v); }

// a b, not multiplied yet: what is added to it makes one fused operation of both, always the same one.
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

HWY_INLINE Batch operator+(Batch a, Batch b) { return hn::Add(a.v, b.v); }
HWY_INLINE Batch operator-(Batch a, Batch b) { return hn::Sub(a.v, b.v); }
HWY_INLINE Product<Batch> operator*(Batch a, Batch b) { return {a, b}; }
HWY_INLINE Batch operator/(Batch a, Batch b) { return hn::Div(a.v, b.v); }
HWY_INLINE Batch operator-(Batch a) { return hn::Neg(a.v); }
HWY_INLINE BatchMask operator<(Batch a, Batch b) { return hn::Lt(a.v, b.v); }
HWY_INLINE Batch min(Batch a, Batch b) { return hn::Min(a.v, b.v); }
HWY_INLINE Batch max(Batch a, Batch b) { return hn::Max(a.v, b.v); }
HWY_INLINE Batch sqrt(Batch a) { return hn::Sqrt(a.v); }
HWY_INLINE Batch select(BatchMask condition, Batch a, Batch b) { return hn::IfThenElse(condition, a.v, b.v); }

using LanesOfBits = hn::RebindToSigned<Lanes>;

// c_0 + x (c_1 + x (c_2 + ...))
HWY_INLINE Batch polynomial(Batch, double c) { return Batch(c); }
template <typename... More> HWY_INLINE Batch polynomial(Batch x, double c, More... more) {
    return Batch(c) + x * polynomial(x, more...);
}

// 2^a for a < 127.5: 2^n 2^r, n the nearest integer, with a minimax polynomial for 2^r. Relative error 2e-7 from -126 up; falls to
// 0 at -127, where the bits of 2^n 2^r are those of 0, and stays there.
HWY_INLINE Batch exp2(Batch a) {
    const LanesOfBits bits;
    const Batch magic(12582912.0);  // 1.5 * 2^23: adding it rounds to an integer, in the low bits of the sum
    const Batch x = max(a, Batch(-127.0));
    const Batch sum = x + magic;
    const Batch r = x - (sum - magic);
    const Batch power = polynomial(r, 1.0, 0.6931469768716529, 0.24022241112231937, 0.05550734515316676,
                                   0.009671576407961614, 0.0013264645359974006);
    const auto n = hn::ShiftLeft<23>(hn::BitCast(bits, sum.v));
    return hn::BitCast(Lanes(), hn::Add(hn::BitCast(bits, power.v), n));
}
// e^a. Relative error 2e-7 (1 + |a| / 2), of which the part that grows is half an ulp of the exponent.
HWY_INLINE Batch exp(Batch a) { return exp2(Batch(1.4426950408889634) * a); }

// The natural logarithm of a normal positive number: e log(2) + log(m), m in [sqrt(1/2), sqrt(2)), with a minimax polynomial.
// Relative error 4e-7.
HWY_INLINE Batch log(Batch a) {
    const LanesOfBits bits;
    const auto x = hn::BitCast(bits, a.v);
    const auto e = hn::ShiftRight<23>(hn::Sub(x, hn::Set(bits, 0x3f3504f3)));  // the bits of sqrt(1/2)
    const Batch m = hn::BitCast(Lanes(), hn::Sub(x, hn::ShiftLeft<23>(e)));
    const Batch r = m - Batch(1.0);
    const Batch log_m =
        r * polynomial(r, 1.0, -0.5000032343267086, 0.3333471490238037, -0.24971228722553673, 0.19906883134210476,
                       -0.17243221986349655, 0.1618050203316588, -0.1008238917029115);
    return log_m + Batch(hn::ConvertTo(Lanes(), e)) * Batch(0.6931471805599453);
}

#if HWY_TARGET <= HWY_SSSE3  // x86, whose estimate has 12 bits or more: one step of Newton's. Relative error 3e-7.
HWY_INLINE Batch inversesqrt(Batch a) {
    const Batch x = hn::ApproximateReciprocalSqrt(a.v);
    return x + Batch(0.5) * x * (Batch(1.0) - a * x * x);
}
#else
HWY_INLINE Batch inversesqrt(Batch a) { return Batch(1.0) / sqrt(a); }
#endif

#include "srbf/vec3.inl"

// s v, likewise.
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
    friend HWY_INLINE Vec3<B> operator+(Scaled p, Scaled q) { return Vec3<B>(p) + q; }
    friend HWY_INLINE Vec3<B> operator-(Scaled p, Scaled q) { return Vec3<B>(p) - q; }
};
HWY_INLINE Scaled<Batch> operator*(Batch s, Vec3<Batch> v) { return {s, v}; }

// Batches of x, y, z from and to x y z x y z ... in memory. Of the three vectors there, the lanes of one component never
// meet, since their number is no multiple of 3: they are blended into one vector, and this is put in order.
struct Interleaved {
    BatchMask third[3];  // the lanes r, r + 3, ...
    decltype(hn::IndicesFromVec(Lanes(), hn::Zero(LanesOfBits()))) gather[3], scatter[3];

    HWY_INLINE Interleaved() {
        constexpr std::size_t most = HWY_MAX_BYTES / sizeof(float);
        const std::size_t N = Batch::size();
        HWY_ALIGN float phase[most];
        for (std::size_t k = 0; k < N; ++k) phase[k] = float(k % 3);
        for (std::size_t c = 0; c < 3; ++c) {
            HWY_ALIGN std::int32_t from[most], to[most];
            for (std::size_t k = 0; k < N; ++k) {
                const std::size_t lane = (3 * k + c) % N;
                from[k] = std::int32_t(lane);
                to[lane] = std::int32_t(k);
            }
            gather[c] = hn::IndicesFromVec(Lanes(), hn::Load(LanesOfBits(), from));
            scatter[c] = hn::IndicesFromVec(Lanes(), hn::Load(LanesOfBits(), to));
            third[c] = hn::Eq(hn::Load(Lanes(), phase), hn::Set(Lanes(), float(c)));
        }
    }
    // In the lanes `first`, first + 3, ... those of a; in the lanes `second`, second + 3, ... those of b; in the others those of c.
    HWY_INLINE Batch blended(std::size_t first, std::size_t second, Batch a, Batch b, Batch c) const {
        return select(third[first % 3], a, select(third[second % 3], b, c));
    }
    HWY_INLINE Vec3<Batch> load(const float* p) const {
        const std::size_t N = Batch::size();
        const Batch a = hn::LoadU(Lanes(), p), b = hn::LoadU(Lanes(), p + N), c = hn::LoadU(Lanes(), p + 2 * N);
        const auto component = [&](std::size_t k) HWY_ATTR {
            return Batch(hn::TableLookupLanes(blended(k, k + 2 * N, a, b, c).v, gather[k]));
        };
        return {component(0), component(1), component(2)};
    }
    HWY_INLINE void store(Vec3<Batch> w, float* p) const {
        const std::size_t N = Batch::size();
        const Batch x = hn::TableLookupLanes(w.x.v, scatter[0]), y = hn::TableLookupLanes(w.y.v, scatter[1]),
                    z = hn::TableLookupLanes(w.z.v, scatter[2]);
        for (std::size_t q = 0; q < 3; ++q)
            hn::StoreU(blended(2 * q * N, 2 * q * N + 1, x, y, z).v, Lanes(), p + q * N);
    }
};
template <typename Real> using Triple = Vec3<Real>;
#define SRBF_FN static HWY_INLINE
#include "srbf/kernel_formulas.inl"

}  // namespace HWY_NAMESPACE
}  // namespace srbf
HWY_AFTER_NAMESPACE();

#endif
