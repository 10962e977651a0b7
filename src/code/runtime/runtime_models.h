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

// The falloff and the centre of variate n of lobe j; `centre` is null if the model is axial.
static void srbf_read_variate(const srbf_file* file, const srbf_lobes* pm, const srbf_tensor* bandwidth,
                              const srbf_tensor* centre, int j, int n, float* number) {
    const float half_log2_e = 0.5f * 1.44269504f;
    const size_t i = (size_t)(j * pm->variates + n);
    const int row = srbf_variate_row(pm, n);
    number[srbf_place(j, row, pm->rows)] = half_log2_e * fabsf(srbf_number(file, bandwidth, i));
    if (centre) {
        const srbf_vec3 xi = srbf_spherical(srbf_number(file, centre, 2 * i), srbf_number(file, centre, 2 * i + 1));
        number[srbf_place(j, row + 1, pm->rows)] = xi.x, number[srbf_place(j, row + 2, pm->rows)] = xi.y;
        number[srbf_place(j, row + 3, pm->rows)] = xi.z;
    } else {
        number[srbf_place(j, row + 1, pm->rows)] = srbf_half_bits(file, bandwidth, i) >> 15 ? -1.0f : 1.0f;
    }
}

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
        for (n = 0; n < pm.variates; ++n) srbf_read_variate(file, &pm, bandwidth, centre, j, n, number);
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

