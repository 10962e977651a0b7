// ---- Models ----

typedef enum { SRBF_KIND_PM, SRBF_KIND_SU, SRBF_KIND_GGX, SRBF_KIND_OPENPBR } srbf_kind;
typedef struct {
    srbf_kind kind;
    int is_exchanged, has_film, is_anisotropic;
    srbf_form pm;
    const float* lobes;
    srbf_view_lobes su;
    srbf_vec3 diffuse;
    srbf_GgxLobe ggx[2];
    srbf_OpenPbrSurface surface;
    srbf_OpenPbrFilm film;
    srbf_OpenPbrAnisotropy anisotropy;
} srbf_model;

static const char* const srbf_truths[] = {"true", "false", 0};

static srbf_vec3 srbf_spherical(float theta, float phi) {
    return srbf_vec3_of(sinf(theta) * cosf(phi), sinf(theta) * sinf(phi), cosf(theta));
}
static srbf_vec3 srbf_numbers(const srbf_file* file, const srbf_tensor* tensor, size_t i) {
    return srbf_vec3_of(srbf_number(file, tensor, i), srbf_number(file, tensor, i + 1),
                        srbf_number(file, tensor, i + 2));
}

// The next number of a text of wavelengths [nm], which blanks separate; 0 if there is none or it is malformed.
static float srbf_wavelength(const unsigned char** text, const unsigned char* end) {
    float x = 0.0f, unit = 0.0f;
    while (*text < end && **text == ' ') ++*text;
    for (; *text < end && **text != ' '; ++*text) {
        if (**text == '.' && unit == 0.0f) {
            unit = 1.0f;
        } else {
            if (**text < '0' || **text > '9' || x > 1.0e9f) return 0.0f;
            x = 10.0f * x + (float)(**text - '0'), unit *= 10.0f;
        }
    }
    return x / srbf_max(unit, 1.0f);
}
// The place of a number of lobe j among the rows of its group.
static int srbf_place(int j, int row, int rows) { return (j / 8 * rows + row) * 8 + j % 8; }

// Adds to the colours of lobes their spectra, which are linear between the wavelengths of a text: a sample counts by a
// hat function, which is constant beyond the first and the last. R, G, B of white light are linear between rows of
// srbf_observer.
static int srbf_add_spectra(srbf_file* file, const srbf_tensor* spectra, srbf_word text, float* rgb, int rows) {
    const size_t count = spectra->extent[1];
    const unsigned char* end = text.text + text.length;
    float before = 0.0f, at = srbf_wavelength(&text.text, end), after;
    size_t i, j;
    int nm, c;
    for (i = 0; i < count; ++i, before = at, at = after) {
        double weight[3] = {0, 0, 0};
        after = i + 1 < count ? srbf_wavelength(&text.text, end) : 0.0f;
        if (!(at >= 100.0f && at <= 1.0e5f && (i == 0 || at > before))) break;
        for (nm = SRBF_FIRST_NM; nm <= SRBF_LAST_NM; ++nm) {
            const float x = (float)nm, share = (float)((nm - SRBF_FIRST_NM) % 5) / 5.0f;
            const int row = 3 * ((nm - SRBF_FIRST_NM) / 5), next = nm < SRBF_LAST_NM ? row + 3 : row;
            const int is_constant = x < at ? i == 0 : i + 1 == count;
            const float hat = is_constant ? 1.0f : 1.0f - (x - at) / ((x < at ? before : after) - at);
            for (c = 0; c < 3 && hat > 0.0f; ++c)
                weight[c] +=
                    (double)(hat * ((1.0f - share) * srbf_observer[row + c] + share * srbf_observer[next + c]));
        }
        for (j = 0; j < spectra->extent[0]; ++j)
            for (c = 0; c < 3; ++c)
                rgb[srbf_place((int)j, 1 + c, rows)] +=
                    (float)(1e-6 * weight[c]) * srbf_number(file, spectra, j * count + i);
    }
    return (i == count && srbf_wavelength(&text.text, end) == 0.0f && text.text == end) ||
           srbf_fail_at(file, SRBF_BAD_METADATA, text);
}

