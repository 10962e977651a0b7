// Opens bytes with srbf_runtime.h, and checks that values of the model are finite and not negative. C and C++.
#define SRBF_RUNTIME_IMPLEMENTATION
#include "srbf_runtime.h"

#include <stdio.h>
#include <stdlib.h>

static unsigned long long state = 88172645463325252ull;
static unsigned random_number(unsigned below) {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return (unsigned)(state >> 33) % below;
}
static float random_float(void) { return (float)random_number(1u << 20) / (float)(1u << 20); }

static void use_model(const srbf_brdf* brdf) {
    int i;
    for (i = 0; i < 4; ++i) {
        float wv[3], u[3], rgb[3], alone[3], pdf;
        srbf_light light;
        const float z = 2 * random_float() - 1, r = sqrtf(1 - z * z), phi = 6.2831853f * random_float();
        wv[0] = r * cosf(phi);
        wv[1] = r * sinf(phi);
        wv[2] = z;
        u[0] = random_float();
        u[1] = random_float();
        u[2] = random_float();
        srbf_sample(brdf, wv, u, &light);
        pdf = srbf_value_pdf(brdf, light.wl, wv, rgb);
        srbf_value(brdf, light.wl, wv, alone);
        if (!(pdf >= 0) || !(rgb[0] >= 0 && rgb[1] >= 0 && rgb[2] >= 0) || rgb[0] + rgb[1] + rgb[2] > 3e38f ||
            memcmp(rgb, alone, sizeof rgb) != 0 || srbf_pdf(brdf, light.wl, wv) != pdf) {
            fprintf(stderr, "pdf %g, value %g %g %g\n", (double)pdf, (double)rgb[0], (double)rgb[1], (double)rgb[2]);
            abort();
        }
        srbf_albedo(brdf, z, rgb);
    }
}

// Returns true if the bytes are a model. It opens a copy, so that sanitizers see reads beyond the end, and frees it
// before use.
static int use_file(const unsigned char* bytes, size_t size, int is_prepared) {
    unsigned char* copy = (unsigned char*)malloc(size ? size : 1);
    size_t needed, offset;
    void* memory;
    srbf_brdf* brdf;
    srbf_error error;
    if (size) memcpy(copy, bytes, size);
    needed = srbf_memory_needed(copy, size);
    memory = needed ? malloc(needed) : 0;
    error = memory ? srbf_open(copy, size, memory, needed, &brdf, &offset) : SRBF_NO_MODEL;
    free(copy);
    if (error == SRBF_TOO_LITTLE_MEMORY || (memory && error != SRBF_OK && offset > size)) abort();
    if (error == SRBF_OK && is_prepared) srbf_prepare(brdf);
    if (error == SRBF_OK) use_model(brdf);
    free(memory);
    return error == SRBF_OK;
}
