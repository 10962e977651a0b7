// srbf_runtime.h: loads a model file of srbf (.srbf) and evaluates it, in C99 and C++. It needs <math.h> and
// <string.h>, and on x86 <immintrin.h>, allocates nothing, reads no file, and has no variables. Printed by srbf; the
// text is under the MIT License.
//
// One source file of the program defines SRBF_RUNTIME_IMPLEMENTATION before it includes this header. Or each file that
// includes it defines SRBF_RUNTIME_STATIC, and has functions of its own. For a linker, names have the version, so that
// two plugins with two versions in one process do not call each other's functions: srbf_value is
// srbf_v0_1_value.
//
// Directions are unit vectors (x, y, z) in the local frame, whose z is the shading normal; wl points to the light, wv
// to the viewer. Lengths are not checked. Colours are R, G, B in linear sRGB.
#ifndef SRBF_RUNTIME_H
#define SRBF_RUNTIME_H

#include <string.h>

// clang-format off
#define SRBF_VERSIONED(name) srbf_v0_1_##name
// clang-format on
#define srbf_memory_needed SRBF_VERSIONED(memory_needed)
#define srbf_open SRBF_VERSIONED(open)
#define srbf_prepare SRBF_VERSIONED(prepare)
#define srbf_is_two_sided SRBF_VERSIONED(is_two_sided)
#define srbf_value SRBF_VERSIONED(value)
#define srbf_values SRBF_VERSIONED(values)
#define srbf_sample SRBF_VERSIONED(sample)
#define srbf_pdf SRBF_VERSIONED(pdf)
#define srbf_value_pdf SRBF_VERSIONED(value_pdf)
#define srbf_albedo SRBF_VERSIONED(albedo)
#if defined SRBF_RUNTIME_STATIC && defined __GNUC__
#define SRBF_API static __attribute__((unused))
#elif defined SRBF_RUNTIME_STATIC
#define SRBF_API static
#else
#define SRBF_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef enum srbf_error {
    SRBF_OK,
    SRBF_NO_MODEL,       // the bytes do not begin as a model file does, or end within its header
    SRBF_BAD_HEADER,     // a malformed header, or tensors that do not fill the file
    SRBF_OTHER_VERSION,  // a file of another version
    SRBF_OTHER_KIND,     // a kind of model that is not known here, or a file of several models
    SRBF_BAD_METADATA,   // a word that is missing, or is none of the format's
    SRBF_BAD_TENSOR,     // a tensor that is missing, of another shape, or unknown
    SRBF_BAD_NUMBER,     // a number out of its range
    SRBF_TOO_LITTLE_MEMORY
} srbf_error;

typedef struct srbf_brdf srbf_brdf;

// The memory that srbf_open needs for this file, about 150 kB and 16 bytes for each byte of a file at most; 0 if the
// file cannot be opened.
SRBF_API size_t srbf_memory_needed(const void* bytes, size_t size);

// Reads a model file in the caller's memory, of any alignment; *brdf lies there. The bytes are not needed afterwards.
// In case of an error, *offset (unless offset is null) is where in the file it is.
SRBF_API srbf_error srbf_open(const void* bytes, size_t size, void* memory, size_t capacity, srbf_brdf** brdf,
                              size_t* offset);

// Computes the densities that samples are drawn from, and the directional albedos: about 0.2 s for each side
// of a surface. Before it, samples are drawn by the cosine, and albedos are 0. Afterwards, several threads may use a
// model.
SRBF_API void srbf_prepare(srbf_brdf* brdf);

// 1 for a two-sided surface, for which z < 0 is the back. Other models are 0 where a z is not above 0.
SRBF_API int srbf_is_two_sided(const srbf_brdf* brdf);

// f(wl, wv) [1/sr], without the cosine. Finite and at least 0. It is 0 if a direction lies below the horizon or in the
// surface (z is 0 or subnormal), or has a component that is not finite or at least 2^50; of a two-sided surface also
// without its beams.
SRBF_API void srbf_value(const srbf_brdf* brdf, const float wl[3], const float wv[3], float rgb[3]);
// Evaluates `count` pairs; each direction and colour is three floats of the arrays.
SRBF_API void srbf_values(const srbf_brdf* brdf, size_t count, const float* wl, const float* wv, float* rgb);

typedef struct srbf_light {
    float wl[3];      // the direction to the light, if pdf > 0 or is_beam
    float weight[3];  // f |cos(theta_l)| / pdf, or of a beam its share over the chance that it is drawn
    float pdf;        // [1/sr]; 0 for a beam, and where the sample has no direction, which then counts with weight 0
    int is_beam;      // light that a two-sided surface does not scatter
} srbf_light;

// Samples a direction to the light from three independent numbers, uniform in [0, 1): a point, and the selector of a
// lobe.
SRBF_API void srbf_sample(const srbf_brdf* brdf, const float wv[3], const float u[3], srbf_light* light);
// The density of srbf_sample [1/sr], 0 where srbf_value is 0 by its directions.
SRBF_API float srbf_pdf(const srbf_brdf* brdf, const float wl[3], const float wv[3]);
// Both.
SRBF_API float srbf_value_pdf(const srbf_brdf* brdf, const float wl[3], const float wv[3], float rgb[3]);

// The share of the light that is reflected to a view at this cosine to the normal, as the mean over four azimuths:
// ∫ f(wl, wv) cos(theta_l) dwl, estimated by samples. It is within about 3 %, and rough where it depends on the
// azimuth. Cosines below 0 are at the back.
SRBF_API void srbf_albedo(const srbf_brdf* brdf, float cosine, float rgb[3]);

#ifdef __cplusplus
}
#endif

#endif

#if (defined SRBF_RUNTIME_IMPLEMENTATION || defined SRBF_RUNTIME_STATIC) && !defined SRBF_RUNTIME_IMPLEMENTED
#define SRBF_RUNTIME_IMPLEMENTED
#include <math.h>
#include <string.h>

