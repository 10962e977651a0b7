// ---- Preparation ----

#define SRBF_ALBEDO_NODES 33
// One of the four parts of a surface: the model that answers for it, and how it is sampled.
typedef struct {
    const srbf_model* model;
    int is_exchanged;
    srbf_mixture* mixture;
    float (*albedo)[3];  // of nodes
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

SRBF_INLINE srbf_vec3 srbf_part_value(const srbf_part* part, srbf_vec3 wl, srbf_vec3 wv) {
    const srbf_vec3 l = part->is_exchanged ? wv : wl, v = part->is_exchanged ? wl : wv;
    return part->model->kind == SRBF_KIND_PM ? srbf_pm_value(part->model, &l, &v) : srbf_other_value(part->model, l, v);
}

// Sets a segment from the numbers at its ends.
static void srbf_set_segment(srbf_segment* segment, const float* low, const float* high) {
    int k;
    memset(segment, 0, sizeof *segment);
    for (k = 0; k < SRBF_SLOTS; ++k) segment->half_bandwidth[k] = 8.0f;  // of slots without weight
    for (k = 0; k < SRBF_NUMBERS; ++k) {
        const int is_half = k >= SRBF_SLOTS;
        int slot = k, i;
        if (k < SRBF_FACET_SLOT) {
            if (!(low[k] > 0.0f || high[k] > 0.0f)) continue;
            i = is_half ? segment->halves++ : segment->directions++;
            slot = is_half ? SRBF_SLOTS + i : i;
            (is_half ? segment->half_bandwidth : segment->bandwidth)[i] = srbf_component(2 * k);
            (is_half ? segment->weighted : segment->scale)[i] = srbf_component(2 * k + 1);
        }
        segment->number[0][slot] = low[k], segment->number[1][slot] = high[k];
    }
}

// Points at a few views about a node, and the densities of all components at them. Each view has as many points.
#define SRBF_MOST_POINTS 1152
typedef struct {
    srbf_segment all;  // of all components
    srbf_vec3 view[8], l[SRBF_MOST_POINTS];
    float weight[SRBF_MOST_POINTS], density[SRBF_MOST_POINTS][SRBF_NUMBERS];
    int views, count, components, slot[SRBF_STRETCH];
} srbf_points;

static float srbf_luminance(const float* rgb) { return 0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2]; }
static float srbf_turns(double x) { return (float)(x - floor(x)); }

// The view of a point, whose half-vector lobes have this stretch and power.
static void srbf_point_view(srbf_points* points, const srbf_mixture* mixture, int i, const float shape[2],
                            srbf_view* view) {
    points->all.number[0][SRBF_STRETCH] = shape[0], points->all.number[0][SRBF_STRETCH + 1] = shape[1];
    srbf_set_view(view, mixture, &points->all, points->view[i], 0.0f);
}
static void srbf_set_densities(srbf_points* points, const srbf_mixture* mixture, const float shape[2]) {
    const int own = points->count / points->views;
    srbf_view view;
    int i;
    for (i = 0; i < points->count; ++i) {
        if (i % own == 0) srbf_point_view(points, mixture, i / own, shape, &view);
        srbf_view_pdf(&view, points->l[i], points->density[i]);
    }
}

// The second moment of f cos(theta_l) / pdf after `steps` multiplicative steps of the weights towards the least one
// (the library's `propose`, srbf/sampling.h).
static float srbf_least_moment(const srbf_points* points, int steps, float weight[SRBF_NUMBERS]) {
    float moment = 0.0f, sum;
    int step, i, k;
    memset(weight, 0, SRBF_NUMBERS * sizeof *weight);
    for (k = 0; k < points->components; ++k) weight[points->slot[k]] = 1.0f / (float)points->components;
    for (step = 0; step <= steps; ++step) {
        float slope[SRBF_NUMBERS] = {0.0f};
        for (i = 0, moment = 0.0f; i < points->count; ++i) {
            const float* density = points->density[i];
            srbf_x pdfs = srbf_x_of(0.0f), share;
            float pdf;
            if (!(points->weight[i] > 0.0f)) continue;
            for (k = 0; k < SRBF_NUMBERS; k += SRBF_LANES)
                pdfs = pdfs + srbf_x_load(weight + k) * srbf_x_load(density + k);
            pdf = srbf_x_sum(pdfs) + 1.0e-15f;
            moment += points->weight[i] / pdf, share = srbf_x_of(points->weight[i] / pdf / pdf);
            for (k = 0; k < SRBF_NUMBERS; k += SRBF_LANES)
                srbf_x_store(srbf_x_load(slope + k) + share * srbf_x_load(density + k), slope + k);
        }
        if (step == steps) break;
        for (k = 0, sum = 0.0f; k < SRBF_STRETCH; ++k) sum += slope[k] = weight[k] * srbf_sqrt(slope[k]);
        for (k = 0; k < SRBF_STRETCH && sum > 0.0f; ++k) weight[k] = slope[k] / sum;
    }
    return moment;
}

