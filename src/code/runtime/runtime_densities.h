// A mixture of the components of kernel.glsl's proposal, whose weights are linear in mixture_position(cos(theta_v))
// between nodes: cosines and lobes of directions, from 8 on lobes of half vectors, then facets. After the weights
// follow stretch and power of the half-vector lobes.
#define SRBF_NODES 15
#define SRBF_SLOTS 8
#define SRBF_FACET_SLOT (2 * SRBF_SLOTS)
#define SRBF_STRETCH (2 * SRBF_SLOTS + 2)
#define SRBF_NUMBERS (3 * SRBF_SLOTS)
typedef struct {
    float axis[2];  // the tangent along which half-vector lobes are stretched; 0 for the viewer's
    int facets;
    srbf_Facets facet[2];
    float number[SRBF_NODES][SRBF_NUMBERS];
} srbf_mixture;

// A mixture for a view, with its interpolated numbers and its lobes.
typedef struct {
    const srbf_mixture* mixture;
    srbf_vec3 wv;
    float number[SRBF_NUMBERS];
    srbf_x_Stretch map;
    int has_halves;
    srbf_x_ProposalLobe lobe[SRBF_FACET_SLOT / SRBF_LANES];  // of groups of slots that have weight
} srbf_view;
SRBF_FN int srbf_has_weight(const srbf_view* view, int slot) {
    return srbf_x_sum(srbf_x_load(view->number + slot)) > 0.0f;
}

// Sets what follows from a view's direction and numbers.
SRBF_FN void srbf_set_view(srbf_view* view) {
    const float *slots = srbf_slots(), *axis = view->mixture->axis;
    const int has_axis = axis[0] != 0.0f || axis[1] != 0.0f;
    const srbf_x_vec3 v = srbf_x_all(view->wv),
                      tangent = has_axis ? srbf_x_all(srbf_vec3_of(axis[0], axis[1], 0.0f)) : v;
    const srbf_x power = srbf_x_of(view->number[SRBF_STRETCH + 1]);
    int i;
    view->has_halves = 0;
    view->map = srbf_x_stretch_along(tangent, srbf_x_of(view->number[SRBF_STRETCH]));
    for (i = 0; i < SRBF_SLOTS; i += SRBF_LANES, slots += SRBF_LANES) {
        srbf_x_ProposalLobe* lobe = &view->lobe[i / SRBF_LANES];
        lobe->centre = srbf_x_vec3_of(-v.x, -v.y, v.z), lobe->bandwidth = srbf_x_load(slots);
        lobe->width = srbf_x_load(slots + 8), lobe->scale = srbf_x_load(slots + 16);
        lobe->rest = srbf_x_load(slots + 24);
        if (!srbf_has_weight(view, SRBF_SLOTS + i)) continue;
        view->has_halves = 1;
        lobe[SRBF_SLOTS / SRBF_LANES] =
            srbf_x_half_vector_lobe(srbf_x_stretched(v, view->map), view->map.inverse, srbf_x_load(slots + 56), power);
    }
}
SRBF_FN void srbf_view_of(srbf_view* view, const srbf_mixture* mixture, srbf_vec3 wv) {
    const float at = srbf_mixture_position(wv.z) * (float)(SRBF_NODES - 1);
    const int below = (int)srbf_min(at, (float)(SRBF_NODES - 2));
    const srbf_x beyond = srbf_x_of(at - (float)below);
    const float* number = mixture->number[below];
    int i;
    view->mixture = mixture, view->wv = wv;
    for (i = 0; i < SRBF_NUMBERS; i += SRBF_LANES) {
        const srbf_x low = srbf_x_load(number + i), high = srbf_x_load(number + SRBF_NUMBERS + i);
        srbf_x_store(low + beyond * (high - low), view->number + i);
    }
    srbf_set_view(view);
}

