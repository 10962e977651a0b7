// Samples a mixture of proposal lobes. This text follows kernel.glsl, and requires:
//   mixture_number(node, i)  number i of a node of MIXTURE_NODES, which are uniform in mixture_position(cos(theta_v)):
//                            the weights of MIXTURE_COMPONENTS components, of which those after SRBF_PROPOSAL_LOBES are
//                            facets; then stretch and power of the half-vector lobes; then the matrices (xx, xy, yy) of
//                            facets
//   mixture_tangent(wv)      the tangent along which these lobes are stretched, of any length

// The position of a coordinate from 0 to 1 between two of `count` nodes.
struct NodesAbout {
    int below;
    Real beyond;
};
NodesAbout nodes_about(Real coordinate, int count) {
    Real at = min(max(coordinate, Real(0.0)), Real(1.0)) * Real(count - 1);
    NodesAbout nodes;
    nodes.below = int(min(at, Real(count - 2)));
    nodes.beyond = at - Real(nodes.below);
    return nodes;
}
NodesAbout mixture_nodes(Vec3 wv) { return nodes_about(mixture_position(wv.z), MIXTURE_NODES); }
Real mixture_between(int i, NodesAbout nodes) {
    Real below = mixture_number(nodes.below, i);
    Real above = mixture_number(nodes.below + 1, i);
    return below + nodes.beyond * (above - below);
}

Facets mixture_facets(int k) {
    int first = MIXTURE_COMPONENTS + 2 + 3 * (k - SRBF_PROPOSAL_LOBES);
    Facets facets;
    facets.xx = mixture_number(0, first);
    facets.xy = mixture_number(0, first + 1);
    facets.yy = mixture_number(0, first + 2);
    return facets;
}

// The component that a selector uniform in [0,1) chooses.
int chosen_lobe(Vec3 wv, Real selector) {
    NodesAbout nodes = mixture_nodes(wv);
    Real running = Real(0.0);
    int chosen = 0;
    for (int k = 0; k < MIXTURE_COMPONENTS; ++k) {
        running = running + mixture_between(k, nodes);
        if (running <= selector) chosen = k + 1;
    }
    // Rounding errors of the shares go to the cosine.
    if (chosen >= MIXTURE_COMPONENTS) chosen = 0;
    return chosen;
}
// The shape of half-vector lobes.
Stretch mixture_stretch(Vec3 wv, NodesAbout nodes) {
    return stretch_along(mixture_tangent(wv), mixture_between(MIXTURE_COMPONENTS, nodes));
}
Real mixture_power(NodesAbout nodes) { return mixture_between(MIXTURE_COMPONENTS + 1, nodes); }
Vec3 sample_of_lobe(int k, Vec3 wv, Real u1, Real u2) {
    if (SRBF_PROPOSAL_LOBES < MIXTURE_COMPONENTS && k >= SRBF_PROPOSAL_LOBES)
        return sample_facets(wv, mixture_facets(k), u1, u2);
    NodesAbout nodes = mixture_nodes(wv);
    return sample_proposal_lobe(k, wv, mixture_stretch(wv, nodes), mixture_power(nodes), u1, u2);
}

// A direction to the light for u1, u2 and selector uniform in [0,1). The sample is lost if z <= 0.
Vec3 sample_light(Vec3 wv, Real u1, Real u2, Real selector) {
    return sample_of_lobe(chosen_lobe(wv, selector), wv, u1, u2);
}

// The density of these samples [1/sr]; 0 if wl or wv is not above the horizon, or has a NaN.
Real light_pdf(Vec3 wl, Vec3 wv) {
    if (!(Real(0.0) < wl.z && Real(0.0) < wv.z && dot(wl, wl) + dot(wv, wv) < Real(1.0e30))) return Real(0.0);
    NodesAbout nodes = mixture_nodes(wv);
    ProposalPoint at = proposal_point(wl, wv, mixture_stretch(wv, nodes), mixture_power(nodes));
    Real sum = Real(0.0);
    for (int k = 0; k < SRBF_PROPOSAL_LOBES; ++k) {
        Real weight = mixture_between(k, nodes);
        if (Real(0.0) < weight) sum = sum + weight * proposal_lobe_pdf(k, at);
    }
    for (int k = SRBF_PROPOSAL_LOBES; k < MIXTURE_COMPONENTS; ++k)
        sum = sum + mixture_between(k, nodes) * facets_pdf(wl, wv, mixture_facets(k));
    return sum;
}
