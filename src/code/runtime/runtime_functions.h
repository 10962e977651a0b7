// ---- The functions of the interface ----

static int srbf_read_beam(srbf_file* file, srbf_beam* beam) {
    const srbf_tensor *angle, *azimuths, *share = srbf_find(file, "share");
    const int has_azimuths = srbf_find(file, "azimuths") != 0, is_grey = has_azimuths && share && share->extent[1] == 1;
    size_t rings, nodes = 0, i;
    float* number;
    if (!srbf_find(file, "angle")) return 1;
    rings = srbf_extent(file, "angle", 0, 256);
    angle = srbf_need(file, "angle", rings, 0, 0, 0.0f, 1.5713f);
    azimuths = has_azimuths ? srbf_need(file, "azimuths", rings, 0, 0, 1.0f, 2048.0f) : 0;
    for (i = 0; i < rings && !file->error; ++i) {
        const float n = azimuths ? srbf_number(file, azimuths, i) : 1.0f;
        if (n != floorf(n) || (i > 0 && !(srbf_number(file, angle, i) > srbf_number(file, angle, i - 1))))
            srbf_fail(file, SRBF_BAD_NUMBER, angle->begin + 2 * i);
        nodes += (size_t)n;
    }
    share = srbf_need(file, "share", nodes, is_grey ? 1 : 3, 0, 0.0f, 1.0f);
    if (file->error) return 0;
    number = (float*)srbf_take(file, (2 * rings + 3 * nodes) * sizeof *number);
    if (!number) return !file->error;
    beam->rings = (int)rings, beam->theta = number;
    beam->azimuths = number + rings, beam->share = number + 2 * rings;
    for (i = 0; i < rings; ++i) {
        number[i] = srbf_number(file, angle, i);
        number[rings + i] = azimuths ? srbf_number(file, azimuths, i) : 1.0f;
    }
    for (i = 0; i < 3 * nodes; ++i) number[2 * rings + i] = srbf_number(file, share, is_grey ? i / 3 : i);
    return 1;
}

// True if a tensor is a table for shaders, whose names begin with "aux.", also in parts.
static int srbf_is_auxiliary(srbf_word name) {
    size_t i;
    for (i = 0; i + 4 <= name.length; ++i)
        if (memcmp(name.text + i, "aux.", 4) == 0 && (i == 0 || name.text[i - 1] == '.')) return 1;
    return 0;
}
static void srbf_read(srbf_file* file, srbf_brdf* brdf) {
    static const char* const parts[] = {"reflection_front.", "reflection_back.", "transmission_front.",
                                        "transmission_back."};
    static const char* const beams[] = {"beam.reflection_front.", "beam.reflection_back.", "beam.transmission.",
                                        "beam.transmission_back."};
    int p, i;
    memset(brdf, 0, sizeof *brdf);
    if (!srbf_read_header(file) || srbf_choice(file, "srbf", "1 ", SRBF_OTHER_VERSION) < 0) return;
    brdf->is_two_sided = srbf_metadata(file, "model") && srbf_is(file->word, "", "bsdf");
    for (p = 0; p < 4; ++p) {
        file->prefix = brdf->is_two_sided ? parts[p] : "";
        if (brdf->is_two_sided ? !srbf_metadata(file, "model") : p > 0) continue;
        if (!srbf_read_model(file, &brdf->model[p])) return;
        brdf->part[p].model = &brdf->model[p];
    }
    for (p = 0; p < 4 && brdf->is_two_sided; ++p) {
        file->prefix = beams[p];
        if (!srbf_read_beam(file, &brdf->beam[p])) return;
    }
    for (i = 0; i < file->tensors; ++i)
        if (!file->tensor[i].is_read && !srbf_is_auxiliary(file->tensor[i].name))
            srbf_fail_tensor(file, &file->tensor[i]);
    for (p = 0; p < 4; ++p) {  // a part without a model is answered by its counterpart, a transmission by reciprocity
        srbf_part* part = &brdf->part[p];
        if (!part->model && brdf->is_two_sided) part->model = brdf->part[p ^ 1].model, part->is_exchanged = p >= 2;
        for (i = 0; i < SRBF_NODES; ++i) {  // the cosine alone
            float* number = part->mixture.number[i];
            int k;
            for (k = SRBF_STRETCH; k < SRBF_NUMBERS; ++k) number[k] = 1.0f;
            number[0] = 1.0f;
        }
    }
    brdf->points = (srbf_points*)srbf_take(file, sizeof *brdf->points);
}