// Sets samples of all components in a wide and a narrow shape at the points' views, weighted by the square of
// f cos(theta_l) over its integral.
static void srbf_make_points(const srbf_part* part, srbf_points* points) {
    static const float shapes[2][2] = {{1.0f, 1.0f}, {0.4f, 2.4f}};
    const int draws = SRBF_MOST_POINTS / (points->views * 2 * points->components), own = 2 * points->components * draws;
    double albedo = 0.0;
    srbf_view view;
    int i, k, shape;
    points->count = points->views * own;
    memset(points->density, 0, sizeof points->density), memset(points->weight, 0, sizeof points->weight);
    for (i = 0; i < points->count; ++i) {
        const float u1 = ((float)(i % draws) + 0.5f) / (float)draws,
                    u2 = srbf_turns(0.6180339887 * (i + 7 * (i / draws)));
        if (i % (own / 2) == 0) srbf_point_view(points, part->mixture, i / own, shapes[i / (own / 2) % 2], &view);
        points->l[i] = srbf_slot_sample(&view, points->slot[i / draws % points->components], u1, u2);
    }
    for (shape = 0; shape < 2; ++shape) {
        srbf_set_densities(points, part->mixture, shapes[shape]);
        for (i = 0; i < points->count; ++i)
            for (k = 0; k < points->components; ++k)
                points->weight[i] += (float)draws * points->density[i][points->slot[k]];
    }
    for (i = 0; i < points->count; ++i) {
        const srbf_vec3 l = points->l[i];
        const float density = points->weight[i];
        points->weight[i] = 0.0f;
        if (l.z > 1.0e-6f && density > 0.0f) {
            const srbf_vec3 f = srbf_part_value(part, l, points->view[i / own]);
            const float reflected = srbf_min((0.2126f * f.x + 0.7152f * f.y + 0.0722f * f.z) * l.z, 1.0e12f);
            albedo += (double)(reflected / density), points->weight[i] = reflected * reflected / density;
        }
        if ((i + 1) % own != 0) continue;
        for (k = i + 1 - own; k <= i; ++k)
            points->weight[k] = albedo > 1.0e-12 ? (float)((double)points->weight[k] / (albedo * albedo)) : 0.0f;
        albedo = 0.0;
    }
}