static int srbf_read_pm(srbf_file* file, const char* prefix, srbf_model* model) {
    static const char* const forms[] = {"source", "horizon", "extended", "reciprocal", 0};
    const float log2_e = 1.44269504f;
    const int form = srbf_choice(file, prefix, "form", forms, SRBF_BAD_METADATA);
    const int axial = srbf_choice(file, prefix, "axial", srbf_truths, SRBF_BAD_METADATA) == 0;
    const int is_spectral = srbf_metadata(file, prefix, "wavelengths");
    const srbf_word waves = file->word;
    const srbf_tensor *coefficient, *bandwidth, *parameterization, *scale = 0, *centre = 0, *exponent = 0;
    srbf_form* pm = &model->pm;
    size_t lobes, variates, features, channels = 3, j, n, k;
    float* number;
    int rows;
    if (file->error || !srbf_shape(file, prefix, "bandwidth", &lobes, &variates, 1024, SRBF_MOST_VARIATES)) return 0;
    if (is_spectral && !srbf_shape(file, prefix, "coefficient", &lobes, &channels, 1024, 4096)) return 0;
    features = form == 0 ? 0 : form == 1 ? 1 : 4;
    coefficient = srbf_need(file, prefix, "coefficient", lobes, channels, 0, 0.0f, SRBF_MOST);
    bandwidth = srbf_need(file, prefix, "bandwidth", lobes, variates, 0, axial ? -SRBF_MOST : 0.0f, SRBF_MOST);
    parameterization = srbf_need(file, prefix, "parameterization", variates, 2, 0, -SRBF_MOST, SRBF_MOST);
    if (features || srbf_find(file, prefix, "log_scale"))
        scale = srbf_need(file, prefix, "log_scale", lobes, 0, 0, -SRBF_MOST, SRBF_MOST);
    if (!axial) centre = srbf_need(file, prefix, "centre", lobes, variates, 2, -SRBF_MOST, SRBF_MOST);
    if (features) exponent = srbf_need(file, prefix, "exponent", lobes, features, 0, -SRBF_MOST, SRBF_MOST);
    if (file->error) return 0;
    pm->lobes = (int)lobes, pm->variates = (int)variates, pm->features = (int)features;
    pm->axial = axial, pm->reciprocal = form == 3, rows = srbf_rows(*pm);
    model->lobes = number =
        (float*)srbf_take(file, (SRBF_FIRST_ROW + (lobes + 7) / 8 * 8 * (size_t)rows) * sizeof *number);
    for (n = 0; n < variates; ++n) {
        const float a = srbf_number(file, parameterization, 2 * n), b = srbf_number(file, parameterization, 2 * n + 1);
        if (a == 0.0f && b == 0.0f) return srbf_fail(file, SRBF_BAD_NUMBER, parameterization->begin);
        if (!number) continue;
        number[n] = a, number[16 + n] = b;
        if (pm->reciprocal) number[variates + n] = b, number[16 + variates + n] = a;
    }
    if (!number) return !file->error;
    number += SRBF_FIRST_ROW;
    for (j = 0; j < lobes; ++j) {
        float* lobe = number + srbf_place((int)j, 0, rows);
        if (scale) lobe[0] = log2_e * srbf_number(file, scale, j);
        for (k = 0; k < 3 && !is_spectral; ++k) lobe[8 * (1 + k)] = srbf_number(file, coefficient, 3 * j + k);
        for (k = 0; k < features; ++k) {
            lobe[8 * (4 + k)] = log2_e * srbf_number(file, exponent, features * j + k);
            if (k == 0 && lobe[32] < 0.0f) return srbf_fail(file, SRBF_BAD_NUMBER, exponent->begin);
        }
        for (n = 0; n < variates; ++n) {
            const size_t i = j * variates + n;
            const float falloff = -0.5f * log2_e * srbf_number(file, bandwidth, i);
            float* of = lobe + 8 * (4 + (int)features + (int)n * srbf_rows_of_variate(*pm));
            if (axial) {
                of[0] = srbf_min(falloff, 0.0f), of[8] = srbf_min(-falloff, 0.0f);
            } else {
                const srbf_vec3 xi =
                    srbf_spherical(srbf_number(file, centre, 2 * i), srbf_number(file, centre, 2 * i + 1));
                of[0] = falloff, of[8] = xi.x, of[16] = xi.y, of[24] = xi.z;
            }
        }
    }
    return !is_spectral || srbf_add_spectra(file, coefficient, waves, number, rows);
}