static void srbf_begin(srbf_file* file, const void* bytes, size_t size) {
    memset(file, 0, sizeof *file);
    file->bytes = (const unsigned char*)bytes, file->size = size, file->prefix = "";
    file->used = (sizeof(srbf_brdf) + 15) / 16 * 16;
}
size_t srbf_memory_needed(const void* bytes, size_t size) {
    srbf_file file;
    srbf_brdf brdf;
    srbf_begin(&file, bytes, size);
    srbf_read(&file, &brdf);
    return file.error ? 0 : file.used + 16;
}
srbf_error srbf_open(const void* bytes, size_t size, void* memory, size_t capacity, srbf_brdf** brdf, size_t* offset) {
    const size_t unaligned = (16 - (size_t)memory % 16) % 16;
    srbf_file file;
    srbf_begin(&file, bytes, size);
    *brdf = 0;
    if (memory && capacity >= unaligned + file.used) {
        file.memory = (char*)memory + unaligned, file.capacity = capacity - unaligned;
        srbf_read(&file, (srbf_brdf*)(void*)file.memory);
    } else {
        file.error = SRBF_TOO_LITTLE_MEMORY;
    }
    if (offset) *offset = file.error_at;
    if (!file.error) *brdf = (srbf_brdf*)(void*)file.memory;
    return file.error;
}
void srbf_prepare(srbf_brdf* brdf) {
    int p;
    for (p = 0; p < 4; ++p) {
        srbf_part* part = &brdf->part[p];
        if (p == 1 && part->model == brdf->part[0].model)
            *part = brdf->part[0];
        else if (part->model)
            srbf_prepare_part(part, brdf->points);
    }
}
int srbf_is_two_sided(const srbf_brdf* brdf) { return brdf->is_two_sided; }

// True if no direction lies in the surface. Sets the pair in the frame of a part, above its horizon.
SRBF_INLINE int srbf_is_above(const srbf_brdf* brdf, const float wl[3], const float wv[3], srbf_vec3* l, srbf_vec3* v) {
    *l = srbf_vec3_at(wl), *v = srbf_vec3_at(wv);
    if (!srbf_is_finite(*l) || !srbf_is_finite(*v)) return 0;
    if (brdf->is_two_sided) l->z = fabsf(l->z), v->z = fabsf(v->z);
    return l->z >= 1.17549435e-38f && v->z >= 1.17549435e-38f;
}
// The part that answers for the pair; -1 if there is none.
SRBF_INLINE int srbf_part_of(const srbf_brdf* brdf, const float wl[3], const float wv[3], srbf_vec3* l, srbf_vec3* v) {
    const int is_back = wl[2] < 0.0f, part = is_back + 2 * (is_back != (wv[2] < 0.0f));
    return srbf_is_above(brdf, wl, wv, l, v) && brdf->part[part].model ? part : -1;
}

static srbf_vec3 srbf_ring_share(const srbf_beam* beam, int ring, int first, float turns) {
    const int n = (int)beam->azimuths[ring], at = (int)(turns * (float)n), k = at < n ? at : n - 1;
    return srbf_interpolated(srbf_vec3_at(beam->share + 3 * (first + k)),
                             srbf_vec3_at(beam->share + 3 * (first + (k + 1) % n)), turns * (float)n - (float)k);
}
// The share of the light from wl that a part lets pass unscattered: linear in the azimuth, and in theta between rings.
static srbf_vec3 srbf_beam_share(const srbf_brdf* brdf, int part, srbf_vec3 wl) {
    const srbf_beam *stored = &brdf->beam[part], *beam = part >= 2 && !stored->rings ? &brdf->beam[part ^ 1] : stored;
    const float theta = acosf(srbf_min(wl.z, 1.0f)), sign = beam == stored ? 1.0f : -1.0f;
    const float turns = srbf_turns((double)atan2f(sign * wl.y, sign * wl.x) / 6.283185307179586);
    srbf_vec3 high = srbf_vec3_of(0.0f, 0.0f, 0.0f);
    int next = 0, first = 0, before = 0;
    float t;
    if (!beam->rings) return high;
    for (; next < beam->rings && beam->theta[next] <= theta; ++next) before = first, first += (int)beam->azimuths[next];
    if (next < beam->rings) high = srbf_ring_share(beam, next, first, turns);
    if (next == 0) return high;
    t = (next < beam->rings ? beam->theta[next] : 1.57079633f) - beam->theta[next - 1];
    t = t > 0.0f ? srbf_min((theta - beam->theta[next - 1]) / t, 1.0f) : 0.0f;
    return srbf_interpolated(srbf_ring_share(beam, next - 1, before, turns), high, t);
}

