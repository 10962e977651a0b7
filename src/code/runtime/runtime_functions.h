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

// ---- Models ----

typedef enum { SRBF_KIND_PM, SRBF_KIND_SU, SRBF_KIND_GGX, SRBF_KIND_OPENPBR } srbf_kind;
typedef struct {
    srbf_kind kind;
    int is_exchanged, has_film, is_anisotropic;
    srbf_lobes pm;
    srbf_view_lobes su;
    srbf_vec3 diffuse;
    srbf_GgxLobe ggx[2];
    srbf_OpenPbrSurface surface;
    srbf_OpenPbrFilm film;
    srbf_OpenPbrAnisotropy anisotropy;
} srbf_model;

#define SRBF_MOST 65504.0f

static srbf_vec3 srbf_spherical(float theta, float phi) {
    return srbf_vec3_of(sinf(theta) * cosf(phi), sinf(theta) * sinf(phi), cosf(theta));
}

// The next number of a text of wavelengths [nm], which blanks separate; 0 if there is none or it is malformed.
static float srbf_wavelength(const char** text, const char* end) {
    double x = 0, unit = 1;
    int digits = 0;
    while (*text < end && **text == ' ') ++*text;
    for (; *text < end && **text >= '0' && **text <= '9' && digits < 9; ++*text, ++digits) x = 10 * x + (**text - '0');
    if (*text < end && **text == '.')
        for (++*text; *text < end && **text >= '0' && **text <= '9' && digits < 18; ++*text, ++digits)
            x = 10 * x + (**text - '0'), unit *= 10;
    return digits > 0 && (*text == end || **text == ' ') ? (float)(x / unit) : 0.0f;
}
// R, G, B of white light at a whole wavelength between the rows of srbf_observer, which are 5 nm apart.
static float srbf_observed(int nm, int channel) {
    const int i = (nm - 360) / 5, k = 3 * (i < 93 ? i : 93) + channel;
    const float share = (float)(nm - 360 - 5 * (i < 93 ? i : 93)) / 5.0f;
    return srbf_observer(k) + share * (srbf_observer(k + 3) - srbf_observer(k));
}
// Adds to colours (of row, three numbers each, `step` apart) the spectra of `lobes` lobes.
static int srbf_colours(srbf_file* file, const srbf_tensor* spectra, const char* text, const char* end, float* rgb,
                        int (*place)(int, int, int), int rows) {
    const int count = (int)spectra->extent[1], lobes = (int)spectra->extent[0];
    float before = 0.0f, at = srbf_wavelength(&text, end);
    int i, nm, j, c;
    for (i = 0; i < count; ++i) {
        const float after = i + 1 < count ? srbf_wavelength(&text, end) : 0.0f;
        if (!(at >= 100.0f && at <= 1.0e5f) || (i > 0 && !(at > before)))
            return srbf_fail(file, SRBF_BAD_METADATA, (size_t)((const unsigned char*)text - file->bytes));
        // The spectrum is linear between samples: this one counts by a hat function, constant beyond the first and the last.
        for (c = 0; c < 3; ++c) {
            double weight = 0;
            for (nm = 360; nm <= 830; ++nm) {
                const float x = (float)nm;
                const float neighbour = x < at ? before : after;
                const int is_end = x < at ? i == 0 : i + 1 == count;
                const float hat = is_end ? 1.0f : 1.0f - (x - at) / (neighbour - at);
                if (hat > 0.0f) weight += (double)hat * (double)srbf_observed(nm, c);
            }
            for (j = 0; j < lobes; ++j)
                rgb[place(j, 1 + c, rows)] +=
                    (float)weight * srbf_number(file, spectra, (size_t)j * (size_t)count + (size_t)i);
        }
        before = at, at = after;
    }
    srbf_wavelength(&text, end);
    return text == end || srbf_fail(file, SRBF_BAD_METADATA, 8);
}

// The place of a number of lobe j among the rows of its group.
static int srbf_place(int j, int row, int rows) { return (j / SRBF_LANES * rows + row) * SRBF_LANES + j % SRBF_LANES; }

// The row of a variate's falloff.
static int srbf_variate_row(const srbf_lobes* pm, int n) { return 4 + pm->features + (pm->axial ? 2 : 4) * n; }

static int srbf_read_pm(srbf_file* file, const char* prefix, srbf_model* model) {
    static const char* const forms[] = {"source", "horizon", "extended", "reciprocal", 0};
    static const char* const truths[] = {"true", "false", 0};
    const float log2_e = 1.44269504f;
    const int form = srbf_word(file, prefix, "form", forms, SRBF_BAD_METADATA);
    const int axial = srbf_word(file, prefix, "axial", truths, SRBF_BAD_METADATA) == 0;
    const char* waves = 0;
    const int waves_length = srbf_metadata(file, prefix, "wavelengths", &waves);
    const srbf_tensor *coefficient, *bandwidth, *parameterization, *scale = 0, *centre = 0, *exponent = 0;
    srbf_lobes pm;
    size_t lobes, variates, features, channels = 3;
    int j, n, k;
    float* number;
    if (file->error || !srbf_shape(file, prefix, &lobes, &variates, 1, 1024, SRBF_MOST_VARIATES)) return 0;
    features = form == 0 ? 0 : form == 1 ? 1 : 4;
    if (waves_length >= 0) {
        const srbf_tensor* spectra = srbf_find(file, prefix, "coefficient");
        if (!spectra || spectra->rank != 2 || spectra->extent[1] > 4096) return srbf_fail(file, SRBF_BAD_TENSOR, 8);
        channels = spectra->extent[1];
    }
    coefficient = srbf_need(file, prefix, "coefficient", lobes, channels, 0, 0.0f, SRBF_MOST);
    bandwidth = srbf_need(file, prefix, "bandwidth", lobes, variates, 0, axial ? -SRBF_MOST : 0.0f, SRBF_MOST);
    parameterization = srbf_need(file, prefix, "parameterization", variates, 2, 0, -SRBF_MOST, SRBF_MOST);
    if (features || srbf_find(file, prefix, "log_scale"))
        scale = srbf_need(file, prefix, "log_scale", lobes, 0, 0, -SRBF_MOST, SRBF_MOST);
    if (!axial) centre = srbf_need(file, prefix, "centre", lobes, variates, 2, -SRBF_MOST, SRBF_MOST);
    if (features) exponent = srbf_need(file, prefix, "exponent", lobes, features, 0, -SRBF_MOST, SRBF_MOST);
    if (file->error) return 0;
    memset(&pm, 0, sizeof pm);
    pm.groups = ((int)lobes + SRBF_LANES - 1) / SRBF_LANES, pm.variates = (int)variates, pm.features = (int)features;
    pm.axial = axial, pm.reciprocal = form == 3, pm.rows = srbf_variate_row(&pm, pm.variates);
    for (n = 0; n < pm.variates; ++n) {
        pm.weight_l[n] = srbf_number(file, parameterization, (size_t)(2 * n));
        pm.weight_v[n] = srbf_number(file, parameterization, (size_t)(2 * n + 1));
        if (pm.weight_l[n] == 0.0f && pm.weight_v[n] == 0.0f)
            return srbf_fail(file, SRBF_BAD_NUMBER, file->header_end + parameterization->begin);
    }
    number = (float*)srbf_take(file, (size_t)(pm.groups * pm.rows * SRBF_LANES) * sizeof *number);
    pm.number = number;
    model->pm = pm;
    if (!number) return !file->error;
    for (j = 0; j < (int)lobes; ++j) {
        if (scale) number[srbf_place(j, 0, pm.rows)] = log2_e * srbf_number(file, scale, (size_t)j);
        for (k = 0; k < 3 && waves_length < 0; ++k)
            number[srbf_place(j, 1 + k, pm.rows)] = srbf_number(file, coefficient, (size_t)(3 * j + k));
        for (k = 0; k < pm.features; ++k) {
            const float x = srbf_number(file, exponent, (size_t)(pm.features * j + k));
            if (k == 0 && x < 0.0f) return srbf_fail(file, SRBF_BAD_NUMBER, file->header_end + exponent->begin);
            number[srbf_place(j, 4 + k, pm.rows)] = log2_e * x;
        }
        for (n = 0; n < pm.variates; ++n) {
            const size_t i = (size_t)(j * pm.variates + n);
            const float lambda = srbf_number(file, bandwidth, i);
            const int row = srbf_variate_row(&pm, n);
            number[srbf_place(j, row, pm.rows)] = 0.5f * log2_e * fabsf(lambda);
            if (axial) {
                number[srbf_place(j, row + 1, pm.rows)] = srbf_half_bits(file, bandwidth, i) >> 15 ? -1.0f : 1.0f;
            } else {
                const srbf_vec3 xi =
                    srbf_spherical(srbf_number(file, centre, 2 * i), srbf_number(file, centre, 2 * i + 1));
                number[srbf_place(j, row + 1, pm.rows)] = xi.x, number[srbf_place(j, row + 2, pm.rows)] = xi.y;
                number[srbf_place(j, row + 3, pm.rows)] = xi.z;
            }
        }
    }
    return waves_length < 0 || srbf_colours(file, coefficient, waves, waves + waves_length, number, srbf_place, pm.rows);
}

