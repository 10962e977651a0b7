// ---- The functions of the interface ----

static int srbf_read_beam(srbf_file* file, const char* prefix, srbf_beam* beam) {
    const srbf_tensor *angle, *azimuths = srbf_find(file, prefix, "azimuths"),
                              *share = srbf_find(file, prefix, "share");
    size_t rings, none, nodes = 0, i, channels;
    float* number;
    if (!srbf_find(file, prefix, "angle")) return 1;
    if (!srbf_shape(file, prefix, "angle", &rings, &none, 256, 0)) return 0;
    angle = srbf_need(file, prefix, "angle", rings, 0, 0, 0.0f, 1.5713f);
    if (azimuths) azimuths = srbf_need(file, prefix, "azimuths", rings, 0, 0, 1.0f, 2048.0f);
    if (file->error) return 0;
    for (i = 0; i < rings; ++i) {
        const float n = azimuths ? srbf_number(file, azimuths, i) : 1.0f;
        if (n != floorf(n) || (i > 0 && !(srbf_number(file, angle, i) > srbf_number(file, angle, i - 1))))
            return srbf_fail(file, SRBF_BAD_NUMBER, angle->begin + 2 * i);
        nodes += (size_t)n;
    }
    channels = azimuths && share && share->rank == 2 && share->extent[1] == 1 ? 1 : 3;
    share = srbf_need(file, prefix, "share", nodes, channels, 0, 0.0f, 1.0f);
    if (file->error) return 0;
    number = (float*)srbf_take(file, (2 * rings + 3 * nodes) * sizeof *number);
    if (!number) return !file->error;
    beam->rings = (int)rings, beam->nodes = (int)nodes, beam->theta = number, beam->azimuths = number + rings;
    beam->share = number + 2 * rings;
    for (i = 0; i < rings; ++i) {
        number[i] = srbf_number(file, angle, i);
        number[rings + i] = azimuths ? srbf_number(file, azimuths, i) : 1.0f;
    }
    for (i = 0; i < 3 * nodes; ++i) number[2 * rings + i] = srbf_number(file, share, channels == 3 ? i : i / 3);
    return 1;
}

// True if a tensor is a table for shaders, whose names begin with "aux.", also in parts.
static int srbf_is_auxiliary(srbf_word name) {
    size_t i;
    for (i = 0; i + 4 <= name.length; ++i)
        if (memcmp(name.text + i, "aux.", 4) == 0 && (i == 0 || name.text[i - 1] == '.')) return 1;
    return 0;
}
static srbf_brdf* srbf_read(srbf_file* file) {
    static const char* const versions[] = {"1", 0};
    static const char* const parts[] = {"reflection_front.", "reflection_back.", "transmission_front.",
                                        "transmission_back."};
    static const char* const beams[] = {"beam.reflection_front.", "beam.reflection_back.", "beam.transmission.",
                                        "beam.transmission_back."};
    srbf_model own[4];
    srbf_brdf result, *brdf;
    int p, i;
    memset(&result, 0, sizeof result), memset(own, 0, sizeof own);
    if (!srbf_read_header(file) || srbf_choice(file, "", "srbf", versions, SRBF_OTHER_VERSION) < 0) return 0;
    result.is_two_sided = srbf_metadata(file, "", "model") && srbf_is(file->word, "", "bsdf");
    brdf = (srbf_brdf*)srbf_take(file, sizeof *brdf);
    for (p = 0; p < 4; ++p) {
        srbf_model* model;
        if (result.is_two_sided ? !srbf_metadata(file, parts[p], "model") : p > 0) continue;
        if (!srbf_read_model(file, result.is_two_sided ? parts[p] : "", &own[p])) return 0;
        model = (srbf_model*)srbf_take(file, sizeof *model);
        if (model) *model = own[p];
        result.part[p].model = model ? model : &own[p];
    }
    for (p = 0; p < 4 && result.is_two_sided; ++p)
        if (!srbf_read_beam(file, beams[p], &result.beam[p])) return 0;
    for (i = 0; i < file->tensors; ++i)
        if (!file->tensor[i].is_read && !srbf_is_auxiliary(file->tensor[i].name))
            return srbf_fail_at(file, SRBF_BAD_TENSOR, file->tensor[i].name), (srbf_brdf*)0;
    for (p = 0; p < 4; ++p) {  // a part without a model is answered by its counterpart, a transmission by reciprocity
        srbf_part* part = &result.part[p];
        const int is_missing = !part->model;
        if (is_missing && result.is_two_sided && result.part[p ^ 1].model)
            part->model = result.part[p ^ 1].model, part->is_exchanged = p >= 2;
        if (part->model && !(is_missing && p == 1))
            part->mixture = (srbf_mixture*)srbf_take(file, sizeof *part->mixture),
            part->albedo = (float(*)[3])srbf_take(file, SRBF_ALBEDO_NODES * sizeof *part->albedo);
        if (part->mixture) srbf_reset(part->mixture);
    }
    if (!result.part[1].mixture)
        result.part[1].mixture = result.part[0].mixture, result.part[1].albedo = result.part[0].albedo;
    result.scratch = (float*)srbf_take(file, sizeof(srbf_points));
    if (!brdf || file->error) return 0;
    *brdf = result;
    return brdf;
}