// The chances of reflection, its beam, transmission and its beam for a view, by their albedos.
typedef struct {
    const srbf_part* part[2];
    float chance[4];
    srbf_vec3 share[2];
} srbf_chances;
static srbf_chances srbf_chances_of(const srbf_brdf* brdf, srbf_vec3 v, int is_back) {
    const srbf_vec3 none = {0.0f, 0.0f, 0.0f};
    srbf_chances chances;
    float sum = 0.0f, total = 0.0f;
    int k;
    memset(&chances, 0, sizeof chances);
    chances.part[0] = &brdf->part[is_back], chances.part[1] = &brdf->part[3 - is_back];
    chances.chance[0] = brdf->is_two_sided ? 0.0f : 1.0f;
    if (!brdf->is_two_sided) return chances;
    for (k = 0; k < 2; ++k) {
        const srbf_vec3 albedo = chances.part[k]->model ? srbf_part_albedo(chances.part[k], v.z) : none;
        chances.share[k] = srbf_beam_share(brdf, (int)(chances.part[k] - brdf->part), srbf_vec3_of(-v.x, -v.y, v.z));
        chances.chance[2 * k] = srbf_luminance(albedo), chances.chance[2 * k + 1] = srbf_luminance(chances.share[k]);
        sum += chances.chance[2 * k] + chances.chance[2 * k + 1];
    }
    for (k = 0; k < 4; ++k) {
        const float smallest = sum > 0.0f ? 1.0e-3f * sum : 1.0f;
        const float min = k % 2 == 0 && chances.part[k / 2]->model ? smallest : 0.0f;
        chances.chance[k] = srbf_max(chances.chance[k], min);
        total += chances.chance[k];
    }
    for (k = 0; k < 4 && total > 0.0f; ++k) chances.chance[k] /= total;
    return chances;
}

void srbf_sample(const srbf_brdf* brdf, const float wv[3], const float u[3], srbf_light* light) {
    const int is_back = wv[2] < 0.0f;
    float selector = u[2], *weight = light->weight;
    srbf_chances chances;
    srbf_vec3 v, same;
    int k, c;
    memset(light, 0, sizeof *light);
    if (!srbf_is_above(brdf, wv, wv, &same, &v)) return;
    chances = srbf_chances_of(brdf, v, is_back);
    for (k = 0; k < 4 && !(selector < chances.chance[k]); ++k) selector -= chances.chance[k];
    if (k == 4) return;
    if (k % 2 == 0) {
        const float in_part[3] = {u[0], u[1], srbf_min(selector / chances.chance[k], 0.99999994f)};
        srbf_part_sample(chances.part[k / 2], v, in_part, light);
        light->pdf *= chances.chance[k];
    } else {
        const srbf_vec3 straight = srbf_vec3_of(-v.x, -v.y, v.z);
        memcpy(light->wl, &straight, sizeof straight), memcpy(weight, &chances.share[k / 2], sizeof straight);
        light->is_beam = 1;
    }
    if (is_back != (k >= 2)) light->wl[2] = -light->wl[2];
    for (c = 0; c < 3; ++c) weight[c] /= chances.chance[k];
}

// The value and the density, each unless its pointer is null.
SRBF_INLINE void srbf_evaluate(const srbf_brdf* brdf, const float wl[3], const float wv[3], float* rgb, float* pdf) {
    srbf_vec3 l, v, f = srbf_vec3_of(0.0f, 0.0f, 0.0f);
    const int part = srbf_part_of(brdf, wl, wv, &l, &v);
    srbf_view view;
    if (part >= 0 && rgb) f = srbf_part_value(&brdf->part[part], l, v);
    if (rgb) memcpy(rgb, &f, sizeof f);
    if (!pdf) return;
    *pdf = 0.0f;
    if (part < 0) return;
    srbf_view_of(&view, &brdf->part[part].mixture, v);
    *pdf = srbf_view_pdf(&view, l, 0);
    if (brdf->is_two_sided) *pdf *= srbf_chances_of(brdf, v, wv[2] < 0.0f).chance[part & 2];
}
void srbf_value(const srbf_brdf* brdf, const float wl[3], const float wv[3], float rgb[3]) {
    srbf_evaluate(brdf, wl, wv, rgb, 0);
}
void srbf_values(const srbf_brdf* brdf, size_t count, const float* wl, const float* wv, float* rgb) {
    size_t i;
    for (i = 0; i < count; ++i) srbf_value(brdf, wl + 3 * i, wv + 3 * i, rgb + 3 * i);
}
float srbf_pdf(const srbf_brdf* brdf, const float wl[3], const float wv[3]) {
    float pdf;
    srbf_evaluate(brdf, wl, wv, 0, &pdf);
    return pdf;
}
float srbf_value_pdf(const srbf_brdf* brdf, const float wl[3], const float wv[3], float rgb[3]) {
    float pdf;
    srbf_evaluate(brdf, wl, wv, rgb, &pdf);
    return pdf;
}
void srbf_albedo(const srbf_brdf* brdf, float cosine, float rgb[3]) {
    const srbf_part* part = &brdf->part[cosine < 0.0f];
    srbf_vec3 albedo = srbf_vec3_of(0.0f, 0.0f, 0.0f);
    if (part->model && srbf_is_finite(srbf_vec3_of(cosine, 0.0f, 0.0f)) && fabsf(cosine) > 0.0f)
        albedo = srbf_part_albedo(part, srbf_min(fabsf(cosine), 1.0f));
    memcpy(rgb, &albedo, sizeof albedo);
}

#endif