static int srbf_read_su(srbf_file* file, const char* prefix, srbf_model* model) {
    static const char* const sampled[] = {"view", "light", 0};
    static const char* const interpolations[] = {"rotated", "plain", 0};
    static const char* const neighbours[] = {"1", "2", "3", "4", "5", "6", "7", 0};
    const srbf_tensor *coefficient, *bandwidth, *centre, *shape = 0;
    srbf_view_lobes su;
    size_t views, lobes, i, j, c;
    float* number;
    su.of_lights = srbf_word(file, prefix, "discretise", sampled, SRBF_BAD_METADATA);
    su.is_plain = srbf_word(file, prefix, "interpolation", interpolations, SRBF_BAD_METADATA);
    su.neighbours = srbf_word(file, prefix, "neighbours", neighbours, SRBF_BAD_METADATA) + 1;
    if (file->error || !srbf_shape(file, prefix, &views, &lobes, 8, 8192, 64)) return 0;
    coefficient = srbf_need(file, prefix, "coefficient", views, lobes, 3, 0.0f, SRBF_MOST);
    bandwidth = srbf_need(file, prefix, "bandwidth", views, lobes, 0, 0.0f, SRBF_MOST);
    centre = srbf_need(file, prefix, "centre", views, lobes, 2, -SRBF_MOST, SRBF_MOST);
    if (srbf_find(file, prefix, "shape"))
        shape = srbf_need(file, prefix, "shape", views, lobes, 0, -SRBF_MOST, SRBF_MOST);
    if (file->error) return 0;
    su.views = (int)views, su.lobes = (int)lobes;
    number = (float*)srbf_take(file, views * (3 + 8 * lobes) * sizeof *number);
    su.number = number;
    model->su = su;
    for (i = 0; number && i < views; ++i) {  // the Fibonacci set of the hemisphere, and angles relative to the mirror direction
        const double z = ((double)i + 0.5) / (double)views, r = sqrt(1.0 - z * z), phi = 2.3999632297286533 * (double)i;
        const float theta0 = atan2f((float)r, (float)z), phi0 = atan2f(-(float)(r * sin(phi)), -(float)(r * cos(phi)));
        *number++ = (float)(r * cos(phi)), *number++ = (float)(r * sin(phi)), *number++ = (float)z;
        for (j = i * lobes; j < (i + 1) * lobes; ++j) {
            const srbf_vec3 xi =
                srbf_spherical(theta0 + srbf_number(file, centre, 2 * j), phi0 + srbf_number(file, centre, 2 * j + 1));
            for (c = 0; c < 3; ++c) *number++ = srbf_number(file, coefficient, 3 * j + c);
            *number++ = srbf_number(file, bandwidth, j);
            *number++ = xi.x, *number++ = xi.y, *number++ = xi.z;
            *number++ = shape ? srbf_number(file, shape, j) : 0.0f;
        }
    }
    return !file->error;
}

static int srbf_read_ggx(srbf_file* file, const char* prefix, srbf_model* model) {
    const srbf_tensor *roughness = srbf_find(file, prefix, "roughness"), *diffuse, *f0, *f90;
    size_t lobes, i;
    if (!roughness || roughness->rank != 1 || roughness->extent[0] > 2)
        return srbf_fail(file, SRBF_BAD_TENSOR, roughness ? roughness->name : 8);
    lobes = roughness->extent[0];
    roughness = srbf_need(file, prefix, "roughness", lobes, 0, 0, 1.0f / 1024.0f, 1.0f);
    diffuse = srbf_need(file, prefix, "diffuse", 3, 0, 0, 0.0f, SRBF_MOST);
    f0 = srbf_need(file, prefix, "facing", lobes, 3, 0, 0.0f, SRBF_MOST);
    f90 = srbf_need(file, prefix, "grazing", lobes, 0, 0, 0.0f, SRBF_MOST);
    if (file->error) return 0;
    model->diffuse =
        srbf_vec3_of(srbf_number(file, diffuse, 0), srbf_number(file, diffuse, 1), srbf_number(file, diffuse, 2));
    for (i = 0; i < 2; ++i) {
        model->ggx[i].roughness = i < lobes ? srbf_number(file, roughness, i) : 1.0f;
        model->ggx[i].f90 = i < lobes ? srbf_number(file, f90, i) : 0.0f;
        model->ggx[i].f0 = i < lobes ? srbf_vec3_of(srbf_number(file, f0, 3 * i), srbf_number(file, f0, 3 * i + 1),
                                                    srbf_number(file, f0, 3 * i + 2))
                                     : srbf_vec3_of(0.0f, 0.0f, 0.0f);
    }
    return 1;
}

static int srbf_read_openpbr(srbf_file* file, const char* prefix, srbf_model* model) {
    static const char* const truths[] = {"true", "false", 0};
    float p[3 * SRBF_PARAMETERS];
    int i, c, n = 0;
    model->is_exchanged = srbf_word(file, prefix, "exchanged_surface", truths, SRBF_BAD_METADATA) == 0;
    model->has_film = srbf_find(file, prefix, "thin_film_weight") != 0;
    model->is_anisotropic = srbf_find(file, prefix, "specular_roughness_anisotropy") != 0;
    for (i = 0; i < SRBF_PARAMETERS; ++i) {
        const srbf_parameter* of = &srbf_parameters[i];
        const int is_film = strncmp(of->name, "thin_film_", 10) == 0, is_turned = i >= SRBF_PARAMETERS - 2;
        const int is_stored = is_film ? model->has_film : is_turned ? model->is_anisotropic : 1;
        const srbf_tensor* tensor =
            is_stored ? srbf_need(file, prefix, of->name, (size_t)of->count, 0, 0, of->least, of->most) : 0;
        for (c = 0; c < of->count; ++c) p[n++] = tensor ? srbf_number(file, tensor, (size_t)c) : of->by_default;
    }
    if (file->error) return 0;
    // The members of the structures are in the order of the parameters, after the weight of the base.
    memcpy(&model->surface, p + 1, sizeof model->surface);
    memcpy(&model->film, p + 1 + sizeof model->surface / sizeof *p, sizeof model->film);
    model->surface.base_color = srbf_scale(p[0], model->surface.base_color);
    model->anisotropy.amount = p[n - 2];
    model->anisotropy.cosine = cosf(6.28318531f * p[n - 1]), model->anisotropy.sine = sinf(6.28318531f * p[n - 1]);
    return 1;
}

