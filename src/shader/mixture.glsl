// Sampling of a BRDF's mixture of proposal lobes, to follow kernel.glsl. What precedes:
//   mixture_weights                 SRBF_PROPOSAL_LOBES weights of each of MIXTURE_NODES nodes, from MIXTURE_FIRST on
//   mixture_stretch()               how many times as wide half-vector lobes are along the grain
//   into_grain(w), out_of_grain(w)  the frame whose x is along the grain

// Between which nodes a view is, and its distance from the lower one, of 1: nodes are uniform in sqrt(1 -
// cos(theta_v)).
struct NodesAbout {
    int below;
    Real beyond;
};
NodesAbout nodes_about(Real cosine, int count) {
    Real at = sqrt(min(max(Real(1.0) - cosine, Real(0.0)), Real(1.0))) * Real(count - 1);
    NodesAbout nodes;
    nodes.below = int(min(at, Real(count - 2)));
    nodes.beyond = at - Real(nodes.below);
    return nodes;
}
Real mixture_weight(int k, NodesAbout nodes) {
    Real below = mixture_weights[SRBF_PROPOSAL_LOBES * nodes.below + k + MIXTURE_FIRST];
    Real above = mixture_weights[SRBF_PROPOSAL_LOBES * (nodes.below + 1) + k + MIXTURE_FIRST];
    return below + nodes.beyond * (above - below);
}

// The lobe that a selector uniform in [0,1) chooses.
int chosen_lobe(Vec3 wv, Real selector) {
    NodesAbout nodes = nodes_about(wv.z, MIXTURE_NODES);
    Real running = Real(0.0);
    int chosen = 0;
    for (int k = 0; k < SRBF_PROPOSAL_LOBES; ++k) {
        running = running + mixture_weight(k, nodes);
        if (running <= selector) chosen = k + 1;
    }
    // What rounding leaves over is the cosine's.
    if (chosen >= SRBF_PROPOSAL_LOBES) chosen = 0;
    return chosen;
}
Vec3 sample_of_lobe(int k, Vec3 wv, Real u1, Real u2) {
    return out_of_grain(sample_proposal_lobe(k, into_grain(wv), mixture_stretch(), u1, u2));
}

// A direction to the light for u1, u2 and selector uniform in [0,1); z <= 0 where the draw has none.
Vec3 sample_light(Vec3 wv, Real u1, Real u2, Real selector) {
    return sample_of_lobe(chosen_lobe(wv, selector), wv, u1, u2);
}

// The density of sample_light [1/sr]; 0 where wl or wv is not above the horizon.
Real light_pdf(Vec3 wl, Vec3 wv) {
    if (wl.z <= Real(0.0) || wv.z <= Real(0.0)) return Real(0.0);
    ProposalPoint at = proposal_point(into_grain(wl), into_grain(wv), mixture_stretch());
    NodesAbout nodes = nodes_about(wv.z, MIXTURE_NODES);
    Real sum = Real(0.0);
    for (int k = 0; k < SRBF_PROPOSAL_LOBES; ++k) sum = sum + mixture_weight(k, nodes) * proposal_lobe_pdf(k, at);
    return sum;
}
