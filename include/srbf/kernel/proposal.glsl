// Sampling of the light.

// The density max(z, 0) / pi [1/sr], and a direction sampled from it with u1, u2 uniform in [0,1).
SRBF_FN Real cosine_pdf(Vec3 wl) { return max(wl.z, Real(0.0)) * Real(2.0 / SRBF_TWO_PI); }
SRBF_FN Vec3 sample_cosine(Real u1, Real u2) {
    Real radius = sqrt(u1);
    Real phi = Real(SRBF_TWO_PI) * u2;
    return Vec3(radius * cos(phi), radius * sin(phi), sqrt(max(Real(1.0) - u1, Real(0.0))));
}

// The densities max(z, 0) / pi and 3 max(z, 0)^2 / (2 pi) [1/sr] as one function, with power 1 and 2, and a
// direction sampled from it: z = u1^width with width = 1 / (power + 1).
SRBF_FN Real power_cosine_pdf(Vec3 wl, Real power) {
    Real z = max(wl.z, Real(0.0));
    return (power + Real(1.0)) * Real(1.0 / SRBF_TWO_PI) * z * select(Real(1.0) < power, z, Real(1.0));
}
SRBF_FN Real below_power_cosine(Real width, Real u1) {
    return min(exp(sample_below(width, Real(0.0), u1)), Real(1.0)) - Real(1.0);
}

// A map that multiplies the component of directions along a tangent of the surface, the unit vector t along (x, y):
// M = I + (stretch - 1) t t^T. stretch_minus_1 and inverse_minus_1 are divided by x^2 + y^2; inverse is 1 /
// stretch. With (x, y) = (0, 0) it is the identity.
struct Stretch {
    Real x;
    Real y;
    Real stretch_minus_1;
    Real inverse_minus_1;
    Real inverse;
};
SRBF_FN Stretch stretch_along(Vec3 tangent, Real stretch) {
    Stretch map;
    map.x = tangent.x;
    map.y = tangent.y;
    Real reciprocal = Real(1.0) / max(tangent.x * tangent.x + tangent.y * tangent.y, Real(1.0e-20));
    map.inverse = Real(1.0) / stretch;
    map.stretch_minus_1 = (stretch - Real(1.0)) * reciprocal;
    map.inverse_minus_1 = (map.inverse - Real(1.0)) * reciprocal;
    return map;
}
SRBF_FN Vec3 grown_along(Vec3 w, Real x, Real y, Real gain) {
    Real along = gain * (w.x * x + w.y * y);
    return Vec3(w.x + along * x, w.y + along * y, w.z);
}
SRBF_FN Vec3 stretched(Vec3 w, Stretch map) { return grown_along(w, map.x, map.y, map.stretch_minus_1); }

// A lobe G(g . z | lambda) of directions g, which a map M takes to half vectors h along M g. It is weighted by a
// power of their visibility: G(g . z | lambda) (M g . wv)^power. With viewer = M wv, M g . wv is g . viewer. If its
// logarithm is linearised about the direction where the product is largest, this is again a lobe, along lambda z +
// sharpness viewer. For small angles, that direction is tilted from the normal by t with
// lambda t = power stretch / (wv.z + stretch t).
SRBF_FN GaussianProduct visible_lobe(Vec3 viewer, Real inverse, Real bandwidth, Real power) {
    Real z = max(viewer.z, Real(0.0));
    Real sharpness = Real(2.0) * power /
                     max(z + sqrt(z * z + Real(4.0) * power / (inverse * inverse * bandwidth)), Real(1.0e-6));
    return gaussian_product(Vec3(Real(0.0), Real(0.0), Real(1.0)), bandwidth, viewer, sharpness);
}

// For half vectors h from a stretched lobe: the unstretched direction g = M^-1 h / |M^-1 h|, and the factor that
// converts the lobe's density there to the density of wl, 1 / (stretch |M^-1 h|^3) / (4 |h . wl|), where 2 |h . wl| =
// |wl + wv|. h is above the horizon: where wl + wv is below it, h is opposite. Where wl = -wv there is no half vector,
// and the factor is 0.
struct HalfVector {
    Vec3 direction;
    Real factor;
};
SRBF_FN HalfVector half_vector(Vec3 wl, Vec3 wv, Stretch map) {
    Vec3 sum = wl + wv;
    Real squared = dot(sum, sum);
    Vec3 back = grown_along(sum, map.x, map.y, map.inverse_minus_1);
    Real reciprocal = inversesqrt(max(dot(back, back), Real(1.0e-20)));
    HalfVector h;
    h.direction = (select(sum.z < Real(0.0), Real(-1.0), Real(1.0)) * reciprocal) * back;
    Real exists = select(Real(1.0e-12) < squared, Real(0.5), Real(0.0)) * map.inverse;
    h.factor = (exists * squared) * (reciprocal * reciprocal * reciprocal);
    return h;
}