static int srbf_read_model(srbf_file* file, const char* prefix, srbf_model* model) {
    static const char* const kinds[] = {"pm", "su", "ggx", "openpbr", "pbr", 0};
    const int kind = srbf_word(file, prefix, "model", kinds, SRBF_OTHER_KIND);
    if (kind < 0) return 0;
    model->kind = kind < 4 ? (srbf_kind)kind : SRBF_KIND_OPENPBR;
    if (model->kind == SRBF_KIND_PM) return srbf_read_pm(file, prefix, model);
    if (model->kind == SRBF_KIND_SU) return srbf_read_su(file, prefix, model);
    if (model->kind == SRBF_KIND_GGX) return srbf_read_ggx(file, prefix, model);
    return srbf_read_openpbr(file, prefix, model);
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

// The squared distances of variate n from the centres of a group of lobes.
SRBF_FN srbf_x4 srbf_squared(const srbf_lobes* pm, float (*psi)[SRBF_MOST_VARIATES], int n, const float* of) {
    const srbf_x4 first = srbf_x4_of(psi[0][n]), second = srbf_x4_of(psi[1][n]), x = srbf_row(of, 1);
    if (pm->axial) return srbf_x4_select(x < srbf_x4_of(0.0f), second, first);
    return srbf_x4_squared_distance(srbf_x4_vec3_of(first, second, srbf_x4_of(psi[2][n])),
                                    srbf_x4_vec3_of(x, srbf_row(of, 2), srbf_row(of, 3)));
}

// pm_value of kernel.glsl, with variates in lanes, then lobes.
static srbf_vec3 srbf_pm_value(const srbf_lobes* pm, srbf_vec3 wl, srbf_vec3 wv) {
    const srbf_PmFeatures features = srbf_pm_further_features(pm->features, wl, wv);
    const srbf_x4_vec3 l = srbf_x4_all(wl), v = srbf_x4_all(wv);
    float psi[2][3][SRBF_MOST_VARIATES];  // of (wl, wv) and (wv, wl): the squared distances from both poles, or psi
    srbf_x4_vec3 sum = srbf_x4_all(srbf_vec3_of(0.0f, 0.0f, 0.0f));
    const float* group = pm->number;
    int j, n, k, side;
    for (n = 0; n < pm->variates; n += SRBF_LANES)
        for (side = 0; side <= pm->reciprocal; ++side) {
            const srbf_x4 a = srbf_x4_load((side ? pm->weight_v : pm->weight_l) + n);
            const srbf_x4 b = srbf_x4_load((side ? pm->weight_l : pm->weight_v) + n);
            if (pm->axial) {
                const srbf_x4_AxialPsi at = srbf_x4_axial_psi(l, v, a, b);
                srbf_x4_store(srbf_x4_squared_distance_from_pole(at, srbf_x4_of(1.0f)), psi[side][0] + n);
                srbf_x4_store(srbf_x4_squared_distance_from_pole(at, srbf_x4_of(-1.0f)), psi[side][1] + n);
            } else {
                const srbf_x4_vec3 at = srbf_x4_psi(l, v, a, b);
                srbf_x4_store(at.x, psi[side][0] + n), srbf_x4_store(at.y, psi[side][1] + n);
                srbf_x4_store(at.z, psi[side][2] + n);
            }
        }
    for (j = 0; j < pm->groups; ++j, group += pm->rows * SRBF_LANES) {
        srbf_x4 exponent = srbf_row(group, 0), exchanged, power;
        for (k = 0; k < pm->features; ++k) exponent = exponent + srbf_row(group, 4 + k) * srbf_x4_of(features.x[k]);
        exchanged = exponent;
        for (n = 0; n < pm->variates; ++n) {
            const float* of = group + srbf_variate_row(pm, n) * SRBF_LANES;
            exponent = exponent - srbf_row(of, 0) * srbf_squared(pm, psi[0], n, of);
            if (pm->reciprocal) exchanged = exchanged - srbf_row(of, 0) * srbf_squared(pm, psi[1], n, of);
        }
        power = srbf_x4_pm_power(exponent);
        if (pm->reciprocal) power = srbf_x4_of(0.5f) * (power + srbf_x4_pm_power(exchanged));
        sum = srbf_x4_add(sum, srbf_x4_scale(power, srbf_x4_vec3_of(srbf_row(group, 1), srbf_row(group, 2), srbf_row(group, 3))));
    }
    return srbf_vec3_of(srbf_max(srbf_x4_sum(sum.x), 0.0f), srbf_max(srbf_x4_sum(sum.y), 0.0f),
                        srbf_max(srbf_x4_sum(sum.z), 0.0f));
}

// f(wl, wv) of a model above the horizon.
static srbf_vec3 srbf_model_value(const srbf_model* model, srbf_vec3 wl, srbf_vec3 wv) {
    const srbf_vec3 l = model->is_exchanged ? wv : wl, v = model->is_exchanged ? wl : wv;
    if (model->kind == SRBF_KIND_PM) return srbf_pm_value(&model->pm, wl, wv);
    if (model->kind == SRBF_KIND_SU) {
        const srbf_vec3 evaluated = model->su.of_lights ? wv : wl, sampled = model->su.of_lights ? wl : wv;
        int nearest[8];
        if (!model->su.is_plain) return srbf_su_rotated_value(&model->su, evaluated, sampled);
        srbf_find_nearest(&model->su, sampled, nearest);
        return srbf_su_plain_value(&model->su, nearest, evaluated, sampled, model->su.neighbours);
    }
    if (model->kind == SRBF_KIND_GGX) return srbf_ggx_value(model->diffuse, model->ggx[0], model->ggx[1], wl, wv);
    if (model->is_anisotropic)
        return srbf_openpbr_anisotropic_value(model->surface, model->film, model->anisotropy, l, v);
    if (model->has_film) return srbf_openpbr_film_value(model->surface, model->film, l, v);
    return srbf_openpbr_value(model->surface, l, v);
}

// ---- Densities ----

// A mixture of components of kernel.glsl's proposal, whose weights are linear in sqrt(cos(theta_v)) between nodes. Only those
// with weight are kept: lobes of directions, then lobes of half vectors, each in SRBF_SLOTS slots, then facets.
#define SRBF_NODES 13
#define SRBF_SLOTS 8
#define SRBF_FACET_SLOT (2 * SRBF_SLOTS)
#define SRBF_STRETCH (2 * SRBF_SLOTS + 2)
#define SRBF_NUMBERS (2 * SRBF_SLOTS + 4)
#define SRBF_ALBEDO_NODES 33
typedef struct {
    int component[SRBF_FACET_SLOT], directions, halves, facets;
    srbf_Facets facet[2];
    float bandwidth[SRBF_SLOTS], width[SRBF_SLOTS], scale[SRBF_SLOTS], rest[SRBF_SLOTS], constant[SRBF_SLOTS];
    float linear[SRBF_SLOTS], square[SRBF_SLOTS], half_bandwidth[SRBF_SLOTS], weighted[SRBF_SLOTS];
    float node[SRBF_NODES][SRBF_NUMBERS];  // weights, then stretch and power of half-vector lobes
    float albedo[SRBF_ALBEDO_NODES][3];
} srbf_mixture;

// One of the four parts of a surface: the model that answers for it, and how it is sampled.
typedef struct {
    const srbf_model* model;
    int is_exchanged;
    srbf_mixture* mixture;
} srbf_part;
typedef struct {
    int rings, nodes;
    const float *theta, *azimuths, *share;
} srbf_beam;
struct srbf_brdf {
    int is_two_sided;
    srbf_part part[4];  // reflection at the front and the back, transmission of light from the front and from the back
    srbf_beam beam[4];
    float* scratch;
};

static srbf_vec3 srbf_part_value(const srbf_part* part, srbf_vec3 wl, srbf_vec3 wv) {
    return part->is_exchanged ? srbf_model_value(part->model, wv, wl) : srbf_model_value(part->model, wl, wv);
}

static void srbf_add_component(srbf_mixture* mixture, int k) {
    const int is_half = k >= SRBF_SLOTS, i = is_half ? mixture->halves++ : mixture->directions++;
    mixture->component[is_half ? SRBF_SLOTS + i : i] = k;
    if (is_half) {
        mixture->half_bandwidth[i] = srbf_proposal_bandwidth(k), mixture->weighted[i] = srbf_proposal_power(k, 1.0f);
    } else if (k < 2) {  // powers of the cosine
        mixture->linear[i] = k == 0, mixture->square[i] = k == 1, mixture->width[i] = 1.0f / (float)(k + 2);
        mixture->scale[i] = (float)(k + 2) / 6.28318531f;
    } else {
        const srbf_ProposalLobe lobe = srbf_mirror_lobe(srbf_vec3_of(0.0f, 0.0f, 1.0f), srbf_proposal_bandwidth(k));
        mixture->bandwidth[i] = lobe.bandwidth, mixture->width[i] = lobe.width, mixture->scale[i] = lobe.scale;
        mixture->rest[i] = lobe.rest, mixture->constant[i] = 1.0f;
    }
}
// The cosine alone.
static void srbf_reset(srbf_mixture* mixture) {
    int i;
    mixture->directions = mixture->halves = mixture->facets = 0;
    memset(mixture->bandwidth, 0, sizeof mixture->bandwidth), memset(mixture->constant, 0, sizeof mixture->constant);
    memset(mixture->linear, 0, sizeof mixture->linear), memset(mixture->square, 0, sizeof mixture->square);
    memset(mixture->node, 0, sizeof mixture->node);
    for (i = 0; i < SRBF_SLOTS; ++i) mixture->half_bandwidth[i] = 8.0f;  // of slots without weight
    for (i = 0; i < SRBF_NODES; ++i)
        mixture->node[i][0] = mixture->node[i][SRBF_STRETCH] = mixture->node[i][SRBF_STRETCH + 1] = 1.0f;
    srbf_add_component(mixture, 0);
}

// The numbers of a mixture for a view, interpolated between its nodes.
static void srbf_at_view(const srbf_mixture* mixture, float cosine, float number[SRBF_NUMBERS]) {
    const float at = (1.0f - sqrtf(srbf_min(cosine, 1.0f))) * (float)(SRBF_NODES - 1);
    const int below = (int)srbf_min(at, (float)(SRBF_NODES - 2));
    const srbf_x4 beyond = srbf_x4_of(at - (float)below);
    int i;
    for (i = 0; i < SRBF_NUMBERS; i += SRBF_LANES) {
        const srbf_x4 low = srbf_x4_load(&mixture->node[below][i]), high = srbf_x4_load(&mixture->node[below + 1][i]);
        srbf_x4_store(low + beyond * (high - low), number + i);
    }
}

static float srbf_mixture_pdf(const srbf_mixture* mixture, const float* number, srbf_vec3 wl, srbf_vec3 wv) {
    const srbf_x4_vec3 l = srbf_x4_all(wl), v = srbf_x4_all(wv), mirrored = srbf_x4_vec3_of(l.x, l.y, -l.z);
    srbf_x4 sum = srbf_x4_of(0.0f);
    float pdf;
    int i;
    for (i = 0; i < mixture->directions; i += SRBF_LANES) {
        const srbf_x4 constant = srbf_x4_load(mixture->constant + i);
        srbf_x4_ProposalLobe lobe;
        srbf_x4_HalfVector above, below;
        lobe.centre = srbf_x4_vec3_of(-v.x, -v.y, v.z), lobe.bandwidth = srbf_x4_load(mixture->bandwidth + i);
        lobe.scale = srbf_x4_load(mixture->scale + i), lobe.width = lobe.rest = constant;  // which no density reads
        above.direction = l, below.direction = mirrored, below.factor = constant;
        above.factor = constant + l.z * (srbf_x4_load(mixture->linear + i) + l.z * srbf_x4_load(mixture->square + i));
        sum = sum + srbf_x4_load(number + i) * srbf_x4_reflected_pdf(lobe, above, below);
    }
    if (mixture->halves > 0) {
        const srbf_x4_Stretch map = srbf_x4_stretch_along(v, srbf_x4_of(number[SRBF_STRETCH]));
        const srbf_x4 power = srbf_x4_of(number[SRBF_STRETCH + 1]);
        const srbf_x4_vec3 viewer = srbf_x4_stretched(v, map);
        const srbf_x4_HalfVector above = srbf_x4_half_vector(l, v, map), below = srbf_x4_half_vector(mirrored, v, map);
        for (i = 0; i < mixture->halves; i += SRBF_LANES) {
            const srbf_x4_ProposalLobe lobe =
                srbf_x4_half_vector_lobe(viewer, map.inverse, srbf_x4_load(mixture->half_bandwidth + i),
                                         power * srbf_x4_load(mixture->weighted + i));
            sum = sum + srbf_x4_load(number + SRBF_SLOTS + i) * srbf_x4_reflected_pdf(lobe, above, below);
        }
    }
    pdf = srbf_x4_sum(sum);
    for (i = 0; i < mixture->facets; ++i) pdf += number[SRBF_FACET_SLOT + i] * srbf_facets_pdf(wl, wv, mixture->facet[i]);
    return pdf;
}

// A direction that the selector's component samples; z <= 0 if there is none.
static srbf_vec3 srbf_mixture_sample(const srbf_mixture* mixture, const float* number, srbf_vec3 wv, float u1, float u2,
                                     float selector) {
    int slot, chosen = 0;
    for (slot = 0; slot < SRBF_FACET_SLOT + 2; ++slot) {
        if (number[slot] > 0.0f) chosen = slot;
        if (selector < number[slot]) break;
        selector -= number[slot];
    }
    if (chosen >= SRBF_FACET_SLOT) return srbf_sample_facets(wv, mixture->facet[chosen - SRBF_FACET_SLOT], u1, u2);
    return srbf_sample_proposal_lobe(mixture->component[chosen], wv, srbf_stretch_along(wv, number[SRBF_STRETCH]),
                                     number[SRBF_STRETCH + 1], u1, u2);
}

// ---- Preparation ----

// Points at a few views about a node, and the densities of all components at them, as columns.
#define SRBF_MOST_POINTS 1152
#define SRBF_COMPONENTS 18
typedef struct {
    float l[3][SRBF_MOST_POINTS], v[3][SRBF_MOST_POINTS], weight[SRBF_MOST_POINTS];
    float density[SRBF_COMPONENTS][SRBF_MOST_POINTS];
    int count, components;
} srbf_points;

static float srbf_luminance(const float* rgb) { return 0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2]; }
static float srbf_turns(double x) { return (float)(x - floor(x)); }

