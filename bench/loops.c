/* Loops of code_bench.cpp. Each stores one number for each pair of directions, as the library's loops do. RUNTIME is
 * defined for loops that call srbf_runtime.h; the others call exported code, m.h, and ignore the model `b`. */
#ifdef RUNTIME
#define SRBF_RUNTIME_IMPLEMENTATION
#include "srbf_runtime.h"

static float value_of(const srbf_brdf* b, const float* wl, const float* wv) {
    float f[3];
    srbf_value(b, wl, wv, f);
    return f[0];
}
static float density_of(const srbf_brdf* b, const float* wl, const float* wv) { return srbf_pdf(b, wl, wv); }
static float both_of(const srbf_brdf* b, const float* wl, const float* wv) {
    float f[3];
    const float density = srbf_value_pdf(b, wl, wv, f);
    return density + f[0];
}
static float sample_of(const srbf_brdf* b, const float* u, const float* wv) {
    srbf_light light;
    srbf_sample(b, wv, u, &light);
    return light.pdf + light.weight[0];
}
#else
#include "m.h"

typedef void srbf_brdf;
static srbf_vec3 vector_of(const float* w) { return srbf_vec3_of(w[0], w[1], w[2]); }
static float value_of(const srbf_brdf* b, const float* wl, const float* wv) {
    (void)b;
    return m_brdf(vector_of(wl), vector_of(wv)).x;
}
static float density_of(const srbf_brdf* b, const float* wl, const float* wv) {
    (void)b;
    return m_pdf(vector_of(wl), vector_of(wv));
}
static float both_of(const srbf_brdf* b, const float* wl, const float* wv) {
    const m_ValuePdf f = m_value_pdf(vector_of(wl), vector_of(wv));
    (void)b;
    return f.value.x + f.pdf;
}
static float sample_of(const srbf_brdf* b, const float* u, const float* wv) {
    const srbf_vec3 v = vector_of(wv), l = m_sample(v, u[0], u[1], u[2]);
    const m_ValuePdf f = m_value_pdf(l, v);
    (void)b;
    return l.z > 0 ? f.value.x * l.z / f.pdf + f.pdf : 0;
}
#endif

#define SRBF_LOOP(name)                                                                                          \
    void name(const srbf_brdf* b, int n, const float* first, const float* wv, float* results) {                  \
        int i;                                                                                                   \
        for (i = 0; i < n; ++i) results[i] = name##_of(b, first + 3 * i, wv + 3 * i);                            \
    }
SRBF_LOOP(value)
SRBF_LOOP(density)
SRBF_LOOP(both)
SRBF_LOOP(sample)
