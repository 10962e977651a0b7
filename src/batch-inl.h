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

#include <cmath>

#include "srbf/vec.h"

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

HWY_INLINE Batch operator+(Batch a, Batch b) { return hn::Add(a.v, b.v); }
HWY_INLINE Batch operator-(Batch a, Batch b) { return hn::Sub(a.v, b.v); }
HWY_INLINE Batch operator*(Batch a, Batch b) { return hn::Mul(a.v, b.v); }
HWY_INLINE Batch operator/(Batch a, Batch b) { return hn::Div(a.v, b.v); }
HWY_INLINE Batch operator-(Batch a) { return hn::Neg(a.v); }
HWY_INLINE BatchMask operator<(Batch a, Batch b) { return hn::Lt(a.v, b.v); }
HWY_INLINE Batch multiply_add(Batch a, Batch b, Batch c) { return hn::MulAdd(a.v, b.v, c.v); }
HWY_INLINE Batch exp(Batch a) { return hn::Exp(Lanes(), a.v); }
HWY_INLINE Batch log(Batch a) { return hn::Log(Lanes(), a.v); }
HWY_INLINE Batch sqrt(Batch a) { return hn::Sqrt(a.v); }
// Newton's steps bring the machine's estimate of 12 bits or more to all 24.
HWY_INLINE Batch inversesqrt(Batch a) {
    Batch x = hn::ApproximateReciprocalSqrt(a.v);
    for (int step = 0; step < 2; ++step) x = x * multiply_add(Batch(-0.5) * a * x, x, Batch(1.5));
    return x;
}
HWY_INLINE Batch min(Batch a, Batch b) { return hn::Min(a.v, b.v); }
HWY_INLINE Batch max(Batch a, Batch b) { return hn::Max(a.v, b.v); }
HWY_INLINE Batch select(BatchMask condition, Batch a, Batch b) { return hn::IfThenElse(condition, a.v, b.v); }

#include "srbf/vec3.inl"
template <typename Real> using Triple = Vec3<Real>;
#include "srbf/kernel_formulas.inl"

}  // namespace HWY_NAMESPACE
}  // namespace srbf
HWY_AFTER_NAMESPACE();

#endif
