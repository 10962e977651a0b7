// ---- Preparation ----

#define SRBF_ALBEDO_NODES 33
#define SRBF_MOST_POINTS 1152
// One of the four parts of a surface: the model that answers for it, and how it is sampled.
typedef struct {
    const srbf_model* model;
    int is_exchanged;
    srbf_mixture mixture;
    srbf_vec3 albedo[SRBF_ALBEDO_NODES];
} srbf_part;
typedef struct {
    int rings;
    const float *theta, *azimuths, *share;
} srbf_beam;
// Points at a few views about a node, and the densities of all components at them. Each view has as many points.
typedef struct {
    srbf_vec3 view[8], l[SRBF_MOST_POINTS];
    float weight[SRBF_MOST_POINTS], density[SRBF_MOST_POINTS][SRBF_NUMBERS];
    int views, each, count, components;
} srbf_points;
struct srbf_brdf {
    int is_two_sided;
    srbf_model model[4];
    srbf_part part[4];  // reflection at the front and the back, transmission of light from the front and from the back
    srbf_beam beam[4];
    srbf_points* points;
};

SRBF_INLINE srbf_vec3 srbf_part_value(const srbf_part* part, srbf_vec3 wl, srbf_vec3 wv) {
    const srbf_vec3 l = part->is_exchanged ? wv : wl, v = part->is_exchanged ? wl : wv;
    return part->model->kind == SRBF_KIND_PM ? srbf_pm_value(part->model, &l, &v) : srbf_other_value(part->model, l, v);
}
static float srbf_luminance(srbf_vec3 f) { return 0.2126f * f.x + 0.7152f * f.y + 0.0722f * f.z; }
static float srbf_turns(double x) { return (float)(x - floor(x)); }

// A view where all slots have weight, and half-vector lobes this stretch and power.
static void srbf_set_shape(srbf_view* view, const srbf_mixture* mixture, srbf_vec3 wv, const float shape[2]) {
    int k;
    for (k = 0; k < SRBF_NUMBERS; ++k) view->number[k] = 1.0f;
    memcpy(view->number + SRBF_STRETCH, shape, 2 * sizeof *shape);
    view->mixture = mixture, view->wv = wv;
    srbf_set_view(view);
}
static void srbf_set_densities(srbf_points* points, const srbf_mixture* mixture, const float shape[2]) {
    srbf_view view;
    int i;
    for (i = 0; i < points->count; ++i) {
        if (i % points->each == 0) srbf_set_shape(&view, mixture, points->view[i / points->each], shape);
        srbf_view_pdf(&view, points->l[i], points->density[i]);
    }
}

// The second moment of f cos(theta_l) / pdf after `steps` multiplicative steps of the weights towards the least one
// (the library's `propose`, srbf/sampling.h).
static float srbf_least_moment(const srbf_points* points, int steps, float weight[SRBF_NUMBERS]) {
    float moment = 0.0f, sum;
    int step, i, k;
    memset(weight, 0, SRBF_NUMBERS * sizeof *weight);
    for (k = 0; k < points->components; ++k) weight[k] = 1.0f / (float)points->components;
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
    static const float shapes[2][2] = {{1.0f, 1.0f}, {0.2f, 2.4f}};
    const int draws = SRBF_MOST_POINTS / (points->views * 2 * points->components), half = points->components * draws;
    double albedo = 0.0;
    srbf_view view;
    int i, k, shape;
    points->each = 2 * half, points->count = points->views * points->each;
    memset(points->density, 0, sizeof points->density), memset(points->weight, 0, sizeof points->weight);
    for (i = 0; i < points->count; ++i) {
        const float u1 = ((float)(i % draws) + 0.5f) / (float)draws;
        const float u2 = srbf_turns(0.6180339887 * (i + 7 * (i / draws)));
        if (i % half == 0) srbf_set_shape(&view, &part->mixture, points->view[i / points->each], shapes[i / half % 2]);
        points->l[i] = srbf_slot_sample(&view, i / draws % points->components, u1, u2);
    }
    for (shape = 0; shape < 2; ++shape) {
        srbf_set_densities(points, &part->mixture, shapes[shape]);
        for (i = 0; i < points->count; ++i)
            for (k = 0; k < points->components; ++k) points->weight[i] += (float)draws * points->density[i][k];
    }
    for (i = 0; i < points->count; ++i) {
        const srbf_vec3 l = points->l[i];
        const float density = points->weight[i];
        points->weight[i] = 0.0f;
        if (l.z > 1.0e-6f && density > 0.0f) {
            const srbf_vec3 f = srbf_part_value(part, l, points->view[i / points->each]);
            const float reflected = srbf_min(srbf_luminance(f) * l.z, 1.0e12f);
            albedo += (double)(reflected / density), points->weight[i] = reflected * reflected / density;
        }
        if ((i + 1) % points->each != 0) continue;
        for (k = i + 1 - points->each; k <= i; ++k)
            points->weight[k] = albedo > 1.0e-12 ? (float)((double)points->weight[k] / (albedo * albedo)) : 0.0f;
        albedo = 0.0;
    }
}