// The light direction wl that a facet with the normal h, of any length, reflects to the viewer, also if it faces away
// from the viewer. The result is the zero vector where h.z <= 0.
SRBF_FN Vec3 light_of(Vec3 h, Vec3 wv) {
    Real twice = Real(2.0) * dot(h, wv) / max(dot(h, h), Real(1.0e-20));
    return select(Real(0.0) < h.z, Real(1.0), Real(0.0)) * (twice * h - wv);
}

// Facets with GGX's distribution of normals, by the symmetric matrix M = ((xx, xy), (xy, yy)), whose eigenvalues are
// their roughness along a tangent and across it.
struct Facets {
    Real xx;
    Real xy;
    Real yy;
};
SRBF_FN Facets facets_along(Real cosine, Real sine, Real along, Real across) {
    Facets facets;
    facets.xx = along * cosine * cosine + across * sine * sine;
    facets.xy = (along - across) * cosine * sine;
    facets.yy = along * sine * sine + across * cosine * cosine;
    return facets;
}
SRBF_FN Vec3 roughened_by(Facets facets, Vec3 w) {
    return Vec3(facets.xx * w.x + facets.xy * w.y, facets.xy * w.x + facets.yy * w.y, w.z);
}

// The density of wl [1/sr] if h is sampled from the normals visible to the viewer: D(h) G1(wv) / (4 cos(theta_v)) =
// D(h) / (2 (cos(theta_v) + |M wv|)) (Heitz, "Sampling the GGX Distribution of Visible Normals", JCGT 2018).
SRBF_FN Real visible_normals_pdf(Vec3 wl, Vec3 wv, Facets facets) {
    Vec3 sum = wl + wv;
    Real product = facets.xx * facets.yy - facets.xy * facets.xy;
    Vec3 back = Vec3(facets.yy * sum.x - facets.xy * sum.y, facets.xx * sum.y - facets.xy * sum.x, product * sum.z);
    Real slope = max(dot(back, back) / (product * max(dot(sum, sum), Real(1.0e-12))), Real(1.0e-10));
    Vec3 seen = roughened_by(facets, wv);
    Real density = product / (Real(SRBF_TWO_PI) * slope * slope * (wv.z + sqrt(dot(seen, seen))));
    return select(Real(1.0e-6) < sum.z, density, Real(0.0));
}

// Samples visible_normals_pdf, by a spherical cap about the viewer (Dupuy & Benyoub, "Sampling Visible GGX Normals with
// Spherical Caps", 2023).
SRBF_FN Vec3 sample_visible_normals(Vec3 wv, Facets facets, Real u1, Real u2) {
    Vec3 seen = roughened_by(facets, wv);
    seen = inversesqrt(max(dot(seen, seen), Real(1.0e-20))) * seen;
    Real phi = Real(SRBF_TWO_PI) * u2;
    Real z = (Real(1.0) - u1) * (Real(1.0) + seen.z) - seen.z;
    Real radius = sqrt(max(Real(1.0) - z * z, Real(0.0)));
    Vec3 normal = Vec3(seen.x + radius * cos(phi), seen.y + radius * sin(phi), seen.z + z);
    return light_of(roughened_by(facets, normal), wv);
}

// Facets as components of a mixture: directions below the horizon are reflected to above it, so that no sample is lost.
SRBF_FN Vec3 reflected_up(Vec3 wl) { return Vec3(wl.x, wl.y, max(wl.z, -wl.z)); }
SRBF_FN Vec3 sample_facets(Vec3 wv, Facets facets, Real u1, Real u2) {
    return reflected_up(sample_visible_normals(wv, facets, u1, u2));
}
SRBF_FN Real facets_pdf(Vec3 wl, Vec3 wv, Facets facets) {
    return visible_normals_pdf(wl, wv, facets) + visible_normals_pdf(Vec3(wl.x, wl.y, -wl.z), wv, facets);
}

