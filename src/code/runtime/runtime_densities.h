// ---- Densities ----

// A mixture of components of kernel.glsl's proposal, whose weights are linear in sqrt(cos(theta_v)) between nodes. Only those
// with weight are kept: lobes of directions, then lobes of half vectors, each in SRBF_SLOTS slots, then facets.
#define SRBF_NODES 13
#define SRBF_SLOTS 8
#define SRBF_FACET_SLOT (2 * SRBF_SLOTS)
#define SRBF_STRETCH (2 * SRBF_SLOTS + 2)
#define SRBF_NUMBERS (2 * SRBF_SLOTS + 4)
#define SRBF_ALBEDO_NODES 33
typedef struct {
    int component[SRBF_FACET_SLOT], directions, halves, facets;
    srbf_Facets facet[2];
    float bandwidth[SRBF_SLOTS], width[SRBF_SLOTS], scale[SRBF_SLOTS], rest[SRBF_SLOTS], constant[SRBF_SLOTS];
    float linear[SRBF_SLOTS], square[SRBF_SLOTS], half_bandwidth[SRBF_SLOTS], weighted[SRBF_SLOTS];
    float node[SRBF_NODES][SRBF_NUMBERS];  // weights, then stretch and power of half-vector lobes
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

static void srbf_add_component(srbf_mixture* mixture, int k) {
    const int is_half = k >= SRBF_SLOTS, i = is_half ? mixture->halves++ : mixture->directions++;
    mixture->component[is_half ? SRBF_SLOTS + i : i] = k;
    if (is_half) {
        mixture->half_bandwidth[i] = srbf_proposal_bandwidth(k), mixture->weighted[i] = srbf_proposal_power(k, 1.0f);
    } else if (k < 2) {  // powers of the cosine
        mixture->linear[i] = k == 0, mixture->square[i] = k == 1, mixture->width[i] = 1.0f / (float)(k + 2);
        mixture->scale[i] = (float)(k + 2) / 6.28318531f;
    } else {
        const srbf_ProposalLobe lobe = srbf_mirror_lobe(srbf_vec3_of(0.0f, 0.0f, 1.0f), srbf_proposal_bandwidth(k));
        mixture->bandwidth[i] = lobe.bandwidth, mixture->width[i] = lobe.width, mixture->scale[i] = lobe.scale;
        mixture->rest[i] = lobe.rest, mixture->constant[i] = 1.0f;
    }
}
// The cosine alone.
static void srbf_reset(srbf_mixture* mixture) {
    int i;
    mixture->directions = mixture->halves = mixture->facets = 0;
    memset(mixture->bandwidth, 0, sizeof mixture->bandwidth), memset(mixture->constant, 0, sizeof mixture->constant);
    memset(mixture->linear, 0, sizeof mixture->linear), memset(mixture->square, 0, sizeof mixture->square);
    memset(mixture->node, 0, sizeof mixture->node);
    for (i = 0; i < SRBF_SLOTS; ++i) mixture->half_bandwidth[i] = 8.0f;  // of slots without weight
    for (i = 0; i < SRBF_NODES; ++i)
        mixture->node[i][0] = mixture->node[i][SRBF_STRETCH] = mixture->node[i][SRBF_STRETCH + 1] = 1.0f;
    srbf_add_component(mixture, 0);
}

// The numbers of a mixture for a view, interpolated between its nodes.
static void srbf_at_view(const srbf_mixture* mixture, float cosine, float number[SRBF_NUMBERS]) {
    const float at = (1.0f - sqrtf(srbf_min(cosine, 1.0f))) * (float)(SRBF_NODES - 1);
    const int below = (int)srbf_min(at, (float)(SRBF_NODES - 2));
    const srbf_x4 beyond = srbf_x4_of(at - (float)below);
    int i;
    for (i = 0; i < SRBF_NUMBERS; i += SRBF_LANES) {
        const srbf_x4 low = srbf_x4_load(&mixture->node[below][i]), high = srbf_x4_load(&mixture->node[below + 1][i]);
        srbf_x4_store(low + beyond * (high - low), number + i);
    }
}

static float srbf_mixture_pdf(const srbf_mixture* mixture, const float* number, srbf_vec3 wl, srbf_vec3 wv) {
    const srbf_x4_vec3 l = srbf_x4_all(wl), v = srbf_x4_all(wv), mirrored = srbf_x4_vec3_of(l.x, l.y, -l.z);
    srbf_x4 sum = srbf_x4_of(0.0f);
    float pdf;
    int i;
    for (i = 0; i < mixture->directions; i += SRBF_LANES) {
        const srbf_x4 constant = srbf_x4_load(mixture->constant + i);
        srbf_x4_ProposalLobe lobe;
        srbf_x4_HalfVector above, below;
        lobe.centre = srbf_x4_vec3_of(-v.x, -v.y, v.z), lobe.bandwidth = srbf_x4_load(mixture->bandwidth + i);
        lobe.scale = srbf_x4_load(mixture->scale + i), lobe.width = lobe.rest = constant;  // which no density reads
        above.direction = l, below.direction = mirrored, below.factor = constant;
        above.factor = constant + l.z * (srbf_x4_load(mixture->linear + i) + l.z * srbf_x4_load(mixture->square + i));
        sum = sum + srbf_x4_load(number + i) * srbf_x4_reflected_pdf(lobe, above, below);
    }
    if (mixture->halves > 0) {
        const srbf_x4_Stretch map = srbf_x4_stretch_along(v, srbf_x4_of(number[SRBF_STRETCH]));
        const srbf_x4 power = srbf_x4_of(number[SRBF_STRETCH + 1]);
        const srbf_x4_vec3 viewer = srbf_x4_stretched(v, map);
        const srbf_x4_HalfVector above = srbf_x4_half_vector(l, v, map), below = srbf_x4_half_vector(mirrored, v, map);
        for (i = 0; i < mixture->halves; i += SRBF_LANES) {
            const srbf_x4_ProposalLobe lobe =
                srbf_x4_half_vector_lobe(viewer, map.inverse, srbf_x4_load(mixture->half_bandwidth + i),
                                         power * srbf_x4_load(mixture->weighted + i));
            sum = sum + srbf_x4_load(number + SRBF_SLOTS + i) * srbf_x4_reflected_pdf(lobe, above, below);
        }
    }
    pdf = srbf_x4_sum(sum);
    for (i = 0; i < mixture->facets; ++i) pdf += number[SRBF_FACET_SLOT + i] * srbf_facets_pdf(wl, wv, mixture->facet[i]);
    return pdf;
}

// A direction that the selector's component samples; z <= 0 if there is none.
static srbf_vec3 srbf_mixture_sample(const srbf_mixture* mixture, const float* number, srbf_vec3 wv, float u1, float u2,
                                     float selector) {
    int slot, chosen = 0;
    for (slot = 0; slot < SRBF_FACET_SLOT + 2; ++slot) {
        if (number[slot] > 0.0f) chosen = slot;
        if (selector < number[slot]) break;
        selector -= number[slot];
    }
    if (chosen >= SRBF_FACET_SLOT) return srbf_sample_facets(wv, mixture->facet[chosen - SRBF_FACET_SLOT], u1, u2);
    return srbf_sample_proposal_lobe(mixture->component[chosen], wv, srbf_stretch_along(wv, number[SRBF_STRETCH]),
                                     number[SRBF_STRETCH + 1], u1, u2);
}

