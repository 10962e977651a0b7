// ---- Numbers ----

// Four floats, if the compiler has such vectors: lobes, components of a density and points are computed four at a time.
// Without them, or with SRBF_ONE_LANE, each is computed alone by the same functions.
#if defined __GNUC__ && !defined SRBF_ONE_LANE
#define SRBF_LANES 4
#ifdef __SSE__
#include <xmmintrin.h>
#endif
typedef float srbf_x4 __attribute__((vector_size(16)));
typedef int srbf_mask4 __attribute__((vector_size(16)));
typedef unsigned srbf_bits4 __attribute__((vector_size(16)));
SRBF_FN srbf_x4 srbf_x4_of(float x) { srbf_x4 all = {x, x, x, x}; return all; }
SRBF_FN srbf_bits4 srbf_bits4_of(unsigned x) { srbf_bits4 all = {x, x, x, x}; return all; }
SRBF_FN srbf_x4 srbf_x4_select(srbf_mask4 where, srbf_x4 a, srbf_x4 b) {
    return (srbf_x4)(((srbf_mask4)a & where) | ((srbf_mask4)b & ~where));
}
SRBF_FN float srbf_x4_sum(srbf_x4 a) { return (a[0] + a[1]) + (a[2] + a[3]); }
#else
#define SRBF_LANES 1
typedef float srbf_x4;
typedef int srbf_mask4;
typedef unsigned srbf_bits4;
SRBF_FN srbf_x4 srbf_x4_of(float x) { return x; }
SRBF_FN srbf_bits4 srbf_bits4_of(unsigned x) { return x; }
SRBF_FN srbf_x4 srbf_x4_select(srbf_mask4 where, srbf_x4 a, srbf_x4 b) { return where ? a : b; }
SRBF_FN float srbf_x4_sum(srbf_x4 a) { return a; }
#endif
SRBF_FN srbf_bits4 srbf_x4_bits(srbf_x4 a) { srbf_bits4 bits; memcpy(&bits, &a, sizeof bits); return bits; }
SRBF_FN srbf_x4 srbf_x4_of_bits(srbf_bits4 bits) { srbf_x4 a; memcpy(&a, &bits, sizeof a); return a; }
SRBF_FN srbf_x4 srbf_x4_load(const float* from) { srbf_x4 a; memcpy(&a, from, sizeof a); return a; }
SRBF_FN void srbf_x4_store(srbf_x4 a, float* to) { memcpy(to, &a, sizeof a); }

// Minimum, maximum and 1 / sqrt(a), whose relative error is 3e-7 by steps of Newton's method. At 0 it is finite.
#if defined __SSE__ && SRBF_LANES == 4
SRBF_FN srbf_x4 srbf_x4_min(srbf_x4 a, srbf_x4 b) { return (srbf_x4)_mm_min_ps((__m128)a, (__m128)b); }
SRBF_FN srbf_x4 srbf_x4_max(srbf_x4 a, srbf_x4 b) { return (srbf_x4)_mm_max_ps((__m128)a, (__m128)b); }
SRBF_FN srbf_x4 srbf_x4_inversesqrt(srbf_x4 a) {
    const srbf_x4 y = (srbf_x4)_mm_rsqrt_ps((__m128)srbf_x4_max(a, srbf_x4_of(1.17549435e-38f)));
    return y * (srbf_x4_of(1.5f) - srbf_x4_of(0.5f) * a * y * y);
}
#else
SRBF_FN srbf_x4 srbf_x4_min(srbf_x4 a, srbf_x4 b) { return srbf_x4_select(a < b, a, b); }
SRBF_FN srbf_x4 srbf_x4_max(srbf_x4 a, srbf_x4 b) { return srbf_x4_select(a > b, a, b); }
SRBF_FN srbf_x4 srbf_x4_inversesqrt(srbf_x4 a) {
    const srbf_x4 half = srbf_x4_of(0.5f) * a, most = srbf_x4_of(1.5f);
    srbf_x4 y = srbf_x4_of_bits(srbf_bits4_of(0x5f375a86) - (srbf_x4_bits(a) >> 1));
    y = y * (most - half * y * y);
    y = y * (most - half * y * y);
    return y * (most - half * y * y);
}
#endif
SRBF_FN srbf_x4 srbf_x4_sqrt(srbf_x4 a) { return a * srbf_x4_inversesqrt(a); }

