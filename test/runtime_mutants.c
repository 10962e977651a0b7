// mutants COUNT FILE..: opens COUNT changed copies of each file with srbf_runtime.h, and uses those that open. Some of them
// are prepared too, which takes long.
#include "support/runtime_use.h"

#ifndef PREPARED_EVERY
#define PREPARED_EVERY 200
#endif

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
            size_t size = length;
            unsigned char* bytes = (unsigned char*)malloc(size);
            memcpy(bytes, original, size);
            change(bytes, &size);
            opened += use_file(bytes, size, opened % PREPARED_EVERY == 0);
            free(bytes);
        }
        free(original);
    }
    printf("%ld mutants, %ld opened\n", all, opened);
    return 0;
}
