// Vectors of floats, if the compiler has them: lobes and components of a density are computed SRBF_LANES at a time.
// Without them, or with SRBF_ONE_LANE, each is computed alone by the same functions.
#if defined __GNUC__ && !defined __OPTIMIZE_SIZE__
#define SRBF_INLINE SRBF_FN __attribute__((always_inline))
#define SRBF_APART static __attribute__((noinline))
#else
#define SRBF_INLINE SRBF_FN
#define SRBF_APART static
#endif
#ifdef __CUDACC__
#define SRBF_UNROLL _Pragma("unroll")
#elif defined __GNUC__ && !defined __clang__
#define SRBF_UNROLL _Pragma("GCC unroll 8")
#else
#define SRBF_UNROLL
#endif
#if (defined __clang__ || __GNUC__ >= 9) && (defined __SSE2_MATH__ || !defined __i386__) && !defined __CUDACC__ && \
    !defined SRBF_ONE_LANE
// GCC does not align the stack of Windows for eight.
#if defined __AVX2__ && (!defined __MINGW32__ || defined __clang__)
#define SRBF_LANES 8
#else
#define SRBF_LANES 4
#endif
typedef float srbf_x __attribute__((vector_size(4 * SRBF_LANES)));
typedef int srbf_x_mask __attribute__((vector_size(4 * SRBF_LANES)));
typedef unsigned srbf_x_bits __attribute__((vector_size(4 * SRBF_LANES)));
#define SRBF_X_CONVERTED(type, a) __builtin_convertvector(a, type)
SRBF_FN srbf_x srbf_x_select(srbf_x_mask where, srbf_x a, srbf_x b) {
    return (srbf_x)(((srbf_x_mask)a & where) | ((srbf_x_mask)b & ~where));
}
#else
#define SRBF_LANES 1
typedef float srbf_x;
typedef int srbf_x_mask;
typedef unsigned srbf_x_bits;
#define SRBF_X_CONVERTED(type, a) ((type)(a))
SRBF_FN srbf_x srbf_x_select(srbf_x_mask where, srbf_x a, srbf_x b) { return where ? a : b; }
#endif
SRBF_FN srbf_x srbf_x_load(const float* from) {
    srbf_x a;
    memcpy(&a, from, sizeof a);
    return a;
}
SRBF_FN void srbf_x_store(srbf_x a, float* to) { memcpy(to, &a, sizeof a); }
SRBF_FN srbf_x_bits srbf_x_bits_of(srbf_x a) {
    srbf_x_bits bits;
    memcpy(&bits, &a, sizeof bits);
    return bits;
}
SRBF_FN srbf_x srbf_x_of_bits(srbf_x_bits bits) { return srbf_x_load((const float*)(const void*)&bits); }

SRBF_FN srbf_x srbf_x_of(float x) {
    const srbf_x zero = {0.0f};
    return x - zero;
}

