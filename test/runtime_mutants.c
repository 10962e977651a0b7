// mutants COUNT FILE..: opens COUNT changed copies of each file with srbf_runtime.h, and uses those that open. Every 200th
// of them is prepared too, which takes long.
#define SRBF_RUNTIME_IMPLEMENTATION
#include "srbf_runtime.h"

#include <stdio.h>
#include <stdlib.h>

static unsigned long long state = 88172645463325252ull;
static unsigned random_number(unsigned below) {
    state ^= state << 13, state ^= state >> 7, state ^= state << 17;
    return (unsigned)(state >> 33) % below;
}
static float random_float(void) { return (float)random_number(1u << 20) / (float)(1u << 20); }

// Changes a copy: bytes, bits, a digit of the header, or its length.
static void change(unsigned char* bytes, size_t* size) {
    static const unsigned char likely[] = "{}[]\",:\\0123456789-+.eE \377\177\200";
    unsigned changes = 1 + random_number(4);
    for (; changes > 0; --changes) {
        const size_t header = *size > 1200 && random_number(2) ? 1200 : *size;
        const size_t at = random_number((unsigned)header);
        switch (random_number(6)) {
            case 0: bytes[at] ^= (unsigned char)(1u << random_number(8)); break;
            case 1: bytes[at] = (unsigned char)random_number(256); break;
            case 2: bytes[at] = likely[random_number(sizeof likely - 1)]; break;
            case 3: memmove(bytes + at, bytes + at + 1, *size - at - 1), --*size; break;
            case 4: memmove(bytes + at, bytes + random_number((unsigned)*size), 1); break;
            default: if (random_number(8) == 0) *size = at + 1;
        }
        if (*size < 2) return;
    }
}

static void use(const srbf_brdf* brdf) {
    int i;
    for (i = 0; i < 4; ++i) {
        float wv[3], u[3], rgb[3], pdf;
        srbf_light light;
        const float z = 2 * random_float() - 1, r = sqrtf(1 - z * z), phi = 6.2831853f * random_float();
        wv[0] = r * cosf(phi), wv[1] = r * sinf(phi), wv[2] = z;
        u[0] = random_float(), u[1] = random_float(), u[2] = random_float();
        srbf_sample(brdf, wv, u, &light);
        pdf = srbf_value_pdf(brdf, light.wl, wv, rgb);
        if (!(pdf >= 0) || !(rgb[0] >= 0 && rgb[1] >= 0 && rgb[2] >= 0) || rgb[0] + rgb[1] + rgb[2] > 3e38f) {
            fprintf(stderr, "pdf %g, value %g %g %g\n", pdf, rgb[0], rgb[1], rgb[2]);
            exit(1);
        }
        srbf_albedo(brdf, z, rgb);
    }
}

int main(int count, char** arguments) {
    const long mutants = count > 1 ? strtol(arguments[1], 0, 10) : 0;
    long opened = 0, all = 0;
    int i;
    for (i = 2; i < count; ++i) {
        FILE* file = fopen(arguments[i], "rb");
        unsigned char* original = (unsigned char*)malloc(1 << 20);
        const size_t length = file ? fread(original, 1, 1 << 20, file) : 0;
        long n;
        if (file) fclose(file);
        for (n = 0; n < mutants && length > 0; ++n, ++all) {
            size_t size = length, needed;
            unsigned char *bytes = (unsigned char*)malloc(size), *exact;
            memcpy(bytes, original, size);
            change(bytes, &size);
            exact = (unsigned char*)malloc(size);  // whose end is watched
            memcpy(exact, bytes, size);
            free(bytes);
            needed = srbf_memory_needed(exact, size);
            if (needed > 0) {
                void* memory = malloc(needed);
                srbf_brdf* brdf;
                const srbf_error error = srbf_open(exact, size, memory, needed, &brdf, 0);
                if (error == SRBF_TOO_LITTLE_MEMORY) return fprintf(stderr, "too little memory\n"), 1;
                if (error == SRBF_OK) {
                    free(exact), exact = 0;  // is not needed any more
                    if (opened++ % 200 == 0) srbf_prepare(brdf);
                    use(brdf);
                }
                free(memory);
            }
            free(exact);
        }
        free(original);
    }
    printf("%ld mutants, %ld opened\n", all, opened);
    return 0;
}
