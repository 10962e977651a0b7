// ---- Files ----

#define SRBF_MOST_TENSORS 64

typedef struct {
    size_t name, name_length;  // where in the file
    int is_half, rank, is_read;
    size_t extent[4], count, begin, end;
} srbf_tensor;

// A file that is read: its tensors and metadata, the first error, and the caller's memory. Without memory, what is needed is
// counted.
typedef struct {
    const unsigned char* bytes;
    size_t size, at, header_end, metadata;
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

// The next `bytes` of the memory; null if it is too little or only counted.
static void* srbf_take(srbf_file* file, size_t bytes) {
    char* taken = file->memory ? file->memory + file->used : 0;
    bytes = (bytes + 15) / 16 * 16;
    file->used += bytes;
    if (!file->memory) return 0;
    if (file->used <= file->capacity) return memset(taken, 0, bytes);
    srbf_fail(file, SRBF_TOO_LITTLE_MEMORY, 0);
    return 0;
}

// JSON, in the bytes of the header from file->at on.
static int srbf_json_next(srbf_file* file) {
    while (file->at < file->header_end && strchr(" \t\r\n", file->bytes[file->at]) && file->bytes[file->at]) ++file->at;
    return file->at < file->header_end ? file->bytes[file->at] : -1;
}
static int srbf_json_accept(srbf_file* file, int sign) {
    if (srbf_json_next(file) != sign) return 0;
    ++file->at;
    return 1;
}
static int srbf_json_expect(srbf_file* file, int sign) {
    return srbf_json_accept(file, sign) || srbf_fail(file, SRBF_BAD_HEADER, file->at);
}
// The raw characters of a string, in which a backslash precedes those that stand for others.
static int srbf_json_string(srbf_file* file, size_t* begin, size_t* length) {
    if (!srbf_json_expect(file, '"')) return 0;
    *begin = file->at;
    for (; file->at < file->header_end && file->bytes[file->at] != '"'; ++file->at) {
        if (file->bytes[file->at] < ' ') return srbf_fail(file, SRBF_BAD_HEADER, file->at);
        if (file->bytes[file->at] == '\\') ++file->at;
    }
    if (file->at >= file->header_end) return srbf_fail(file, SRBF_BAD_HEADER, file->header_end);
    *length = file->at++ - *begin;
    return 1;
}
static int srbf_json_count(srbf_file* file, size_t* count) {
    const size_t most = (size_t)-1 / 32;
    int digits = 0;
    *count = 0;
    for (srbf_json_next(file); file->at < file->header_end && file->bytes[file->at] >= '0' && file->bytes[file->at] <= '9';
         ++file->at, ++digits) {
        *count = 10 * *count + (size_t)(file->bytes[file->at] - '0');
        if (*count > most) return srbf_fail(file, SRBF_BAD_HEADER, file->at);
    }
    return digits > 0 || srbf_fail(file, SRBF_BAD_HEADER, file->at);
}
// A list of at most `most` counts.
static int srbf_json_counts(srbf_file* file, size_t* counts, int most) {
    int n = 0;
    if (!srbf_json_expect(file, '[')) return 0;
    if (srbf_json_accept(file, ']')) return 1;
    do {
        if (n == most) return srbf_fail(file, SRBF_BAD_HEADER, file->at) - 1;
        if (!srbf_json_count(file, &counts[n++])) return 0;
    } while (srbf_json_accept(file, ','));
    return srbf_json_expect(file, ']') ? n + 1 : 0;
}
// True if the string at `begin` is the prefix followed by the name.
static int srbf_is_named(const srbf_file* file, size_t begin, size_t length, const char* prefix, const char* name) {
    const size_t first = strlen(prefix), second = strlen(name);
    return length == first + second && memcmp(file->bytes + begin, prefix, first) == 0 &&
           memcmp(file->bytes + begin + first, name, second) == 0;
}

static int srbf_read_tensor(srbf_file* file, srbf_tensor* tensor) {
    size_t key, length, word, word_length, ends[2];
    int has_type = 0, listed = 0, i;
    tensor->rank = -1;
    if (!srbf_json_expect(file, '{')) return 0;
    do {
        if (!srbf_json_string(file, &key, &length) || !srbf_json_expect(file, ':')) return 0;
        if (srbf_is_named(file, key, length, "", "dtype")) {
            if (!srbf_json_string(file, &word, &word_length)) return 0;
            tensor->is_half = srbf_is_named(file, word, word_length, "", "F16");
            has_type = tensor->is_half || srbf_is_named(file, word, word_length, "", "U16");
        } else if (srbf_is_named(file, key, length, "", "shape")) {
            tensor->rank = srbf_json_counts(file, tensor->extent, 4) - 1;
        } else if (srbf_is_named(file, key, length, "", "data_offsets")) {
            listed = srbf_json_counts(file, ends, 2) - 1;
        } else {
            return srbf_fail(file, SRBF_BAD_HEADER, key);
        }
        if (file->error) return 0;
    } while (srbf_json_accept(file, ','));
    if (!srbf_json_expect(file, '}')) return 0;
    if (!has_type || tensor->rank < 0 || listed != 2) return srbf_fail(file, SRBF_BAD_HEADER, tensor->name);
    tensor->count = 1;
    for (i = 0; i < tensor->rank; ++i) {
        if (tensor->extent[i] == 0 || tensor->extent[i] > file->size / tensor->count)
            return srbf_fail(file, SRBF_BAD_HEADER, tensor->name);
        tensor->count *= tensor->extent[i];
    }
    tensor->begin = ends[0], tensor->end = ends[1];
    if (ends[1] > file->size - file->header_end || ends[0] > ends[1] || ends[1] - ends[0] != 2 * tensor->count)
        return srbf_fail(file, SRBF_BAD_HEADER, tensor->name);
    return 1;
}
static int srbf_read_header(srbf_file* file) {
    size_t length = 0, covered, before;
    int i;
    if (file->size < 8) return srbf_fail(file, SRBF_NO_MODEL, file->size);
    for (i = 8; i-- > 0;) {
        if (length > (size_t)-1 / 256) return srbf_fail(file, SRBF_NO_MODEL, 0);
        length = 256 * length + file->bytes[i];
    }
    if (length > file->size - 8 || length > (size_t)1 << 20) return srbf_fail(file, SRBF_NO_MODEL, 0);
    file->at = 8, file->header_end = 8 + length;
    if (srbf_json_next(file) != '{') return srbf_fail(file, SRBF_NO_MODEL, 8);
    ++file->at;
    do {
        size_t name, name_length, text, text_length;
        if (!srbf_json_string(file, &name, &name_length) || !srbf_json_expect(file, ':')) return 0;
        if (srbf_is_named(file, name, name_length, "", "__metadata__")) {
            file->metadata = file->at + 1;
            if (!srbf_json_expect(file, '{')) return 0;
            if (srbf_json_accept(file, '}')) continue;
            do {
                if (!srbf_json_string(file, &text, &text_length) || !srbf_json_expect(file, ':') ||
                    !srbf_json_string(file, &text, &text_length))
                    return 0;
            } while (srbf_json_accept(file, ','));
            if (!srbf_json_expect(file, '}')) return 0;
            continue;
        }
        if (file->tensors == SRBF_MOST_TENSORS) return srbf_fail(file, SRBF_BAD_HEADER, name);
        file->tensor[file->tensors].name = name, file->tensor[file->tensors].name_length = name_length;
        if (!srbf_read_tensor(file, &file->tensor[file->tensors++])) return 0;
    } while (srbf_json_accept(file, ','));
    if (!srbf_json_expect(file, '}')) return 0;
    if (srbf_json_next(file) != -1) return srbf_fail(file, SRBF_BAD_HEADER, file->at);
    // Tensors follow one another without gap or overlap.
    for (covered = 0; covered < file->size - file->header_end;) {
        before = covered;
        for (i = 0; i < file->tensors; ++i)
            if (file->tensor[i].begin == before) covered = file->tensor[i].end;
        if (covered == before) return srbf_fail(file, SRBF_BAD_HEADER, file->header_end + covered);
    }
    return 1;
}

// The text of the metadata of this name; its length, or -1 if there is none.
static int srbf_metadata(srbf_file* file, const char* prefix, const char* name, const char** text) {
    size_t key, key_length, begin, length;
    if (!file->metadata) return -1;
    file->at = file->metadata;
    if (srbf_json_next(file) != '{' && srbf_json_next(file) != '"') return -1;
    srbf_json_accept(file, '{');
    if (srbf_json_next(file) == '}') return -1;
    do {
        if (!srbf_json_string(file, &key, &key_length) || !srbf_json_expect(file, ':') ||
            !srbf_json_string(file, &begin, &length))
            return -1;
        if (srbf_is_named(file, key, key_length, prefix, name)) {
            *text = (const char*)file->bytes + begin;
            return (int)length;
        }
    } while (srbf_json_accept(file, ','));
    return -1;
}
// The index of the metadata's word in a list that ends with null; -1 is an error.
static int srbf_word(srbf_file* file, const char* prefix, const char* name, const char* const* words, srbf_error error) {
    const char* text;
    const int length = srbf_metadata(file, prefix, name, &text);
    int i;
    for (i = 0; length >= 0 && words[i]; ++i)
        if (strlen(words[i]) == (size_t)length && memcmp(words[i], text, (size_t)length) == 0) return i;
    return srbf_fail(file, error, length < 0 ? 8 : (size_t)((const unsigned char*)text - file->bytes)) - 1;
}

static srbf_tensor* srbf_find(srbf_file* file, const char* prefix, const char* name) {
    int i;
    for (i = 0; i < file->tensors; ++i)
        if (srbf_is_named(file, file->tensor[i].name, file->tensor[i].name_length, prefix, name)) return &file->tensor[i];
    return 0;
}
static unsigned srbf_half_bits(const srbf_file* file, const srbf_tensor* tensor, size_t i) {
    const unsigned char* at = file->bytes + file->header_end + tensor->begin + 2 * i;
    return at[0] | (unsigned)at[1] << 8;
}
static float srbf_number(const srbf_file* file, const srbf_tensor* tensor, size_t i) {
    const unsigned half = srbf_half_bits(file, tensor, i), exponent = half >> 10 & 31;
    unsigned bits = (half & 0x8000u) << 16 | (half & 0x7fffu) << 13;
    float x;
    if (exponent == 0) return (half & 0x8000u ? -1.0f : 1.0f) * (float)(half & 0x3ffu) * 5.9604645e-8f;
    bits += (127u - 15u) << 23;
    memcpy(&x, &bits, sizeof x);
    return x;
}
// The tensor of this name and shape, all of whose numbers are between the bounds.
static srbf_tensor* srbf_need(srbf_file* file, const char* prefix, const char* name, size_t a, size_t b, size_t c, float least,
                              float most) {
    srbf_tensor* tensor = srbf_find(file, prefix, name);
    const size_t extent[3] = {a, b, c};
    const int rank = c ? 3 : b ? 2 : 1;
    size_t i;
    if (!tensor) return srbf_fail(file, SRBF_BAD_TENSOR, 8), (srbf_tensor*)0;
    if (tensor->rank != rank || !tensor->is_half || memcmp(tensor->extent, extent, (size_t)rank * sizeof *extent) != 0)
        return srbf_fail(file, SRBF_BAD_TENSOR, tensor->name), (srbf_tensor*)0;
    for (i = 0; i < tensor->count; ++i) {
        const float x = srbf_number(file, tensor, i);
        if ((srbf_half_bits(file, tensor, i) >> 10 & 31) == 31 || !(x >= least && x <= most))
            return srbf_fail(file, SRBF_BAD_NUMBER, file->header_end + tensor->begin + 2 * i), (srbf_tensor*)0;
    }
    tensor->is_read = 1;
    return tensor;
}
// The shape [a, b] of the bandwidths, which determines that of the other tensors.
static int srbf_shape(srbf_file* file, const char* prefix, size_t* a, size_t* b, size_t least, size_t most_a, size_t most_b) {
    const srbf_tensor* tensor = srbf_find(file, prefix, "bandwidth");
    if (!tensor) return srbf_fail(file, SRBF_BAD_TENSOR, 8);
    *a = tensor->extent[0], *b = tensor->extent[1];
    if (tensor->rank == 2 && *a >= least && *a <= most_a && *b <= most_b) return 1;
    return srbf_fail(file, SRBF_BAD_TENSOR, tensor->name);
}

