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