static int srbf_read_su(srbf_file* file, const char* prefix, srbf_model* model) {
    static const char* const sampled[] = {"view", "light", 0};
    static const char* const interpolations[] = {"rotated", "plain", 0};
    static const char* const neighbours[] = {"1", "2", "3", "4", "5", "6", "7", 0};
    const srbf_tensor *coefficient, *bandwidth, *centre, *shape = 0;
    srbf_view_lobes* su = &model->su;
    size_t views, lobes, i, j;
    float* number;
    su->of_lights = srbf_choice(file, prefix, "discretise", sampled, SRBF_BAD_METADATA);
    su->is_plain = srbf_choice(file, prefix, "interpolation", interpolations, SRBF_BAD_METADATA);
    su->neighbours = srbf_choice(file, prefix, "neighbours", neighbours, SRBF_BAD_METADATA) + 1;
    if (file->error || !srbf_shape(file, prefix, "bandwidth", &views, &lobes, 8192, 64)) return 0;
    coefficient = srbf_need(file, prefix, "coefficient", views, lobes, 3, 0.0f, SRBF_MOST);
    bandwidth = srbf_need(file, prefix, "bandwidth", views, lobes, 0, 0.0f, SRBF_MOST);
    centre = srbf_need(file, prefix, "centre", views, lobes, 2, -SRBF_MOST, SRBF_MOST);
    if (srbf_find(file, prefix, "shape"))
        shape = srbf_need(file, prefix, "shape", views, lobes, 0, -SRBF_MOST, SRBF_MOST);
    if (views < 8 && !file->error) srbf_fail_at(file, SRBF_BAD_TENSOR, bandwidth->name);
    if (file->error) return 0;
    su->views = (int)views, su->lobes = (int)lobes;
    su->number = number = (float*)srbf_take(file, views * (3 + 8 * lobes) * sizeof *number);
    for (i = 0; number && i < views;
         ++i) {  // the Fibonacci set of the hemisphere, and angles relative to the mirror direction
        const double z = ((double)i + 0.5) / (double)views, r = sqrt(1.0 - z * z), phi = 2.3999632297286533 * (double)i;
        const float theta0 = atan2f((float)r, (float)z), phi0 = atan2f(-(float)(r * sin(phi)), -(float)(r * cos(phi)));
        *number++ = (float)(r * cos(phi)), *number++ = (float)(r * sin(phi)), *number++ = (float)z;
        for (j = i * lobes; j < (i + 1) * lobes; ++j, number += 8) {
            const srbf_vec3 beta = srbf_numbers(file, coefficient, 3 * j);
            const srbf_vec3 xi =
                srbf_spherical(theta0 + srbf_number(file, centre, 2 * j), phi0 + srbf_number(file, centre, 2 * j + 1));
            number[0] = beta.x, number[1] = beta.y, number[2] = beta.z, number[3] = srbf_number(file, bandwidth, j);
            number[4] = xi.x, number[5] = xi.y, number[6] = xi.z,
            number[7] = shape ? srbf_number(file, shape, j) : 0.0f;
        }
    }
    return !file->error;
}

