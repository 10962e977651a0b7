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