static srbf_x4_vec3 srbf_column(float column[3][SRBF_MOST_POINTS], int i) {
    return srbf_x4_vec3_of(srbf_x4_load(column[0] + i), srbf_x4_load(column[1] + i), srbf_x4_load(column[2] + i));
}
static void srbf_set_densities(srbf_points* points, const srbf_mixture* mixture, float stretch, float power) {
    int i, k;
    for (i = 0; i < points->count; i += SRBF_LANES) {
        const srbf_x4_vec3 wl = srbf_column(points->l, i), wv = srbf_column(points->v, i);
        const srbf_x4_ProposalPoint at = srbf_x4_proposal_point(
            wl, wv, srbf_x4_stretch_along(wv, srbf_x4_of(stretch)), srbf_x4_of(power));
        for (k = 0; k < 16; ++k) srbf_x4_store(srbf_x4_proposal_lobe_pdf(k, at), points->density[k] + i);
        for (k = 16; k < points->components; ++k) {
            const srbf_Facets* of = &mixture->facet[k - 16];
            srbf_x4_Facets facets;
            facets.xx = srbf_x4_of(of->xx), facets.xy = srbf_x4_of(of->xy), facets.yy = srbf_x4_of(of->yy);
            srbf_x4_store(srbf_x4_facets_pdf(wl, wv, facets), points->density[k] + i);
        }
    }
}

