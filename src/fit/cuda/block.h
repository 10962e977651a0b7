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

#include "srbf/vec3.inl"

// The built-in functions of GLSL that kernel.glsl uses.
SRBF_DEVICE inline float exp(float x) { return ::expf(x); }
SRBF_DEVICE inline float exp2(float x) { return ::exp2f(x); }
SRBF_DEVICE inline float log(float x) { return ::logf(x); }
SRBF_DEVICE inline float sqrt(float x) { return ::sqrtf(x); }
SRBF_DEVICE inline float inversesqrt(float x) { return 1 / ::sqrtf(x); }
SRBF_DEVICE inline float cos(float x) { return ::cosf(x); }
SRBF_DEVICE inline float sin(float x) { return ::sinf(x); }
SRBF_DEVICE inline float min(float a, float b) { return b < a ? b : a; }
SRBF_DEVICE inline float max(float a, float b) { return a < b ? b : a; }
SRBF_DEVICE inline float select(bool condition, float a, float b) { return condition ? a : b; }
SRBF_DEVICE inline double lesser(double a, double b) { return b < a ? b : a; }
SRBF_DEVICE inline double greater(double a, double b) { return a < b ? b : a; }

template <typename Real> using Triple = Vec3<Real>;
#define SRBF_FN static SRBF_DEVICE
#include "srbf/kernel_host.inl"
using Formula = Formulas<float, PmModel>;

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
    /// A number that items wrote; later items may change it.
    SRBF_DEVICE double read(const double& number) const {
        const double value = number;
#ifdef __CUDA_ARCH__
        __syncthreads();
#endif
        return value;
    }
};

}  // namespace srbf::on_device