// The density of a direction, and unless `density` is null those of all slots that have weight.
SRBF_FN float srbf_view_pdf(const srbf_view* view, srbf_vec3 wl, float* density) {
    const srbf_x_vec3 l = srbf_x_all(wl), v = srbf_x_all(view->wv), mirrored = srbf_x_vec3_of(l.x, l.y, -l.z);
    const float* slots = srbf_slots();
    float pdf, facets[2] = {0.0f, 0.0f};
    srbf_x_HalfVector above[2], below[2];  // of lobes of directions, and of half vectors
    srbf_x sum = srbf_x_of(0.0f);
    int i;
    above[0].direction = l, below[0].direction = mirrored, above[0].factor = below[0].factor = srbf_x_of(1.0f);
    above[1] = above[0], below[1] = below[0];
    if (view->has_halves) {
        above[1] = srbf_x_half_vector(l, v, view->map);
        below[1] = srbf_x_half_vector(mirrored, v, view->map);
    }
    SRBF_UNROLL
    for (i = 0; i < SRBF_FACET_SLOT; i += SRBF_LANES) {
        if (srbf_has_weight(view, i)) {
            const int kind = i / SRBF_SLOTS;
            srbf_x each;
            if (i < SRBF_SLOTS) {  // the cosines are 0 below the horizon
                below[0].factor = srbf_x_load(slots + 32 + i);
                above[0].factor =
                    below[0].factor + l.z * (srbf_x_load(slots + 40 + i) + l.z * srbf_x_load(slots + 48 + i));
            }
            each = srbf_x_reflected_pdf(view->lobe[i / SRBF_LANES], above[kind], below[kind]);
            sum = sum + srbf_x_load(view->number + i) * each;
            if (density) srbf_x_store(each, density + i);
        }
    }
    pdf = srbf_x_sum(sum);
    for (i = 0; i < view->mixture->facets; ++i) {
        facets[i] = srbf_facets_pdf(wl, view->wv, view->mixture->facet[i]);
        pdf += view->number[SRBF_FACET_SLOT + i] * facets[i];
    }
    if (density) memcpy(density + SRBF_FACET_SLOT, facets, sizeof facets);
    return pdf;
}

SRBF_FN float srbf_lane(srbf_x x, int i) {
    float all[SRBF_LANES];
    srbf_x_store(x, all);
    return all[i];
}
// A direction of a slot; z <= 0 if there is none.
SRBF_FN srbf_vec3 srbf_slot_sample(const srbf_view* view, int slot, float u1, float u2) {
    const int facet = slot - SRBF_FACET_SLOT, lane = slot % SRBF_LANES;
    const srbf_x_ProposalLobe* lobe = &view->lobe[facet < 0 ? slot / SRBF_LANES : 0];
    srbf_vec3 w = srbf_vec3_of(0.0f, 0.0f, 1.0f);
    if (slot < 2) return srbf_off_centre(w, srbf_below_power_cosine(1.0f / (float)(2 + slot), u1), u2);
    if (facet >= 0) return srbf_sample_facets(view->wv, view->mixture->facet[facet], u1, u2);
    w = srbf_vec3_of(srbf_lane(lobe->centre.x, lane), srbf_lane(lobe->centre.y, lane), srbf_lane(lobe->centre.z, lane));
    w = srbf_sample_sharp_vmf(w, srbf_lane(lobe->width, lane), srbf_lane(lobe->rest, lane), u1, u2);
    if (slot >= SRBF_SLOTS) {
        w = srbf_grown_along(w, srbf_lane(view->map.x, 0), srbf_lane(view->map.y, 0),
                             srbf_lane(view->map.stretch_minus_1, 0));
        w = srbf_light_of(w, view->wv);
    }
    return srbf_reflected_up(w);
}
// A direction of the slot that a selector chooses. A rest by rounding is the cosine's.
SRBF_FN srbf_vec3 srbf_view_sample(const srbf_view* view, float u1, float u2, float selector) {
    int slot = 0;
    for (; slot < SRBF_STRETCH && !(selector < view->number[slot]); ++slot) selector -= view->number[slot];
    return srbf_slot_sample(view, slot < SRBF_STRETCH ? slot : 0, u1, u2);
}
