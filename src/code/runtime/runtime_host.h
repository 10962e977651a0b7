// ---- Numbers ----

// Vectors of floats, if the compiler has them: lobes and components of a density are computed SRBF_LANES at a time.
// Without them, or with SRBF_ONE_LANE, each is computed alone by the same functions.
#ifdef __GNUC__
#define SRBF_INLINE SRBF_FN __attribute__((always_inline))
#else
#define SRBF_INLINE SRBF_FN
#endif
#if defined __GNUC__ && !defined __clang__
#define SRBF_UNROLL _Pragma("GCC unroll 8")
#else
#define SRBF_UNROLL
#endif
#if defined __GNUC__ && !defined SRBF_ONE_LANE
#ifdef __AVX2__
#define SRBF_LANES 8
#else
#define SRBF_LANES 4
#endif
typedef float srbf_x __attribute__((vector_size(4 * SRBF_LANES)));
typedef int srbf_x_mask __attribute__((vector_size(4 * SRBF_LANES)));
typedef unsigned srbf_x_bits __attribute__((vector_size(4 * SRBF_LANES)));
SRBF_FN srbf_x srbf_x_select(srbf_x_mask where, srbf_x a, srbf_x b) {
    return (srbf_x)(((srbf_x_mask)a & where) | ((srbf_x_mask)b & ~where));
}
#else
#define SRBF_LANES 1
typedef float srbf_x;
typedef int srbf_x_mask;
typedef unsigned srbf_x_bits;
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
SRBF_FN srbf_x srbf_x_of_bits(srbf_x_bits bits) {
    srbf_x a;
    memcpy(&a, &bits, sizeof a);
    return a;
}

// A number in all lanes, the sum of the lanes, minimum, maximum and 1 / sqrt(a), whose relative error is 3e-7 by steps
// of Newton's method. At 0 it is finite.
#if SRBF_LANES > 1 && defined __SSE__
#include <immintrin.h>
#if SRBF_LANES == 8
#define SRBF_X(name) _mm256_##name##_ps
#else
#define SRBF_X(name) _mm_##name##_ps
#endif
SRBF_FN srbf_x srbf_x_of(float x) { return SRBF_X(set1)(x); }
SRBF_FN srbf_x srbf_x_min(srbf_x a, srbf_x b) { return SRBF_X(min)(a, b); }
SRBF_FN srbf_x srbf_x_max(srbf_x a, srbf_x b) { return SRBF_X(max)(a, b); }
SRBF_FN srbf_x srbf_x_inversesqrt(srbf_x a) {
    const srbf_x y = SRBF_X(rsqrt)(srbf_x_max(a, srbf_x_of(1.17549435e-38f)));
    return y * (srbf_x_of(1.5f) - srbf_x_of(0.5f) * a * y * y);
}
#else
SRBF_FN srbf_x srbf_x_of(float x) {
    float all[SRBF_LANES];
    int i;
    for (i = 0; i < SRBF_LANES; ++i) all[i] = x;
    return srbf_x_load(all);
}
SRBF_FN srbf_x srbf_x_min(srbf_x a, srbf_x b) { return srbf_x_select(a < b, a, b); }
SRBF_FN srbf_x srbf_x_max(srbf_x a, srbf_x b) { return srbf_x_select(a > b, a, b); }
SRBF_FN srbf_x srbf_x_inversesqrt(srbf_x a) {
    const srbf_x half = srbf_x_of(0.5f) * a, most = srbf_x_of(1.5f);
    const srbf_x_bits shifted = srbf_x_bits_of(a) >> 1;
    srbf_x y = srbf_x_of_bits(0x5f375a86u - shifted);
    y = y * (most - half * y * y);
    y = y * (most - half * y * y);
    return y * (most - half * y * y);
}
#endif
SRBF_FN float srbf_x_sum(srbf_x a) {
    float all[8] = {0.0f};
    srbf_x_store(a, all);
    return ((all[0] + all[1]) + (all[2] + all[3])) + ((all[4] + all[5]) + (all[6] + all[7]));
}
SRBF_FN srbf_x srbf_x_sqrt(srbf_x a) { return a * srbf_x_inversesqrt(a); }