// The second moment of f cos(theta_l) / pdf after `steps` multiplicative steps of the weights towards the least one (the
// library's `propose`, srbf/sampling.h).
static float srbf_least_moment(const srbf_points* points, int steps, float weight[SRBF_COMPONENTS]) {
    float moment = 0.0f, slope[SRBF_COMPONENTS], sum;
    int step, i, k;
    for (k = 0; k < points->components; ++k) weight[k] = 1.0f / (float)points->components;
    for (step = 0; step <= steps; ++step) {
        srbf_x4 moments = srbf_x4_of(0.0f), slopes[SRBF_COMPONENTS];
        for (k = 0; k < points->components; ++k) slopes[k] = moments;
        for (i = 0; i < points->count; i += SRBF_LANES) {
            srbf_x4 pdf = srbf_x4_of(1.0e-15f), ratio;
            for (k = 0; k < points->components; ++k)
                pdf = pdf + srbf_x4_of(weight[k]) * srbf_x4_load(points->density[k] + i);
            ratio = srbf_x4_load(points->weight + i) / pdf;
            moments = moments + ratio, ratio = ratio / pdf;
            for (k = 0; k < points->components; ++k)
                slopes[k] = slopes[k] + ratio * srbf_x4_load(points->density[k] + i);
        }
        moment = srbf_x4_sum(moments);
        if (step == steps) break;
        for (k = 0, sum = 0.0f; k < points->components; ++k) {
            slope[k] = weight[k] * sqrtf(srbf_x4_sum(slopes[k]));
            sum += slope[k];
        }
        for (k = 0; k < points->components && sum > 0.0f; ++k) weight[k] = slope[k] / sum;
    }
    return moment;
}

// Samples of all components in a wide and a narrow shape, at these views, weighted by the square of f cos(theta_l).
static void srbf_make_points(const srbf_part* part, srbf_points* points, const srbf_vec3* views, int view_count) {
    static const float shapes[2][2] = {{1.0f, 1.0f}, {0.4f, 2.4f}};
    const srbf_mixture* mixture = part->mixture;
    const int draws = SRBF_MOST_POINTS / (view_count * 2 * points->components);
    int view, shape, k, i, first, c;
    points->count = 0;
    for (view = 0; view < view_count; ++view)
        for (shape = 0; shape < 2; ++shape)
            for (k = 0; k < points->components; ++k)
                for (i = 0; i < draws; ++i) {
                    const float u1 = ((float)i + 0.5f) / (float)draws, u2 = srbf_turns(0.6180339887 * (i + 7 * k + view));
                    const srbf_vec3 v = views[view];
                    const srbf_vec3 l = k < 16 ? srbf_sample_proposal_lobe(k, v, srbf_stretch_along(v, shapes[shape][0]),
                                                                           shapes[shape][1], u1, u2)
                                               : srbf_sample_facets(v, mixture->facet[k - 16], u1, u2);
                    points->l[0][points->count] = l.x, points->l[1][points->count] = l.y;
                    points->l[2][points->count] = l.z, points->weight[points->count] = 0.0f;
                    points->v[0][points->count] = v.x, points->v[1][points->count] = v.y, points->v[2][points->count++] = v.z;
                }
    for (; points->count % SRBF_LANES; ++points->count) {  // a point of weight 0
        for (c = 0; c < 3; ++c)
            points->l[c][points->count] = points->l[c][0], points->v[c][points->count] = points->v[c][0];
        points->weight[points->count] = 0.0f;
    }
    for (shape = 0; shape < 2; ++shape) {
        srbf_set_densities(points, mixture, shapes[shape][0], shapes[shape][1]);
        for (i = 0; i < points->count; ++i)
            for (k = 0; k < points->components; ++k) points->weight[i] += (float)draws * points->density[k][i];
    }
    for (view = 0; view < view_count; ++view) {
        const int own = 2 * points->components * draws;
        double albedo = 0.0;
        for (i = first = view * own; i < first + own; ++i) {
            const srbf_vec3 l = srbf_vec3_of(points->l[0][i], points->l[1][i], points->l[2][i]);
            float reflected = 0.0f, density = points->weight[i], rgb[3];
            if (l.z > 1.0e-6f && density > 0.0f) {
                const srbf_vec3 f = srbf_part_value(part, l, views[view]);
                rgb[0] = f.x, rgb[1] = f.y, rgb[2] = f.z;
                reflected = srbf_min(srbf_luminance(rgb) * l.z, 1.0e12f);
                albedo += (double)(reflected / density);
            }
            points->weight[i] = density > 0.0f ? reflected * reflected / density : 0.0f;
        }
        for (i = first; i < first + own; ++i)
            points->weight[i] = albedo > 1.0e-12 ? (float)((double)points->weight[i] / (albedo * albedo)) : 0.0f;
    }
    for (i = 2 * points->components * draws * view_count; i < points->count; ++i) points->weight[i] = 0.0f;
}