static int srbf_read_ggx(srbf_file* file, const char* prefix, srbf_model* model) {
    const srbf_tensor *roughness, *diffuse, *f0, *f90;
    size_t lobes, none, i;
    if (!srbf_shape(file, prefix, "roughness", &lobes, &none, 2, 0)) return 0;
    roughness = srbf_need(file, prefix, "roughness", lobes, 0, 0, 1.0f / 1024.0f, 1.0f);
    diffuse = srbf_need(file, prefix, "diffuse", 3, 0, 0, 0.0f, SRBF_MOST);
    f0 = srbf_need(file, prefix, "facing", lobes, 3, 0, 0.0f, SRBF_MOST);
    f90 = srbf_need(file, prefix, "grazing", lobes, 0, 0, 0.0f, SRBF_MOST);
    if (file->error) return 0;
    model->diffuse = srbf_numbers(file, diffuse, 0), model->ggx[1].roughness = 1.0f;
    for (i = 0; i < lobes; ++i) {
        model->ggx[i].roughness = srbf_number(file, roughness, i), model->ggx[i].f90 = srbf_number(file, f90, i);
        model->ggx[i].f0 = srbf_numbers(file, f0, 3 * i);
    }
    return 1;
}

static int srbf_read_openpbr(srbf_file* file, const char* prefix, srbf_model* model) {
    float p[3 * SRBF_PARAMETERS];
    int i, c, n = 0;
    model->is_exchanged = srbf_choice(file, prefix, "exchanged_surface", srbf_truths, SRBF_BAD_METADATA) == 0;
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
    const int kind = srbf_choice(file, prefix, "model", kinds, SRBF_OTHER_KIND);
    if (kind < 0) return 0;
    model->kind = kind < 4 ? (srbf_kind)kind : SRBF_KIND_OPENPBR;
    return model->kind == SRBF_KIND_PM    ? srbf_read_pm(file, prefix, model)
           : model->kind == SRBF_KIND_SU  ? srbf_read_su(file, prefix, model)
           : model->kind == SRBF_KIND_GGX ? srbf_read_ggx(file, prefix, model)
                                          : srbf_read_openpbr(file, prefix, model);
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

// f(wl, wv) of a multivariate model. The forms that fits have by default have constant sizes.
SRBF_APART srbf_vec3 srbf_pm_value(const srbf_model* model, const srbf_vec3* wl, const srbf_vec3* wv) {
    const srbf_form form = model->pm;
#ifndef __OPTIMIZE_SIZE__
    const srbf_form usual = {form.lobes, 3, 4, 1, 1}, measured = {form.lobes, 4, 4, 1, 0};
    if (form.axial && form.features == 4 && form.reciprocal && form.variates == 3)
        return srbf_lobes_value(usual, model->lobes, *wl, *wv);
    if (form.axial && form.features == 4 && !form.reciprocal && form.variates == 4)
        return srbf_lobes_value(measured, model->lobes, *wl, *wv);
#endif
    return srbf_lobes_value(form, model->lobes, *wl, *wv);
}

// f(wl, wv) of any other model above the horizon.
SRBF_APART srbf_vec3 srbf_other_value(const srbf_model* model, srbf_vec3 wl, srbf_vec3 wv) {
    const srbf_vec3 l = model->is_exchanged ? wv : wl, v = model->is_exchanged ? wl : wv;
    if (model->kind == SRBF_KIND_SU) {
        const srbf_vec3 evaluated = model->su.of_lights ? wv : wl, sampled = model->su.of_lights ? wl : wv;
        int nearest[8];
        if (!model->su.is_plain) return srbf_su_rotated_value(&model->su, evaluated, sampled);
        srbf_find_nearest(&model->su, sampled, nearest);
        return srbf_su_plain_value(&model->su, nearest, evaluated, sampled, model->su.neighbours);
    }
    if (model->kind == SRBF_KIND_GGX) return srbf_ggx_value(model->diffuse, model->ggx[0], model->ggx[1], wl, wv);
#ifndef __OPTIMIZE_SIZE__
    if (!model->is_anisotropic && !model->has_film) return srbf_openpbr_value(model->surface, l, v);
#endif
    return srbf_openpbr_anisotropic_value(model->surface, model->film, model->anisotropy, l, v);
}
