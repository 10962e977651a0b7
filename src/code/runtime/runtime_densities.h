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
typedef struct {
    int directions, halves;
    float bandwidth[SRBF_SLOTS], scale[SRBF_SLOTS], half_bandwidth[SRBF_SLOTS], weighted[SRBF_SLOTS];
    float number[2][SRBF_NUMBERS];
} srbf_segment;
typedef struct {
    float axis[2];  // the tangent along which half-vector lobes are stretched; 0 for the viewer's
    int facets;
    srbf_Facets facet[2];
    srbf_segment segment[SRBF_NODES - 1];
} srbf_mixture;

// A segment for a view, with its interpolated numbers and its half-vector lobes.
typedef struct {
    const srbf_mixture* mixture;
    const srbf_segment* segment;
    srbf_vec3 wv;
    float number[SRBF_NUMBERS];
    srbf_x_Stretch map;
    srbf_x_ProposalLobe half[SRBF_SLOTS / SRBF_LANES];
} srbf_view;

SRBF_FN void srbf_set_view(srbf_view* view, const srbf_mixture* mixture, const srbf_segment* segment, srbf_vec3 wv,
                          float beyond) {
    const srbf_x_vec3 v = srbf_x_all(wv);
    const int has_axis = mixture->axis[0] != 0.0f || mixture->axis[1] != 0.0f;
    srbf_vec3 tangent;
    int i;
    view->mixture = mixture, view->segment = segment, view->wv = wv;
    for (i = 0; i < SRBF_NUMBERS; i += SRBF_LANES) {
        const srbf_x low = srbf_x_load(segment->number[0] + i), high = srbf_x_load(segment->number[1] + i);
        srbf_x_store(low + srbf_x_of(beyond) * (high - low), view->number + i);
    }
    tangent = has_axis ? srbf_vec3_of(mixture->axis[0], mixture->axis[1], 0.0f) : wv;
    view->map = srbf_x_stretch_along(srbf_x_all(tangent), srbf_x_of(view->number[SRBF_STRETCH]));
    for (i = 0; i < segment->halves; i += SRBF_LANES)
        view->half[i / SRBF_LANES] = srbf_x_half_vector_lobe(
            srbf_x_stretched(v, view->map), view->map.inverse, srbf_x_load(segment->half_bandwidth + i),
            srbf_x_of(view->number[SRBF_STRETCH + 1]) * srbf_x_load(segment->weighted + i));
}
SRBF_FN void srbf_view_of(srbf_view* view, const srbf_mixture* mixture, srbf_vec3 wv) {
    const float at = (1.0f - srbf_sqrt(srbf_max(srbf_min(wv.z, 1.0f), 0.0f))) * (float)(SRBF_NODES - 1);
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

SRBF_FN float srbf_lane(srbf_x x, int i) {
    float all[SRBF_LANES];
    srbf_x_store(x, all);
    return all[i];
}
// A direction of a slot; z <= 0 if there is none.
SRBF_FN srbf_vec3 srbf_slot_sample(const srbf_view* view, int slot, float u1, float u2) {
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
        const srbf_x_Stretch* map = &view->map;
        return srbf_reflected_up(srbf_light_of(
            srbf_grown_along(h, srbf_lane(map->x, 0), srbf_lane(map->y, 0), srbf_lane(map->stretch_minus_1, 0)), v));
    } else {
        const float bandwidth = view->segment->bandwidth[slot], rest = expf(srbf_max(-2.0f * bandwidth, -60.0f));
        return srbf_reflected_up(srbf_sample_sharp_vmf(srbf_vec3_of(-v.x, -v.y, v.z), 1.0f / bandwidth, rest, u1, u2));
    }
}
// A direction of the slot that a selector chooses, the cosines' first.
SRBF_FN srbf_vec3 srbf_view_sample(const srbf_view* view, float u1, float u2, float selector) {
    float running = 0.0f;
    int i, slot = SRBF_COSINE_SLOT;
    for (i = 0; i < SRBF_STRETCH; ++i) {
        const int next = i < 2 ? SRBF_COSINE_SLOT + i : i - 2;
        running += view->number[next];
        if (selector < running) {
            slot = next;
            break;
        }
    }
    return srbf_slot_sample(view, slot, u1, u2);
}