#ifndef SRBF_VEC3
#define SRBF_VEC3
#ifdef __CUDACC__
#define SRBF_FN __host__ __device__ static inline
#elif defined __GNUC__ && defined __OPTIMIZE_SIZE__
#define SRBF_FN static __attribute__((unused))
#else
#define SRBF_FN static inline
#endif
typedef struct {
    float x, y, z;
} srbf_vec3;
SRBF_FN srbf_vec3 srbf_vec3_of(float x, float y, float z) { srbf_vec3 w = {x, y, z}; return w; }
SRBF_FN srbf_vec3 srbf_add(srbf_vec3 a, srbf_vec3 b) { return srbf_vec3_of(a.x + b.x, a.y + b.y, a.z + b.z); }
SRBF_FN srbf_vec3 srbf_subtract(srbf_vec3 a, srbf_vec3 b) { return srbf_vec3_of(a.x - b.x, a.y - b.y, a.z - b.z); }
SRBF_FN srbf_vec3 srbf_scale(float s, srbf_vec3 a) { return srbf_vec3_of(s * a.x, s * a.y, s * a.z); }
SRBF_FN float srbf_dot(srbf_vec3 a, srbf_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
SRBF_FN float srbf_min(float a, float b) { return a < b ? a : b; }
SRBF_FN float srbf_max(float a, float b) { return a > b ? a : b; }
// The processor's instruction, without sqrtf's errno.
#if defined __SSE__ && !defined __CUDACC__
#include <xmmintrin.h>
SRBF_FN float srbf_sqrt(float x) { return _mm_cvtss_f32(_mm_sqrt_ss(_mm_set_ss(x))); }
#else
SRBF_FN float srbf_sqrt(float x) { return sqrtf(x); }
#endif
SRBF_FN float srbf_inversesqrt(float x) { return 1.0f / srbf_sqrt(x); }
// True if no component is a NaN, infinite, or 2^50 and more: by bits, since fast math takes every number for finite.
SRBF_FN int srbf_is_finite(srbf_vec3 w) {
    unsigned bits[3];
    memcpy(bits, &w, sizeof bits);
    return bits[0] << 1 < 0xb1000000u && bits[1] << 1 < 0xb1000000u && bits[2] << 1 < 0xb1000000u;
}
#endif

#define SRBF_MOST_VARIATES 8

#ifndef SRBF_LANES
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
typedef struct {
    float x[4];
} srbf_PmFeatures;
SRBF_FN srbf_PmFeatures srbf_pm_further_features(int count, srbf_vec3 wl, srbf_vec3 wv) {
    srbf_PmFeatures features;
    for (int k = 0; k < 4; ++k) features.x[k] = 0.0f;
    if (count > 0) features.x[0] = logf(srbf_max(wl.z, 1.0e-6f) * srbf_max(wv.z, 1.0e-6f));
    if (count > 1) {
        srbf_vec3 sum = srbf_add(wl, wv);
        float squared = srbf_max(srbf_dot(sum, sum), 1.0e-12f);
        float across = (sum.x * sum.x + sum.y * sum.y) / squared;
        float apart = wl.z - wv.z;
        features.x[1] = 0.5f * srbf_sqrt(squared) - 1.0f;
        features.x[2] = 0.05f - srbf_sqrt(apart * apart + 0.0625f * across + 0.0025f);
        features.x[3] = -srbf_sqrt(across);
    }
    return features;
}

typedef struct {
    srbf_x across, along;
} srbf_x_AxialPsi;
SRBF_FN srbf_x_vec3 srbf_x_psi(srbf_x_vec3 wl, srbf_x_vec3 wv, srbf_x a, srbf_x b) {
    srbf_x_vec3 d = srbf_x_add(srbf_x_scale(a, wl), srbf_x_scale(b, wv));
    return srbf_x_scale(srbf_x_inversesqrt(srbf_x_max(srbf_x_dot(d, d), srbf_x_of(1.0e-20f))), d);
}
SRBF_FN srbf_x_AxialPsi srbf_x_axial_psi(srbf_x_vec3 wl, srbf_x_vec3 wv, srbf_x a, srbf_x b) {
    srbf_x_vec3 d = srbf_x_add(srbf_x_scale(a, wl), srbf_x_scale(b, wv));
    srbf_x reciprocal = srbf_x_inversesqrt(srbf_x_max(srbf_x_dot(d, d), srbf_x_of(1.0e-20f)));
    srbf_x_AxialPsi psi_;
    psi_.across = reciprocal * reciprocal * (d.x * d.x + d.y * d.y);
    psi_.along = reciprocal * d.z;
    return psi_;
}
SRBF_FN srbf_x srbf_x_squared_distance_from_pole(srbf_x_AxialPsi psi_, srbf_x pole) {
    srbf_x apart = psi_.along - pole;
    return psi_.across + apart * apart;
}
SRBF_FN srbf_x srbf_x_squared_distance(srbf_x_vec3 psi_, srbf_x_vec3 centre) {
    srbf_x_vec3 apart = srbf_x_subtract(psi_, centre);
    return srbf_x_dot(apart, apart);
}
SRBF_FN srbf_x srbf_x_pm_power(srbf_x exponent) {
    return srbf_x_exp2(srbf_x_max(srbf_x_min(exponent, srbf_x_of(100.0f)), -srbf_x_of(100.0f)));
}

// The form of a multivariate model. Its numbers are 16 weights of variates by the light, 16 by the viewer, of a
// reciprocal model with the exchanged ones after them; then groups of eight lobes. A row has a number of each lobe. A
// group has the rows: log2 of the scale; R, G, B; the exponents; and for each variate minus its falloff, if its centre
// is +z and if it is -z, or with x, y, z of the centre. Lobes that the last group lacks are 0.
#define SRBF_FIRST_ROW 32
typedef struct {
    int lobes, variates, features, axial, reciprocal;
} srbf_form;
SRBF_FN int srbf_rows_of_variate(srbf_form form) { return form.axial ? 2 : 4; }
SRBF_FN int srbf_rows(srbf_form form) { return 4 + form.features + form.variates * srbf_rows_of_variate(form); }

// pm_value of kernel.glsl, with variates in lanes, then lobes. x has in all lanes each variate's x, y, z, or of an
// axial model its squared distances from +z and from -z; further has the features. Constant sizes make it faster.
SRBF_INLINE srbf_vec3 srbf_lobes_value(srbf_form form, const float* number, srbf_vec3 wl, srbf_vec3 wv) {
    const int axial = form.axial, variates = form.variates, count = form.features;
    const int other = form.reciprocal ? variates : 0, columns = srbf_rows_of_variate(form);
    const srbf_PmFeatures features = srbf_pm_further_features(count, wl, wv);
    const srbf_x_vec3 l = srbf_x_all(wl), v = srbf_x_all(wv);
    srbf_x x[16][3], further[4];
    srbf_x_vec3 sum = srbf_x_all(srbf_vec3_of(0.0f, 0.0f, 0.0f));
    float each[3][SRBF_LANES];
    int j, n, k;
    SRBF_UNROLL
    for (k = 0; k < 4; ++k) further[k] = srbf_x_of(features.x[k]);
    SRBF_UNROLL
    for (n = 0; n < variates + other; ++n) {
        if (n % SRBF_LANES == 0) {
            const srbf_x a = srbf_x_load(number + n), b = srbf_x_load(number + 16 + n);
            const srbf_x_AxialPsi at = srbf_x_axial_psi(l, v, a, b);
            const srbf_x_vec3 psi = srbf_x_psi(l, v, a, b);
            srbf_x_store(axial ? srbf_x_squared_distance_from_pole(at, srbf_x_of(1.0f)) : psi.x, each[0]);
            srbf_x_store(axial ? srbf_x_squared_distance_from_pole(at, srbf_x_of(-1.0f)) : psi.y, each[1]);
            srbf_x_store(psi.z, each[2]);
        }
        for (k = 0; k < columns - columns / 4; ++k) x[n][k] = srbf_x_of(each[k][n % SRBF_LANES]);
    }
    for (j = 0; j < form.lobes; j += SRBF_LANES) {
        const float *group = number + SRBF_FIRST_ROW + j / 8 * 8 * srbf_rows(form) + j % 8, *row = group + 32;
        srbf_x exponent = srbf_x_load(group), exchanged, power;
        SRBF_UNROLL
        for (k = 0; k < count; ++k, row += 8) exponent = exponent + srbf_x_load(row) * further[k];
        exchanged = exponent;
        SRBF_UNROLL
        for (n = 0; n < variates; ++n, row += 8 * columns) {
            const srbf_x first = srbf_x_load(row), second = srbf_x_load(row + 8);
            const srbf_x *y = x[n], *z = x[n + other];
            if (axial) {
                exponent = exponent + first * y[0] + second * y[1];
                exchanged = exchanged + first * z[0] + second * z[1];
            } else {
                const srbf_x_vec3 xi = srbf_x_rows(row + 8);
                exponent = exponent + first * srbf_x_squared_distance(srbf_x_vec3_of(y[0], y[1], y[2]), xi);
                exchanged = exchanged + first * srbf_x_squared_distance(srbf_x_vec3_of(z[0], z[1], z[2]), xi);
            }
        }
        power = srbf_x_pm_power(exponent);
        if (form.reciprocal) power = srbf_x_of(0.5f) * (power + srbf_x_pm_power(exchanged));
        sum = srbf_x_add(sum, srbf_x_scale(power, srbf_x_rows(group + 8)));
    }
    return srbf_vec3_of(srbf_max(srbf_x_sum(sum.x), 0.0f), srbf_max(srbf_x_sum(sum.y), 0.0f),
                        srbf_max(srbf_x_sum(sum.z), 0.0f));
}
#endif

#ifndef SRBF_NODES
typedef struct {
    float xx, xy, yy;
} srbf_Facets;
SRBF_FN srbf_vec3 srbf_from_frame(srbf_vec3 n, float x, float y, float z) {
    float sign = n.z < 0.0f ? -1.0f : 1.0f;
    float a = -1.0f / (sign + n.z);
    float b = n.x * n.y * a;
    return srbf_add(srbf_add(srbf_scale(x, srbf_vec3_of(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x)),
            srbf_scale(y, srbf_vec3_of(b, sign + n.y * n.y * a, -n.y))), srbf_scale(z, n));
}
SRBF_FN srbf_vec3 srbf_off_centre(srbf_vec3 centre, float below, float u2) {
    float sine = srbf_sqrt(srbf_max(-below * (2.0f + below), 0.0f));
    float phi = 6.283185307179586f * u2;
    return srbf_from_frame(centre, sine * cosf(phi), sine * sinf(phi), 1.0f + below);
}
SRBF_FN float srbf_sample_below(float width, float rest, float u1) {
    return logf(srbf_max(u1 + (1.0f - u1) * rest, 1.0e-35f)) * width;
}
SRBF_FN srbf_vec3 srbf_sample_sharp_vmf(srbf_vec3 centre, float width, float rest, float u1, float u2) {
    return srbf_off_centre(centre, srbf_max(srbf_sample_below(width, rest, u1), -2.0f), u2);
}
SRBF_FN float srbf_below_power_cosine(float width, float u1) {
    return srbf_min(expf(srbf_sample_below(width, 0.0f, u1)), 1.0f) - 1.0f;
}
SRBF_FN srbf_vec3 srbf_grown_along(srbf_vec3 w, float x, float y, float gain) {
    float along = gain * (w.x * x + w.y * y);
    return srbf_vec3_of(w.x + along * x, w.y + along * y, w.z);
}
SRBF_FN srbf_vec3 srbf_light_of(srbf_vec3 h, srbf_vec3 wv) {
    float twice = 2.0f * srbf_dot(h, wv) / srbf_max(srbf_dot(h, h), 1.0e-20f);
    return srbf_scale(0.0f < h.z ? 1.0f : 0.0f, srbf_subtract(srbf_scale(twice, h), wv));
}
SRBF_FN srbf_vec3 srbf_roughened_by(srbf_Facets facets, srbf_vec3 w) {
    return srbf_vec3_of(facets.xx * w.x + facets.xy * w.y, facets.xy * w.x + facets.yy * w.y, w.z);
}
SRBF_FN float srbf_visible_normals_pdf(srbf_vec3 wl, srbf_vec3 wv, srbf_Facets facets) {
    srbf_vec3 sum = srbf_add(wl, wv);
    float product = facets.xx * facets.yy - facets.xy * facets.xy;
    srbf_vec3 back = srbf_vec3_of(facets.yy * sum.x - facets.xy * sum.y, facets.xx * sum.y - facets.xy * sum.x,
            product * sum.z);
    float slope = srbf_max(srbf_dot(back, back) / (product * srbf_max(srbf_dot(sum, sum), 1.0e-12f)), 1.0e-10f);
    srbf_vec3 seen = srbf_roughened_by(facets, wv);
    float density = product / (6.283185307179586f * slope * slope * (wv.z + srbf_sqrt(srbf_dot(seen, seen))));
    return 1.0e-6f < sum.z ? density : 0.0f;
}
SRBF_FN srbf_vec3 srbf_sample_visible_normals(srbf_vec3 wv, srbf_Facets facets, float u1, float u2) {
    srbf_vec3 seen = srbf_roughened_by(facets, wv);
    seen = srbf_scale(srbf_inversesqrt(srbf_max(srbf_dot(seen, seen), 1.0e-20f)), seen);
    float phi = 6.283185307179586f * u2;
    float z = (1.0f - u1) * (1.0f + seen.z) - seen.z;
    float radius = srbf_sqrt(srbf_max(1.0f - z * z, 0.0f));
    srbf_vec3 normal = srbf_vec3_of(seen.x + radius * cosf(phi), seen.y + radius * sinf(phi), seen.z + z);
    return srbf_light_of(srbf_roughened_by(facets, normal), wv);
}
SRBF_FN srbf_vec3 srbf_reflected_up(srbf_vec3 wl) { return srbf_vec3_of(wl.x, wl.y, srbf_max(wl.z, -wl.z)); }
SRBF_FN srbf_vec3 srbf_sample_facets(srbf_vec3 wv, srbf_Facets facets, float u1, float u2) {
    return srbf_reflected_up(srbf_sample_visible_normals(wv, facets, u1, u2));
}
SRBF_FN float srbf_facets_pdf(srbf_vec3 wl, srbf_vec3 wv, srbf_Facets facets) {
    return srbf_visible_normals_pdf(wl, wv, facets) + srbf_visible_normals_pdf(srbf_vec3_of(wl.x, wl.y, -wl.z), wv,
            facets);
}
SRBF_FN float srbf_mixture_position(float z) {
    float root = srbf_sqrt(srbf_sqrt(srbf_max(z, 0.0f)));
    return srbf_min(srbf_max(1.0f - root, 0.0f) * (1.0f / 0.9f), 1.0f);
}

typedef struct {
    srbf_x_vec3 centre;
    srbf_x bandwidth, width;
} srbf_x_GaussianProduct;
typedef struct {
    srbf_x x, y, stretch_minus_1, inverse_minus_1, inverse;
} srbf_x_Stretch;
typedef struct {
    srbf_x_vec3 direction;
    srbf_x factor;
} srbf_x_HalfVector;
typedef struct {
    srbf_x_vec3 centre;
    srbf_x bandwidth, width, scale, rest;
} srbf_x_ProposalLobe;
SRBF_FN srbf_x srbf_x_exp_of_lobe(srbf_x x) { return srbf_x_exp(srbf_x_max(x, -srbf_x_of(60.0f))); }
SRBF_FN srbf_x srbf_x_gaussian_exponent(srbf_x_vec3 omega, srbf_x_vec3 centre, srbf_x bandwidth) {
    srbf_x_vec3 d = srbf_x_subtract(omega, centre);
    return -srbf_x_of(0.5f) * bandwidth * srbf_x_dot(d, d);
}
SRBF_FN srbf_x srbf_x_gaussian(srbf_x_vec3 omega, srbf_x_vec3 centre, srbf_x bandwidth) {
    return srbf_x_exp_of_lobe(srbf_x_gaussian_exponent(omega, centre, bandwidth));
}
SRBF_FN srbf_x_GaussianProduct srbf_x_gaussian_product(srbf_x_vec3 centre1, srbf_x bandwidth1, srbf_x_vec3 centre2,
        srbf_x bandwidth2) {
    srbf_x_vec3 axis = srbf_x_add(srbf_x_scale(bandwidth1, centre1), srbf_x_scale(bandwidth2, centre2));
    srbf_x squared = srbf_x_dot(axis, axis);
    srbf_x_GaussianProduct product;
    product.width = srbf_x_inversesqrt(srbf_x_max(squared, srbf_x_of(1.0e-30f)));
    product.bandwidth = squared * product.width;
    product.centre = srbf_x_scale(product.width, axis);
    return product;
}
SRBF_FN srbf_x_Stretch srbf_x_stretch_along(srbf_x_vec3 tangent, srbf_x stretch) {
    srbf_x_Stretch map;
    map.x = tangent.x;
    map.y = tangent.y;
    srbf_x reciprocal = srbf_x_of(1.0f) / srbf_x_max(tangent.x * tangent.x + tangent.y * tangent.y,
            srbf_x_of(1.0e-20f));
    map.inverse = srbf_x_of(1.0f) / stretch;
    map.stretch_minus_1 = (stretch - srbf_x_of(1.0f)) * reciprocal;
    map.inverse_minus_1 = (map.inverse - srbf_x_of(1.0f)) * reciprocal;
    return map;
}
SRBF_FN srbf_x_vec3 srbf_x_grown_along(srbf_x_vec3 w, srbf_x x, srbf_x y, srbf_x gain) {
    srbf_x along = gain * (w.x * x + w.y * y);
    return srbf_x_vec3_of(w.x + along * x, w.y + along * y, w.z);
}
SRBF_FN srbf_x_vec3 srbf_x_stretched(srbf_x_vec3 w, srbf_x_Stretch map) {
    return srbf_x_grown_along(w, map.x, map.y, map.stretch_minus_1);
}
SRBF_FN srbf_x_GaussianProduct srbf_x_visible_lobe(srbf_x_vec3 viewer, srbf_x inverse, srbf_x bandwidth, srbf_x power) {
    srbf_x z = srbf_x_max(viewer.z, srbf_x_of(0.0f));
    srbf_x sharpness = srbf_x_of(2.0f) * power / srbf_x_max(z + srbf_x_sqrt(z * z + srbf_x_of(4.0f) * power / (inverse *
            inverse * bandwidth)), srbf_x_of(1.0e-6f));
    return srbf_x_gaussian_product(srbf_x_vec3_of(srbf_x_of(0.0f), srbf_x_of(0.0f), srbf_x_of(1.0f)), bandwidth, viewer,
            sharpness);
}
SRBF_FN srbf_x_HalfVector srbf_x_half_vector(srbf_x_vec3 wl, srbf_x_vec3 wv, srbf_x_Stretch map) {
    srbf_x_vec3 sum = srbf_x_add(wl, wv);
    srbf_x squared = srbf_x_dot(sum, sum);
    srbf_x_vec3 back = srbf_x_grown_along(sum, map.x, map.y, map.inverse_minus_1);
    srbf_x reciprocal = srbf_x_inversesqrt(srbf_x_max(srbf_x_dot(back, back), srbf_x_of(1.0e-20f)));
    srbf_x_HalfVector h;
    h.direction = srbf_x_scale(srbf_x_select(sum.z < srbf_x_of(0.0f), -srbf_x_of(1.0f), srbf_x_of(1.0f)) * reciprocal,
            back);
    srbf_x exists = srbf_x_select(srbf_x_of(1.0e-12f) < squared, srbf_x_of(0.5f), srbf_x_of(0.0f)) * map.inverse;
    h.factor = exists * squared * (reciprocal * reciprocal * reciprocal);
    return h;
}
SRBF_FN srbf_x_ProposalLobe srbf_x_half_vector_lobe(srbf_x_vec3 viewer, srbf_x inverse, srbf_x bandwidth,
        srbf_x power) {
    srbf_x_GaussianProduct product = srbf_x_visible_lobe(viewer, inverse, bandwidth, power);
    srbf_x_ProposalLobe lobe;
    lobe.centre = product.centre;
    lobe.bandwidth = product.bandwidth;
    lobe.width = product.width;
    lobe.scale = product.bandwidth * (srbf_x_of(1.0f) / srbf_x_of(6.283185307179586f));
    lobe.rest = srbf_x_of(0.0f);
    return lobe;
}
SRBF_FN srbf_x srbf_x_reflected_pdf(srbf_x_ProposalLobe lobe, srbf_x_HalfVector above, srbf_x_HalfVector below) {
    return lobe.scale * (srbf_x_gaussian(above.direction, lobe.centre, lobe.bandwidth) * above.factor +
            srbf_x_gaussian(below.direction, lobe.centre, lobe.bandwidth) * below.factor);
}

SRBF_FN const float* srbf_slots(void) {
    static const float numbers[64] = {
        0.0f, 0.0f, 4.0f, 16.0f, 64.0f, 256.0f, 32768.0f, 131072.0f,
        0.5f, 0.33333334f, 0.25f, 0.0625f, 0.015625f, 0.00390625f, 3.0517578e-05f, 7.6293945e-06f,
        0.31830987f, 0.47746482f, 0.63683337f, 2.546479f, 10.185916f, 40.743664f, 5215.189f, 20860.756f,
        0.0f, 0.0f, 0.00033546262f, 1.2664166e-14f, 8.756511e-27f, 8.756511e-27f, 8.756511e-27f, 8.756511e-27f,
        0.0f, 0.0f, 1.0f, 1.0f, 1.0f, 1.0f, 1.0f, 1.0f,
        1.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f,
        0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f,
        8.0f, 32.0f, 128.0f, 512.0f, 2048.0f, 8192.0f, 32768.0f, 131072.0f,
    };
    return numbers;
}
// A mixture of the components of kernel.glsl's proposal, whose weights are linear in mixture_position(cos(theta_v))
// between nodes: cosines and lobes of directions, from 8 on lobes of half vectors, then facets. After the weights
// follow stretch and power of the half-vector lobes.
#define SRBF_NODES 15
#define SRBF_SLOTS 8
#define SRBF_FACET_SLOT (2 * SRBF_SLOTS)
#define SRBF_STRETCH (2 * SRBF_SLOTS + 2)
#define SRBF_NUMBERS (3 * SRBF_SLOTS)
typedef struct {
    float axis[2];  // the tangent along which half-vector lobes are stretched; 0 for the viewer's
    int facets;
    srbf_Facets facet[2];
    float number[SRBF_NODES][SRBF_NUMBERS];
} srbf_mixture;

// A mixture for a view, with its interpolated numbers and its lobes.
typedef struct {
    const srbf_mixture* mixture;
    srbf_vec3 wv;
    float number[SRBF_NUMBERS];
    srbf_x_Stretch map;
    int has_halves;
    srbf_x_ProposalLobe lobe[SRBF_FACET_SLOT / SRBF_LANES];  // of groups of slots that have weight
} srbf_view;
SRBF_FN int srbf_has_weight(const srbf_view* view, int slot) {
    return srbf_x_sum(srbf_x_load(view->number + slot)) > 0.0f;
}

// Sets what follows from a view's direction and numbers.
SRBF_FN void srbf_set_view(srbf_view* view) {
    const float *slots = srbf_slots(), *axis = view->mixture->axis;
    const int has_axis = axis[0] != 0.0f || axis[1] != 0.0f;
    const srbf_x_vec3 v = srbf_x_all(view->wv),
                      tangent = has_axis ? srbf_x_all(srbf_vec3_of(axis[0], axis[1], 0.0f)) : v;
    const srbf_x power = srbf_x_of(view->number[SRBF_STRETCH + 1]);
    int i;
    view->has_halves = 0;
    view->map = srbf_x_stretch_along(tangent, srbf_x_of(view->number[SRBF_STRETCH]));
    for (i = 0; i < SRBF_SLOTS; i += SRBF_LANES, slots += SRBF_LANES) {
        srbf_x_ProposalLobe* lobe = &view->lobe[i / SRBF_LANES];
        lobe->centre = srbf_x_vec3_of(-v.x, -v.y, v.z), lobe->bandwidth = srbf_x_load(slots);
        lobe->width = srbf_x_load(slots + 8), lobe->scale = srbf_x_load(slots + 16);
        lobe->rest = srbf_x_load(slots + 24);
        if (!srbf_has_weight(view, SRBF_SLOTS + i)) continue;
        view->has_halves = 1;
        lobe[SRBF_SLOTS / SRBF_LANES] =
            srbf_x_half_vector_lobe(srbf_x_stretched(v, view->map), view->map.inverse, srbf_x_load(slots + 56), power);
    }
}
SRBF_FN void srbf_view_of(srbf_view* view, const srbf_mixture* mixture, srbf_vec3 wv) {
    const float at = srbf_mixture_position(wv.z) * (float)(SRBF_NODES - 1);
    const int below = (int)srbf_min(at, (float)(SRBF_NODES - 2));
    const srbf_x beyond = srbf_x_of(at - (float)below);
    const float* number = mixture->number[below];
    int i;
    view->mixture = mixture, view->wv = wv;
    for (i = 0; i < SRBF_NUMBERS; i += SRBF_LANES) {
        const srbf_x low = srbf_x_load(number + i), high = srbf_x_load(number + SRBF_NUMBERS + i);
        srbf_x_store(low + beyond * (high - low), view->number + i);
    }
    srbf_set_view(view);
}

// The density of a direction, and unless `density` is null those of all slots that have weight.
SRBF_FN float srbf_view_pdf(const srbf_view* view, srbf_vec3 wl, float* density) {
    const srbf_x_vec3 l = srbf_x_all(wl), v = srbf_x_all(view->wv), mirrored = srbf_x_vec3_of(l.x, l.y, -l.z);
    const float* slots = srbf_slots();
    float pdf, facets[2] = {0.0f, 0.0f};
    srbf_x_HalfVector above[2], below[2];  // of lobes of directions, and of half vectors
    srbf_x sum = srbf_x_of(0.0f);
    int i;
    above[0].direction = l, below[0].direction = mirrored, above[0].factor = below[0].factor = srbf_x_of(1.0f);
    above[1] = above[0], below[1] = below[0];
    if (view->has_halves) {
        above[1] = srbf_x_half_vector(l, v, view->map);
        below[1] = srbf_x_half_vector(mirrored, v, view->map);
    }
    SRBF_UNROLL
    for (i = 0; i < SRBF_FACET_SLOT; i += SRBF_LANES) {
        if (srbf_has_weight(view, i)) {
            const int kind = i / SRBF_SLOTS;
            srbf_x each;
            if (i < SRBF_SLOTS) {  // the cosines are 0 below the horizon
                below[0].factor = srbf_x_load(slots + 32 + i);
                above[0].factor =
                    below[0].factor + l.z * (srbf_x_load(slots + 40 + i) + l.z * srbf_x_load(slots + 48 + i));
            }
            each = srbf_x_reflected_pdf(view->lobe[i / SRBF_LANES], above[kind], below[kind]);
            sum = sum + srbf_x_load(view->number + i) * each;
            if (density) srbf_x_store(each, density + i);
        }
    }
    pdf = srbf_x_sum(sum);
    for (i = 0; i < view->mixture->facets; ++i) {
        facets[i] = srbf_facets_pdf(wl, view->wv, view->mixture->facet[i]);
        pdf += view->number[SRBF_FACET_SLOT + i] * facets[i];
    }
    if (density) memcpy(density + SRBF_FACET_SLOT, facets, sizeof facets);
    return pdf;
}

SRBF_FN float srbf_lane(srbf_x x, int i) {
    float all[SRBF_LANES];
    srbf_x_store(x, all);
    return all[i];
}
// A direction of a slot; z <= 0 if there is none.
SRBF_FN srbf_vec3 srbf_slot_sample(const srbf_view* view, int slot, float u1, float u2) {
    const int facet = slot - SRBF_FACET_SLOT, lane = slot % SRBF_LANES;
    const srbf_x_ProposalLobe* lobe = &view->lobe[facet < 0 ? slot / SRBF_LANES : 0];
    srbf_vec3 w = srbf_vec3_of(0.0f, 0.0f, 1.0f);
    if (slot < 2) return srbf_off_centre(w, srbf_below_power_cosine(1.0f / (float)(2 + slot), u1), u2);
    if (facet >= 0) return srbf_sample_facets(view->wv, view->mixture->facet[facet], u1, u2);
    w = srbf_vec3_of(srbf_lane(lobe->centre.x, lane), srbf_lane(lobe->centre.y, lane), srbf_lane(lobe->centre.z, lane));
    w = srbf_sample_sharp_vmf(w, srbf_lane(lobe->width, lane), srbf_lane(lobe->rest, lane), u1, u2);
    if (slot >= SRBF_SLOTS) {
        w = srbf_grown_along(w, srbf_lane(view->map.x, 0), srbf_lane(view->map.y, 0),
                             srbf_lane(view->map.stretch_minus_1, 0));
        w = srbf_light_of(w, view->wv);
    }
    return srbf_reflected_up(w);
}
// A direction of the slot that a selector chooses. A rest by rounding is the cosine's.
SRBF_FN srbf_vec3 srbf_view_sample(const srbf_view* view, float u1, float u2, float selector) {
    int slot = 0;
    for (; slot < SRBF_STRETCH && !(selector < view->number[slot]); ++slot) selector -= view->number[slot];
    return srbf_slot_sample(view, slot < SRBF_STRETCH ? slot : 0, u1, u2);
}
#endif

// ---- Models, and their numbers as the formulas read them ----

// A view-by-view model: for each view its direction, and for each of its lobes R, G, B, bandwidth and centre.
typedef struct {
    int views, lobes, of_lights, is_plain, neighbours;
    const float* number;
} srbf_view_lobes;
typedef const srbf_view_lobes* srbf_su;
typedef const int* srbf_su_nearest_views;
SRBF_FN int srbf_su_lobes(srbf_su su) { return su->lobes; }
SRBF_FN int srbf_su_views(srbf_su su) { return su->views; }
SRBF_FN const float* srbf_su_row(srbf_su su, int view) {
    return su->number + (size_t)view * (size_t)(3 + 7 * su->lobes);
}
SRBF_FN srbf_vec3 srbf_vec3_at(const float* w) { return srbf_vec3_of(w[0], w[1], w[2]); }
SRBF_FN srbf_vec3 srbf_su_direction(srbf_su su, int view) { return srbf_vec3_at(srbf_su_row(su, view)); }
SRBF_FN const float* srbf_su_lobe(srbf_su su, int view, int j) { return srbf_su_row(su, view) + 3 + 7 * j; }
SRBF_FN srbf_vec3 srbf_su_coefficient(srbf_su su, int view, int j) { return srbf_vec3_at(srbf_su_lobe(su, view, j)); }
SRBF_FN float srbf_su_bandwidth(srbf_su su, int view, int j) { return srbf_su_lobe(su, view, j)[3]; }
SRBF_FN srbf_vec3 srbf_su_centre(srbf_su su, int view, int j) { return srbf_vec3_at(srbf_su_lobe(su, view, j) + 4); }
SRBF_FN int srbf_su_nearest(srbf_su_nearest_views nearest, int k) { return nearest[k]; }
typedef struct {
    float roughness;
    srbf_vec3 f0;
    float f90;
} srbf_GgxLobe;
typedef struct {
    float scale, bias;
} srbf_FacetAlbedo;
typedef struct {
    srbf_vec3 base_color;
    float base_metalness, base_diffuse_roughness, specular_weight;
    srbf_vec3 specular_color;
    float specular_roughness, specular_ior, coat_weight;
    srbf_vec3 coat_color;
    float coat_roughness, coat_ior, coat_darkening, fuzz_weight;
    srbf_vec3 fuzz_color;
    float fuzz_roughness;
} srbf_OpenPbrSurface;
typedef struct {
    float weight, thickness, ior;
} srbf_OpenPbrFilm;
typedef struct {
    float amount, cosine, sine;
} srbf_OpenPbrAnisotropy;
typedef struct {
    float along, across;
} srbf_OpenPbrRoughness;
typedef struct {
    float reflectance, turn;
} srbf_FilmBase;
typedef struct {
    float f0, ior, alpha;
} srbf_OpenPbrBase;
typedef struct {
    srbf_vec3 dielectric, metal, dielectric_f0, metal_f0;
} srbf_OpenPbrFacets;
typedef struct {
    int view;
    float weight, cosine, sine;
} srbf_SuNeighbour;
SRBF_FN float srbf_exp_of_lobe(float x) { return expf(srbf_max(x, -60.0f)); }
SRBF_FN srbf_vec3 srbf_turned(srbf_vec3 w, float cosine, float sine) {
    return srbf_vec3_of(cosine * w.x - sine * w.y, sine * w.x + cosine * w.y, w.z);
}
SRBF_FN float srbf_gaussian_exponent(srbf_vec3 omega, srbf_vec3 centre, float bandwidth) {
    srbf_vec3 d = srbf_subtract(omega, centre);
    return -0.5f * bandwidth * srbf_dot(d, d);
}
SRBF_FN float srbf_gaussian(srbf_vec3 omega, srbf_vec3 centre, float bandwidth) {
    return srbf_exp_of_lobe(srbf_gaussian_exponent(omega, centre, bandwidth));
}
SRBF_FN srbf_Facets srbf_facets_along(float cosine, float sine, float along, float across) {
    srbf_Facets facets;
    facets.xx = along * cosine * cosine + across * sine * sine;
    facets.xy = (along - across) * cosine * sine;
    facets.yy = along * sine * sine + across * cosine * cosine;
    return facets;
}
SRBF_FN float srbf_mixture_cosine(float position) {
    float root = 1.0f - 0.9f * position;
    return root * root * (root * root);
}
SRBF_FN float srbf_ggx_facets(srbf_vec3 wl, srbf_vec3 wv, float roughness) {
    srbf_vec3 sum = srbf_add(wl, wv);
    float squared = srbf_max(srbf_dot(sum, sum), 1.0e-12f);
    float alpha2 = roughness * roughness;
    float slope = (sum.x * sum.x + sum.y * sum.y + alpha2 * (sum.z * sum.z)) / squared;
    float cl = srbf_max(wl.z, 1.0e-6f);
    float cv = srbf_max(wv.z, 1.0e-6f);
    float masking = cv * srbf_sqrt(alpha2 + (1.0f - alpha2) * (cl * cl)) + cl * srbf_sqrt(alpha2 + (1.0f - alpha2) *
            (cv * cv));
    return alpha2 / (6.283185307179586f * slope * slope * masking);
}
SRBF_FN float srbf_ggx_stretched_facets(srbf_vec3 wl, srbf_vec3 wv, float alpha_x, float alpha_y) {
    srbf_vec3 sum = srbf_add(wl, wv);
    float squared = srbf_max(srbf_dot(sum, sum), 1.0e-12f);
    float product = alpha_x * alpha_y;
    float slope = (alpha_y / alpha_x * (sum.x * sum.x) + alpha_x / alpha_y * (sum.y * sum.y) + product * (sum.z *
            sum.z)) / squared;
    float cl = srbf_max(wl.z, 1.0e-6f);
    float cv = srbf_max(wv.z, 1.0e-6f);
    srbf_vec3 l = srbf_vec3_of(alpha_x * wl.x, alpha_y * wl.y, cl);
    srbf_vec3 v = srbf_vec3_of(alpha_x * wv.x, alpha_y * wv.y, cv);
    float masking = cv * srbf_sqrt(srbf_dot(l, l)) + cl * srbf_sqrt(srbf_dot(v, v));
    return product / (6.283185307179586f * slope * slope * masking);
}
SRBF_FN float srbf_schlick_weight(srbf_vec3 wl, srbf_vec3 wv) {
    srbf_vec3 sum = srbf_add(wl, wv);
    float x = srbf_max(1.0f - 0.5f * srbf_sqrt(srbf_dot(sum, sum)), 0.0f);
    return x * x * (x * x) * x;
}
SRBF_FN srbf_vec3 srbf_ggx_lobe_value(srbf_GgxLobe lobe, srbf_vec3 wl, srbf_vec3 wv) {
    float weight = srbf_schlick_weight(wl, wv);
    float f90 = weight * lobe.f90;
    return srbf_scale(srbf_ggx_facets(wl, wv, lobe.roughness), srbf_add(srbf_scale(1.0f - weight, lobe.f0),
            srbf_vec3_of(f90, f90, f90)));
}
SRBF_FN srbf_vec3 srbf_ggx_value(srbf_vec3 diffuse, srbf_GgxLobe first, srbf_GgxLobe second, srbf_vec3 wl,
        srbf_vec3 wv) {
    return srbf_add(srbf_add(srbf_scale(2.0f / 6.283185307179586f, diffuse), srbf_ggx_lobe_value(first, wl, wv)),
            srbf_ggx_lobe_value(second, wl, wv));
}
SRBF_FN srbf_vec3 srbf_product_of(srbf_vec3 a, srbf_vec3 b) { return srbf_vec3_of(a.x * b.x, a.y * b.y, a.z * b.z); }
SRBF_FN srbf_vec3 srbf_interpolated(srbf_vec3 a, srbf_vec3 b, float t) {
    return srbf_add(srbf_scale(1.0f - t, a), srbf_scale(t, b));
}
SRBF_FN float srbf_polynomial(float y, float a, float b, float c) { return a + y * (b + y * c); }
SRBF_FN float srbf_clamped_to_unit(float x) { return srbf_min(srbf_max(x, 0.0f), 1.0f); }
SRBF_FN float srbf_dielectric_reflectance(float c, float ior) {
    float g = srbf_sqrt(srbf_max(ior * ior - 1.0f + c * c, 1.0e-12f));
    float across = (g - c) / (g + c);
    float turn = (c * (g + c) - 1.0f) / (c * (g - c) + 1.0f);
    return 0.5f * (across * across) * (1.0f + turn * turn);
}
SRBF_FN float srbf_normal_reflectance(float ior) {
    float share = (ior - 1.0f) / (ior + 1.0f);
    return share * share;
}
SRBF_FN srbf_FacetAlbedo srbf_facet_albedo(float x, float y) {
    srbf_FacetAlbedo facet;
    facet.scale = srbf_clamped_to_unit(srbf_polynomial(x, srbf_polynomial(y, 0.1003f, 9.748f, -8.245f),
            srbf_polynomial(y, -0.6303f, -2.038f, 19.99f), srbf_polynomial(y, 29.34f, -26.44f,
            -5.448f)) / srbf_polynomial(x, srbf_polynomial(y, 1.0f, 8.263f, -7.507f), srbf_polynomial(y, -1.765f,
            11.53f, 15.86f), srbf_polynomial(y, 28.96f, -36.11f, 33.37f)));
    facet.bias = srbf_clamped_to_unit(srbf_polynomial(x, srbf_polynomial(y, 0.9345f, 2.229f, -0.7684f),
            srbf_polynomial(y, -2.323f, -3.748f, 0.2913f), srbf_polynomial(y, 1.424f, 1.436f,
            0.6286f)) / srbf_polynomial(x, srbf_polynomial(y, 1.0f, 15.94f, 41.26f), srbf_polynomial(y, 0.2281f,
            -55.83f, 300.2f), srbf_polynomial(y, 13.08f, 54.9f, -285.1f)));
    return facet;
}
SRBF_FN float srbf_multiple_scattering(srbf_FacetAlbedo facet) {
    float whole = srbf_max(facet.scale + facet.bias, 0.1f);
    return srbf_max(1.0f - whole, 0.0f) / whole;
}
SRBF_FN float srbf_lobe_albedo(srbf_FacetAlbedo facet, float f0) {
    return srbf_clamped_to_unit((f0 * facet.scale + facet.bias * srbf_clamped_to_unit(50.0f * f0)) * (1.0f + f0 *
            srbf_multiple_scattering(facet)));
}
SRBF_FN float srbf_eon_share(float cosine, float r) {
    float m = 1.0f - cosine;
    float g = m * (0.0571085289f + m * (0.491881867f + m * (-0.332181442f + m * 0.0714429953f)));
    return (1.0f + r * g) / (1.0f + 0.28779341f * r);
}
SRBF_FN float srbf_eon_multiple_colour(float colour, float mean) {
    return colour * colour * mean / (1.0f - colour * (1.0f - mean));
}
SRBF_FN srbf_vec3 srbf_eon_value(srbf_vec3 colour, float r, srbf_vec3 wl, srbf_vec3 wv) {
    float s = wl.x * wv.x + wl.y * wv.y;
    float single_scale = 1.0f / (1.0f + 0.28779341f * r);
    float single = single_scale * (1.0f + r * (0.0f < s ? s / srbf_max(srbf_max(wl.z, wv.z), 1.0e-6f) : s));
    float mean = single_scale * (1.0f + 0.07248821f * r);
    float multiple_scale = srbf_max(1.0f - srbf_eon_share(wl.z, r), 1.0e-6f) * srbf_max(1.0f - srbf_eon_share(wv.z, r),
            1.0e-6f) / srbf_max(1.0f - mean, 1.0e-6f);
    srbf_vec3 multiple = srbf_vec3_of(srbf_eon_multiple_colour(colour.x, mean), srbf_eon_multiple_colour(colour.y,
            mean), srbf_eon_multiple_colour(colour.z, mean));
    return srbf_scale(2.0f / 6.283185307179586f, srbf_add(srbf_scale(single, colour), srbf_scale(multiple_scale,
            multiple)));
}
SRBF_FN float srbf_fuzz_albedo(float x, float y) {
    float s = y * (0.0206607f + 1.58491f * y) / (0.0379424f + y * (1.32227f + y));
    float m = y * (-0.193854f + y * (-1.14885f + y * (1.7932f - 0.95943f * y * y))) / (0.046391f + y);
    float rest = y * (0.000654023f + (-0.0207818f + 0.119681f * y) * y) / (1.26264f + y * (-1.92021f + y));
    float t = (x - m) / s;
    return srbf_clamped_to_unit(srbf_exp_of_lobe(-0.5f * t * t) * 0.3989422804f / s + rest);
}
SRBF_FN float srbf_fuzz_value(srbf_vec3 wl, srbf_vec3 wv, float y) {
    float x = wv.z;
    float a = (2.58126f * x + 0.813703f * y) * y / (1.0f + 0.310327f * x * x + 2.60994f * x * y);
    float b = srbf_sqrt(srbf_max(1.0f - x, 0.0f)) * (y - 1.0f) * y * y * y / (0.0000254053f + 1.71228f * x - 1.71506f *
            x * y + 1.34174f * y * y);
    float along = (wl.x * wv.x + wl.y * wv.y) * srbf_inversesqrt(srbf_max(wv.x * wv.x + wv.y * wv.y, 1.0e-12f));
    float across2 = srbf_max(wl.x * wl.x + wl.y * wl.y - along * along, 0.0f);
    float first = a * along + b * wl.z;
    float a2 = srbf_max(a * a, 1.0e-12f);
    float squared = srbf_max(first * first + a2 * across2 + wl.z * wl.z, 1.0e-8f);
    return srbf_fuzz_albedo(x, y) * a2 / (squared * squared) * (2.0f / 6.283185307179586f);
}
SRBF_FN float srbf_alpha_of(float roughness) { return srbf_max(roughness * roughness, 1.0f / 1024.0f); }
SRBF_FN float srbf_roughened(float base, float coat, float weight) {
    float b2 = base * base;
    float c2 = coat * coat;
    float fourth = srbf_min(b2 * b2 + 2.0f * (c2 * c2), 1.0f);
    return (1.0f - weight) * base + weight * srbf_sqrt(srbf_sqrt(fourth));
}
SRBF_FN float srbf_metal_reflectance(float c, float weight, float f0, float tint) {
    float schlick = f0 + (1.0f - f0) * weight;
    float at_82 = f0 + (1.0f - f0) * 0.462664366f;
    float m = 1.0f - c;
    float m2 = m * m;
    return srbf_max(schlick - c * (m2 * m2 * m2) * at_82 * (1.0f - tint) * 17.651384f, 0.0f);
}
SRBF_FN srbf_OpenPbrRoughness srbf_openpbr_roughness(float alpha, float anisotropy) {
    float share = 1.0f - anisotropy;
    srbf_OpenPbrRoughness roughness;
    roughness.along = alpha * srbf_sqrt(2.0f / (1.0f + share * share));
    roughness.across = srbf_max(share * roughness.along, 1.0f / 1024.0f);
    return roughness;
}
SRBF_FN float srbf_doubled(float v) { return 2.0f * v * (2.0f - v); }
SRBF_FN float srbf_one_minus_cos(float x) {
    float s = sinf(x * (1.0f / 64.0f));
    return srbf_doubled(srbf_doubled(srbf_doubled(srbf_doubled(srbf_doubled(2.0f * s * s)))));
}
SRBF_FN float srbf_film_wave(float path, float size, float frequency, float decay) {
    return size * (1.0f - srbf_one_minus_cos(frequency * path)) * srbf_exp_of_lobe(-decay * path * path);
}
SRBF_FN srbf_vec3 srbf_film_colour(float path, srbf_vec3 turn) {
    float x = turn.x * (srbf_film_wave(path, 0.84659f, 10.5620345f, 0.170854696f) + srbf_film_wave(path, 0.153868307f,
            14.0737068f, 0.178766171f));
    float y = turn.y * srbf_film_wave(path, 1.00022189f, 11.2802026f, 0.367330884f);
    float z = turn.z * srbf_film_wave(path, 1.00112249f, 13.8757864f, 0.261035245f);
    return srbf_vec3_of(3.2404542f * x - 1.5371385f * y - 0.4985314f * z, 1.8760108f * y - 0.9692660f * x + 0.0415560f *
            z, 0.0556434f * x - 0.2040259f * y + 1.0572252f * z);
}
SRBF_FN srbf_FilmBase srbf_film_base(float f0, float ior, float schlick) {
    float root = srbf_sqrt(srbf_min(f0, 0.9999f));
    float below = (1.0f + root) / (1.0f - root);
    float share = (below - ior) / (below + ior);
    srbf_FilmBase base;
    base.reflectance = share * share + (1.0f - share * share) * schlick;
    base.turn = below < ior ? 1.0f : -1.0f;
    return base;
}
SRBF_FN float srbf_film_order(srbf_FilmBase base, float above, float first, float second) {
    float both = srbf_min(srbf_max(above * base.reflectance, 1.0e-5f), 0.9999f);
    float through = 1.0f - above;
    float returned = through * through * base.reflectance / (1.0f - both);
    return srbf_max(above + returned + 2.0f * (returned - through) * (srbf_sqrt(both) * first + both * second), 0.0f);
}
SRBF_FN float srbf_fifth_power(float x) { return x * x * (x * x) * x; }
SRBF_FN srbf_vec3 srbf_film_reflectance(srbf_OpenPbrFilm film, srbf_vec3 f0, float c) {
    float within = srbf_sqrt(srbf_max(1.0f - (1.0f - c * c) / (film.ior * film.ior), 0.0f));
    float normal = srbf_normal_reflectance(film.ior);
    float above = normal + (1.0f - normal) * srbf_fifth_power(1.0f - c);
    float schlick = srbf_fifth_power(1.0f - within);
    srbf_FilmBase r = srbf_film_base(f0.x, film.ior, schlick);
    srbf_FilmBase g = srbf_film_base(f0.y, film.ior, schlick);
    srbf_FilmBase b = srbf_film_base(f0.z, film.ior, schlick);
    float path = 2.0f * film.ior * film.thickness * within;
    srbf_vec3 first = srbf_film_colour(path, srbf_vec3_of(r.turn, g.turn, b.turn));
    srbf_vec3 second = srbf_film_colour(2.0f * path, srbf_vec3_of(1.0f, 1.0f, 1.0f));
    return srbf_vec3_of(srbf_film_order(r, above, first.x, second.x), srbf_film_order(g, above, first.y, second.y),
            srbf_film_order(b, above, first.z, second.z));
}
SRBF_FN srbf_OpenPbrBase srbf_openpbr_base(srbf_OpenPbrSurface material) {
    float coat_ior = 1.0f + material.coat_weight * (material.coat_ior - 1.0f);
    float ratio = material.specular_ior / coat_ior;
    srbf_OpenPbrBase base;
    float f0 = srbf_normal_reflectance(srbf_max(srbf_max(ratio, 1.0f / ratio), 1.0f));
    base.f0 = srbf_min(material.specular_weight * f0, 0.98f);
    float root = srbf_sqrt(base.f0);
    base.ior = (1.0f + root) / (1.0f - root);
    base.alpha = srbf_alpha_of(srbf_roughened(material.specular_roughness, material.coat_roughness,
            material.coat_weight));
    return base;
}
SRBF_FN float srbf_half_cosine(srbf_vec3 wl, srbf_vec3 wv) {
    srbf_vec3 sum = srbf_add(wl, wv);
    return srbf_min(0.5f * srbf_sqrt(srbf_dot(sum, sum)), 1.0f);
}
SRBF_FN srbf_OpenPbrFacets srbf_openpbr_facets(srbf_OpenPbrSurface material, srbf_OpenPbrBase base, srbf_vec3 wl,
        srbf_vec3 wv) {
    float c = srbf_half_cosine(wl, wv);
    float schlick = srbf_schlick_weight(wl, wv);
    float plain = srbf_dielectric_reflectance(c, base.ior);
    srbf_vec3 f0 = material.base_color;
    srbf_OpenPbrFacets facets;
    facets.dielectric = srbf_vec3_of(plain, plain, plain);
    facets.metal = srbf_vec3_of(srbf_metal_reflectance(c, schlick, f0.x, material.specular_color.x),
            srbf_metal_reflectance(c, schlick, f0.y, material.specular_color.y), srbf_metal_reflectance(c, schlick,
            f0.z, material.specular_color.z));
    facets.dielectric_f0 = srbf_vec3_of(base.f0, base.f0, base.f0);
    facets.metal_f0 = f0;
    return facets;
}
SRBF_FN srbf_OpenPbrFacets srbf_openpbr_film_facets(srbf_OpenPbrSurface material, srbf_OpenPbrFilm film,
        srbf_OpenPbrBase base, srbf_vec3 wl, srbf_vec3 wv) {
    srbf_OpenPbrFacets facets = srbf_openpbr_facets(material, base, wl, wv);
    float c = srbf_half_cosine(wl, wv);
    facets.dielectric = srbf_interpolated(facets.dielectric, srbf_film_reflectance(film, facets.dielectric_f0, c),
            film.weight);
    facets.metal = srbf_interpolated(facets.metal, srbf_film_reflectance(film, facets.metal_f0, c), film.weight);
    srbf_vec3 f0 = facets.dielectric_f0;
    facets.dielectric_f0 = srbf_interpolated(f0, srbf_film_reflectance(film, f0, 1.0f), film.weight);
    f0 = facets.metal_f0;
    facets.metal_f0 = srbf_interpolated(f0, srbf_film_reflectance(film, f0, 1.0f), film.weight);
    return facets;
}
SRBF_FN srbf_vec3 srbf_multiple_scattering_by(srbf_vec3 f0, float factor) {
    return srbf_vec3_of(1.0f + f0.x * factor, 1.0f + f0.y * factor, 1.0f + f0.z * factor);
}
SRBF_FN srbf_vec3 srbf_openpbr_base_value(srbf_OpenPbrSurface material, srbf_OpenPbrBase base,
        srbf_OpenPbrFacets facets, float density, srbf_vec3 wl, srbf_vec3 wv) {
    srbf_FacetAlbedo whole = srbf_facet_albedo(wv.z, base.alpha);
    float multiple = srbf_multiple_scattering(whole);
    srbf_vec3 f0 = facets.dielectric_f0;
    srbf_vec3 dielectric = srbf_scale(density, srbf_product_of(facets.dielectric, srbf_multiple_scattering_by(f0,
            multiple)));
    srbf_vec3 through = srbf_vec3_of(1.0f - srbf_lobe_albedo(whole, f0.x), 1.0f - srbf_lobe_albedo(whole, f0.y),
            1.0f - srbf_lobe_albedo(whole, f0.z));
    srbf_vec3 glossy = srbf_add(srbf_product_of(dielectric, material.specular_color), srbf_product_of(through,
            srbf_eon_value(material.base_color, material.base_diffuse_roughness, wl, wv)));
    srbf_vec3 metal = srbf_scale(material.specular_weight * density, srbf_product_of(facets.metal,
            srbf_multiple_scattering_by(facets.metal_f0, multiple)));
    return srbf_interpolated(glossy, metal, material.base_metalness);
}
SRBF_FN float srbf_darkened(float colour, float k, float strength) {
    return 1.0f - strength + strength * (1.0f - k) / (1.0f - colour * k);
}
SRBF_FN srbf_vec3 srbf_openpbr_layers_value(srbf_OpenPbrSurface material, srbf_vec3 base, srbf_vec3 wl, srbf_vec3 wv) {
    float c = srbf_half_cosine(wl, wv);
    float alpha = srbf_alpha_of(material.coat_roughness);
    srbf_FacetAlbedo whole = srbf_facet_albedo(wv.z, alpha);
    float f0 = srbf_normal_reflectance(material.coat_ior);
    float coat = material.coat_weight * srbf_ggx_facets(wl, wv, alpha) * srbf_dielectric_reflectance(c,
            material.coat_ior) * (1.0f + f0 * srbf_multiple_scattering(whole));
    float k = 1.0f - (1.0f - f0) / (material.coat_ior * material.coat_ior);
    float strength = material.coat_weight * material.coat_darkening;
    srbf_vec3 dark = srbf_vec3_of(srbf_darkened(material.base_color.x, k, strength),
            srbf_darkened(material.base_color.y, k, strength), srbf_darkened(material.base_color.z, k, strength));
    srbf_vec3 white = srbf_vec3_of(1.0f, 1.0f, 1.0f);
    srbf_vec3 passed = srbf_product_of(dark, srbf_interpolated(white, material.coat_color, material.coat_weight));
    float through = 1.0f - material.coat_weight * srbf_lobe_albedo(whole, f0);
    srbf_vec3 coated = srbf_add(srbf_vec3_of(coat, coat, coat), srbf_scale(through, srbf_product_of(passed, base)));
    float y = srbf_max(material.fuzz_roughness, 0.01f);
    float below = 1.0f - material.fuzz_weight * srbf_fuzz_albedo(wv.z, y);
    return srbf_add(srbf_scale(below, coated), srbf_scale(material.fuzz_weight * srbf_fuzz_value(wl, wv, y),
            material.fuzz_color));
}
SRBF_FN srbf_vec3 srbf_openpbr_value(srbf_OpenPbrSurface material, srbf_vec3 wl, srbf_vec3 wv) {
    srbf_OpenPbrBase base = srbf_openpbr_base(material);
    float density = srbf_ggx_facets(wl, wv, base.alpha);
    srbf_OpenPbrFacets facets = srbf_openpbr_facets(material, base, wl, wv);
    return srbf_openpbr_layers_value(material, srbf_openpbr_base_value(material, base, facets, density, wl, wv), wl,
            wv);
}
SRBF_FN srbf_vec3 srbf_openpbr_anisotropic_value(srbf_OpenPbrSurface material, srbf_OpenPbrFilm film,
        srbf_OpenPbrAnisotropy anisotropy, srbf_vec3 wl, srbf_vec3 wv) {
    srbf_OpenPbrBase base = srbf_openpbr_base(material);
    srbf_OpenPbrRoughness roughness = srbf_openpbr_roughness(base.alpha, anisotropy.amount);
    float density = srbf_ggx_stretched_facets(srbf_turned(wl, anisotropy.cosine, -anisotropy.sine), srbf_turned(wv,
            anisotropy.cosine, -anisotropy.sine), roughness.along, roughness.across);
    base.alpha = srbf_sqrt(roughness.along * roughness.across);
    srbf_OpenPbrFacets facets = srbf_openpbr_film_facets(material, film, base, wl, wv);
    return srbf_openpbr_layers_value(material, srbf_openpbr_base_value(material, base, facets, density, wl, wv), wl,
            wv);
}
SRBF_FN srbf_vec3 srbf_su_view_value(srbf_su su, int view, srbf_vec3 wl) {
    srbf_vec3 sum = srbf_vec3_of(0.0f, 0.0f, 0.0f);
    for (int j = 0; j < srbf_su_lobes(su); ++j)
        sum = srbf_add(sum, srbf_scale(srbf_gaussian(wl, srbf_su_centre(su, view, j), srbf_su_bandwidth(su, view, j)),
                srbf_su_coefficient(su, view, j)));
    return sum;
}
SRBF_FN srbf_SuNeighbour srbf_su_rotated_neighbour(srbf_su su, srbf_vec3 wv, int k) {
    int last = srbf_su_views(su) - 1;
    float position = srbf_max(wv.z * (float)(srbf_su_views(su)) - 0.5f, 0.0f);
    int below = position < (float)(last) ? (int)(position) : last;
    int above = below < last ? below + 1 : last;
    srbf_vec3 top = srbf_su_direction(su, last);
    float radius = srbf_sqrt(wv.x * wv.x + wv.y * wv.y);
    float top_radius = srbf_max(srbf_sqrt(top.x * top.x + top.y * top.y), 1.0e-20f);
    float cap = wv.z > top.z ? srbf_min(radius / top_radius, 1.0f) : 1.0f;
    srbf_SuNeighbour neighbour;
    neighbour.view = k == 0 ? below : k == 1 ? above : last;
    srbf_vec3 sample_ = srbf_su_direction(su, neighbour.view);
    float from_ = srbf_su_direction(su, below).z;
    float step = srbf_su_direction(su, above).z - from_;
    float part_ = step > 0.0f ? srbf_min(srbf_max((wv.z - from_) / step, 0.0f), 1.0f) : 0.0f;
    float length = srbf_max(radius * srbf_sqrt(sample_.x * sample_.x + sample_.y * sample_.y), 1.0e-20f);
    neighbour.weight = k == 0 ? cap * (1.0f - part_) : k == 1 ? cap * part_ : (1.0f - cap) / 3.0f;
    neighbour.cosine = k < 2 ? (wv.x * sample_.x + wv.y * sample_.y) / length : k == 2 ? 1.0f : -0.5f;
    neighbour.sine = k < 2 ? (wv.x * sample_.y - wv.y * sample_.x) / length : 0.8660254037844386f * (k == 3 ? 1.0f :
            k == 4 ? -1.0f : 0.0f);
    return neighbour;
}
SRBF_FN srbf_vec3 srbf_su_rotated_part(srbf_su su, srbf_vec3 wl, srbf_vec3 wv, int k) {
    srbf_SuNeighbour neighbour = srbf_su_rotated_neighbour(su, wv, k);
    return srbf_scale(neighbour.weight, srbf_su_view_value(su, neighbour.view, srbf_turned(wl, neighbour.cosine,
            neighbour.sine)));
}
SRBF_FN srbf_vec3 srbf_su_rotated_value(srbf_su su, srbf_vec3 wl, srbf_vec3 wv) {
    srbf_vec3 sum = srbf_add(srbf_su_rotated_part(su, wl, wv, 0), srbf_su_rotated_part(su, wl, wv, 1));
    int count = wv.z > srbf_su_direction(su, srbf_su_views(su) - 1).z ? 5 : 2;
    for (int k = 2; k < count; ++k) sum = srbf_add(sum, srbf_su_rotated_part(su, wl, wv, k));
    return sum;
}
SRBF_FN float srbf_su_plain_weight(srbf_su su, srbf_su_nearest_views nearest, srbf_vec3 wv, int neighbours, int k) {
    srbf_vec3 apart = srbf_subtract(wv, srbf_su_direction(su, srbf_su_nearest(nearest, k)));
    srbf_vec3 leaving = srbf_subtract(wv, srbf_su_direction(su, srbf_su_nearest(nearest, neighbours)));
    float of_next = srbf_inversesqrt(srbf_max(srbf_dot(leaving, leaving), 1.0e-30f));
    return srbf_max(srbf_inversesqrt(srbf_max(srbf_dot(apart, apart), 1.0e-30f)) - of_next, 1.0e-5f * of_next);
}
SRBF_FN srbf_vec3 srbf_su_plain_value(srbf_su su, srbf_su_nearest_views nearest, srbf_vec3 wl, srbf_vec3 wv,
        int neighbours) {
    srbf_vec3 sum = srbf_vec3_of(0.0f, 0.0f, 0.0f);
    float weights = 0.0f;
    for (int k = 0; k < neighbours; ++k) {
        float weight = srbf_su_plain_weight(su, nearest, wv, neighbours, k);
        weights = weights + weight;
        sum = srbf_add(sum, srbf_scale(weight, srbf_su_view_value(su, srbf_su_nearest(nearest, k), wl)));
    }
    return srbf_scale(1.0f / srbf_max(weights, 1.0e-20f), sum);
}

#define SRBF_FIRST_NM 360
#define SRBF_LAST_NM 780
// R, G, B of a spectrum that is 1 within 1 nm, every 5 nm, in millionths.
static const short srbf_observer[255] = {
    0, 0, 3, 1, -1, 5, 2, -1, 10, 3, -3, 18, 5, -5, 33, 9, -8, 56, 18, -16, 111, 42, -36, 251, 93, -81, 567, 159, -138,
    970, 309, -271, 1917, 552, -488, 3468, 950, -848, 6093, 1421, -1289, 9450, 1734, -1606, 12125, 2080, -1988, 15683,
    2206, -2201, 18472, 2030, -2177, 19921, 1634, -2003, 20863, 994, -1626, 20572, 200, -1114, 19716, -680, -454, 17771,
    -1617, 379, 14711, -2534, 1275, 11862, -3391, 2215, 9174, -4037, 3052, 6593, -4613, 3898, 4645, -5430, 5012, 3319,
    -6377, 6338, 2296, -7441, 7918, 1454, -8385, 9601, 664, -9016, 11240, -44, -9177, 12632, -581, -8975, 13916, -957,
    -8253, 14863, -1244, -6921, 15040, -1430, -5291, 14910, -1551, -3432, 14705, -1635, -1272, 14245, -1670, 1152,
    13323, -1636, 3739, 12213, -1569, 6436, 10947, -1477, 9164, 9548, -1364, 12019, 8188, -1254, 14786, 6745, -1131,
    16722, 5088, -965, 18142, 3570, -807, 19917, 2363, -693, 21054, 1314, -586, 21389, 424, -483, 20991, -239, -394,
    19821, -687, -315, 18119, -941, -249, 15708, -1020, -191, 13197, -989, -144, 11240, -934, -111, 9366, -838, -85,
    7412, -701, -63, 5712, -561, -46, 4423, -447, -34, 3345, -345, -25, 2493, -260, -18, 1822, -192, -13, 1295, -138,
    -9, 929, -100, -6, 618, -67, -4, 402, -44, -3, 284, -31, -2, 207, -22, -1, 150, -16, -1, 109, -12, -1, 71, -8, 0,
    45, -5, 0, 34, -4, 0, 26, -3, 0, 18, -2, 0, 13, -1, 0, 8, -1, 0, 5, -1, 0, 3, 0, 0, 2, 0, 0, 2, 0, 0, 1, 0, 0, 1, 0,
    0, 1, 0, 0,
};

// The parameters of surfaces: name, range, default and count of numbers.
#define SRBF_PARAMETERS 21
typedef struct {
    const char* name;
    float least, most, by_default;
    int count;
} srbf_parameter;
static const srbf_parameter srbf_parameters[SRBF_PARAMETERS] = {
    {"base_weight", 0.0f, 1.0f, 1.0f, 1}, {"base_color", 0.0f, 1.0f, 0.8f, 3}, {"base_metalness", 0.0f, 1.0f, 0.0f, 1},
    {"base_diffuse_roughness", 0.0f, 1.0f, 0.0f, 1}, {"specular_weight", 0.0f, 1.0f, 1.0f, 1},
    {"specular_color", 0.0f, 1.0f, 1.0f, 3}, {"specular_roughness", 0.0f, 1.0f, 0.3f, 1},
    {"specular_ior", 1.0f, 3.0f, 1.5f, 1}, {"coat_weight", 0.0f, 1.0f, 0.0f, 1}, {"coat_color", 0.0f, 1.0f, 1.0f, 3},
    {"coat_roughness", 0.0f, 1.0f, 0.0f, 1}, {"coat_ior", 1.0f, 3.0f, 1.6f, 1}, {"coat_darkening", 0.0f, 1.0f, 1.0f, 1},
    {"fuzz_weight", 0.0f, 1.0f, 0.0f, 1}, {"fuzz_color", 0.0f, 1.0f, 1.0f, 3}, {"fuzz_roughness", 0.0f, 1.0f, 0.5f, 1},
    {"thin_film_weight", 0.0f, 1.0f, 0.0f, 1}, {"thin_film_thickness", 0.0f, 1.0f, 0.5f, 1},
    {"thin_film_ior", 1.0f, 3.0f, 1.4f, 1}, {"specular_roughness_anisotropy", 0.0f, 1.0f, 0.0f, 1},
    {"specular_rotation", 0.0f, 1.0f, 0.0f, 1},
};

// ---- Files ----

#define SRBF_MOST_TENSORS 64
#define SRBF_MOST 65504.0f  // the largest 16-bit float; infinities and NaNs are read as larger numbers

typedef struct {
    const unsigned char* text;
    size_t length;
} srbf_word;
typedef struct {
    srbf_word name;
    int is_half, rank, is_read;
    size_t extent[4], count, begin;
} srbf_tensor;

// A file that is read: its header up to `end` and the place there, tensors, the first error, and the caller's memory.
// Without memory, what is needed is counted. Names of the model that is read have the prefix.
typedef struct {
    const unsigned char* bytes;
    size_t size, at, end, metadata, number;
    srbf_word word;
    const char* prefix;
    srbf_error error;
    size_t error_at;
    int tensors;
    srbf_tensor tensor[SRBF_MOST_TENSORS];
    char* memory;
    size_t capacity, used;
} srbf_file;

static int srbf_fail(srbf_file* file, srbf_error error, size_t at) {
    if (file->error == SRBF_OK) file->error = error, file->error_at = at;
    return 0;
}
static int srbf_fail_at(srbf_file* file, srbf_error error, srbf_word word) {
    return srbf_fail(file, error, (size_t)(word.text - file->bytes));
}

// The next `bytes` of the memory; null if it is too little or only counted.
static void* srbf_take(srbf_file* file, size_t bytes) {
    char* taken = file->memory ? file->memory + file->used : 0;
    file->used += (bytes + 15) / 16 * 16;
    if (taken && file->used <= file->capacity) return memset(taken, 0, bytes);
    if (taken) srbf_fail(file, SRBF_TOO_LITTLE_MEMORY, 0);
    return 0;
}

// The next token of the header: a bracket; '"' sets the word, without quotes; '0' sets the number; 0 at the end.
static int srbf_token(srbf_file* file) {
    const unsigned char* bytes = file->bytes;
    int sign;
    while (file->at < file->end && (bytes[file->at] <= ' ' || bytes[file->at] == ',' || bytes[file->at] == ':'))
        ++file->at;
    if (file->at >= file->end) return 0;
    sign = bytes[file->at];
    if (sign >= '0' && sign <= '9') {
        for (file->number = 0; file->at < file->end && bytes[file->at] >= '0' && bytes[file->at] <= '9'; ++file->at) {
            file->number = 10 * file->number + (size_t)(bytes[file->at] - '0');
            if (file->number > file->size) return srbf_fail(file, SRBF_BAD_HEADER, file->at);
        }
        return '0';
    }
    ++file->at;
    if (sign != '"') return sign;
    file->word.text = bytes + file->at;
    while (file->at < file->end && bytes[file->at] != '"') file->at += bytes[file->at] == '\\' ? 2 : 1;
    if (file->at >= file->end) return srbf_fail(file, SRBF_BAD_HEADER, file->end);
    file->word.length = (size_t)(bytes + file->at++ - file->word.text);
    return '"';
}
// True if a word is the prefix followed by the name.
static int srbf_is(srbf_word word, const char* prefix, const char* name) {
    const size_t first = strlen(prefix), second = strlen(name);
    return word.length == first + second && memcmp(word.text, prefix, first) == 0 &&
           memcmp(word.text + first, name, second) == 0;
}

// Reads the object of a tensor, after its brace.
static int srbf_read_tensor(srbf_file* file, srbf_tensor* tensor) {
    size_t ends[4] = {1, 0, 0, 0};
    int token, i;
    tensor->name = file->word, tensor->rank = -1, tensor->count = 1;
    while ((token = srbf_token(file)) == '"') {
        const srbf_word key = file->word;
        const int is_shape = srbf_is(key, "", "shape");
        token = srbf_token(file);
        if (token == '"' && srbf_is(key, "", "dtype")) tensor->is_half = srbf_is(file->word, "", "F16");
        if (token != '[') continue;
        if (is_shape) memset(tensor->extent, 0, sizeof tensor->extent);
        for (i = 0; (token = srbf_token(file)) == '0' && i < 4; ++i)
            (is_shape ? tensor->extent : ends)[i] = file->number;
        if (token != ']') break;
        if (is_shape) tensor->rank = i;
    }
    for (i = 0; i < tensor->rank && tensor->count > 0; ++i)
        tensor->count = tensor->extent[i] <= file->size / tensor->count ? tensor->count * tensor->extent[i] : 0;
    tensor->begin = file->end + ends[0];
    return (token == '}' && tensor->rank >= 0 && tensor->count > 0 && ends[0] <= ends[1] &&
            ends[1] <= file->size - file->end && ends[1] - ends[0] == 2 * tensor->count) ||
           srbf_fail_at(file, SRBF_BAD_HEADER, tensor->name);
}
static int srbf_read_header(srbf_file* file) {
    size_t length = 0, covered = 0;
    int i, token;
    if (file->size < 8) return srbf_fail(file, SRBF_NO_MODEL, file->size);
    for (i = 8; i-- > 0;) length = length > file->size ? length : 256 * length + file->bytes[i];
    if (length > file->size - 8 || length > (size_t)1 << 20) return srbf_fail(file, SRBF_NO_MODEL, 0);
    file->at = 8, file->end = 8 + length;
    if (srbf_token(file) != '{') return srbf_fail(file, SRBF_NO_MODEL, 8);
    while ((token = srbf_token(file)) == '"') {
        const int is_metadata = srbf_is(file->word, "", "__metadata__");
        if (srbf_token(file) != '{' || file->tensors == SRBF_MOST_TENSORS) break;
        if (is_metadata) {
            file->metadata = file->at;
            while ((token = srbf_token(file)) == '"') {
            }
            if (token != '}') break;
        } else if (srbf_read_tensor(file, &file->tensor[file->tensors])) {
            covered += 2 * file->tensor[file->tensors++].count;
        } else {
            return 0;
        }
    }
    return (token == '}' && covered == file->size - file->end) || srbf_fail(file, SRBF_BAD_HEADER, file->at);
}

// Sets the word of the metadata of this name; 0 if there is none.
static int srbf_metadata(srbf_file* file, const char* name) {
    int is_it = 0;
    for (file->at = file->metadata; file->metadata && !is_it && srbf_token(file) == '"';) {
        is_it = srbf_is(file->word, file->prefix, name);
        if (srbf_token(file) != '"') return 0;
    }
    return is_it;
}
// The index of the metadata's word in a list, whose words end with a blank; -1 is an error.
static int srbf_choice(srbf_file* file, const char* name, const char* words, srbf_error error) {
    int i;
    if (!srbf_metadata(file, name)) return srbf_fail(file, error, 8) - 1;
    for (i = 0; *words; ++i) {
        const size_t length = strcspn(words, " ");
        if (length == file->word.length && memcmp(words, file->word.text, length) == 0) return i;
        words += length + 1;
    }
    return srbf_fail_at(file, error, file->word) - 1;
}

static srbf_tensor* srbf_find(srbf_file* file, const char* name) {
    int i;
    for (i = 0; i < file->tensors; ++i)
        if (srbf_is(file->tensor[i].name, file->prefix, name)) return &file->tensor[i];
    return 0;
}
// A number of a tensor; 0 if there is no tensor.
static float srbf_number(const srbf_file* file, const srbf_tensor* tensor, size_t i) {
    const unsigned char* at = tensor ? file->bytes + tensor->begin + 2 * i : (const unsigned char*)"\0";
    const unsigned half = at[0] | (unsigned)at[1] << 8;
    const unsigned bits = ((half & 0x8000u) << 16 | (half & 0x7fffu) << 13) + (112u << 23);
    float x;
    if ((half >> 10 & 31) == 0) return (half & 0x8000u ? -1.0f : 1.0f) * (float)(half & 0x3ffu) * 5.9604645e-8f;
    memcpy(&x, &bits, sizeof x);
    return x;
}
static srbf_vec3 srbf_numbers(const srbf_file* file, const srbf_tensor* tensor, size_t i) {
    return srbf_vec3_of(srbf_number(file, tensor, i), srbf_number(file, tensor, i + 1),
                        srbf_number(file, tensor, i + 2));
}
static int srbf_fail_tensor(srbf_file* file, const srbf_tensor* tensor) {
    return srbf_fail(file, SRBF_BAD_TENSOR, tensor ? (size_t)(tensor->name.text - file->bytes) : 8);
}
// An extent of a tensor that determines the shapes of others; 0 is an error.
static size_t srbf_extent(srbf_file* file, const char* name, int which, size_t most) {
    const srbf_tensor* tensor = srbf_find(file, name);
    if (!tensor || tensor->extent[which] - 1 >= most) return (size_t)srbf_fail_tensor(file, tensor);
    return tensor->extent[which];
}
// The tensor of this name and shape, all of whose numbers are between the bounds; null is an error.
static srbf_tensor* srbf_need(srbf_file* file, const char* name, size_t a, size_t b, size_t c, float least,
                              float most) {
    srbf_tensor* tensor = srbf_find(file, name);
    const size_t extent[4] = {a, b, c, 0};
    size_t i;
    if (!tensor || !tensor->is_half || memcmp(tensor->extent, extent, sizeof extent) != 0)
        return srbf_fail_tensor(file, tensor), (srbf_tensor*)0;
    for (i = 0; i < tensor->count; ++i) {
        const float x = srbf_number(file, tensor, i);
        if (!(x >= least && x <= most)) return srbf_fail(file, SRBF_BAD_NUMBER, tensor->begin + 2 * i), (srbf_tensor*)0;
    }
    tensor->is_read = 1;
    return tensor;
}
// ---- Models ----

typedef enum { SRBF_KIND_PM, SRBF_KIND_SU, SRBF_KIND_GGX, SRBF_KIND_OPENPBR } srbf_kind;
typedef struct {
    srbf_kind kind;
    int is_isotropic, is_exchanged, is_plain;  // plain: a surface without a film and with round facets
    srbf_form pm;
    const float* lobes;
    srbf_view_lobes su;
    srbf_vec3 diffuse;
    srbf_GgxLobe ggx[2];
    srbf_OpenPbrSurface surface;
    srbf_OpenPbrFilm film;
    srbf_OpenPbrAnisotropy anisotropy;
    int facets;
    srbf_Facets facet[2];
} srbf_model;

static srbf_vec3 srbf_spherical(float theta, float phi) {
    return srbf_vec3_of(sinf(theta) * cosf(phi), sinf(theta) * sinf(phi), cosf(theta));
}

// The next number of a text of wavelengths [nm], which blanks separate; 0 if there is none or it is malformed.
static float srbf_wavelength(const unsigned char** text, const unsigned char* end) {
    float x = 0.0f, unit = 0.0f;
    while (*text < end && **text == ' ') ++*text;
    for (; *text < end && **text != ' '; ++*text) {
        if (**text == '.' && unit == 0.0f) {
            unit = 1.0f;
        } else {
            if (**text < '0' || **text > '9' || x > 1.0e9f) return 0.0f;
            x = 10.0f * x + (float)(**text - '0'), unit *= 10.0f;
        }
    }
    return x / srbf_max(unit, 1.0f);
}
// The place of a number of lobe j among the rows of its group.
static int srbf_place(int j, int row, int rows) { return (j / 8 * rows + row) * 8 + j % 8; }

// Adds to the colours of lobes their spectra, which are linear between the wavelengths of a text: a sample counts by a
// hat function, which is constant beyond the first and the last. R, G, B of white light are linear between rows of
// srbf_observer.
static int srbf_add_spectra(srbf_file* file, const srbf_tensor* spectra, srbf_word text, float* rgb, int rows) {
    const size_t count = spectra->extent[1];
    const unsigned char* end = text.text + text.length;
    float before = 0.0f, at = srbf_wavelength(&text.text, end), after;
    size_t i, j;
    int nm, c;
    for (i = 0; i < count; ++i, before = at, at = after) {
        double weight[3] = {0, 0, 0};
        after = i + 1 < count ? srbf_wavelength(&text.text, end) : 0.0f;
        if (!(at >= 100.0f && at <= 1.0e5f && (i == 0 || at > before))) break;
        for (nm = SRBF_FIRST_NM; nm <= SRBF_LAST_NM; ++nm) {
            const float x = (float)nm, share = (float)((nm - SRBF_FIRST_NM) % 5) / 5.0f;
            const int row = 3 * ((nm - SRBF_FIRST_NM) / 5), next = nm < SRBF_LAST_NM ? row + 3 : row;
            const int is_constant = x < at ? i == 0 : i + 1 == count;
            const float hat = is_constant ? 1.0f : 1.0f - (x - at) / ((x < at ? before : after) - at);
            for (c = 0; c < 3 && hat > 0.0f; ++c)
                weight[c] +=
                    (double)(hat * ((1.0f - share) * srbf_observer[row + c] + share * srbf_observer[next + c]));
        }
        for (j = 0; j < spectra->extent[0]; ++j)
            for (c = 0; c < 3; ++c)
                rgb[srbf_place((int)j, 1 + c, rows)] +=
                    (float)(1e-6 * weight[c]) * srbf_number(file, spectra, j * count + i);
    }
    return (i == count && srbf_wavelength(&text.text, end) == 0.0f && text.text == end) ||
           srbf_fail_at(file, SRBF_BAD_METADATA, text);
}

static int srbf_read_pm(srbf_file* file, srbf_model* model) {
    const float log2_e = 1.44269504f;
    const int form = srbf_choice(file, "form", "source horizon extended reciprocal ", SRBF_BAD_METADATA);
    const int axial = srbf_choice(file, "axial", "true false ", SRBF_BAD_METADATA) == 0;
    const int is_spectral = srbf_metadata(file, "wavelengths");
    const srbf_word waves = file->word;
    const size_t lobes = srbf_extent(file, "bandwidth", 0, 1024);
    const size_t variates = srbf_extent(file, "bandwidth", 1, SRBF_MOST_VARIATES);
    const size_t channels = is_spectral ? srbf_extent(file, "coefficient", 1, 4096) : 3;
    const size_t features = form == 0 ? 0 : form == 1 ? 1 : 4;
    const srbf_tensor *coefficient, *bandwidth, *parameterization, *scale = 0, *centre = 0, *exponent = 0;
    const srbf_form pm = {(int)lobes, (int)variates, (int)features, axial, form == 3};
    const int rows = srbf_rows(pm);
    size_t j, n, k;
    float* number;
    coefficient = srbf_need(file, "coefficient", lobes, channels, 0, 0.0f, SRBF_MOST);
    bandwidth = srbf_need(file, "bandwidth", lobes, variates, 0, axial ? -SRBF_MOST : 0.0f, SRBF_MOST);
    parameterization = srbf_need(file, "parameterization", variates, 2, 0, -SRBF_MOST, SRBF_MOST);
    if (features || srbf_find(file, "log_scale"))
        scale = srbf_need(file, "log_scale", lobes, 0, 0, -SRBF_MOST, SRBF_MOST);
    if (!axial) centre = srbf_need(file, "centre", lobes, variates, 2, -SRBF_MOST, SRBF_MOST);
    if (features) exponent = srbf_need(file, "exponent", lobes, features, 0, -SRBF_MOST, SRBF_MOST);
    if (file->error) return 0;
    model->pm = pm, model->is_isotropic = axial;
    for (n = 0; n < variates; ++n)
        if (srbf_number(file, parameterization, 2 * n) == 0.0f &&
            srbf_number(file, parameterization, 2 * n + 1) == 0.0f)
            return srbf_fail(file, SRBF_BAD_NUMBER, parameterization->begin);
    for (j = 0; j < lobes && features; ++j)
        if (srbf_number(file, exponent, features * j) < 0.0f) return srbf_fail(file, SRBF_BAD_NUMBER, exponent->begin);
    model->lobes = number =
        (float*)srbf_take(file, (SRBF_FIRST_ROW + (lobes + 7) / 8 * 8 * (size_t)rows) * sizeof *number);
    if (!number) return !file->error;
    for (n = 0; n < variates; ++n) {
        const float a = srbf_number(file, parameterization, 2 * n), b = srbf_number(file, parameterization, 2 * n + 1);
        number[n] = a, number[16 + n] = b;
        if (pm.reciprocal) number[variates + n] = b, number[16 + variates + n] = a;
    }
    number += SRBF_FIRST_ROW;
    for (j = 0; j < lobes; ++j) {
        float* row = number + srbf_place((int)j, 0, rows);
        *row = log2_e * srbf_number(file, scale, j);
        for (k = 0; k < 3; ++k) *(row += 8) = is_spectral ? 0.0f : srbf_number(file, coefficient, 3 * j + k);
        for (k = 0; k < features; ++k) *(row += 8) = log2_e * srbf_number(file, exponent, features * j + k);
        for (n = j * variates; n < (j + 1) * variates; ++n) {
            const float falloff = -0.5f * log2_e * srbf_number(file, bandwidth, n);
            const srbf_vec3 xi = srbf_spherical(srbf_number(file, centre, 2 * n), srbf_number(file, centre, 2 * n + 1));
            *(row += 8) = srbf_min(falloff, 0.0f);
            *(row += 8) = axial ? srbf_min(-falloff, 0.0f) : xi.x;
            if (!axial) row[8] = xi.y, row[16] = xi.z, row += 16;
        }
    }
    return !is_spectral || srbf_add_spectra(file, coefficient, waves, number, rows);
}

static int srbf_read_su(srbf_file* file, srbf_model* model) {
    srbf_view_lobes* su = &model->su;
    const size_t views = srbf_extent(file, "bandwidth", 0, 8192), lobes = srbf_extent(file, "bandwidth", 1, 64);
    const srbf_tensor *coefficient, *bandwidth, *centre;
    size_t i, j;
    float* number;
    su->of_lights = srbf_choice(file, "discretise", "view light ", SRBF_BAD_METADATA);
    su->is_plain = srbf_choice(file, "interpolation", "rotated plain ", SRBF_BAD_METADATA);
    su->neighbours = srbf_choice(file, "neighbours", "1 2 3 4 5 6 7 ", SRBF_BAD_METADATA) + 1;
    su->views = (int)views, su->lobes = (int)lobes, model->is_isotropic = !su->is_plain;
    coefficient = srbf_need(file, "coefficient", views, lobes, 3, 0.0f, SRBF_MOST);
    bandwidth = srbf_need(file, "bandwidth", views, lobes, 0, 0.0f, SRBF_MOST);
    centre = srbf_need(file, "centre", views, lobes, 2, -SRBF_MOST, SRBF_MOST);
    if (views < 8) srbf_fail_tensor(file, bandwidth);
    if (file->error) return 0;
    su->number = number = (float*)srbf_take(file, views * (3 + 7 * lobes) * sizeof *number);
    // Views are the Fibonacci set of the hemisphere, and angles are relative to the mirror direction.
    for (i = 0; number && i < views; ++i) {
        const double z = ((double)i + 0.5) / (double)views, r = sqrt(1.0 - z * z), phi = 2.3999632297286533 * (double)i;
        const float theta0 = atan2f((float)r, (float)z), phi0 = atan2f(-(float)(r * sin(phi)), -(float)(r * cos(phi)));
        *number++ = (float)(r * cos(phi)), *number++ = (float)(r * sin(phi)), *number++ = (float)z;
        for (j = i * lobes; j < (i + 1) * lobes; ++j, number += 7) {
            const float theta = theta0 + srbf_number(file, centre, 2 * j);
            const srbf_vec3 beta = srbf_numbers(file, coefficient, 3 * j);
            const srbf_vec3 xi = srbf_spherical(theta, phi0 + srbf_number(file, centre, 2 * j + 1));
            memcpy(number, &beta, sizeof beta), number[3] = srbf_number(file, bandwidth, j);
            memcpy(number + 4, &xi, sizeof xi);
        }
    }
    return !file->error;
}

static int srbf_read_ggx(srbf_file* file, srbf_model* model) {
    const size_t lobes = srbf_extent(file, "roughness", 0, 2);
    const srbf_tensor *diffuse = srbf_need(file, "diffuse", 3, 0, 0, 0.0f, SRBF_MOST),
                      *roughness = srbf_need(file, "roughness", lobes, 0, 0, 1.0f / 1024.0f, 1.0f),
                      *f0 = srbf_need(file, "facing", lobes, 3, 0, 0.0f, SRBF_MOST),
                      *f90 = srbf_need(file, "grazing", lobes, 0, 0, 0.0f, SRBF_MOST);
    size_t i;
    if (file->error) return 0;
    model->diffuse = srbf_numbers(file, diffuse, 0), model->is_isotropic = 1, model->facets = 2;
    for (i = 0; i < 2; ++i) {
        const float alpha = i < lobes ? srbf_number(file, roughness, i) : 1.0f;
        model->ggx[i].roughness = alpha, model->facet[i] = srbf_facets_along(1.0f, 0.0f, alpha, alpha);
        if (i == lobes) break;
        model->ggx[i].f0 = srbf_numbers(file, f0, 3 * i), model->ggx[i].f90 = srbf_number(file, f90, i);
    }
    return 1;
}

static int srbf_read_openpbr(srbf_file* file, srbf_model* model) {
    const int has_film = srbf_find(file, "thin_film_weight") != 0;
    const int is_anisotropic = srbf_find(file, "specular_roughness_anisotropy") != 0;
    srbf_OpenPbrSurface* surface = &model->surface;
    srbf_OpenPbrAnisotropy* turned = &model->anisotropy;
    srbf_OpenPbrRoughness base;
    float p[3 * SRBF_PARAMETERS], coat, alpha;
    int i, c, n = 0;
    model->is_exchanged = srbf_choice(file, "exchanged_surface", "true false ", SRBF_BAD_METADATA) == 0;
    model->is_isotropic = !is_anisotropic, model->is_plain = !has_film && !is_anisotropic;
    for (i = 0; i < SRBF_PARAMETERS; ++i) {
        const srbf_parameter* row = &srbf_parameters[i];
        const int is_film = strncmp(row->name, "thin_film_", 10) == 0, is_turned = i >= SRBF_PARAMETERS - 2;
        const int is_stored = is_film ? has_film : is_turned ? is_anisotropic : 1;
        const srbf_tensor* tensor =
            is_stored ? srbf_need(file, row->name, (size_t)row->count, 0, 0, row->least, row->most) : 0;
        for (c = 0; c < row->count; ++c) p[n++] = tensor ? srbf_number(file, tensor, (size_t)c) : row->by_default;
    }
    if (file->error) return 0;
    // The members of the structures are in the order of the parameters, after the weight of the base.
    memcpy(surface, p + 1, sizeof *surface);
    memcpy(&model->film, p + 1 + sizeof *surface / sizeof *p, sizeof model->film);
    surface->base_color = srbf_scale(p[0], surface->base_color);
    turned->amount = p[n - 2];
    turned->cosine = cosf(6.28318531f * p[n - 1]), turned->sine = sinf(6.28318531f * p[n - 1]);
    coat = srbf_alpha_of(surface->coat_roughness);
    alpha = srbf_alpha_of(srbf_roughened(surface->specular_roughness, surface->coat_roughness, surface->coat_weight));
    base = srbf_openpbr_roughness(alpha, turned->amount);
    model->facets = surface->coat_weight > 0.0f ? 2 : 1;
    model->facet[0] = srbf_facets_along(turned->cosine, turned->sine, base.along, base.across);
    model->facet[1] = srbf_facets_along(1.0f, 0.0f, coat, coat);
    return 1;
}

static int srbf_read_model(srbf_file* file, srbf_model* model) {
    static int (*const readers[])(srbf_file*, srbf_model*) = {srbf_read_pm, srbf_read_su, srbf_read_ggx,
                                                              srbf_read_openpbr, srbf_read_openpbr};
    const int kind = srbf_choice(file, "model", "pm su ggx openpbr pbr ", SRBF_OTHER_KIND);
    if (kind < 0) return 0;
    model->kind = kind < 4 ? (srbf_kind)kind : SRBF_KIND_OPENPBR;
    return readers[kind](file, model);
}

// The sampled views nearest to w, the nearest first: one more than the model's neighbours. The directions' z rises.
static void srbf_find_nearest(srbf_su su, srbf_vec3 w, int* nearest) {
    float squared[8];
    int count = 0, most = su->neighbours + 1, middle = (int)(w.z * (float)su->views), side, i, k;
    if (middle > su->views) middle = su->views;
    for (side = 0; side < 2; ++side)
        for (i = side ? middle - 1 : middle; i >= 0 && i < su->views; i += side ? -1 : 1) {
            const srbf_vec3 apart = srbf_subtract(srbf_su_direction(su, i), w);
            const float next = srbf_dot(apart, apart);
            if (count == most && apart.z * apart.z > squared[count - 1]) break;
            if (count == most && next >= squared[count - 1]) continue;
            for (k = count < most ? count++ : count - 1; k > 0 && next < squared[k - 1]; --k)
                squared[k] = squared[k - 1], nearest[k] = nearest[k - 1];
            squared[k] = next, nearest[k] = i;
        }
}

// f(wl, wv) of a multivariate model. The forms that fits have by default have constant sizes.
SRBF_APART srbf_vec3 srbf_pm_value(const srbf_model* model, const srbf_vec3* wl, const srbf_vec3* wv) {
    const srbf_form form = model->pm;
#ifndef __OPTIMIZE_SIZE__
    const srbf_form usual = {form.lobes, 3, 4, 1, 1}, measured = {form.lobes, 4, 4, 1, 0};
    if (form.axial && form.features == 4 && form.reciprocal && form.variates == 3)
        return srbf_lobes_value(usual, model->lobes, *wl, *wv);
    if (form.axial && form.features == 4 && !form.reciprocal && form.variates == 4)
        return srbf_lobes_value(measured, model->lobes, *wl, *wv);
#endif
    return srbf_lobes_value(form, model->lobes, *wl, *wv);
}

// f(wl, wv) of any other model above the horizon.
SRBF_APART srbf_vec3 srbf_other_value(const srbf_model* model, srbf_vec3 wl, srbf_vec3 wv) {
    const srbf_vec3 l = model->is_exchanged ? wv : wl, v = model->is_exchanged ? wl : wv;
    if (model->kind == SRBF_KIND_SU) {
        const srbf_vec3 evaluated = model->su.of_lights ? wv : wl, sampled = model->su.of_lights ? wl : wv;
        int nearest[8];
        if (!model->su.is_plain) return srbf_su_rotated_value(&model->su, evaluated, sampled);
        srbf_find_nearest(&model->su, sampled, nearest);
        return srbf_su_plain_value(&model->su, nearest, evaluated, sampled, model->su.neighbours);
    }
    if (model->kind == SRBF_KIND_GGX) return srbf_ggx_value(model->diffuse, model->ggx[0], model->ggx[1], wl, wv);
#ifndef __OPTIMIZE_SIZE__
    if (model->is_plain) return srbf_openpbr_value(model->surface, l, v);
#endif
    return srbf_openpbr_anisotropic_value(model->surface, model->film, model->anisotropy, l, v);
}
// ---- Preparation ----

#define SRBF_ALBEDO_NODES 33
#define SRBF_MOST_POINTS 1152
// One of the four parts of a surface: the model that answers for it, and how it is sampled.
typedef struct {
    const srbf_model* model;
    int is_exchanged;
    srbf_mixture mixture;
    srbf_vec3 albedo[SRBF_ALBEDO_NODES];
} srbf_part;
typedef struct {
    int rings;
    const float *theta, *azimuths, *share;
} srbf_beam;
// Points at a few views about a node, and the densities of all components at them. Each view has as many points.
typedef struct {
    srbf_vec3 view[8], l[SRBF_MOST_POINTS];
    float weight[SRBF_MOST_POINTS], density[SRBF_MOST_POINTS][SRBF_NUMBERS];
    int views, each, count, components;
} srbf_points;
struct srbf_brdf {
    int is_two_sided;
    srbf_model model[4];
    srbf_part part[4];  // reflection at the front and the back, transmission of light from the front and from the back
    srbf_beam beam[4];
    srbf_points* points;
};

SRBF_INLINE srbf_vec3 srbf_part_value(const srbf_part* part, srbf_vec3 wl, srbf_vec3 wv) {
    const srbf_vec3 l = part->is_exchanged ? wv : wl, v = part->is_exchanged ? wl : wv;
    return part->model->kind == SRBF_KIND_PM ? srbf_pm_value(part->model, &l, &v) : srbf_other_value(part->model, l, v);
}
static float srbf_luminance(srbf_vec3 f) { return 0.2126f * f.x + 0.7152f * f.y + 0.0722f * f.z; }
static float srbf_turns(double x) { return (float)(x - floor(x)); }

// A view where all slots have weight, and half-vector lobes this stretch and power.
static void srbf_set_shape(srbf_view* view, const srbf_mixture* mixture, srbf_vec3 wv, const float shape[2]) {
    int k;
    for (k = 0; k < SRBF_NUMBERS; ++k) view->number[k] = 1.0f;
    memcpy(view->number + SRBF_STRETCH, shape, 2 * sizeof *shape);
    view->mixture = mixture, view->wv = wv;
    srbf_set_view(view);
}
static void srbf_set_densities(srbf_points* points, const srbf_mixture* mixture, const float shape[2]) {
    srbf_view view;
    int i;
    for (i = 0; i < points->count; ++i) {
        if (i % points->each == 0) srbf_set_shape(&view, mixture, points->view[i / points->each], shape);
        srbf_view_pdf(&view, points->l[i], points->density[i]);
    }
}

// The second moment of f cos(theta_l) / pdf after `steps` multiplicative steps of the weights towards the least one
// (the library's `propose`, srbf/sampling.h).
static float srbf_least_moment(const srbf_points* points, int steps, float weight[SRBF_NUMBERS]) {
    float moment = 0.0f, sum;
    int step, i, k;
    memset(weight, 0, SRBF_NUMBERS * sizeof *weight);
    for (k = 0; k < points->components; ++k) weight[k] = 1.0f / (float)points->components;
    for (step = 0; step <= steps; ++step) {
        float slope[SRBF_NUMBERS] = {0.0f};
        for (i = 0, moment = 0.0f; i < points->count; ++i) {
            const float* density = points->density[i];
            srbf_x pdfs = srbf_x_of(0.0f), share;
            float pdf;
            if (!(points->weight[i] > 0.0f)) continue;
            for (k = 0; k < SRBF_NUMBERS; k += SRBF_LANES)
                pdfs = pdfs + srbf_x_load(weight + k) * srbf_x_load(density + k);
            pdf = srbf_x_sum(pdfs) + 1.0e-15f;
            moment += points->weight[i] / pdf, share = srbf_x_of(points->weight[i] / pdf / pdf);
            for (k = 0; k < SRBF_NUMBERS; k += SRBF_LANES)
                srbf_x_store(srbf_x_load(slope + k) + share * srbf_x_load(density + k), slope + k);
        }
        if (step == steps) break;
        for (k = 0, sum = 0.0f; k < SRBF_STRETCH; ++k) sum += slope[k] = weight[k] * srbf_sqrt(slope[k]);
        for (k = 0; k < SRBF_STRETCH && sum > 0.0f; ++k) weight[k] = slope[k] / sum;
    }
    return moment;
}

// Sets samples of all components in a wide and a narrow shape at the points' views, weighted by the square of
// f cos(theta_l) over its integral.
static void srbf_make_points(const srbf_part* part, srbf_points* points) {
    static const float shapes[2][2] = {{1.0f, 1.0f}, {0.2f, 2.4f}};
    const int draws = SRBF_MOST_POINTS / (points->views * 2 * points->components), half = points->components * draws;
    double albedo = 0.0;
    srbf_view view;
    int i, k, shape;
    points->each = 2 * half, points->count = points->views * points->each;
    memset(points->density, 0, sizeof points->density), memset(points->weight, 0, sizeof points->weight);
    for (i = 0; i < points->count; ++i) {
        const float u1 = ((float)(i % draws) + 0.5f) / (float)draws;
        const float u2 = srbf_turns(0.6180339887 * (i + 7 * (i / draws)));
        if (i % half == 0) srbf_set_shape(&view, &part->mixture, points->view[i / points->each], shapes[i / half % 2]);
        points->l[i] = srbf_slot_sample(&view, i / draws % points->components, u1, u2);
    }
    for (shape = 0; shape < 2; ++shape) {
        srbf_set_densities(points, &part->mixture, shapes[shape]);
        for (i = 0; i < points->count; ++i)
            for (k = 0; k < points->components; ++k) points->weight[i] += (float)draws * points->density[i][k];
    }
    for (i = 0; i < points->count; ++i) {
        const srbf_vec3 l = points->l[i];
        const float density = points->weight[i];
        points->weight[i] = 0.0f;
        if (l.z > 1.0e-6f && density > 0.0f) {
            const srbf_vec3 f = srbf_part_value(part, l, points->view[i / points->each]);
            const float reflected = srbf_min(srbf_luminance(f) * l.z, 1.0e12f);
            albedo += (double)(reflected / density), points->weight[i] = reflected * reflected / density;
        }
        if ((i + 1) % points->each != 0) continue;
        for (k = i + 1 - points->each; k <= i; ++k)
            points->weight[k] = albedo > 1.0e-12 ? (float)((double)points->weight[k] / (albedo * albedo)) : 0.0f;
        albedo = 0.0;
    }
}

// The stretch 0.64^a and the power 0.64^(1 - b), from the steps a, b.
static void srbf_shape_of(const int at[2], float shape[2]) {
    shape[0] = powf(0.64f, (float)at[0]), shape[1] = powf(0.64f, (float)(1 - at[1]));
}
// The numbers of a node: the shape by descent, then the weights of least variance.
static void srbf_make_node(srbf_part* part, srbf_points* points, int node) {
    float *number = part->mixture.number[node], shape[2], least, moment, sum = 0.0f;
    int i, move, best[2] = {0, 1}, is_better = node > 0;
    points->views = part->model->is_isotropic ? 3 : 8;
    for (i = 0; i < points->views; ++i) {
        const float apart = points->views == 3 ? ((float)i - 1.0f) / 3.0f : 0.0f;
        const float at = srbf_min(srbf_max(((float)node + apart) / (float)(SRBF_NODES - 1), 0.0f), 1.0f);
        const float phi = points->views == 3 ? 0.0f : 0.785398163f * (float)i;
        points->view[i] = srbf_spherical(acosf(srbf_mixture_cosine(at)), phi);
    }
    srbf_make_points(part, points);
    srbf_shape_of(best, shape);
    srbf_set_densities(points, &part->mixture, shape);
    least = srbf_least_moment(points, 15, number);
    while (is_better) {
        const int centre[2] = {best[0], best[1]};
        is_better = 0;
        for (move = 0; move < 4; ++move) {  // stretch or power up or down
            int at[2] = {centre[0], centre[1]};
            at[move % 2] += move / 2 ? 1 : -1;
            if (at[0] < -2 || at[0] > 10 || at[1] < 0 || at[1] > 7) continue;
            srbf_shape_of(at, shape);
            srbf_set_densities(points, &part->mixture, shape);
            moment = srbf_least_moment(points, 15, number);
            if (moment < 0.998f * least) least = moment, memcpy(best, at, sizeof best), is_better = 1;
        }
    }
    srbf_shape_of(best, shape);
    if (node == 0) shape[0] = shape[1] = 1.0f;
    srbf_set_densities(points, &part->mixture, shape);
    srbf_least_moment(points, 60, number);
    number[0] = srbf_max(number[0], 0.02f);
    for (i = 0; i < SRBF_STRETCH; ++i) {
        if (!(number[i] > 1.0e-2f)) number[i] = 0.0f;
        sum += number[i];
    }
    for (i = 0; i < SRBF_STRETCH; ++i) number[i] /= sum;
    memcpy(number + SRBF_STRETCH, shape, sizeof shape);
}

static void srbf_part_sample(const srbf_part* part, srbf_vec3 wv, const float u[3], srbf_light* light) {
    srbf_view view;
    srbf_vec3 wl, f;
    srbf_view_of(&view, &part->mixture, wv);
    wl = srbf_view_sample(&view, u[0], u[1], u[2]);
    memcpy(light->wl, &wl, sizeof wl);
    if (wl.z >= 1.17549435e-38f) light->pdf = srbf_max(srbf_view_pdf(&view, wl, 0), 0.0f);
    if (!(light->pdf > 0.0f)) return;
    f = srbf_scale(wl.z / light->pdf, srbf_part_value(part, wl, wv));
    memcpy(light->weight, &f, sizeof f);
}
// Albedos as the means of weights of samples, at four azimuths. Their nodes are uniform in
// t = sqrt(1 - sqrt(1 - cos(theta_v))), so that they are dense at the horizon and at the normal.
static void srbf_make_albedos(srbf_part* part) {
    const int draws = 8192;
    int node, i;
    for (node = 0; node < SRBF_ALBEDO_NODES; ++node) {
        const float t = (float)node / (float)(SRBF_ALBEDO_NODES - 1);
        const float cosine = srbf_max(t * t * (2.0f - t * t), 1.0e-6f);
        double sum[3] = {0, 0, 0};
        for (i = 0; i < draws; ++i) {
            const float u[3] = {srbf_turns(0.8191725134 * i), srbf_turns(0.6710436067 * i),
                                srbf_turns(0.5497004779 * i)};
            srbf_light light;
            memset(&light, 0, sizeof light);
            srbf_part_sample(part, srbf_spherical(acosf(cosine), 1.57079633f * (float)(i % 4)), u, &light);
            sum[0] += (double)light.weight[0], sum[1] += (double)light.weight[1], sum[2] += (double)light.weight[2];
        }
        part->albedo[node] = srbf_vec3_of((float)(sum[0] / draws), (float)(sum[1] / draws), (float)(sum[2] / draws));
    }
}
static srbf_vec3 srbf_part_albedo(const srbf_part* part, float cosine) {
    const float t = srbf_sqrt(1.0f - srbf_sqrt(1.0f - srbf_min(cosine, 1.0f)));
    const float at = t * (float)(SRBF_ALBEDO_NODES - 1);
    const int below = (int)srbf_min(at, (float)(SRBF_ALBEDO_NODES - 2));
    return srbf_interpolated(part->albedo[below], part->albedo[below + 1], at - (float)below);
}

static void srbf_prepare_part(srbf_part* part, srbf_points* points) {
    const srbf_model* model = part->model;
    int node;
    part->mixture.facets = model->facets, points->components = SRBF_FACET_SLOT + model->facets;
    memcpy(part->mixture.facet, model->facet, sizeof model->facet);
    for (node = 0; node < SRBF_NODES; ++node) srbf_make_node(part, points, node);
    srbf_make_albedos(part);
}
// ---- The functions of the interface ----

static int srbf_read_beam(srbf_file* file, srbf_beam* beam) {
    const srbf_tensor *angle, *azimuths, *share = srbf_find(file, "share");
    const int has_azimuths = srbf_find(file, "azimuths") != 0, is_grey = has_azimuths && share && share->extent[1] == 1;
    size_t rings, nodes = 0, i;
    float* number;
    if (!srbf_find(file, "angle")) return 1;
    rings = srbf_extent(file, "angle", 0, 256);
    angle = srbf_need(file, "angle", rings, 0, 0, 0.0f, 1.5713f);
    azimuths = has_azimuths ? srbf_need(file, "azimuths", rings, 0, 0, 1.0f, 2048.0f) : 0;
    for (i = 0; i < rings && !file->error; ++i) {
        const float n = azimuths ? srbf_number(file, azimuths, i) : 1.0f;
        if (n != floorf(n) || (i > 0 && !(srbf_number(file, angle, i) > srbf_number(file, angle, i - 1))))
            srbf_fail(file, SRBF_BAD_NUMBER, angle->begin + 2 * i);
        nodes += (size_t)n;
    }
    share = srbf_need(file, "share", nodes, is_grey ? 1 : 3, 0, 0.0f, 1.0f);
    if (file->error) return 0;
    number = (float*)srbf_take(file, (2 * rings + 3 * nodes) * sizeof *number);
    if (!number) return !file->error;
    beam->rings = (int)rings, beam->theta = number;
    beam->azimuths = number + rings, beam->share = number + 2 * rings;
    for (i = 0; i < rings; ++i) {
        number[i] = srbf_number(file, angle, i);
        number[rings + i] = azimuths ? srbf_number(file, azimuths, i) : 1.0f;
    }
    for (i = 0; i < 3 * nodes; ++i) number[2 * rings + i] = srbf_number(file, share, is_grey ? i / 3 : i);
    return 1;
}

// True if a tensor is a table for shaders, whose names begin with "aux.", also in parts.
static int srbf_is_auxiliary(srbf_word name) {
    size_t i;
    for (i = 0; i + 4 <= name.length; ++i)
        if (memcmp(name.text + i, "aux.", 4) == 0 && (i == 0 || name.text[i - 1] == '.')) return 1;
    return 0;
}
static void srbf_read(srbf_file* file, srbf_brdf* brdf) {
    static const char* const parts[] = {"reflection_front.", "reflection_back.", "transmission_front.",
                                        "transmission_back."};
    static const char* const beams[] = {"beam.reflection_front.", "beam.reflection_back.", "beam.transmission.",
                                        "beam.transmission_back."};
    int p, i;
    memset(brdf, 0, sizeof *brdf);
    if (!srbf_read_header(file) || srbf_choice(file, "srbf", "1 ", SRBF_OTHER_VERSION) < 0) return;
    brdf->is_two_sided = srbf_metadata(file, "model") && srbf_is(file->word, "", "bsdf");
    for (p = 0; p < 4; ++p) {
        file->prefix = brdf->is_two_sided ? parts[p] : "";
        if (brdf->is_two_sided ? !srbf_metadata(file, "model") : p > 0) continue;
        if (!srbf_read_model(file, &brdf->model[p])) return;
        brdf->part[p].model = &brdf->model[p];
    }
    for (p = 0; p < 4 && brdf->is_two_sided; ++p) {
        file->prefix = beams[p];
        if (!srbf_read_beam(file, &brdf->beam[p])) return;
    }
    for (i = 0; i < file->tensors; ++i)
        if (!file->tensor[i].is_read && !srbf_is_auxiliary(file->tensor[i].name))
            srbf_fail_tensor(file, &file->tensor[i]);
    for (p = 0; p < 4; ++p) {  // a part without a model is answered by its counterpart, a transmission by reciprocity
        srbf_part* part = &brdf->part[p];
        if (!part->model && brdf->is_two_sided) part->model = brdf->part[p ^ 1].model, part->is_exchanged = p >= 2;
        for (i = 0; i < SRBF_NODES; ++i) {  // the cosine alone
            float* number = part->mixture.number[i];
            int k;
            for (k = SRBF_STRETCH; k < SRBF_NUMBERS; ++k) number[k] = 1.0f;
            number[0] = 1.0f;
        }
    }
    brdf->points = (srbf_points*)srbf_take(file, sizeof *brdf->points);
}

static void srbf_begin(srbf_file* file, const void* bytes, size_t size) {
    memset(file, 0, sizeof *file);
    file->bytes = (const unsigned char*)bytes, file->size = size, file->prefix = "";
    file->used = (sizeof(srbf_brdf) + 15) / 16 * 16;
}
size_t srbf_memory_needed(const void* bytes, size_t size) {
    srbf_file file;
    srbf_brdf brdf;
    srbf_begin(&file, bytes, size);
    srbf_read(&file, &brdf);
    return file.error ? 0 : file.used + 16;
}
srbf_error srbf_open(const void* bytes, size_t size, void* memory, size_t capacity, srbf_brdf** brdf, size_t* offset) {
    const size_t unaligned = (16 - (size_t)memory % 16) % 16;
    srbf_file file;
    srbf_begin(&file, bytes, size);
    *brdf = 0;
    if (memory && capacity >= unaligned + file.used) {
        file.memory = (char*)memory + unaligned, file.capacity = capacity - unaligned;
        srbf_read(&file, (srbf_brdf*)(void*)file.memory);
    } else {
        file.error = SRBF_TOO_LITTLE_MEMORY;
    }
    if (offset) *offset = file.error_at;
    if (!file.error) *brdf = (srbf_brdf*)(void*)file.memory;
    return file.error;
}
void srbf_prepare(srbf_brdf* brdf) {
    int p;
    for (p = 0; p < 4; ++p) {
        srbf_part* part = &brdf->part[p];
        if (p == 1 && part->model == brdf->part[0].model)
            *part = brdf->part[0];
        else if (part->model)
            srbf_prepare_part(part, brdf->points);
    }
}
int srbf_is_two_sided(const srbf_brdf* brdf) { return brdf->is_two_sided; }

// True if no direction lies in the surface. Sets the pair in the frame of a part, above its horizon.
SRBF_INLINE int srbf_is_above(const srbf_brdf* brdf, const float wl[3], const float wv[3], srbf_vec3* l, srbf_vec3* v) {
    *l = srbf_vec3_at(wl), *v = srbf_vec3_at(wv);
    if (!srbf_is_finite(*l) || !srbf_is_finite(*v)) return 0;
    if (brdf->is_two_sided) l->z = fabsf(l->z), v->z = fabsf(v->z);
    return l->z >= 1.17549435e-38f && v->z >= 1.17549435e-38f;
}
// The part that answers for the pair; -1 if there is none.
SRBF_INLINE int srbf_part_of(const srbf_brdf* brdf, const float wl[3], const float wv[3], srbf_vec3* l, srbf_vec3* v) {
    const int is_back = wl[2] < 0.0f, part = is_back + 2 * (is_back != (wv[2] < 0.0f));
    return srbf_is_above(brdf, wl, wv, l, v) && brdf->part[part].model ? part : -1;
}

static srbf_vec3 srbf_ring_share(const srbf_beam* beam, int ring, int first, float turns) {
    const int n = (int)beam->azimuths[ring], at = (int)(turns * (float)n), k = at < n ? at : n - 1;
    return srbf_interpolated(srbf_vec3_at(beam->share + 3 * (first + k)),
                             srbf_vec3_at(beam->share + 3 * (first + (k + 1) % n)), turns * (float)n - (float)k);
}
// The share of the light from wl that a part lets pass unscattered: linear in the azimuth, and in theta between rings.
static srbf_vec3 srbf_beam_share(const srbf_brdf* brdf, int part, srbf_vec3 wl) {
    const srbf_beam *stored = &brdf->beam[part], *beam = part >= 2 && !stored->rings ? &brdf->beam[part ^ 1] : stored;
    const float theta = acosf(srbf_min(wl.z, 1.0f)), sign = beam == stored ? 1.0f : -1.0f;
    const float turns = srbf_turns((double)atan2f(sign * wl.y, sign * wl.x) / 6.283185307179586);
    srbf_vec3 high = srbf_vec3_of(0.0f, 0.0f, 0.0f);
    int next = 0, first = 0, before = 0;
    float t;
    if (!beam->rings) return high;
    for (; next < beam->rings && beam->theta[next] <= theta; ++next) before = first, first += (int)beam->azimuths[next];
    if (next < beam->rings) high = srbf_ring_share(beam, next, first, turns);
    if (next == 0) return high;
    t = (next < beam->rings ? beam->theta[next] : 1.57079633f) - beam->theta[next - 1];
    t = t > 0.0f ? srbf_min((theta - beam->theta[next - 1]) / t, 1.0f) : 0.0f;
    return srbf_interpolated(srbf_ring_share(beam, next - 1, before, turns), high, t);
}

// The chances of reflection, its beam, transmission and its beam for a view, by their albedos.
typedef struct {
    const srbf_part* part[2];
    float chance[4];
    srbf_vec3 share[2];
} srbf_chances;
static srbf_chances srbf_chances_of(const srbf_brdf* brdf, srbf_vec3 v, int is_back) {
    const srbf_vec3 none = {0.0f, 0.0f, 0.0f};
    srbf_chances chances;
    float sum = 0.0f, total = 0.0f;
    int k;
    memset(&chances, 0, sizeof chances);
    chances.part[0] = &brdf->part[is_back], chances.part[1] = &brdf->part[3 - is_back];
    chances.chance[0] = brdf->is_two_sided ? 0.0f : 1.0f;
    if (!brdf->is_two_sided) return chances;
    for (k = 0; k < 2; ++k) {
        const srbf_vec3 albedo = chances.part[k]->model ? srbf_part_albedo(chances.part[k], v.z) : none;
        chances.share[k] = srbf_beam_share(brdf, (int)(chances.part[k] - brdf->part), srbf_vec3_of(-v.x, -v.y, v.z));
        chances.chance[2 * k] = srbf_luminance(albedo), chances.chance[2 * k + 1] = srbf_luminance(chances.share[k]);
        sum += chances.chance[2 * k] + chances.chance[2 * k + 1];
    }
    for (k = 0; k < 4; ++k) {
        const float smallest = sum > 0.0f ? 1.0e-3f * sum : 1.0f;
        const float min = k % 2 == 0 && chances.part[k / 2]->model ? smallest : 0.0f;
        chances.chance[k] = srbf_max(chances.chance[k], min);
        total += chances.chance[k];
    }
    for (k = 0; k < 4 && total > 0.0f; ++k) chances.chance[k] /= total;
    return chances;
}

void srbf_sample(const srbf_brdf* brdf, const float wv[3], const float u[3], srbf_light* light) {
    const int is_back = wv[2] < 0.0f;
    float selector = u[2], *weight = light->weight;
    srbf_chances chances;
    srbf_vec3 v, same;
    int k, c;
    memset(light, 0, sizeof *light);
    if (!srbf_is_above(brdf, wv, wv, &same, &v)) return;
    chances = srbf_chances_of(brdf, v, is_back);
    for (k = 0; k < 4 && !(selector < chances.chance[k]); ++k) selector -= chances.chance[k];
    if (k == 4) return;
    if (k % 2 == 0) {
        const float in_part[3] = {u[0], u[1], srbf_min(selector / chances.chance[k], 0.99999994f)};
        srbf_part_sample(chances.part[k / 2], v, in_part, light);
        light->pdf *= chances.chance[k];
    } else {
        const srbf_vec3 straight = srbf_vec3_of(-v.x, -v.y, v.z);
        memcpy(light->wl, &straight, sizeof straight), memcpy(weight, &chances.share[k / 2], sizeof straight);
        light->is_beam = 1;
    }
    if (is_back != (k >= 2)) light->wl[2] = -light->wl[2];
    for (c = 0; c < 3; ++c) weight[c] /= chances.chance[k];
}

// The value and the density, each unless its pointer is null.
SRBF_INLINE void srbf_evaluate(const srbf_brdf* brdf, const float wl[3], const float wv[3], float* rgb, float* pdf) {
    srbf_vec3 l, v, f = srbf_vec3_of(0.0f, 0.0f, 0.0f);
    const int part = srbf_part_of(brdf, wl, wv, &l, &v);
    srbf_view view;
    if (part >= 0 && rgb) f = srbf_part_value(&brdf->part[part], l, v);
    if (rgb) memcpy(rgb, &f, sizeof f);
    if (!pdf) return;
    *pdf = 0.0f;
    if (part < 0) return;
    srbf_view_of(&view, &brdf->part[part].mixture, v);
    *pdf = srbf_view_pdf(&view, l, 0);
    if (brdf->is_two_sided) *pdf *= srbf_chances_of(brdf, v, wv[2] < 0.0f).chance[part & 2];
}
void srbf_value(const srbf_brdf* brdf, const float wl[3], const float wv[3], float rgb[3]) {
    srbf_evaluate(brdf, wl, wv, rgb, 0);
}
void srbf_values(const srbf_brdf* brdf, size_t count, const float* wl, const float* wv, float* rgb) {
    size_t i;
    for (i = 0; i < count; ++i) srbf_value(brdf, wl + 3 * i, wv + 3 * i, rgb + 3 * i);
}
float srbf_pdf(const srbf_brdf* brdf, const float wl[3], const float wv[3]) {
    float pdf;
    srbf_evaluate(brdf, wl, wv, 0, &pdf);
    return pdf;
}
float srbf_value_pdf(const srbf_brdf* brdf, const float wl[3], const float wv[3], float rgb[3]) {
    float pdf;
    srbf_evaluate(brdf, wl, wv, rgb, &pdf);
    return pdf;
}
void srbf_albedo(const srbf_brdf* brdf, float cosine, float rgb[3]) {
    const srbf_part* part = &brdf->part[cosine < 0.0f];
    srbf_vec3 albedo = srbf_vec3_of(0.0f, 0.0f, 0.0f);
    if (part->model && srbf_is_finite(srbf_vec3_of(cosine, 0.0f, 0.0f)) && fabsf(cosine) > 0.0f)
        albedo = srbf_part_albedo(part, srbf_min(fabsf(cosine), 1.0f));
    memcpy(rgb, &albedo, sizeof albedo);
}

#endif