// 2^a by the nearest integer and a polynomial for the rest; relative error 2e-7. It is 0 from -127 down.
SRBF_FN srbf_x srbf_x_exp2(srbf_x a) {
    const srbf_x shift = srbf_x_of(12582912.0f), x = srbf_x_max(a, srbf_x_of(-127.0f)), sum = x + shift;
    const srbf_x r = x - (sum - shift);
    srbf_x power = srbf_x_of(0.00132646454f) * r + srbf_x_of(0.00967157641f);
    power = (power * r + srbf_x_of(0.0555073452f)) * r + srbf_x_of(0.240222411f);
    power = (power * r + srbf_x_of(0.693146977f)) * r + srbf_x_of(1.0f);
    return srbf_x_of_bits(srbf_x_bits_of(power) + (srbf_x_bits_of(sum) << 23));
}
SRBF_FN srbf_x srbf_x_exp(srbf_x a) { return srbf_x_exp2(srbf_x_of(1.44269504f) * a); }

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
    return srbf_x_vec3_of(srbf_x_load(row), srbf_x_load(row + SRBF_LANES), srbf_x_load(row + 2 * SRBF_LANES));
}
SRBF_FN srbf_x_vec3 srbf_x_all(srbf_vec3 a) { return srbf_x_vec3_of(srbf_x_of(a.x), srbf_x_of(a.y), srbf_x_of(a.z)); }

// ---- Models, and their numbers as the formulas read them ----

// A multivariate model. A row has a number of each lobe. A group of SRBF_LANES lobes has the rows: log2 of the scale;
// R, G, B; the exponents; and for each variate minus its falloff, if its centre is +z and if it is -z, or with x, y, z
// of the centre.
typedef struct {
    int groups, variates, features, axial, reciprocal, rows;
    float weight_l[SRBF_MOST_VARIATES], weight_v[SRBF_MOST_VARIATES];
    const float* number;
} srbf_lobes;

// A view-by-view model: for each view its direction, and for each of its lobes R, G, B, bandwidth, centre and shape.
typedef struct {
    int views, lobes, of_lights, is_plain, neighbours;
    const float* number;
} srbf_view_lobes;
typedef const srbf_view_lobes* srbf_su;
typedef const int* srbf_su_nearest_views;
SRBF_FN int srbf_su_lobes(srbf_su su) { return su->lobes; }
SRBF_FN int srbf_su_views(srbf_su su) { return su->views; }
SRBF_FN const float* srbf_su_row(srbf_su su, int view) {
    return su->number + (size_t)view * (size_t)(3 + 8 * su->lobes);
}
SRBF_FN srbf_vec3 srbf_vec3_at(const float* w) { return srbf_vec3_of(w[0], w[1], w[2]); }
SRBF_FN srbf_vec3 srbf_su_direction(srbf_su su, int view) { return srbf_vec3_at(srbf_su_row(su, view)); }
SRBF_FN const float* srbf_su_lobe(srbf_su su, int view, int j) { return srbf_su_row(su, view) + 3 + 8 * j; }
SRBF_FN srbf_vec3 srbf_su_coefficient(srbf_su su, int view, int j) { return srbf_vec3_at(srbf_su_lobe(su, view, j)); }
SRBF_FN float srbf_su_bandwidth(srbf_su su, int view, int j) { return srbf_su_lobe(su, view, j)[3]; }
SRBF_FN srbf_vec3 srbf_su_centre(srbf_su su, int view, int j) { return srbf_vec3_at(srbf_su_lobe(su, view, j) + 4); }
SRBF_FN float srbf_su_shape(srbf_su su, int view, int j) { return srbf_su_lobe(su, view, j)[7]; }
SRBF_FN int srbf_su_nearest(srbf_su_nearest_views nearest, int k) { return nearest[k]; }

// ---- Formulas: those of kernel.glsl, which explains them, for a number and for SRBF_LANES numbers ----
