// The definitions that kernel.glsl requires, for shaders. Macros of the material precede this text: PM_LOBES and others
// of a multivariate model, or SU_LOBES, MERL_SIZE, VALUE.
#define Real float
#define Vec3 vec3
#define Bool bool
#define SRBF_FN
Real select(Bool condition, Real a, Real b) { return condition ? a : b; }

#ifdef PM_LOBES
struct Pm { int unused; };
layout(std140) uniform PmNumbers {
    vec4 pm_colours[PM_LOBES];      // coefficient, log2 of the scale
#if PM_FEATURES > 0
    vec4 pm_exponents[PM_LOBES * ((PM_FEATURES + 3) / 4)];  // times log2(e)
#endif
    vec4 pm_kernels[PM_KERNELS];  // axial: falloffs of four variates; general: centre and falloff
    vec4 pm_weights[PM_VARIATES];  // a, b
};
int pm_lobes(Pm pm) { return PM_LOBES; }
int pm_variates(Pm pm) { return PM_VARIATES; }
int pm_features(Pm pm) { return PM_FEATURES; }
bool pm_axial(Pm pm) { return PM_AXIAL != 0; }
bool pm_reciprocal(Pm pm) { return PM_RECIPROCAL != 0; }
Real pm_weight_l(Pm pm, int n) { return pm_weights[n].x; }
Real pm_weight_v(Pm pm, int n) { return pm_weights[n].y; }
#ifdef PM_EDITED
uniform float edited_shares[PM_LOBES];  // of each lobe, the share that belongs to the body
uniform int edited_part;                // what is shown: 0 the highlight, 1 the body
Vec3 pm_coefficient(Pm pm, int j) {
    return (edited_part == 1 ? edited_shares[j] : 1.0 - edited_shares[j]) * pm_colours[j].rgb;
}
#else
Vec3 pm_coefficient(Pm pm, int j) { return pm_colours[j].rgb; }
#endif
Real pm_log2_scale(Pm pm, int j) { return pm_colours[j].w; }
#if PM_AXIAL
const int pm_downs[PM_LOBES] = int[PM_LOBES](PM_DOWNS);  // bit n is set if centre n is -z
Real pm_log2_falloff(Pm pm, int j, int n) { return pm_kernels[j * ((PM_VARIATES + 3) / 4) + n / 4][n % 4]; }
bool pm_down(Pm pm, int j, int n) { return (pm_downs[j] >> n & 1) != 0; }
Vec3 pm_centre(Pm pm, int j, int n) { return Vec3(0.0, 0.0, pm_down(pm, j, n) ? -1.0 : 1.0); }
#else
Real pm_log2_falloff(Pm pm, int j, int n) { return pm_kernels[j * PM_VARIATES + n].w; }
Vec3 pm_centre(Pm pm, int j, int n) { return pm_kernels[j * PM_VARIATES + n].xyz; }
bool pm_down(Pm pm, int j, int n) { return false; }
#endif
#if PM_FEATURES > 0
Real pm_exponent(Pm pm, int j, int k) { return pm_exponents[j * ((PM_FEATURES + 3) / 4) + k / 4][k % 4]; }
#else
Real pm_exponent(Pm pm, int j, int k) { return 0.0; }
#endif
#endif

#ifdef SU_LOBES
struct Su { int unused; };
struct SuNearest { uvec4 pairs; };  // a texel of eight 16-bit numbers
int su_nearest(SuNearest nearest, int k) { return int(nearest.pairs[k / 2] >> uint(16 * (k % 2)) & 0xffffu); }
// one row per view, two texels per lobe: coefficient, bandwidth; centre - mirrored view
uniform sampler2D su_numbers;
uniform sampler2D su_directions;  // one row per view
int su_lobes(Su su) { return SU_LOBES; }
int su_views(Su su) { return SU_VIEWS; }
Vec3 su_direction(Su su, int view) { return texelFetch(su_directions, ivec2(0, view), 0).xyz; }
Vec3 su_centre(Su su, int view, int j) {
    Vec3 w = su_direction(su, view);
    return Vec3(-w.x, -w.y, w.z) + texelFetch(su_numbers, ivec2(2 * j + 1, view), 0).xyz;
}
Real su_bandwidth(Su su, int view, int j) { return texelFetch(su_numbers, ivec2(2 * j, view), 0).w; }
Vec3 su_coefficient(Su su, int view, int j) { return texelFetch(su_numbers, ivec2(2 * j, view), 0).rgb; }
#endif
