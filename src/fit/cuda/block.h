// Work of a block of threads, as a text for CUDA and for any processor: on a processor one thread does all of it. The
// mathematics is that of kernel.glsl.
#pragma once
#include <cmath>
#include <cstddef>

#include "srbf/kernel.h"

#ifdef __CUDACC__
#define SRBF_DEVICE __host__ __device__
#define SRBF_CALLED __host__ __device__ __noinline__ inline  // compiled once a file, not wherever it is called
#else
#define SRBF_DEVICE
#define SRBF_CALLED inline
#endif

namespace srbf::on_device {

SRBF_DEVICE inline float exp(float x) { return ::expf(x); }
SRBF_DEVICE inline float min(float a, float b) { return b < a ? b : a; }
SRBF_DEVICE inline float max(float a, float b) { return a < b ? b : a; }
SRBF_DEVICE inline double lesser(double a, double b) { return b < a ? b : a; }
SRBF_DEVICE inline double greater(double a, double b) { return a < b ? b : a; }

#include "srbf/vec3.inl"
#define SRBF_FUSED SRBF_DEVICE
#include "fused.inl"

/// A float with the products of SIMD code (batch-inl.h): features are rounded as there, on any processor, so that they
/// differ only by the elementary functions.
struct Number {
    float value;
    constexpr SRBF_DEVICE Number() : value(0) {}
    constexpr SRBF_DEVICE Number(float x) : value(x) {}
    constexpr SRBF_DEVICE explicit Number(double x) : value(float(x)) {}

    friend SRBF_DEVICE Number multiply_add(Number a, Number b, Number c) { return ::fmaf(a.value, b.value, c.value); }
    friend SRBF_DEVICE Number multiply_subtract(Number a, Number b, Number c) {
        return ::fmaf(a.value, b.value, -c.value);
    }
    friend SRBF_DEVICE Number subtract_product(Number c, Number a, Number b) {
        return ::fmaf(-a.value, b.value, c.value);
    }
    friend SRBF_DEVICE Number product(Number a, Number b) { return a.value * b.value; }
    friend SRBF_DEVICE Number operator+(Number a, Number b) { return a.value + b.value; }
    friend SRBF_DEVICE Number operator-(Number a, Number b) { return a.value - b.value; }
    friend SRBF_DEVICE Number operator-(Number a) { return -a.value; }
    friend SRBF_DEVICE Product<Number> operator*(Number a, Number b) { return {a, b}; }
    friend SRBF_DEVICE Scaled<Number> operator*(Number s, Vec3<Number> v) { return {s, v}; }
    friend SRBF_DEVICE Number operator/(Number a, Number b) { return a.value / b.value; }
    friend SRBF_DEVICE bool operator<(Number a, Number b) { return a.value < b.value; }
    friend SRBF_DEVICE Number min(Number a, Number b) { return on_device::min(a.value, b.value); }
    friend SRBF_DEVICE Number max(Number a, Number b) { return on_device::max(a.value, b.value); }
    friend SRBF_DEVICE Number log(Number x) { return ::logf(x.value); }
    friend SRBF_DEVICE Number sqrt(Number x) { return ::sqrtf(x.value); }
    friend SRBF_DEVICE Number inversesqrt(Number x) { return 1 / ::sqrtf(x.value); }
};
// Those of vec3.inl would be for the host only.
SRBF_DEVICE inline Vec3<Number> operator+(Vec3<Number> a, Vec3<Number> b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
SRBF_DEVICE inline Vec3<Number> operator-(Vec3<Number> a, Vec3<Number> b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
SRBF_DEVICE inline Number dot(Vec3<Number> a, Vec3<Number> b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

template <typename Real> using Triple = Vec3<Real>;
#define SRBF_FN static SRBF_DEVICE
#include "srbf/kernel_host.inl"
using Formula = Formulas<Number, PmModel>;

/// The threads of a block. All of them run the same text: what is outside of `each` is the same in every thread, and
/// only items of `each` write to memory. No item reads what another one of the same loop writes, so that results
/// depend neither on the number of threads nor on their order.
struct Block {
    /// item(i) for i in 0..count−1, then a barrier.
    template <typename Item> SRBF_DEVICE void each(int count, const Item& item) const {
#ifdef __CUDA_ARCH__
        for (int i = int(threadIdx.x); i < count; i += int(blockDim.x)) item(i);
        __syncthreads();
#else
        for (int i = 0; i < count; ++i) item(i);
#endif
    }
    /// f(), which one thread computes for all of them; `place` is for its value, in memory of the block.
    template <typename F> SRBF_DEVICE double once(double& place, const F& f) const {
        each(1, [&](int) { place = f(); });
        const double value = place;
#ifdef __CUDA_ARCH__
        __syncthreads();  // later items may use the place
#endif
        return value;
    }
};

/// The sum of `count` numbers, `stride` apart from each other.
SRBF_DEVICE inline double sum_of(const double* number, int count, int stride) {
    double sum = 0;
    for (int i = 0; i < count; ++i) sum += number[i * stride];
    return sum;
}
/// The largest of them and of `least`.
SRBF_DEVICE inline double largest_of(const double* number, int count, int stride, double least) {
    for (int i = 0; i < count; ++i) least = greater(least, number[i * stride]);
    return least;
}

}  // namespace srbf::on_device