// 2^a by the nearest integer and a polynomial for the rest; relative error 2e-7. It is 0 from -127 down.
SRBF_FN srbf_x4 srbf_x4_exp2(srbf_x4 a) {
    const srbf_x4 shift = srbf_x4_of(12582912.0f), x = srbf_x4_max(a, srbf_x4_of(-127.0f)), sum = x + shift;
    const srbf_x4 r = x - (sum - shift), one = srbf_x4_of(1.0f);
    srbf_x4 power = srbf_x4_of(0.00132646454f) * r + srbf_x4_of(0.00967157641f);
    power = (power * r + srbf_x4_of(0.0555073452f)) * r + srbf_x4_of(0.240222411f);
    power = (power * r + srbf_x4_of(0.693146977f)) * r + one;
    return srbf_x4_of_bits(srbf_x4_bits(power) + ((srbf_x4_bits(sum) - srbf_x4_bits(shift)) << 23));
}
SRBF_FN srbf_x4 srbf_x4_exp(srbf_x4 a) { return srbf_x4_exp2(srbf_x4_of(1.44269504f) * a); }

typedef struct {
    srbf_x4 x, y, z;
} srbf_x4_vec3;
SRBF_FN srbf_x4_vec3 srbf_x4_vec3_of(srbf_x4 x, srbf_x4 y, srbf_x4 z) { srbf_x4_vec3 w = {x, y, z}; return w; }
SRBF_FN srbf_x4_vec3 srbf_x4_add(srbf_x4_vec3 a, srbf_x4_vec3 b) {
    return srbf_x4_vec3_of(a.x + b.x, a.y + b.y, a.z + b.z);
}
SRBF_FN srbf_x4_vec3 srbf_x4_subtract(srbf_x4_vec3 a, srbf_x4_vec3 b) {
    return srbf_x4_vec3_of(a.x - b.x, a.y - b.y, a.z - b.z);
}
SRBF_FN srbf_x4_vec3 srbf_x4_scale(srbf_x4 s, srbf_x4_vec3 a) { return srbf_x4_vec3_of(s * a.x, s * a.y, s * a.z); }
SRBF_FN srbf_x4 srbf_x4_dot(srbf_x4_vec3 a, srbf_x4_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
SRBF_FN srbf_x4_vec3 srbf_x4_all(srbf_vec3 a) { return srbf_x4_vec3_of(srbf_x4_of(a.x), srbf_x4_of(a.y), srbf_x4_of(a.z)); }

// ---- Models, and their numbers as the formulas read them ----

// A multivariate model. A row has a number of each lobe. A group of SRBF_LANES lobes has the rows: log2 of the scale; R, G, B;
// the exponents; and for each variate its falloff, then the pole (1 or -1) of an axial model or x, y, z of the centre.
typedef struct {
    int groups, variates, features, axial, reciprocal, rows;
    float weight_l[SRBF_MOST_VARIATES], weight_v[SRBF_MOST_VARIATES];
    const float* number;
} srbf_lobes;

SRBF_FN srbf_x4 srbf_row(const float* group, int row) { return srbf_x4_load(group + row * SRBF_LANES); }

// A view-by-view model: for each view its direction, and for each of its lobes R, G, B, bandwidth, centre and shape.
typedef struct {
    int views, lobes, of_lights, is_plain, neighbours;
    const float* number;
} srbf_view_lobes;
typedef const srbf_view_lobes* srbf_su;
typedef const int* srbf_su_nearest_views;
SRBF_FN int srbf_su_lobes(srbf_su su) { return su->lobes; }
SRBF_FN int srbf_su_views(srbf_su su) { return su->views; }
SRBF_FN const float* srbf_su_row(srbf_su su, int view) { return su->number + (size_t)view * (size_t)(3 + 8 * su->lobes); }
SRBF_FN srbf_vec3 srbf_vec3_at(const float* w) { return srbf_vec3_of(w[0], w[1], w[2]); }
SRBF_FN srbf_vec3 srbf_su_direction(srbf_su su, int view) { return srbf_vec3_at(srbf_su_row(su, view)); }
SRBF_FN const float* srbf_su_lobe(srbf_su su, int view, int j) { return srbf_su_row(su, view) + 3 + 8 * j; }
SRBF_FN srbf_vec3 srbf_su_coefficient(srbf_su su, int view, int j) { return srbf_vec3_at(srbf_su_lobe(su, view, j)); }
SRBF_FN float srbf_su_bandwidth(srbf_su su, int view, int j) { return srbf_su_lobe(su, view, j)[3]; }
SRBF_FN srbf_vec3 srbf_su_centre(srbf_su su, int view, int j) { return srbf_vec3_at(srbf_su_lobe(su, view, j) + 4); }
SRBF_FN float srbf_su_shape(srbf_su su, int view, int j) { return srbf_su_lobe(su, view, j)[7]; }
SRBF_FN int srbf_su_nearest(srbf_su_nearest_views nearest, int k) { return nearest[k]; }