// The stretch 0.64^a and the power 0.64^(1 - b), from the steps a, b.
static void srbf_shape_of(const int at[2], float shape[2]) {
    shape[0] = powf(0.64f, (float)at[0]), shape[1] = powf(0.64f, (float)(1 - at[1]));
}
// The numbers of a node: the shape by descent, then the weights of least variance.
static void srbf_make_node(srbf_part* part, srbf_points* points, int node) {
    float *number = part->mixture.number[node], shape[2], least, moment, sum = 0.0f;
    int i, move, best[2] = {0, 1}, is_better = node > 0;
    points->views = part->model->is_isotropic ? 3 : 8;
    for (i = 0; i < points->views; ++i) {
        const float apart = points->views == 3 ? ((float)i - 1.0f) / 3.0f : 0.0f;
        const float at = srbf_min(srbf_max(((float)node + apart) / (float)(SRBF_NODES - 1), 0.0f), 1.0f);
        const float phi = points->views == 3 ? 0.0f : 0.785398163f * (float)i;
        points->view[i] = srbf_spherical(acosf(srbf_mixture_cosine(at)), phi);
    }
    srbf_make_points(part, points);
    srbf_shape_of(best, shape);
    srbf_set_densities(points, &part->mixture, shape);
    least = srbf_least_moment(points, 15, number);
    while (is_better) {
        const int centre[2] = {best[0], best[1]};
        is_better = 0;
        for (move = 0; move < 4; ++move) {  // stretch or power up or down
            int at[2] = {centre[0], centre[1]};
            at[move % 2] += move / 2 ? 1 : -1;
            if (at[0] < -2 || at[0] > 10 || at[1] < 0 || at[1] > 7) continue;
            srbf_shape_of(at, shape);
            srbf_set_densities(points, &part->mixture, shape);
            moment = srbf_least_moment(points, 15, number);
            if (moment < 0.998f * least) least = moment, memcpy(best, at, sizeof best), is_better = 1;
        }
    }
    srbf_shape_of(best, shape);
    if (node == 0) shape[0] = shape[1] = 1.0f;
    srbf_set_densities(points, &part->mixture, shape);
    srbf_least_moment(points, 60, number);
    number[0] = srbf_max(number[0], 0.02f);
    for (i = 0; i < SRBF_STRETCH; ++i) {
        if (!(number[i] > 1.0e-2f)) number[i] = 0.0f;
        sum += number[i];
    }
    for (i = 0; i < SRBF_STRETCH; ++i) number[i] /= sum;
    memcpy(number + SRBF_STRETCH, shape, sizeof shape);
}

static void srbf_part_sample(const srbf_part* part, srbf_vec3 wv, const float u[3], srbf_light* light) {
    srbf_view view;
    srbf_vec3 wl, f;
    srbf_view_of(&view, &part->mixture, wv);
    wl = srbf_view_sample(&view, u[0], u[1], u[2]);
    memcpy(light->wl, &wl, sizeof wl);
    if (wl.z >= 1.17549435e-38f) light->pdf = srbf_max(srbf_view_pdf(&view, wl, 0), 0.0f);
    if (!(light->pdf > 0.0f)) return;
    f = srbf_scale(wl.z / light->pdf, srbf_part_value(part, wl, wv));
    memcpy(light->weight, &f, sizeof f);
}
// Albedos as the means of weights of samples, at four azimuths. Their nodes are uniform in
// t = sqrt(1 - sqrt(1 - cos(theta_v))), so that they are dense at the horizon and at the normal.
static void srbf_make_albedos(srbf_part* part) {
    const int draws = 8192;
    int node, i;
    for (node = 0; node < SRBF_ALBEDO_NODES; ++node) {
        const float t = (float)node / (float)(SRBF_ALBEDO_NODES - 1);
        const float cosine = srbf_max(t * t * (2.0f - t * t), 1.0e-6f);
        double sum[3] = {0, 0, 0};
        for (i = 0; i < draws; ++i) {
            const float u[3] = {srbf_turns(0.8191725134 * i), srbf_turns(0.6710436067 * i),
                                srbf_turns(0.5497004779 * i)};
            srbf_light light;
            memset(&light, 0, sizeof light);
            srbf_part_sample(part, srbf_spherical(acosf(cosine), 1.57079633f * (float)(i % 4)), u, &light);
            sum[0] += (double)light.weight[0], sum[1] += (double)light.weight[1], sum[2] += (double)light.weight[2];
        }
        part->albedo[node] = srbf_vec3_of((float)(sum[0] / draws), (float)(sum[1] / draws), (float)(sum[2] / draws));
    }
}
static srbf_vec3 srbf_part_albedo(const srbf_part* part, float cosine) {
    const float t = srbf_sqrt(1.0f - srbf_sqrt(1.0f - srbf_min(cosine, 1.0f)));
    const float at = t * (float)(SRBF_ALBEDO_NODES - 1);
    const int below = (int)srbf_min(at, (float)(SRBF_ALBEDO_NODES - 2));
    return srbf_interpolated(part->albedo[below], part->albedo[below + 1], at - (float)below);
}

static void srbf_prepare_part(srbf_part* part, srbf_points* points) {
    const srbf_model* model = part->model;
    int node;
    part->mixture.facets = model->facets, points->components = SRBF_FACET_SLOT + model->facets;
    memcpy(part->mixture.facet, model->facet, sizeof model->facet);
    for (node = 0; node < SRBF_NODES; ++node) srbf_make_node(part, points, node);
    srbf_make_albedos(part);
}