// Components of a mixture that covers any reflective BRDF.
// Components of directions to the light are 0: the cosine; 1: its square; 2 to 7: lobes around the mirror
// direction, with lambda = 4, 16, 64, 256 and, for highlights narrower than any half-vector lobe, 8 4^6 and 8 4^7.
// Directions of these lobes below the horizon are reflected to above it, so that no sample is lost.
// Components of half vectors are 8 to 15: lobes with lambda = 8, 32, .. 8 4^7, stretched, and weighted by a power
// of their visibility.
#define SRBF_PROPOSAL_LOBES 16
#define SRBF_FIRST_HALF_VECTOR_LOBE 8
// Where a view is between the nodes of a mixture, from 0 at the normal to 1 at cos(theta_v) = 0.1^4 and below.
SRBF_FN Real mixture_position(Real z) {
    Real root = sqrt(sqrt(max(z, Real(0.0))));
    return min(max(Real(1.0) - root, Real(0.0)) * Real(1.0 / 0.9), Real(1.0));
}
// Its inverse, cos(theta_v).
SRBF_FN Real mixture_cosine(Real position) {
    Real root = Real(1.0) - Real(0.9) * position;
    return (root * root) * (root * root);
}
SRBF_FN Real proposal_bandwidth(int k) {
    int power = k < 6 ? k - 1 : k < 8 ? k : k - 8;
    Real bandwidth = k < 6 ? Real(1.0) : Real(8.0);
    for (int i = 0; i < power; ++i) bandwidth = Real(4.0) * bandwidth;
    return bandwidth;
}
// Common subexpressions of the components' densities at (wl, wv): wl above the horizon and mirrored at it, with
// their half vectors.
struct ProposalPoint {
    Vec3 wl;
    Vec3 mirrored;
    Vec3 specular;
    Vec3 viewer;
    Real inverse;
    Real power;
    HalfVector above;
    HalfVector below;
};
SRBF_FN ProposalPoint proposal_point(Vec3 wl, Vec3 wv, Stretch map, Real power) {
    ProposalPoint terms;
    terms.wl = wl;
    terms.mirrored = Vec3(wl.x, wl.y, -wl.z);
    terms.specular = Vec3(-wv.x, -wv.y, wv.z);
    terms.viewer = stretched(wv, map);
    terms.inverse = map.inverse;
    terms.power = power;
    terms.above = half_vector(wl, wv, map);
    terms.below = half_vector(terms.mirrored, wv, map);
    return terms;
}
// A component that is a lobe: its density is scale G, width is 1 / lambda and rest e^(-2 lambda).
struct ProposalLobe {
    Vec3 centre;
    Real bandwidth;
    Real width;
    Real scale;
    Real rest;
};
SRBF_FN ProposalLobe mirror_lobe(Vec3 specular, Real bandwidth) {
    ProposalLobe lobe;
    lobe.centre = specular;
    lobe.bandwidth = bandwidth;
    lobe.width = Real(1.0) / bandwidth;
    lobe.scale = Real(1.0) / gaussian_integral(bandwidth);
    lobe.rest = exp_of_lobe(Real(-2.0) * bandwidth);
    return lobe;
}
// A lobe as visible from the viewer is at least as narrow as the lobe itself. With lambda >= 8, e^(-2 lambda) is at
// most 1.2e-7 and is replaced by 0.
SRBF_FN ProposalLobe half_vector_lobe(Vec3 viewer, Real inverse, Real bandwidth, Real power) {
    GaussianProduct product = visible_lobe(viewer, inverse, bandwidth, power);
    ProposalLobe lobe;
    lobe.centre = product.centre;
    lobe.bandwidth = product.bandwidth;
    lobe.width = product.width;
    lobe.scale = product.bandwidth * Real(1.0 / SRBF_TWO_PI);
    lobe.rest = Real(0.0);
    return lobe;
}
// Its density [1/sr] for a direction sampled at `above`, or sampled at `below` and then reflected.
SRBF_FN Real reflected_pdf(ProposalLobe lobe, HalfVector above, HalfVector below) {
    return lobe.scale * (gaussian(above.direction, lobe.centre, lobe.bandwidth) * above.factor +
                         gaussian(below.direction, lobe.centre, lobe.bandwidth) * below.factor);
}
// The equivalent of half_vector for a component that samples the direction itself.
SRBF_FN HalfVector itself(Vec3 direction) {
    HalfVector h;
    h.direction = direction;
    h.factor = Real(1.0);
    return h;
}
// The density of component k [1/sr]; wl is above the horizon.
SRBF_FN Real proposal_lobe_pdf(int k, ProposalPoint terms) {
    Real bandwidth = proposal_bandwidth(k);
    if (k >= SRBF_FIRST_HALF_VECTOR_LOBE)
        return reflected_pdf(half_vector_lobe(terms.viewer, terms.inverse, bandwidth, terms.power),
                             terms.above, terms.below);
    if (k > 1) return reflected_pdf(mirror_lobe(terms.specular, bandwidth), itself(terms.wl), itself(terms.mirrored));
    return power_cosine_pdf(terms.wl, k == 0 ? Real(1.0) : Real(2.0));
}
// Samples component k from u1, u2 uniform in [0,1). z = 0 if there is no direction.
SRBF_FN Vec3 sample_proposal_lobe(int k, Vec3 wv, Stretch map, Real power, Real u1, Real u2) {
    Real below = below_power_cosine(k == 0 ? Real(0.5) : Real(1.0 / 3.0), u1);
    Vec3 wl = off_centre(Vec3(Real(0.0), Real(0.0), Real(1.0)), below, u2);
    if (k >= SRBF_FIRST_HALF_VECTOR_LOBE) {
        ProposalLobe lobe =
            half_vector_lobe(stretched(wv, map), map.inverse, proposal_bandwidth(k), power);
        wl = light_of(stretched(sample_sharp_vmf(lobe.centre, lobe.width, lobe.rest, u1, u2), map), wv);
    } else if (k > 1) {
        ProposalLobe lobe = mirror_lobe(Vec3(-wv.x, -wv.y, wv.z), proposal_bandwidth(k));
        wl = sample_sharp_vmf(lobe.centre, lobe.width, lobe.rest, u1, u2);
    }
    return reflected_up(wl);
}
