// ---- Densities ----

// A mixture of components of kernel.glsl's proposal, whose weights are linear in sqrt(cos(theta_v)) between nodes.
// Components have slots: lobes of directions, from 8 on lobes of half vectors, then facets, the cosine and its square.
// After these follow the stretch and power of half-vector lobes. A segment lies between two nodes, and has the lobes
// that have weight there in its first slots.
#define SRBF_NODES 13
#define SRBF_SLOTS 8
#define SRBF_FACET_SLOT (2 * SRBF_SLOTS)
#define SRBF_COSINE_SLOT (2 * SRBF_SLOTS + 2)
#define SRBF_STRETCH (2 * SRBF_SLOTS + 4)
#define SRBF_NUMBERS (3 * SRBF_SLOTS)
#define SRBF_ALBEDO_NODES 33
typedef struct {
    int directions, halves;
    float bandwidth[SRBF_SLOTS], scale[SRBF_SLOTS], half_bandwidth[SRBF_SLOTS], weighted[SRBF_SLOTS];
    float number[2][SRBF_NUMBERS];
} srbf_segment;
typedef struct {
    srbf_segment segment[SRBF_NODES - 1];
    int facets;
    srbf_Facets facet[2];
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

// A segment for a view, with its interpolated numbers and its half-vector lobes.
typedef struct {
    const srbf_mixture* mixture;
    const srbf_segment* segment;
    srbf_vec3 wv;
    float number[SRBF_NUMBERS];
    srbf_x_Stretch map;
    srbf_x_ProposalLobe half[SRBF_SLOTS / SRBF_LANES];
} srbf_view;

static void srbf_set_view(srbf_view* view, const srbf_mixture* mixture, const srbf_segment* segment, srbf_vec3 wv,
                          float beyond) {
    const srbf_x_vec3 v = srbf_x_all(wv);
    int i;
    view->mixture = mixture, view->segment = segment, view->wv = wv;
    for (i = 0; i < SRBF_NUMBERS; i += SRBF_LANES) {
        const srbf_x low = srbf_x_load(segment->number[0] + i), high = srbf_x_load(segment->number[1] + i);
        srbf_x_store(low + srbf_x_of(beyond) * (high - low), view->number + i);
    }
    view->map = srbf_x_stretch_along(v, srbf_x_of(view->number[SRBF_STRETCH]));
    for (i = 0; i < segment->halves; i += SRBF_LANES)
        view->half[i / SRBF_LANES] = srbf_x_half_vector_lobe(
            srbf_x_stretched(v, view->map), view->map.inverse, srbf_x_load(segment->half_bandwidth + i),
            srbf_x_of(view->number[SRBF_STRETCH + 1]) * srbf_x_load(segment->weighted + i));
}
static void srbf_view_of(srbf_view* view, const srbf_mixture* mixture, srbf_vec3 wv) {
    const float at = (1.0f - sqrtf(srbf_min(wv.z, 1.0f))) * (float)(SRBF_NODES - 1);
    const int below = (int)srbf_min(at, (float)(SRBF_NODES - 2));
    srbf_set_view(view, mixture, &mixture->segment[below], wv, at - (float)below);
}

// The density of a direction, and unless `density` is null those of all slots.
SRBF_FN float srbf_view_pdf(const srbf_view* view, srbf_vec3 wl, float* density) {
    const srbf_segment* segment = view->segment;
    const srbf_x_vec3 l = srbf_x_all(wl), v = srbf_x_all(view->wv), mirrored = srbf_x_vec3_of(l.x, l.y, -l.z);
    const float cosines[2] = {wl.z * 0.318309886f, wl.z * wl.z * 0.477464829f};
    srbf_x sum = srbf_x_of(0.0f), each;
    srbf_x_HalfVector above, below;
    float pdf;
    int i;
    above.direction = l, below.direction = mirrored, above.factor = below.factor = srbf_x_of(1.0f);
    for (i = 0; i < segment->directions; i += SRBF_LANES) {
        srbf_x_ProposalLobe lobe;
        lobe.centre = srbf_x_vec3_of(-v.x, -v.y, v.z), lobe.bandwidth = srbf_x_load(segment->bandwidth + i);
        lobe.scale = srbf_x_load(segment->scale + i), lobe.width = lobe.rest = sum;  // which no density reads
        each = srbf_x_reflected_pdf(lobe, above, below);
        sum = sum + srbf_x_load(view->number + i) * each;
        if (density) srbf_x_store(each, density + i);
    }
    if (segment->halves > 0) {
        above = srbf_x_half_vector(l, v, view->map), below = srbf_x_half_vector(mirrored, v, view->map);
        for (i = 0; i < segment->halves; i += SRBF_LANES) {
            each = srbf_x_reflected_pdf(view->half[i / SRBF_LANES], above, below);
            sum = sum + srbf_x_load(view->number + SRBF_SLOTS + i) * each;
            if (density) srbf_x_store(each, density + SRBF_SLOTS + i);
        }
    }
    pdf = srbf_x_sum(sum);
    for (i = 0; i < 2; ++i) {
        pdf += view->number[SRBF_COSINE_SLOT + i] * cosines[i];
        if (density) density[SRBF_COSINE_SLOT + i] = cosines[i];
    }
    for (i = 0; i < view->mixture->facets; ++i) {
        const float facets = srbf_facets_pdf(wl, view->wv, view->mixture->facet[i]);
        pdf += view->number[SRBF_FACET_SLOT + i] * facets;
        if (density) density[SRBF_FACET_SLOT + i] = facets;
    }
    return pdf;
}

static float srbf_lane(srbf_x x, int i) {
    float all[SRBF_LANES];
    srbf_x_store(x, all);
    return all[i];
}
// A direction of a slot; z <= 0 if there is none.
static srbf_vec3 srbf_slot_sample(const srbf_view* view, int slot, float u1, float u2) {
    const srbf_vec3 v = view->wv, up = srbf_vec3_of(0.0f, 0.0f, 1.0f);
    const int half = slot - SRBF_SLOTS, i = half / SRBF_LANES, lane = half % SRBF_LANES,
              cosine = slot - SRBF_COSINE_SLOT;
    if (cosine >= 0) return srbf_off_centre(up, srbf_below_power_cosine(1.0f / (float)(2 + cosine), u1), u2);
    if (slot >= SRBF_FACET_SLOT) return srbf_sample_facets(v, view->mixture->facet[slot - SRBF_FACET_SLOT], u1, u2);
    if (half >= 0) {
        const srbf_x_ProposalLobe* lobe = &view->half[i];
        const srbf_vec3 centre = srbf_vec3_of(srbf_lane(lobe->centre.x, lane), srbf_lane(lobe->centre.y, lane),
                                              srbf_lane(lobe->centre.z, lane));
        const srbf_vec3 h = srbf_sample_sharp_vmf(centre, srbf_lane(lobe->width, lane), 0.0f, u1, u2);
        return srbf_reflected_up(
            srbf_light_of(srbf_grown_along(h, v.x, v.y, srbf_lane(view->map.stretch_minus_1, 0)), v));
    } else {
        const float bandwidth = view->segment->bandwidth[slot], rest = expf(srbf_max(-2.0f * bandwidth, -60.0f));
        return srbf_reflected_up(srbf_sample_sharp_vmf(srbf_vec3_of(-v.x, -v.y, v.z), 1.0f / bandwidth, rest, u1, u2));
    }
}
// A direction of the slot that a selector chooses.
static srbf_vec3 srbf_view_sample(const srbf_view* view, float u1, float u2, float selector) {
    int slot, chosen = SRBF_COSINE_SLOT;
    for (slot = 0; slot < SRBF_STRETCH; ++slot) {
        if (view->number[slot] > 0.0f) chosen = slot;
        if (selector < view->number[slot]) break;
        selector -= view->number[slot];
    }
    return srbf_slot_sample(view, chosen, u1, u2);
}