// Minimum, maximum, the sum of the lanes, and 1 / sqrt(a), whose relative error is 3e-7 by steps of Newton's method. At
// 0 it is finite.
#if SRBF_LANES > 1 && defined __SSE__
#include <immintrin.h>
#if SRBF_LANES == 8
#define SRBF_X(name) _mm256_##name##_ps
#define SRBF_X_HALF(a) _mm_add_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps(a, 1))
#else
#define SRBF_X(name) _mm_##name##_ps
#define SRBF_X_HALF(a) (a)
#endif
SRBF_FN srbf_x srbf_x_min(srbf_x a, srbf_x b) { return SRBF_X(min)(a, b); }
SRBF_FN srbf_x srbf_x_max(srbf_x a, srbf_x b) { return SRBF_X(max)(a, b); }
SRBF_FN float srbf_x_sum(srbf_x a) {
    const __m128 half = SRBF_X_HALF(a), sum = _mm_add_ps(half, _mm_movehl_ps(half, half));
    return _mm_cvtss_f32(_mm_add_ss(sum, _mm_shuffle_ps(sum, sum, 1)));
}
SRBF_FN srbf_x srbf_x_inversesqrt(srbf_x a) {
    const srbf_x y = SRBF_X(rsqrt)(srbf_x_max(a, srbf_x_of(1.17549435e-38f)));
    return y * (1.5f - 0.5f * a * y * y);
}
#else
SRBF_FN srbf_x srbf_x_min(srbf_x a, srbf_x b) { return srbf_x_select(a < b, a, b); }
SRBF_FN srbf_x srbf_x_max(srbf_x a, srbf_x b) { return srbf_x_select(a > b, a, b); }
SRBF_FN float srbf_x_sum(srbf_x a) {
    float all[SRBF_LANES], sum = 0.0f;
    int i;
    srbf_x_store(a, all);
    for (i = 0; i < SRBF_LANES; ++i) sum += all[i];
    return sum;
}
SRBF_FN srbf_x srbf_x_inversesqrt(srbf_x a) {
    const srbf_x half = 0.5f * a;
    const srbf_x_bits shifted = srbf_x_bits_of(a) >> 1;
    srbf_x y = srbf_x_of_bits(0x5f375a86u - shifted);
    int i;
    for (i = 0; i < 3; ++i) y = y * (1.5f - half * y * y);
    return y;
}
#endif
SRBF_FN srbf_x srbf_x_sqrt(srbf_x a) { return a * srbf_x_inversesqrt(a); }

// 2^a by the nearest integer and a polynomial for the rest, for |a| < 126; relative error 2e-7. The integer is that of
// a conversion: adding and subtracting a large number rounds too, but fast math cancels both.
SRBF_FN srbf_x srbf_x_exp2(srbf_x a) {
    const srbf_x_mask whole = SRBF_X_CONVERTED(srbf_x_mask, a + 128.5f) - 128;
    const srbf_x r = a - SRBF_X_CONVERTED(srbf_x, whole);
    srbf_x power = 0.00132646454f * r + 0.00967157641f;
    power = (power * r + 0.0555073452f) * r + 0.240222411f;
    power = (power * r + 0.693146977f) * r + 1.0f;
    return srbf_x_of_bits(srbf_x_bits_of(power) + ((srbf_x_bits)whole << 23));
}
SRBF_FN srbf_x srbf_x_exp(srbf_x a) { return srbf_x_exp2(1.44269504f * a); }

typedef struct {
    srbf_x x, y, z;
} srbf_x_vec3;
SRBF_FN srbf_x_vec3 srbf_x_vec3_of(srbf_x x, srbf_x y, srbf_x z) {
    srbf_x_vec3 w = {x, y, z};
    return w;
}
SRBF_FN srbf_x_vec3 srbf_x_add(srbf_x_vec3 a, srbf_x_vec3 b) { return srbf_x_vec3_of(a.x + b.x, a.y + b.y, a.z + b.z); }
SRBF_FN srbf_x_vec3 srbf_x_subtract(srbf_x_vec3 a, srbf_x_vec3 b) {
    return srbf_x_vec3_of(a.x - b.x, a.y - b.y, a.z - b.z);
}
SRBF_FN srbf_x_vec3 srbf_x_scale(srbf_x s, srbf_x_vec3 a) { return srbf_x_vec3_of(s * a.x, s * a.y, s * a.z); }
SRBF_FN srbf_x srbf_x_dot(srbf_x_vec3 a, srbf_x_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
SRBF_FN srbf_x_vec3 srbf_x_rows(const float* row) {
    return srbf_x_vec3_of(srbf_x_load(row), srbf_x_load(row + 8), srbf_x_load(row + 16));
}
SRBF_FN srbf_x_vec3 srbf_x_all(srbf_vec3 a) { return srbf_x_vec3_of(srbf_x_of(a.x), srbf_x_of(a.y), srbf_x_of(a.z)); }