// The numbers of a node: the shape by descent among powers of 0.64, then the weights of least variance.
static void srbf_make_node(const srbf_part* part, srbf_points* points, int is_isotropic, int node,
                           float number[SRBF_NUMBERS]) {
    static const int steps[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    float shape[2] = {1.0f, 1.0f}, least, sum = 0.0f;
    int i, best[2] = {0, node > 0}, is_better = node > 0;
    points->views = is_isotropic ? 3 : 8;
    for (i = 0; i < points->views; ++i) {
        const float at =
            srbf_max(1.0f - ((float)node + (is_isotropic ? ((float)i - 1.0f) / 3.0f : 0.0f)) / 12.0f, 0.03162f);
        const float cosine = srbf_min(at * at, 1.0f);
        points->view[i] = srbf_spherical(acosf(cosine), is_isotropic ? 0.0f : 0.785398163f * (float)i);
    }
    srbf_make_points(part, points);
    srbf_set_densities(points, part->mixture, shape);
    least = srbf_least_moment(points, 15, number);
    while (is_better) {
        const int first = best[0], second = best[1];
        is_better = 0;
        for (i = 0; i < 4; ++i) {
            const int a = first + steps[i][0], b = second + steps[i][1];
            float moment;
            if (a < -6 || a > 6 || b < 0 || b > 5) continue;
            shape[0] = powf(0.64f, (float)a), shape[1] = powf(0.64f, (float)(1 - b));
            srbf_set_densities(points, part->mixture, shape);
            moment = srbf_least_moment(points, 15, number);
            if (moment < 0.998f * least) least = moment, best[0] = a, best[1] = b, is_better = 1;
        }
    }
    shape[0] = powf(0.64f, (float)best[0]), shape[1] = node > 0 ? powf(0.64f, (float)(1 - best[1])) : 1.0f;
    srbf_set_densities(points, part->mixture, shape);
    srbf_least_moment(points, 60, number);
    number[SRBF_COSINE_SLOT] = srbf_max(number[SRBF_COSINE_SLOT], 0.02f);
    for (i = 0; i < SRBF_STRETCH; ++i) {
        if (!(number[i] > 1.0e-2f)) number[i] = 0.0f;
        sum += number[i];
    }
    for (i = 0; i < SRBF_STRETCH; ++i) number[i] /= sum;
    number[SRBF_STRETCH] = shape[0], number[SRBF_STRETCH + 1] = shape[1];
}

static void srbf_part_sample(const srbf_part* part, srbf_vec3 wv, const float u[3], srbf_light* light) {
    srbf_view view;
    srbf_vec3 wl, f;
    srbf_view_of(&view, part->mixture, wv);
    wl = srbf_view_sample(&view, u[0], u[1], u[2]);
    memset(light, 0, sizeof *light);
    light->wl[0] = wl.x, light->wl[1] = wl.y, light->wl[2] = wl.z;
    if (!(wl.z >= 1.17549435e-38f)) return;
    light->pdf = srbf_view_pdf(&view, wl, 0);
    if (!(light->pdf > 0.0f)) {
        light->pdf = 0.0f;
        return;
    }
    f = srbf_scale(wl.z / light->pdf, srbf_part_value(part, wl, wv));
    light->weight[0] = f.x, light->weight[1] = f.y, light->weight[2] = f.z;
}
// Albedos as the means of weights of samples, at four azimuths.
static void srbf_make_albedos(const srbf_part* part) {
    const int draws = 8192;
    int node = 0, i, c;
    float z;
    for (z = 1.0e-6f; node < SRBF_ALBEDO_NODES; ++node) {
        double sum[3] = {0, 0, 0};
        for (; srbf_elevation_coordinate(z) < (float)node / (float)(SRBF_ALBEDO_NODES - 1); z *= 1.0002f) {
        }
        z = srbf_min(z, 1.0f);
        for (i = 0; i < draws; ++i) {
            const float u[3] = {srbf_turns(0.8191725134 * i), srbf_turns(0.6710436067 * i),
                                srbf_turns(0.5497004779 * i)};
            srbf_light light;
            srbf_part_sample(part, srbf_spherical(acosf(z), 1.57079633f * (float)(i % 4)), u, &light);
            for (c = 0; c < 3; ++c) sum[c] += (double)light.weight[c];
        }
        for (c = 0; c < 3; ++c) part->albedo[node][c] = (float)(sum[c] / draws);
    }
}
static void srbf_part_albedo(const srbf_part* part, float cosine, float rgb[3]) {
    const float at = srbf_elevation_coordinate(cosine) * (float)(SRBF_ALBEDO_NODES - 1);
    const int below = (int)srbf_min(at, (float)(SRBF_ALBEDO_NODES - 2));
    int c;
    for (c = 0; c < 3; ++c) {
        const float first = part->albedo[below][c];
        rgb[c] = first + (at - (float)below) * (part->albedo[below + 1][c] - first);
    }
}

static void srbf_set_facets(const srbf_model* model, srbf_mixture* mixture) {
    int i;
    mixture->facets = 0;
    if (model->kind == SRBF_KIND_GGX) {
        mixture->facets = 2;
        for (i = 0; i < 2; ++i)
            mixture->facet[i] = srbf_facets_along(1.0f, 0.0f, model->ggx[i].roughness, model->ggx[i].roughness);
    } else if (model->kind == SRBF_KIND_OPENPBR) {
        const srbf_OpenPbrSurface* of = &model->surface;
        const float coat = srbf_alpha_of(of->coat_roughness);
        const float alpha = srbf_alpha_of(srbf_roughened(of->specular_roughness, of->coat_roughness, of->coat_weight));
        const srbf_OpenPbrRoughness base = srbf_openpbr_roughness(alpha, model->anisotropy.amount);
        mixture->facets = of->coat_weight > 0.0f ? 2 : 1;
        mixture->facet[0] =
            srbf_facets_along(model->anisotropy.cosine, model->anisotropy.sine, base.along, base.across);
        mixture->facet[1] = srbf_facets_along(1.0f, 0.0f, coat, coat);
    }
}
// Sets the cosine alone.
static void srbf_reset(srbf_mixture* mixture) {
    float number[SRBF_NUMBERS] = {0.0f};
    int i;
    number[SRBF_COSINE_SLOT] = number[SRBF_STRETCH] = number[SRBF_STRETCH + 1] = 1.0f;
    for (i = 0; i < SRBF_NODES - 1; ++i) srbf_set_segment(&mixture->segment[i], number, number);
}
static void srbf_prepare_part(const srbf_part* part, srbf_points* points) {
    const srbf_model* model = part->model;
    const int is_isotropic =
        model->kind == SRBF_KIND_PM ? model->pm.axial : !model->su.is_plain && !model->is_anisotropic;
    float number[2][SRBF_NUMBERS];
    int node, k;
    srbf_set_facets(model, part->mixture);
    memset(number, 0, sizeof number);
    for (k = points->components = 0; k < SRBF_STRETCH; ++k)
        if (k < SRBF_FACET_SLOT ? srbf_component(2 * k) > 0.0f
                                : k >= SRBF_COSINE_SLOT || k < SRBF_FACET_SLOT + part->mixture->facets)
            points->slot[points->components++] = k, number[0][k] = 1.0f;
    srbf_set_segment(&points->all, number[0], number[0]);
    for (node = 0; node < SRBF_NODES; ++node) {
        srbf_make_node(part, points, is_isotropic, node, number[node % 2]);
        if (node > 0) srbf_set_segment(&part->mixture->segment[node - 1], number[(node + 1) % 2], number[node % 2]);
    }
    srbf_make_albedos(part);
}
