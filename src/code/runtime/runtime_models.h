// ---- Models ----

typedef enum { SRBF_KIND_PM, SRBF_KIND_SU, SRBF_KIND_GGX, SRBF_KIND_OPENPBR } srbf_kind;
typedef struct {
    srbf_kind kind;
    int is_isotropic, is_exchanged, is_plain;  // plain: a surface without a film and with round facets
    srbf_form pm;
    const float* lobes;
    srbf_view_lobes su;
    srbf_vec3 diffuse;
    srbf_GgxLobe ggx[2];
    srbf_OpenPbrSurface surface;
    srbf_OpenPbrFilm film;
    srbf_OpenPbrAnisotropy anisotropy;
    int facets;
    srbf_Facets facet[2];
} srbf_model;

static srbf_vec3 srbf_spherical(float theta, float phi) {
    return srbf_vec3_of(sinf(theta) * cosf(phi), sinf(theta) * sinf(phi), cosf(theta));
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

static int srbf_read_pm(srbf_file* file, srbf_model* model) {
    const float log2_e = 1.44269504f;
    const int form = srbf_choice(file, "form", "source horizon extended reciprocal ", SRBF_BAD_METADATA);
    const int axial = srbf_choice(file, "axial", "true false ", SRBF_BAD_METADATA) == 0;
    const int is_spectral = srbf_metadata(file, "wavelengths");
    const srbf_word waves = file->word;
    const size_t lobes = srbf_extent(file, "bandwidth", 0, 1024);
    const size_t variates = srbf_extent(file, "bandwidth", 1, SRBF_MOST_VARIATES);
    const size_t channels = is_spectral ? srbf_extent(file, "coefficient", 1, 4096) : 3;
    const size_t features = form == 0 ? 0 : form == 1 ? 1 : 4;
    const srbf_tensor *coefficient, *bandwidth, *parameterization, *scale = 0, *centre = 0, *exponent = 0;
    const srbf_form pm = {(int)lobes, (int)variates, (int)features, axial, form == 3};
    const int rows = srbf_rows(pm);
    size_t j, n, k;
    float* number;
    coefficient = srbf_need(file, "coefficient", lobes, channels, 0, 0.0f, SRBF_MOST);
    bandwidth = srbf_need(file, "bandwidth", lobes, variates, 0, axial ? -SRBF_MOST : 0.0f, SRBF_MOST);
    parameterization = srbf_need(file, "parameterization", variates, 2, 0, -SRBF_MOST, SRBF_MOST);
    if (features || srbf_find(file, "log_scale"))
        scale = srbf_need(file, "log_scale", lobes, 0, 0, -SRBF_MOST, SRBF_MOST);
    if (!axial) centre = srbf_need(file, "centre", lobes, variates, 2, -SRBF_MOST, SRBF_MOST);
    if (features) exponent = srbf_need(file, "exponent", lobes, features, 0, -SRBF_MOST, SRBF_MOST);
    if (file->error) return 0;
    model->pm = pm, model->is_isotropic = axial;
    for (n = 0; n < variates; ++n)
        if (srbf_number(file, parameterization, 2 * n) == 0.0f &&
            srbf_number(file, parameterization, 2 * n + 1) == 0.0f)
            return srbf_fail(file, SRBF_BAD_NUMBER, parameterization->begin);
    for (j = 0; j < lobes && features; ++j)
        if (srbf_number(file, exponent, features * j) < 0.0f) return srbf_fail(file, SRBF_BAD_NUMBER, exponent->begin);
    model->lobes = number =
        (float*)srbf_take(file, (SRBF_FIRST_ROW + (lobes + 7) / 8 * 8 * (size_t)rows) * sizeof *number);
    if (!number) return !file->error;
    for (n = 0; n < variates; ++n) {
        const float a = srbf_number(file, parameterization, 2 * n), b = srbf_number(file, parameterization, 2 * n + 1);
        number[n] = a, number[16 + n] = b;
        if (pm.reciprocal) number[variates + n] = b, number[16 + variates + n] = a;
    }
    number += SRBF_FIRST_ROW;
    for (j = 0; j < lobes; ++j) {
        float* row = number + srbf_place((int)j, 0, rows);
        *row = log2_e * srbf_number(file, scale, j);
        for (k = 0; k < 3; ++k) *(row += 8) = is_spectral ? 0.0f : srbf_number(file, coefficient, 3 * j + k);
        for (k = 0; k < features; ++k) *(row += 8) = log2_e * srbf_number(file, exponent, features * j + k);
        for (n = j * variates; n < (j + 1) * variates; ++n) {
            const float falloff = -0.5f * log2_e * srbf_number(file, bandwidth, n);
            const srbf_vec3 xi = srbf_spherical(srbf_number(file, centre, 2 * n), srbf_number(file, centre, 2 * n + 1));
            *(row += 8) = srbf_min(falloff, 0.0f);
            *(row += 8) = axial ? srbf_min(-falloff, 0.0f) : xi.x;
            if (!axial) row[8] = xi.y, row[16] = xi.z, row += 16;
        }
    }
    return !is_spectral || srbf_add_spectra(file, coefficient, waves, number, rows);
}

static int srbf_read_su(srbf_file* file, srbf_model* model) {
    srbf_view_lobes* su = &model->su;
    const size_t views = srbf_extent(file, "bandwidth", 0, 8192), lobes = srbf_extent(file, "bandwidth", 1, 64);
    const srbf_tensor *coefficient, *bandwidth, *centre;
    size_t i, j;
    float* number;
    su->of_lights = srbf_choice(file, "discretise", "view light ", SRBF_BAD_METADATA);
    su->is_plain = srbf_choice(file, "interpolation", "rotated plain ", SRBF_BAD_METADATA);
    su->neighbours = srbf_choice(file, "neighbours", "1 2 3 4 5 6 7 ", SRBF_BAD_METADATA) + 1;
    su->views = (int)views, su->lobes = (int)lobes, model->is_isotropic = !su->is_plain;
    coefficient = srbf_need(file, "coefficient", views, lobes, 3, 0.0f, SRBF_MOST);
    bandwidth = srbf_need(file, "bandwidth", views, lobes, 0, 0.0f, SRBF_MOST);
    centre = srbf_need(file, "centre", views, lobes, 2, -SRBF_MOST, SRBF_MOST);
    if (views < 8) srbf_fail_tensor(file, bandwidth);
    if (file->error) return 0;
    su->number = number = (float*)srbf_take(file, views * (3 + 7 * lobes) * sizeof *number);
    // Views are the Fibonacci set of the hemisphere, and angles are relative to the mirror direction.
    for (i = 0; number && i < views; ++i) {
        const double z = ((double)i + 0.5) / (double)views, r = sqrt(1.0 - z * z), phi = 2.3999632297286533 * (double)i;
        const float theta0 = atan2f((float)r, (float)z), phi0 = atan2f(-(float)(r * sin(phi)), -(float)(r * cos(phi)));
        *number++ = (float)(r * cos(phi)), *number++ = (float)(r * sin(phi)), *number++ = (float)z;
        for (j = i * lobes; j < (i + 1) * lobes; ++j, number += 7) {
            const float theta = theta0 + srbf_number(file, centre, 2 * j);
            const srbf_vec3 beta = srbf_numbers(file, coefficient, 3 * j);
            const srbf_vec3 xi = srbf_spherical(theta, phi0 + srbf_number(file, centre, 2 * j + 1));
            memcpy(number, &beta, sizeof beta), number[3] = srbf_number(file, bandwidth, j);
            memcpy(number + 4, &xi, sizeof xi);
        }
    }
    return !file->error;
}

static int srbf_read_ggx(srbf_file* file, srbf_model* model) {
    const size_t lobes = srbf_extent(file, "roughness", 0, 2);
    const srbf_tensor *diffuse = srbf_need(file, "diffuse", 3, 0, 0, 0.0f, SRBF_MOST),
                      *roughness = srbf_need(file, "roughness", lobes, 0, 0, 1.0f / 1024.0f, 1.0f),
                      *f0 = srbf_need(file, "facing", lobes, 3, 0, 0.0f, SRBF_MOST),
                      *f90 = srbf_need(file, "grazing", lobes, 0, 0, 0.0f, SRBF_MOST);
    size_t i;
    if (file->error) return 0;
    model->diffuse = srbf_numbers(file, diffuse, 0), model->is_isotropic = 1, model->facets = 2;
    for (i = 0; i < 2; ++i) {
        const float alpha = i < lobes ? srbf_number(file, roughness, i) : 1.0f;
        model->ggx[i].roughness = alpha, model->facet[i] = srbf_facets_along(1.0f, 0.0f, alpha, alpha);
        if (i == lobes) break;
        model->ggx[i].f0 = srbf_numbers(file, f0, 3 * i), model->ggx[i].f90 = srbf_number(file, f90, i);
    }
    return 1;
}

static int srbf_read_openpbr(srbf_file* file, srbf_model* model) {
    const int has_film = srbf_find(file, "thin_film_weight") != 0;
    const int is_anisotropic = srbf_find(file, "specular_roughness_anisotropy") != 0;
    srbf_OpenPbrSurface* surface = &model->surface;
    srbf_OpenPbrAnisotropy* turned = &model->anisotropy;
    srbf_OpenPbrRoughness base;
    float p[3 * SRBF_PARAMETERS], coat, alpha;
    int i, c, n = 0;
    model->is_exchanged = srbf_choice(file, "exchanged_surface", "true false ", SRBF_BAD_METADATA) == 0;
    model->is_isotropic = !is_anisotropic, model->is_plain = !has_film && !is_anisotropic;
    for (i = 0; i < SRBF_PARAMETERS; ++i) {
        const srbf_parameter* row = &srbf_parameters[i];
        const int is_film = strncmp(row->name, "thin_film_", 10) == 0, is_turned = i >= SRBF_PARAMETERS - 2;
        const int is_stored = is_film ? has_film : is_turned ? is_anisotropic : 1;
        const srbf_tensor* tensor =
            is_stored ? srbf_need(file, row->name, (size_t)row->count, 0, 0, row->least, row->most) : 0;
        for (c = 0; c < row->count; ++c) p[n++] = tensor ? srbf_number(file, tensor, (size_t)c) : row->by_default;
    }
    if (file->error) return 0;
    // The members of the structures are in the order of the parameters, after the weight of the base.
    memcpy(surface, p + 1, sizeof *surface);
    memcpy(&model->film, p + 1 + sizeof *surface / sizeof *p, sizeof model->film);
    surface->base_color = srbf_scale(p[0], surface->base_color);
    turned->amount = p[n - 2];
    turned->cosine = cosf(6.28318531f * p[n - 1]), turned->sine = sinf(6.28318531f * p[n - 1]);
    coat = srbf_alpha_of(surface->coat_roughness);
    alpha = srbf_alpha_of(srbf_roughened(surface->specular_roughness, surface->coat_roughness, surface->coat_weight));
    base = srbf_openpbr_roughness(alpha, turned->amount);
    model->facets = surface->coat_weight > 0.0f ? 2 : 1;
    model->facet[0] = srbf_facets_along(turned->cosine, turned->sine, base.along, base.across);
    model->facet[1] = srbf_facets_along(1.0f, 0.0f, coat, coat);
    return 1;
}

static int srbf_read_model(srbf_file* file, srbf_model* model) {
    static int (*const readers[])(srbf_file*, srbf_model*) = {srbf_read_pm, srbf_read_su, srbf_read_ggx,
                                                              srbf_read_openpbr, srbf_read_openpbr};
    const int kind = srbf_choice(file, "model", "pm su ggx openpbr pbr ", SRBF_OTHER_KIND);
    if (kind < 0) return 0;
    model->kind = kind < 4 ? (srbf_kind)kind : SRBF_KIND_OPENPBR;
    return readers[kind](file, model);
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
    if (model->is_plain) return srbf_openpbr_value(model->surface, l, v);
#endif
    return srbf_openpbr_anisotropic_value(model->surface, model->film, model->anisotropy, l, v);
}