static void srbf_begin(srbf_file* file, const void* bytes, size_t size) {
    memset(file, 0, sizeof *file);
    file->bytes = (const unsigned char*)bytes, file->size = size;
}
size_t srbf_memory_needed(const void* bytes, size_t size) {
    srbf_file file;
    srbf_begin(&file, bytes, size);
    srbf_read(&file);
    return file.error ? 0 : file.used + 16;
}
srbf_error srbf_open(const void* bytes, size_t size, void* memory, size_t capacity, srbf_brdf** brdf, size_t* offset) {
    const size_t unaligned = (16 - (size_t)memory % 16) % 16;
    srbf_file file;
    srbf_begin(&file, bytes, size);
    *brdf = 0;
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
SRBF_INLINE int srbf_is_above(const srbf_brdf* brdf, const float wl[3], const float wv[3], srbf_vec3* l,
                              srbf_vec3* v) {
    const float sum = (wl[0] + wl[1]) + (wv[0] + wv[1]) + (wl[2] + wv[2]);
    *l = srbf_vec3_of(wl[0], wl[1], brdf->is_two_sided ? fabsf(wl[2]) : wl[2]);
    *v = srbf_vec3_of(wv[0], wv[1], brdf->is_two_sided ? fabsf(wv[2]) : wv[2]);
    return l->z >= 1.17549435e-38f && v->z >= 1.17549435e-38f && sum - sum == 0.0f;
}
// The part that answers for the pair; -1 if there is none.
SRBF_INLINE int srbf_part_of(const srbf_brdf* brdf, const float wl[3], const float wv[3], srbf_vec3* l, srbf_vec3* v) {
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
        if (brdf->part[of.part[k]].model)
            of.chance[2 * k] = srbf_max(of.chance[2 * k], sum > 0.0f ? 1.0e-3f * sum : 1.0f);
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
// The density of a part's pair, whose view is at the back.
static float srbf_part_pdf(const srbf_brdf* brdf, int part, srbf_vec3 l, srbf_vec3 v, int is_back) {
    const float chance = brdf->is_two_sided ? srbf_chances_of(brdf, v, is_back).chance[part & 2] : 1.0f;
    srbf_view view;
    srbf_view_of(&view, brdf->part[part].mixture, v);
    return chance * srbf_view_pdf(&view, l, 0);
}
float srbf_value_pdf(const srbf_brdf* brdf, const float wl[3], const float wv[3], float rgb[3]) {
    srbf_vec3 l, v, f;
    const int part = srbf_part_of(brdf, wl, wv, &l, &v);
    rgb[0] = rgb[1] = rgb[2] = 0.0f;
    if (part < 0) return 0.0f;
    f = srbf_part_value(&brdf->part[part], l, v);
    rgb[0] = f.x, rgb[1] = f.y, rgb[2] = f.z;
    return srbf_part_pdf(brdf, part, l, v, wv[2] < 0.0f);
}
float srbf_pdf(const srbf_brdf* brdf, const float wl[3], const float wv[3]) {
    srbf_vec3 l, v;
    const int part = srbf_part_of(brdf, wl, wv, &l, &v);
    return part < 0 ? 0.0f : srbf_part_pdf(brdf, part, l, v, wv[2] < 0.0f);
}
void srbf_albedo(const srbf_brdf* brdf, float cosine, float rgb[3]) {
    const srbf_part* part = &brdf->part[cosine < 0.0f];
    rgb[0] = rgb[1] = rgb[2] = 0.0f;
    if (part->model && fabsf(cosine) > 0.0f) srbf_part_albedo(part, srbf_min(fabsf(cosine), 1.0f), rgb);
}

#endif