// The weights, stretch and power of a node: the shape by descent among powers of 0.64.
static void srbf_make_node(const srbf_part* part, srbf_points* points, int is_isotropic, int node,
                           float number[SRBF_COMPONENTS + 2]) {
    srbf_vec3 views[8];
    int count = 0, i, j = 1, best_i = 0, best_j = 1, is_better = 1;
    float least, sum = 0.0f;
    for (i = 0; i < (is_isotropic ? 3 : 8); ++i) {
        const float at = srbf_max(1.0f - ((float)node + (is_isotropic ? ((float)i - 1.0f) / 3.0f : 0.0f)) / 12.0f, 0.03162f);
        const float cosine = srbf_min(at * at, 1.0f), sine = sqrtf(1.0f - cosine * cosine), phi = 0.785398163f * (float)i;
        views[count++] = is_isotropic ? srbf_vec3_of(sine, 0.0f, cosine)
                                      : srbf_vec3_of(sine * cosf(phi), sine * sinf(phi), cosine);
    }
    srbf_make_points(part, points, views, count);
    srbf_set_densities(points, part->mixture, 1.0f, 1.0f);
    least = srbf_least_moment(points, 15, number);
    while (node > 0 && is_better) {
        static const int steps[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
        const int from_i = best_i, from_j = best_j;
        is_better = 0;
        for (count = 0; count < 4; ++count) {
            float moment;
            i = from_i + steps[count][0], j = from_j + steps[count][1];
            if (i < -6 || i > 6 || j < 0 || j > 5) continue;
            srbf_set_densities(points, part->mixture, powf(0.64f, (float)i), powf(0.64f, (float)(1 - j)));
            moment = srbf_least_moment(points, 15, number);
            if (moment < 0.998f * least) least = moment, best_i = i, best_j = j, is_better = 1;
        }
    }
    number[SRBF_COMPONENTS] = powf(0.64f, (float)best_i), number[SRBF_COMPONENTS + 1] = powf(0.64f, (float)(1 - best_j));
    if (node == 0) number[SRBF_COMPONENTS + 1] = 1.0f;
    srbf_set_densities(points, part->mixture, number[SRBF_COMPONENTS], number[SRBF_COMPONENTS + 1]);
    srbf_least_moment(points, 60, number);
    if (!(number[0] >= 0.02f)) number[0] = 0.02f;
    for (i = 0; i < points->components; ++i) {
        if (!(number[i] > 1.0e-3f)) number[i] = 0.0f;
        sum += number[i];
    }
    for (i = 0; i < points->components; ++i) number[i] /= sum;
}

static float srbf_elevation_cosine(float t) {
    float below = 0.0f, above = 1.0f;
    int i;
    for (i = 0; i < 30; ++i) {
        const float middle = 0.5f * (below + above);
        if (srbf_elevation_coordinate(middle) < t) below = middle; else above = middle;
    }
    return srbf_max(above, 1.0e-6f);
}
static void srbf_part_sample(const srbf_part* part, srbf_vec3 wv, const float u[3], srbf_light* light) {
    float number[SRBF_NUMBERS];
    srbf_vec3 wl, f;
    srbf_at_view(part->mixture, wv.z, number);
    wl = srbf_mixture_sample(part->mixture, number, wv, u[0], u[1], u[2]);
    memset(light, 0, sizeof *light);
    light->wl[0] = wl.x, light->wl[1] = wl.y, light->wl[2] = wl.z;
    if (!(wl.z >= 1.17549435e-38f)) return;
    light->pdf = srbf_mixture_pdf(part->mixture, number, wl, wv);
    if (!(light->pdf > 0.0f)) { light->pdf = 0.0f; return; }
    f = srbf_scale(wl.z / light->pdf, srbf_part_value(part, wl, wv));
    light->weight[0] = f.x, light->weight[1] = f.y, light->weight[2] = f.z;
}
// Albedos as the means of weights of samples, at four azimuths.
static void srbf_make_albedos(const srbf_part* part) {
    const int draws = 8192;
    int node, i, c;
    for (node = 0; node < SRBF_ALBEDO_NODES; ++node) {
        const float z = srbf_elevation_cosine((float)node / (float)(SRBF_ALBEDO_NODES - 1)), r = sqrtf(1.0f - z * z);
        double sum[3] = {0, 0, 0};
        for (i = 0; i < draws; ++i) {
            const float u[3] = {srbf_turns(0.8191725134 * i), srbf_turns(0.6710436067 * i), srbf_turns(0.5497004779 * i)};
            srbf_light light;
            srbf_part_sample(part, srbf_vec3_of(i & 1 ? 0.0f : i & 2 ? r : -r, i & 1 ? i & 2 ? r : -r : 0.0f, z), u, &light);
            for (c = 0; c < 3; ++c) sum[c] += (double)light.weight[c];
        }
        for (c = 0; c < 3; ++c) part->mixture->albedo[node][c] = (float)(sum[c] / draws);
    }
}
static void srbf_part_albedo(const srbf_part* part, float cosine, float rgb[3]) {
    const float at = srbf_elevation_coordinate(cosine) * (float)(SRBF_ALBEDO_NODES - 1);
    const int below = (int)srbf_min(at, (float)(SRBF_ALBEDO_NODES - 2));
    int c;
    for (c = 0; c < 3; ++c) {
        const float first = part->mixture->albedo[below][c];
        rgb[c] = first + (at - (float)below) * (part->mixture->albedo[below + 1][c] - first);
    }
}

static void srbf_set_facets(const srbf_model* model, srbf_mixture* mixture) {
    int i;
    if (model->kind == SRBF_KIND_GGX) {
        mixture->facets = 2;
        for (i = 0; i < 2; ++i)
            mixture->facet[i] = srbf_facets_along(1.0f, 0.0f, model->ggx[i].roughness, model->ggx[i].roughness);
    } else if (model->kind == SRBF_KIND_OPENPBR) {
        const srbf_OpenPbrSurface* of = &model->surface;
        const float coat = srbf_alpha_of(of->coat_roughness);
        const srbf_OpenPbrRoughness base =
            srbf_openpbr_roughness(srbf_alpha_of(srbf_roughened(of->specular_roughness, of->coat_roughness, of->coat_weight)),
                                   model->anisotropy.amount);
        mixture->facets = of->coat_weight > 0.0f ? 2 : 1;
        mixture->facet[0] = srbf_facets_along(model->anisotropy.cosine, model->anisotropy.sine, base.along, base.across);
        mixture->facet[1] = srbf_facets_along(1.0f, 0.0f, coat, coat);
    }
}
static int srbf_is_isotropic(const srbf_model* model) {
    return model->kind == SRBF_KIND_PM        ? model->pm.axial
           : model->kind == SRBF_KIND_SU      ? !model->su.is_plain
           : model->kind == SRBF_KIND_OPENPBR ? !model->is_anisotropic
                                              : 1;
}
static void srbf_prepare_part(const srbf_part* part, srbf_points* points) {
    srbf_mixture* mixture = part->mixture;
    float numbers[SRBF_NODES][SRBF_COMPONENTS + 2];
    int node, k, i;
    srbf_reset(mixture);
    srbf_set_facets(part->model, mixture);
    points->components = 16 + mixture->facets;
    memset(numbers, 0, sizeof numbers);
    for (node = 0; node < SRBF_NODES; ++node)
        srbf_make_node(part, points, srbf_is_isotropic(part->model), node, numbers[node]);
    for (k = 1; k < 16; ++k) {
        float most = 0.0f;
        for (node = 0; node < SRBF_NODES; ++node) most = srbf_max(most, numbers[node][k]);
        if (most > 0.0f) srbf_add_component(mixture, k);
    }
    for (node = 0; node < SRBF_NODES; ++node) {
        for (i = 0; i < mixture->directions; ++i) mixture->node[node][i] = numbers[node][mixture->component[i]];
        for (i = 0; i < mixture->halves; ++i)
            mixture->node[node][SRBF_SLOTS + i] = numbers[node][mixture->component[SRBF_SLOTS + i]];
        for (i = 0; i < mixture->facets; ++i) mixture->node[node][SRBF_FACET_SLOT + i] = numbers[node][16 + i];
        for (i = 0; i < 2; ++i) mixture->node[node][SRBF_STRETCH + i] = numbers[node][SRBF_COMPONENTS + i];
    }
    srbf_make_albedos(part);
}

// ---- The functions of the interface ----

static int srbf_read_beam(srbf_file* file, const char* prefix, srbf_beam* beam) {
    const srbf_tensor *angle = srbf_find(file, prefix, "angle"), *azimuths = srbf_find(file, prefix, "azimuths");
    const srbf_tensor* share = srbf_find(file, prefix, "share");
    size_t rings, nodes, i, channels;
    float* number;
    if (!angle) return 1;
    if (angle->rank != 1 || angle->extent[0] > 256) return srbf_fail(file, SRBF_BAD_TENSOR, angle->name);
    rings = nodes = angle->extent[0];
    angle = srbf_need(file, prefix, "angle", rings, 0, 0, 0.0f, 1.5713f);
    if (azimuths) azimuths = srbf_need(file, prefix, "azimuths", rings, 0, 0, 1.0f, 2048.0f);
    if (file->error) return 0;
    for (i = nodes = 0; i < rings; ++i) {
        const float n = azimuths ? srbf_number(file, azimuths, i) : 1.0f;
        if (n != floorf(n) || (i > 0 && !(srbf_number(file, angle, i) > srbf_number(file, angle, i - 1))))
            return srbf_fail(file, SRBF_BAD_NUMBER, file->header_end + angle->begin + 2 * i);
        nodes += (size_t)n;
    }
    channels = azimuths && share && share->rank == 2 && share->extent[1] == 1 ? 1 : 3;
    share = srbf_need(file, prefix, "share", nodes, channels, 0, 0.0f, 1.0f);
    if (file->error) return 0;
    number = (float*)srbf_take(file, (2 * rings + 3 * nodes) * sizeof *number);
    if (!number) return !file->error;
    beam->rings = (int)rings, beam->nodes = (int)nodes, beam->theta = number, beam->azimuths = number + rings;
    beam->share = number + 2 * rings;
    for (i = 0; i < rings; ++i) number[i] = srbf_number(file, angle, i);
    for (i = 0; i < rings; ++i) number[rings + i] = azimuths ? srbf_number(file, azimuths, i) : 1.0f;
    for (i = 0; i < 3 * nodes; ++i)
        number[2 * rings + i] = srbf_number(file, share, channels == 3 ? i : i / 3);
    return 1;
}

static srbf_brdf* srbf_read(srbf_file* file) {
    static const char* const versions[] = {"1", 0};
    static const char* const parts[] = {"reflection_front.", "reflection_back.", "transmission_front.", "transmission_back."};
    static const char* const beams[] = {"beam.reflection_front.", "beam.reflection_back.", "beam.transmission.",
                                        "beam.transmission_back."};
    const char* text = 0;
    srbf_model own[4];
    srbf_brdf result, *brdf;
    int p, i;
    memset(&result, 0, sizeof result);
    memset(own, 0, sizeof own);
    if (!srbf_read_header(file) || srbf_word(file, "", "srbf", versions, SRBF_OTHER_VERSION) < 0) return 0;
    result.is_two_sided = srbf_metadata(file, "", "model", &text) == 4 && memcmp(text, "bsdf", 4) == 0;
    brdf = (srbf_brdf*)srbf_take(file, sizeof *brdf);
    for (p = 0; p < 4; ++p) {
        srbf_model* model;
        if (result.is_two_sided ? srbf_metadata(file, parts[p], "model", &text) < 0 : p > 0) continue;
        if (!srbf_read_model(file, result.is_two_sided ? parts[p] : "", &own[p])) return 0;
        model = (srbf_model*)srbf_take(file, sizeof *model);
        if (model) *model = own[p];
        result.part[p].model = model ? model : &own[p];
    }
    for (p = 0; p < 4 && result.is_two_sided; ++p)
        if (!srbf_read_beam(file, beams[p], &result.beam[p])) return 0;
    for (i = 0; i < file->tensors; ++i) {  // a shader's tables begin with "aux.", also in parts
        const srbf_tensor* of = &file->tensor[i];
        size_t at = of->name;
        for (p = 0; p < 4 && result.is_two_sided; ++p)
            if (of->name_length > strlen(parts[p]) && memcmp(file->bytes + at, parts[p], strlen(parts[p])) == 0)
                at += strlen(parts[p]);
        if (!of->is_read && (of->name_length < 4 || memcmp(file->bytes + at, "aux.", 4) != 0))
            return srbf_fail(file, SRBF_BAD_TENSOR, of->name), (srbf_brdf*)0;
    }
    for (p = 0; p < 4; ++p) {  // a part without a model is answered by its counterpart, a transmission by reciprocity
        const srbf_part* other = &result.part[p ^ 1];
        if (result.part[p].model && !result.part[p].mixture)
            result.part[p].mixture = (srbf_mixture*)srbf_take(file, sizeof(srbf_mixture));
        if (!result.is_two_sided || result.part[p].model || !other->model) continue;
        result.part[p].model = other->model, result.part[p].is_exchanged = p >= 2;
        if (p >= 2) result.part[p].mixture = (srbf_mixture*)srbf_take(file, sizeof(srbf_mixture));
    }
    for (p = 0; p < 2; ++p)
        if (!result.part[p].mixture) result.part[p].mixture = result.part[p ^ 1].mixture;
    result.scratch = (float*)srbf_take(file, sizeof(srbf_points));
    if (!brdf || file->error) return 0;
    for (p = 0; p < 4; ++p)
        if (result.part[p].mixture) srbf_reset(result.part[p].mixture);
    *brdf = result;
    return brdf;
}

size_t srbf_memory_needed(const void* bytes, size_t size) {
    srbf_file file;
    memset(&file, 0, sizeof file);
    file.bytes = (const unsigned char*)bytes, file.size = size;
    srbf_read(&file);
    return file.error ? 0 : file.used + 16;
}
srbf_error srbf_open(const void* bytes, size_t size, void* memory, size_t capacity, srbf_brdf** brdf, size_t* offset) {
    const size_t unaligned = (size_t)memory % 16 ? 16 - (size_t)memory % 16 : 0;
    srbf_file file;
    memset(&file, 0, sizeof file);
    file.bytes = (const unsigned char*)bytes, file.size = size, *brdf = 0;
    if (memory && capacity >= unaligned) {
        file.memory = (char*)memory + unaligned, file.capacity = capacity - unaligned;
        *brdf = srbf_read(&file);
    } else {
        file.error = SRBF_TOO_LITTLE_MEMORY;
    }
    if (offset) *offset = file.error_at;
    return file.error;
}
void srbf_prepare(srbf_brdf* brdf) {
    int p;
    for (p = 0; p < 4; ++p)
        if (brdf->part[p].model && !(p == 1 && brdf->part[1].mixture == brdf->part[0].mixture))
            srbf_prepare_part(&brdf->part[p], (srbf_points*)(void*)brdf->scratch);
}
int srbf_is_two_sided(const srbf_brdf* brdf) { return brdf->is_two_sided; }

// True if no direction lies in the surface. Sets the pair in the frame of a part, above its horizon.
static int srbf_is_above(const srbf_brdf* brdf, const float wl[3], const float wv[3], srbf_vec3* l, srbf_vec3* v) {
    const float sum = (wl[0] + wl[1]) + (wv[0] + wv[1]) + (wl[2] + wv[2]);
    *l = srbf_vec3_of(wl[0], wl[1], brdf->is_two_sided ? fabsf(wl[2]) : wl[2]);
    *v = srbf_vec3_of(wv[0], wv[1], brdf->is_two_sided ? fabsf(wv[2]) : wv[2]);
    return l->z >= 1.17549435e-38f && v->z >= 1.17549435e-38f && sum - sum == 0.0f;
}
// The part that answers for the pair; -1 if there is none.
static int srbf_part_of(const srbf_brdf* brdf, const float wl[3], const float wv[3], srbf_vec3* l, srbf_vec3* v) {
    const int is_back = wl[2] < 0.0f, part = is_back + 2 * (is_back != (wv[2] < 0.0f));
    return srbf_is_above(brdf, wl, wv, l, v) && brdf->part[part].model ? part : -1;
}
void srbf_value(const srbf_brdf* brdf, const float wl[3], const float wv[3], float rgb[3]) {
    srbf_vec3 l, v, f = srbf_vec3_of(0.0f, 0.0f, 0.0f);
    const int part = srbf_part_of(brdf, wl, wv, &l, &v);
    if (part >= 0) f = srbf_part_value(&brdf->part[part], l, v);
    rgb[0] = f.x, rgb[1] = f.y, rgb[2] = f.z;
}
void srbf_values(const srbf_brdf* brdf, size_t count, const float* wl, const float* wv, float* rgb) {
    size_t i;
    for (i = 0; i < count; ++i) srbf_value(brdf, wl + 3 * i, wv + 3 * i, rgb + 3 * i);
}

static void srbf_ring_share(const srbf_beam* beam, int ring, int first, float turns, float rgb[3]) {
    const int n = (int)beam->azimuths[ring], at = (int)(turns * (float)n), k = at < n ? at : n - 1;
    const float t = turns * (float)n - (float)k;
    int c;
    for (c = 0; c < 3; ++c)
        rgb[c] = (1.0f - t) * beam->share[3 * (first + k) + c] + t * beam->share[3 * (first + (k + 1) % n) + c];
}
// The share of the light from wl that a part lets pass unscattered: linear in the azimuth, and in theta between rings.
static void srbf_beam_share(const srbf_brdf* brdf, int part, srbf_vec3 wl, float rgb[3]) {
    const srbf_beam* beam = &brdf->beam[part];
    float theta, turns, low[3], high[3] = {0.0f, 0.0f, 0.0f}, t;
    int next = 0, first = 0, before = 0, c;
    rgb[0] = rgb[1] = rgb[2] = 0.0f;
    if (!beam->rings && part >= 2) beam = &brdf->beam[part ^ 1], wl = srbf_vec3_of(-wl.x, -wl.y, wl.z);
    if (!beam->rings) return;
    theta = acosf(srbf_min(wl.z, 1.0f)), turns = atan2f(wl.y, wl.x) / 6.28318531f;
    if (turns < 0.0f) turns += 1.0f;
    turns = srbf_min(turns, 1.0f);
    for (; next < beam->rings && beam->theta[next] <= theta; ++next) before = first, first += (int)beam->azimuths[next];
    if (next == 0) {
        srbf_ring_share(beam, 0, 0, turns, rgb);
        return;
    }
    srbf_ring_share(beam, next - 1, before, turns, low);
    t = (next < beam->rings ? beam->theta[next] : 1.57079633f) - beam->theta[next - 1];
    t = t > 0.0f ? srbf_min((theta - beam->theta[next - 1]) / t, 1.0f) : 0.0f;
    if (next < beam->rings) srbf_ring_share(beam, next, first, turns, high);
    for (c = 0; c < 3; ++c) rgb[c] = (1.0f - t) * low[c] + t * high[c];
}

// The chances of reflection, its beam, transmission and its beam for a view, by their albedos.
typedef struct {
    int part[2];
    float chance[4], share[2][3];
} srbf_chances;
static srbf_chances srbf_chances_of(const srbf_brdf* brdf, srbf_vec3 v, int is_back) {
    srbf_chances of;
    float sum = 0.0f, total = 0.0f;
    int k;
    memset(&of, 0, sizeof of);
    of.part[0] = is_back, of.part[1] = is_back ? 2 : 3;
    if (!brdf->is_two_sided) {
        of.chance[0] = 1.0f;
        return of;
    }
    for (k = 0; k < 2; ++k) {
        float rgb[3] = {0.0f, 0.0f, 0.0f};
        if (brdf->part[of.part[k]].model) srbf_part_albedo(&brdf->part[of.part[k]], v.z, rgb);
        srbf_beam_share(brdf, of.part[k], srbf_vec3_of(-v.x, -v.y, v.z), of.share[k]);
        of.chance[2 * k] = srbf_luminance(rgb), of.chance[2 * k + 1] = srbf_luminance(of.share[k]);
        sum += of.chance[2 * k] + of.chance[2 * k + 1];
    }
    for (k = 0; k < 2; ++k) {
        if (brdf->part[of.part[k]].model) of.chance[2 * k] = srbf_max(of.chance[2 * k], sum > 0.0f ? 1.0e-3f * sum : 1.0f);
        total += of.chance[2 * k] + of.chance[2 * k + 1];
    }
    for (k = 0; k < 4 && total > 0.0f; ++k) of.chance[k] /= total;
    return of;
}

void srbf_sample(const srbf_brdf* brdf, const float wv[3], const float u[3], srbf_light* light) {
    const float side = wv[2] < 0.0f ? -1.0f : 1.0f;
    float selector = u[2];
    srbf_chances of;
    srbf_vec3 v, same;
    int k, c;
    memset(light, 0, sizeof *light);
    if (!srbf_is_above(brdf, wv, wv, &same, &v)) return;
    of = srbf_chances_of(brdf, v, side < 0.0f);
    for (k = 0; k < 4; ++k) {
        const float chance = of.chance[k], light_side = k < 2 ? side : -side;
        if (!(selector < chance)) {
            selector -= chance;
            continue;
        }
        if (k % 2 == 0) {
            float rescaled[3];
            rescaled[0] = u[0], rescaled[1] = u[1], rescaled[2] = srbf_min(selector / chance, 0.99999994f);
            srbf_part_sample(&brdf->part[of.part[k / 2]], v, rescaled, light);
            light->pdf *= chance;
        } else {
            light->wl[0] = -v.x, light->wl[1] = -v.y, light->wl[2] = v.z, light->is_beam = 1;
        }
        light->wl[2] *= light_side;
        for (c = 0; c < 3; ++c) light->weight[c] = (k % 2 ? of.share[k / 2][c] : light->weight[c]) / chance;
        return;
    }
}
float srbf_value_pdf(const srbf_brdf* brdf, const float wl[3], const float wv[3], float rgb[3]) {
    srbf_vec3 l, v, f;
    float number[SRBF_NUMBERS];
    const int part = srbf_part_of(brdf, wl, wv, &l, &v);
    rgb[0] = rgb[1] = rgb[2] = 0.0f;
    if (part < 0) return 0.0f;
    f = srbf_part_value(&brdf->part[part], l, v);
    rgb[0] = f.x, rgb[1] = f.y, rgb[2] = f.z;
    srbf_at_view(brdf->part[part].mixture, v.z, number);
    return srbf_chances_of(brdf, v, wv[2] < 0.0f).chance[part & 2] *
           srbf_mixture_pdf(brdf->part[part].mixture, number, l, v);
}
float srbf_pdf(const srbf_brdf* brdf, const float wl[3], const float wv[3]) {
    srbf_vec3 l, v;
    float number[SRBF_NUMBERS];
    const int part = srbf_part_of(brdf, wl, wv, &l, &v);
    if (part < 0) return 0.0f;
    srbf_at_view(brdf->part[part].mixture, v.z, number);
    return srbf_chances_of(brdf, v, wv[2] < 0.0f).chance[part & 2] *
           srbf_mixture_pdf(brdf->part[part].mixture, number, l, v);
}
void srbf_albedo(const srbf_brdf* brdf, float cosine, float rgb[3]) {
    const srbf_part* part = &brdf->part[cosine < 0.0f];
    rgb[0] = rgb[1] = rgb[2] = 0.0f;
    if (part->model && fabsf(cosine) > 0.0f) srbf_part_albedo(part, srbf_min(fabsf(cosine), 1.0f), rgb);
}

#endif
