// The mathematics of srbf, written once in the common subset of GLSL 4.50, GLSL ES 3.00 and C++.
//
// The host defines before including it
//   Real, Vec3, Bool        a number, a vector of three components, a truth value (GLSL: float, vec3, bool)
//   SRBF_FN                 a prefix for functions (GLSL: nothing; C++: static)
//   select(Bool, Real, Real)  the second argument where the first holds, otherwise the third
//   Pm                      a handle of a multivariate model with the functions
//     pm_lobes(pm), pm_variates(pm)          J, N                            [int, N <= SRBF_MAX_VARIATES]
//     pm_weight_l(pm, n), pm_weight_v(pm, n) a_n, b_n of variate n
//     pm_centre(pm, j, n), pm_log2_falloff(pm, j, n)  xi_jn (unit vector), lambda_jn log2(e) / 2 >= 0
//     pm_axial(pm), pm_down(pm, j, n)        whether every centre is +z or -z; whether this one is -z  [bool]
//     pm_coefficient(pm, j), pm_log2_scale(pm, j)  beta_j (R, G, B), s_j log2(e)
//     pm_features(pm), pm_exponent(pm, j, k)       F [int, <= SRBF_TERMS], kappa_jk log2(e)
//   Su                      a handle of a view-by-view model with the functions
//     su_lobes(su), su_views(su)             J, n                            [int]
//     su_direction(su, i)                    the direction of sampled view i (unit vector; z rises with i)
//     su_centre(su, i, j), su_bandwidth(su, i, j), su_coefficient(su, i, j)   xi_ij, lambda_ij, beta_ij (R, G, B)
//     su_shape(su, i, j)                     tau_ij or -alpha_ij, 0 where the model has neither
//   SuNearest               a handle of the sampled views nearest to a direction with the function
//     su_nearest(nearest, k)                 the k-th nearest, from 0 on     [int]
// No branch depends on a value, so that Real may be a SIMD batch. The exception is the choice of sampled views
// (su_rotated_..., su_plain_...), which works on one pair of directions. Directions are unit vectors; wl points to the
// light, wv to the viewer, the shading normal is +z. Angles are in radians.

#define SRBF_MAX_VARIATES 8
#define SRBF_TWO_PI 6.283185307179586

// ---- Stable elementary functions ---------------------------------------------------------------------------------

// e^x, with x clamped to at least -60 (9e-27). Products of it with coefficients of lobes then stay in the range of
// normal floats; arithmetic on subnormal numbers is many times slower.
SRBF_FN Real exp_of_lobe(Real x) { return exp(max(x, Real(-60.0))); }

// 1 - exp(-x) for x >= 0, without cancellation: relative error 3e-7 in float, 5e-8 in double.
SRBF_FN Real one_minus_exp(Real x) {
    Real small = x * (Real(1.0) - x * Real(0.5) * (Real(1.0) - x * Real(1.0 / 3.0) *
                 (Real(1.0) - x * Real(0.25) * (Real(1.0) - x * Real(0.2)))));
    return select(x < Real(0.125), small, Real(1.0) - exp_of_lobe(-x));
}

// The vector with coordinates (x, y, z) in the frame whose third axis is the unit vector n (Duff et al., "Building an
// Orthonormal Basis, Revisited", JCGT 2017).
SRBF_FN Vec3 from_frame(Vec3 n, Real x, Real y, Real z) {
    Real sign = select(n.z < Real(0.0), Real(-1.0), Real(1.0));
    Real a = Real(-1.0) / (sign + n.z);
    Real b = n.x * n.y * a;
    return x * Vec3(Real(1.0) + sign * n.x * n.x * a, sign * b, -sign * n.x) +
           y * Vec3(b, sign + n.y * n.y * a, -n.y) + z * n;
}

// ---- Gaussian SRBF -----------------------------------------------------------------------------------------------

// The exponent of a Gaussian SRBF: lambda (omega . xi - 1) = -lambda |omega - xi|^2 / 2. The second form is more
// accurate in float: at lambda = 1e4, where G >= e^-4, the relative error of G is 2.2e-5; with the first form it is
// 1.6e-3.
SRBF_FN Real gaussian_exponent(Vec3 omega, Vec3 centre, Real bandwidth) {
    Vec3 d = omega - centre;
    return Real(-0.5) * bandwidth * dot(d, d);
}

// G(omega . xi | lambda) = exp(lambda (omega . xi - 1)), lambda >= 0. It is 1 at the centre xi, and at least e^-60.
SRBF_FN Real gaussian(Vec3 omega, Vec3 centre, Real bandwidth) {
    return exp_of_lobe(gaussian_exponent(omega, centre, bandwidth));
}

// The integral of G over the sphere: 2 pi (1 - e^(-2 lambda)) / lambda [sr]. At lambda = 0 it is 4 pi within 1e-6.
SRBF_FN Real gaussian_integral(Real bandwidth) {
    Real positive = max(bandwidth, Real(1.0e-6));
    return Real(SRBF_TWO_PI) * one_minus_exp(Real(2.0) * positive) / positive;
}

struct GaussianProduct {
    Vec3 centre;
    Real bandwidth;
    Real width;
    Real scale;
};

// G(omega.xi1 | l1) G(omega.xi2 | l2) = scale G(omega.centre | bandwidth), where bandwidth centre = l1 xi1 + l2 xi2 and
// scale = exp(bandwidth - l1 - l2). The width is 1 / bandwidth. The centre is the zero vector if the bandwidth is 0.
SRBF_FN GaussianProduct gaussian_product(Vec3 centre1, Real bandwidth1, Vec3 centre2, Real bandwidth2) {
    Vec3 axis = bandwidth1 * centre1 + bandwidth2 * centre2;
    Vec3 apart = centre1 - centre2;
    Real sum = bandwidth1 + bandwidth2;
    Real squared = dot(axis, axis);
    GaussianProduct product;
    product.width = inversesqrt(max(squared, Real(1.0e-30)));
    product.bandwidth = squared * product.width;
    product.centre = product.width * axis;
    product.scale = exp(-bandwidth1 * bandwidth2 * dot(apart, apart) / max(product.bandwidth + sum, Real(1.0e-20)));
    return product;
}

// ---- von Mises-Fisher --------------------------------------------------------------------------------------------

// The density of the von Mises-Fisher distribution, G over its integral [1/sr].
SRBF_FN Real vmf_pdf(Vec3 omega, Vec3 centre, Real bandwidth) {
    return gaussian(omega, centre, bandwidth) / gaussian_integral(bandwidth);
}

// The direction at the angle theta from the centre with cos(theta) = 1 + below, at azimuth 2 pi u2 about it.
SRBF_FN Vec3 off_centre(Vec3 centre, Real below, Real u2) {
    Real sine = sqrt(max(-below * (Real(2.0) + below), Real(0.0)));
    Real phi = Real(SRBF_TWO_PI) * u2;
    return from_frame(centre, sine * cos(phi), sine * sin(phi), Real(1.0) + below);
}

// Samples vmf_pdf from u1, u2 uniform in [0,1): cos(theta) - 1 = ln(u1 + (1 - u1) e^(-2 lambda)) / lambda about the
// centre. For lambda > 0.01, with width = 1 / lambda and rest = e^(-2 lambda).
SRBF_FN Real sample_below(Real width, Real rest, Real u1) {
    return log(max(u1 + (Real(1.0) - u1) * rest, Real(1.0e-35))) * width;
}
SRBF_FN Vec3 sample_sharp_vmf(Vec3 centre, Real width, Real rest, Real u1, Real u2) {
    return off_centre(centre, max(sample_below(width, rest, u1), Real(-2.0)), u2);
}

// The same for any lambda. For lambda <= 0.01 it uses the series of the logarithm; at lambda = 0 the cosine is 2 u1 -
// 1.
SRBF_FN Vec3 sample_vmf(Vec3 centre, Real bandwidth, Real u1, Real u2) {
    Real positive = max(bandwidth, Real(1.0e-6));
    Real x = (Real(1.0) - u1) * one_minus_exp(Real(2.0) * positive);
    Real series = -x * (Real(1.0) + x * (Real(0.5) + x * (Real(1.0 / 3.0) + x * Real(0.25))));
    Real rest = exp(max(Real(-2.0) * positive, Real(-80.0)));
    Real direct = log(max(u1 + (Real(1.0) - u1) * rest, Real(1.0e-35)));
    Real below = max(select(positive < Real(0.01), series, direct) / positive, Real(-2.0));
    return off_centre(centre, below, u2);
}

// ---- Sampling of the light ---------------------------------------------------------------------------------------

// The density max(z, 0) / pi [1/sr], and a direction sampled from it with u1, u2 uniform in [0,1).
SRBF_FN Real cosine_pdf(Vec3 wl) { return max(wl.z, Real(0.0)) * Real(2.0 / SRBF_TWO_PI); }
SRBF_FN Vec3 sample_cosine(Real u1, Real u2) {
    Real radius = sqrt(u1);
    Real phi = Real(SRBF_TWO_PI) * u2;
    return Vec3(radius * cos(phi), radius * sin(phi), sqrt(max(Real(1.0) - u1, Real(0.0))));
}

// The densities max(z, 0) / pi and 3 max(z, 0)^2 / (2 pi) [1/sr] as one, of power 1 and 2, and a direction sampled from
// it: z = u1^width with width = 1 / (power + 1).
SRBF_FN Real power_cosine_pdf(Vec3 wl, Real power) {
    Real z = max(wl.z, Real(0.0));
    return (power + Real(1.0)) * Real(1.0 / SRBF_TWO_PI) * z * select(Real(1.0) < power, z, Real(1.0));
}
SRBF_FN Real below_power_cosine(Real width, Real u1) {
    return min(exp(sample_below(width, Real(0.0), u1)), Real(1.0)) - Real(1.0);
}

// A map that multiplies the component of directions along a tangent of the surface, the unit vector t along (x, y):
// M = I + (stretch - 1) t t^T. (more, less) are (stretch - 1, 1 / stretch - 1) over x^2 + y^2, and shrink is
// 1 / stretch. With (x, y) = (0, 0) nothing is mapped.
struct Stretch {
    Real x;
    Real y;
    Real more;
    Real less;
    Real shrink;
};
SRBF_FN Stretch stretch_along(Vec3 tangent, Real stretch) {
    Stretch map;
    map.x = tangent.x;
    map.y = tangent.y;
    Real reciprocal = Real(1.0) / max(tangent.x * tangent.x + tangent.y * tangent.y, Real(1.0e-20));
    map.shrink = Real(1.0) / stretch;
    map.more = (stretch - Real(1.0)) * reciprocal;
    map.less = (map.shrink - Real(1.0)) * reciprocal;
    return map;
}
SRBF_FN Vec3 grown_along(Vec3 w, Real x, Real y, Real gain) {
    Real along = gain * (w.x * x + w.y * y);
    return Vec3(w.x + along * x, w.y + along * y, w.z);
}
SRBF_FN Vec3 stretched(Vec3 w, Stretch map) { return grown_along(w, map.x, map.y, map.more); }

// A lobe G(g . z | lambda) of directions g, which a map M takes to half vectors h along M g, weighted by a power of the
// visibility of these: G(g . z | lambda) (M g . wv)^power. With viewer = M wv, M g . wv is g . viewer. With its
// logarithm linearised about the normal this is again a lobe, along lambda z + pull viewer with
// pull = power / (n . wv). For a view direction close to the horizon its centre is not beyond halfway between the
// normal and the viewer.
SRBF_FN Real pull_of_visibility(Vec3 wv, Real power) { return power / max(wv.z, Real(1.0e-6)); }
SRBF_FN GaussianProduct visible_lobe(Vec3 viewer, Real shrink, Real bandwidth, Real pull) {
    return gaussian_product(Vec3(Real(0.0), Real(0.0), Real(1.0)), bandwidth, viewer, min(pull, shrink * bandwidth));
}

// For half vectors h from a lobe that is stretched: the direction g = M^-1 h / |M^-1 h| before, and the factor that
// converts the lobe's density there to the density of wl: 1 / (stretch |M^-1 h|^3) / (4 h . wl), where 2 h . wl =
// |wl + wv|. Where wl = -wv there is no half vector, and the factor is 0.
struct HalfVector {
    Vec3 direction;
    Real factor;
};
SRBF_FN HalfVector half_vector(Vec3 wl, Vec3 wv, Stretch map) {
    Vec3 sum = wl + wv;
    Real squared = dot(sum, sum);
    Vec3 back = grown_along(sum, map.x, map.y, map.less);
    Real reciprocal = inversesqrt(max(dot(back, back), Real(1.0e-20)));
    HalfVector h;
    h.direction = reciprocal * back;
    Real exists = select(Real(1.0e-12) < squared, Real(0.5), Real(0.0)) * map.shrink;
    h.factor = (exists * squared) * (reciprocal * reciprocal * reciprocal);
    return h;
}

// The density of wl = 2 (h . wv) h - wv [1/sr], with h from the stretched lobe, as visible from wv.
SRBF_FN Real half_vector_pdf(Vec3 wl, Vec3 wv, Real bandwidth, Stretch map, Real power) {
    HalfVector at = half_vector(wl, wv, map);
    GaussianProduct lobe = visible_lobe(stretched(wv, map), map.shrink, bandwidth, pull_of_visibility(wv, power));
    return vmf_pdf(at.direction, lobe.centre, lobe.bandwidth) * at.factor;
}

// The light direction wl with its half vector along h, of any length. Where h . wv <= 0 there is none; the result is
// then the zero vector.
SRBF_FN Vec3 light_of(Vec3 h, Vec3 wv) {
    Real along = dot(h, wv);
    Real twice = Real(2.0) * along / max(dot(h, h), Real(1.0e-20));
    return select(Real(0.0) < along, Real(1.0), Real(0.0)) * (twice * h - wv);
}

// Samples half_vector_pdf. The result is the zero vector where there is no direction.
SRBF_FN Vec3 sample_half_vector(Vec3 wv, Real bandwidth, Stretch map, Real power, Real u1, Real u2) {
    GaussianProduct lobe = visible_lobe(stretched(wv, map), map.shrink, bandwidth, pull_of_visibility(wv, power));
    return light_of(stretched(sample_vmf(lobe.centre, lobe.bandwidth, u1, u2), map), wv);
}

// Components of a mixture that covers any reflective BRDF. Of directions to the light, 0: the cosine; 1: its square; 2
// to 7: lobes about the mirror direction, lambda = 4, 16, 64, 256 and, for highlights narrower than any of half
// vectors, 8 4^6 and 8 4^7. Of half vectors, 8 to 14: lobes with lambda = 8, 32, .. 8 4^6, stretched and weighted by a
// power of their visibility; 15: such a lobe of lambda = 128, not weighted. Directions of these lobes below the horizon
// are reflected to above it, so that no sample is lost.
#define SRBF_PROPOSAL_LOBES 16
#define SRBF_FIRST_HALF_VECTOR_LOBE 8
SRBF_FN Real proposal_bandwidth(int k) {
    int power = k < 6 ? k - 1 : k < 8 ? k : k - 8;
    Real bandwidth = k < 6 ? Real(1.0) : Real(8.0);
    for (int i = 0; i < power; ++i) bandwidth = Real(4.0) * bandwidth;
    if (k == 15) bandwidth = Real(128.0);
    return bandwidth;
}
SRBF_FN Real proposal_pull(int k, Real pull) { return k == 15 ? Real(0.0) : pull; }
// Common subexpressions of the components' densities at (wl, wv): wl above the horizon and reflected at it, with their
// half vectors.
struct ProposalPoint {
    Vec3 wl;
    Vec3 mirrored;
    Vec3 specular;
    Vec3 viewer;
    Real shrink;
    Real pull;
    HalfVector above;
    HalfVector below;
};
SRBF_FN ProposalPoint proposal_point(Vec3 wl, Vec3 wv, Stretch map, Real power) {
    ProposalPoint at;
    at.wl = wl;
    at.mirrored = Vec3(wl.x, wl.y, -wl.z);
    at.specular = Vec3(-wv.x, -wv.y, wv.z);
    at.viewer = stretched(wv, map);
    at.shrink = map.shrink;
    at.pull = pull_of_visibility(wv, power);
    at.above = half_vector(wl, wv, map);
    at.below = half_vector(at.mirrored, wv, map);
    return at;
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
SRBF_FN ProposalLobe half_vector_lobe(Vec3 viewer, Real shrink, Real bandwidth, Real pull) {
    GaussianProduct product = visible_lobe(viewer, shrink, bandwidth, pull);
    ProposalLobe lobe;
    lobe.centre = product.centre;
    lobe.bandwidth = product.bandwidth;
    lobe.width = product.width;
    lobe.scale = product.bandwidth * Real(1.0 / SRBF_TWO_PI);
    lobe.rest = Real(0.0);
    return lobe;
}
// Its density [1/sr] for a direction sampled at `above`, or at `below` and then reflected.
SRBF_FN Real folded_pdf(ProposalLobe lobe, HalfVector above, HalfVector below) {
    return lobe.scale * (gaussian(above.direction, lobe.centre, lobe.bandwidth) * above.factor +
                         gaussian(below.direction, lobe.centre, lobe.bandwidth) * below.factor);
}
// For a component that samples the direction itself instead of a half vector.
SRBF_FN HalfVector itself(Vec3 direction) {
    HalfVector at;
    at.direction = direction;
    at.factor = Real(1.0);
    return at;
}
// The density of component k [1/sr]; wl is above the horizon.
SRBF_FN Real proposal_lobe_pdf(int k, ProposalPoint at) {
    Real bandwidth = proposal_bandwidth(k);
    if (k >= SRBF_FIRST_HALF_VECTOR_LOBE)
        return folded_pdf(half_vector_lobe(at.viewer, at.shrink, bandwidth, proposal_pull(k, at.pull)), at.above,
                          at.below);
    if (k > 1) return folded_pdf(mirror_lobe(at.specular, bandwidth), itself(at.wl), itself(at.mirrored));
    return power_cosine_pdf(at.wl, k == 0 ? Real(1.0) : Real(2.0));
}
// Samples component k from u1, u2 uniform in [0,1). z = 0 where there is no direction.
SRBF_FN Vec3 folded(Vec3 wl) { return Vec3(wl.x, wl.y, max(wl.z, -wl.z)); }
SRBF_FN Vec3 sample_proposal_lobe(int k, Vec3 wv, Stretch map, Real power, Real u1, Real u2) {
    Real below = below_power_cosine(k == 0 ? Real(0.5) : Real(1.0 / 3.0), u1);
    Vec3 wl = off_centre(Vec3(Real(0.0), Real(0.0), Real(1.0)), below, u2);
    if (k >= SRBF_FIRST_HALF_VECTOR_LOBE) {
        Real pull = proposal_pull(k, pull_of_visibility(wv, power));
        ProposalLobe lobe = half_vector_lobe(stretched(wv, map), map.shrink, proposal_bandwidth(k), pull);
        wl = light_of(stretched(sample_sharp_vmf(lobe.centre, lobe.width, lobe.rest, u1, u2), map), wv);
    } else if (k > 1) {
        ProposalLobe lobe = mirror_lobe(Vec3(-wv.x, -wv.y, wv.z), proposal_bandwidth(k));
        wl = sample_sharp_vmf(lobe.centre, lobe.width, lobe.rest, u1, u2);
    }
    return folded(wl);
}

// A lobe of the light times the cosine to the normal, approximated as 1.17 G(wl . z | 2.133) with an error of up to .06
// (Wang et al. 2009): the contribution of a view's lobe to reflected light, and the distribution to sample the light
// from.
SRBF_FN GaussianProduct times_cosine(Vec3 centre, Real bandwidth) {
    GaussianProduct product = gaussian_product(centre, bandwidth, Vec3(Real(0.0), Real(0.0), Real(1.0)), Real(2.133));
    product.scale = Real(1.17) * product.scale;
    return product;
}

// ---- Parameterized multivariate SRBFs ----------------------------------------------------------------------------

// psi = normalize(a wl + b wv): the half vector at (1,1), the light at (1,0), the view at (0,1). Where a wl + b wv
// vanishes (b = -a, wl = wv) it is the zero vector; a kernel of it is then finite, exp(-lambda / 2).
SRBF_FN Vec3 psi(Vec3 wl, Vec3 wv, Real a, Real b) {
    Vec3 d = a * wl + b * wv;
    return inversesqrt(max(dot(d, d), Real(1.0e-20))) * d;
}

// d psi / d angle for (a, b) = (cos angle, sin angle): the component of -b wl + a wv orthogonal to psi, over |a wl + b
// wv|.
SRBF_FN Vec3 psi_by_angle(Vec3 wl, Vec3 wv, Real a, Real b) {
    Vec3 d = a * wl + b * wv;
    Real reciprocal = inversesqrt(max(dot(d, d), Real(1.0e-20)));
    Vec3 across = reciprocal * (a * wv - b * wl);
    Vec3 direction = reciprocal * d;
    return across - dot(across, direction) * direction;
}

#define SRBF_TERMS 4

// The further features x_k of the terms in srbf/exponent_terms.h, in which the exponent of a lobe is linear. Each is at most 0
// above the horizon and symmetric in (wl, wv). Only x_0 is unbounded; its exponent must be >= 0 so that the lobe is
// bounded at the horizon. The last two shape the mirror direction: peaks of measurements are pointed, with different
// widths in the plane of incidence and across it. x_2 is nearly -|cl - cv|, without the crease at cl = cv, which would
// be visible in a highlight. Cosines below 1e-6 count as 1e-6.

// The features, with cl, cv the cosines of wl, wv to the normal, and h their half vector:
//   x_0 = log(cl cv)
//   x_1 = wl . h - 1
//   x_2 = 1/20 - sqrt((cl - cv)^2 + sin^2(theta_h)/16 + 1/400)
//   x_3 = -sin(theta_h)
struct PmFeatures {
    Real x[SRBF_TERMS];
};

// The further features of (wl, wv), of which the form of the model has `count`; what is beyond them is not read.
SRBF_FN PmFeatures pm_further_features(int count, Vec3 wl, Vec3 wv) {
    PmFeatures of;
    for (int k = 0; k < SRBF_TERMS; ++k) of.x[k] = Real(0.0);
    if (count > 0) of.x[0] = log(max(wl.z, Real(1.0e-6)) * max(wv.z, Real(1.0e-6)));
    if (count > 1) {
        Vec3 sum = wl + wv;
        Real squared = max(dot(sum, sum), Real(1.0e-12));
        Real across = (sum.x * sum.x + sum.y * sum.y) / squared;
        Real apart = wl.z - wv.z;
        of.x[1] = Real(0.5) * sqrt(squared) - Real(1.0);
        of.x[2] = Real(0.05) - sqrt(apart * apart + Real(0.0625) * across + Real(0.0025));
        of.x[3] = -sqrt(across);
    }
    return of;
}

// psi(wl, wv) as needed for axial lobes: sin^2 and cos of its angle to the normal.
struct AxialPsi {
    Real across;
    Real along;
};
SRBF_FN AxialPsi axial_psi(Vec3 wl, Vec3 wv, Real a, Real b) {
    Vec3 d = a * wl + b * wv;
    Real reciprocal = inversesqrt(max(dot(d, d), Real(1.0e-20)));
    AxialPsi psi_;
    psi_.across = reciprocal * reciprocal * (d.x * d.x + d.y * d.y);
    psi_.along = reciprocal * d.z;
    return psi_;
}

// |psi - xi|^2 for a pole xi = (0, 0, pole), and for a general centre.
SRBF_FN Real squared_distance_from_pole(AxialPsi psi_, Real pole) {
    Real apart = psi_.along - pole;
    return psi_.across + apart * apart;
}
SRBF_FN Real squared_distance(Vec3 psi_, Vec3 centre) {
    Vec3 apart = psi_ - centre;
    return dot(apart, apart);
}

// A lobe is a power of two with the exponent
//     s_j log2(e) + sum_k (kappa_jk log2(e)) x_k - sum_n (lambda_jn log2(e) / 2) |psi_n - xi_jn|^2,
// pm_with_variate adds the term of a variate, pm_with_features those of the features. pm_power clamps the exponent to
// at most 100, so that every sum of lobes of a stored model is finite in float, and to at least -100 (8e-31 of the
// coefficient), so that no product with a stored coefficient is subnormal, where arithmetic is many times slower.

SRBF_FN Real pm_with_variate(Pm pm, int j, int n, Real exponent, Real squared_distance_) {
    return exponent - Real(pm_log2_falloff(pm, j, n)) * squared_distance_;
}
SRBF_FN Real pm_with_features(Pm pm, int j, Real exponent, PmFeatures features) {
    Real sum = exponent;
    for (int k = 0; k < pm_features(pm); ++k) sum = sum + Real(pm_exponent(pm, j, k)) * features.x[k];
    return sum;
}
SRBF_FN Real pm_power(Real exponent) { return exp2(max(min(exponent, Real(100.0)), Real(-100.0))); }

// rho(wl, wv) = sum_j beta_j e^(s_j) prod_n G(psi_n . xi_jn | lambda_jn) prod_k e^(kappa_jk x_k(wl, wv)) [1/sr], for R,
// G, B, with psi_n = normalize(a_n wl + b_n wv) and x_k the further features. A negative sum counts as 0.
SRBF_FN Vec3 pm_value(Pm pm, Vec3 wl, Vec3 wv) {
    Vec3 variate[SRBF_MAX_VARIATES];
    Real up[SRBF_MAX_VARIATES];  // squared distances from +z and -z, all that axial lobes need
    Real down[SRBF_MAX_VARIATES];
    for (int n = 0; n < pm_variates(pm); ++n) {
        Real a = Real(pm_weight_l(pm, n));
        Real b = Real(pm_weight_v(pm, n));
        if (pm_axial(pm)) {
            AxialPsi psi_ = axial_psi(wl, wv, a, b);
            up[n] = squared_distance_from_pole(psi_, Real(1.0));
            down[n] = squared_distance_from_pole(psi_, Real(-1.0));
        } else {
            variate[n] = psi(wl, wv, a, b);
        }
    }
    PmFeatures features = pm_further_features(pm_features(pm), wl, wv);
    Vec3 sum = Vec3(Real(0.0), Real(0.0), Real(0.0));
    for (int j = 0; j < pm_lobes(pm); ++j) {
        Real exponent = pm_with_features(pm, j, Real(pm_log2_scale(pm, j)), features);
        for (int n = 0; n < pm_variates(pm); ++n) {
            if (pm_axial(pm))
                exponent = pm_with_variate(pm, j, n, exponent, pm_down(pm, j, n) ? down[n] : up[n]);
            else
                exponent = pm_with_variate(pm, j, n, exponent, squared_distance(variate[n], pm_centre(pm, j, n)));
        }
        sum = sum + pm_power(exponent) * pm_coefficient(pm, j);
    }
    // The colour of a spectral model's lobe may have a negative channel.
    return Vec3(max(sum.x, Real(0.0)), max(sum.y, Real(0.0)), max(sum.z, Real(0.0)));
}

// ---- Scattered univariate SRBFs ----------------------------------------------------------------------------------

// How much longer than along the normal the way of a direction through a layer is: 1/cos(theta) - 1. A layer of optical
// depth tau transmits e^-(tau slant) of what it transmits along the normal. Cosines below 1e-6 count as 1e-6.
SRBF_FN Real slant(Real cosine) { return Real(1.0) / max(cosine, Real(1.0e-6)) - Real(1.0); }

// The unit tangent across the plane of w and the normal; the zero vector where w is the normal.
SRBF_FN Vec3 tangent_across(Vec3 w) {
    Real reciprocal = inversesqrt(max(w.x * w.x + w.y * w.y, Real(1.0e-20)));
    return Vec3(-reciprocal * w.y, reciprocal * w.x, Real(0.0));
}

// The exponent of a lobe with a shape, where `apart` is its distance omega - xi from the centre, `across` the component
// of that along a tangent, and `further` slant(omega.z). A shape tau > 0 attenuates the lobe: -tau slant. A shape
// -alpha < 0 narrows it along the tangent, to 1 + alpha times its bandwidth. A lobe of shape 0 is a Gaussian.
SRBF_FN Real shaped_exponent(Vec3 apart, Real across, Real further, Real bandwidth, Real shape) {
    Real squared = dot(apart, apart) - min(shape, Real(0.0)) * (across * across);
    return Real(-0.5) * bandwidth * squared - max(shape, Real(0.0)) * further;
}

// The function of sampled view i: sum_j beta_ij G(wl . xi_ij | lambda_ij) [1/sr], for R, G, B, of lobes with shapes;
// the tangent is that across the plane of the view and the normal.
SRBF_FN Vec3 su_view_value(Su su, int view, Vec3 wl) {
    Vec3 sum = Vec3(Real(0.0), Real(0.0), Real(0.0));
    Vec3 tangent = tangent_across(su_direction(su, view));
    Real further = slant(wl.z);
    for (int j = 0; j < su_lobes(su); ++j) {
        Vec3 apart = wl - su_centre(su, view, j);
        Real exponent = shaped_exponent(apart, dot(apart, tangent), further, Real(su_bandwidth(su, view, j)),
                                        Real(su_shape(su, view, j)));
        sum = sum + exp_of_lobe(exponent) * su_coefficient(su, view, j);
    }
    return sum;
}

// w rotated about the normal by the angle with that cosine and sine.
SRBF_FN Vec3 turned(Vec3 w, Real cosine, Real sine) {
    return Vec3(cosine * w.x - sine * w.y, sine * w.x + cosine * w.y, w.z);
}

// The contribution of a sampled view to the value at another view direction: its weight, and the rotation about the
// normal that takes the view direction to the azimuth of the sampled view, to be applied to wl too.
struct SuNeighbour {
    int view;
    Real weight;
    Real cosine;
    Real sine;
};

// Interpolation for isotropic BRDFs. Sampled views are rotated to the azimuth of wv, so that they differ only in
// elevation: the value is linear in wv.z between the two sampled views adjacent in elevation. Above the last sampled
// view the azimuth is ill-defined: over that cap the weight of this view falls linearly to 0 at the pole, and three
// copies of it, rotated by thirds of a circle, replace it. The interpolation is continuous in wv and exact at sampled
// views. k: 0..SU_ROTATED_NEIGHBOURS-1.
#define SU_ROTATED_NEIGHBOURS 5
SRBF_FN SuNeighbour su_rotated_neighbour(Su su, Vec3 wv, int k) {
    int last = su_views(su) - 1;
    Real at = max(wv.z * Real(su_views(su)) - Real(0.5), Real(0.0));  // the samples are uniform in z
    int below = at < Real(last) ? int(at) : last;
    int above = below < last ? below + 1 : last;
    Vec3 top = su_direction(su, last);
    Real radius = sqrt(wv.x * wv.x + wv.y * wv.y);
    Real top_radius = max(sqrt(top.x * top.x + top.y * top.y), Real(1.0e-20));
    Real cap = wv.z > top.z ? min(radius / top_radius, Real(1.0)) : Real(1.0);  // 1 outside of it, 0 at the pole

    SuNeighbour neighbour;
    neighbour.view = k == 0 ? below : k == 1 ? above : last;
    Vec3 sample_ = su_direction(su, neighbour.view);
    Real from = su_direction(su, below).z;
    Real step = su_direction(su, above).z - from;
    Real part = step > Real(0.0) ? min(max((wv.z - from) / step, Real(0.0)), Real(1.0)) : Real(0.0);
    Real length = max(radius * sqrt(sample_.x * sample_.x + sample_.y * sample_.y), Real(1.0e-20));
    neighbour.weight = k == 0 ? cap * (Real(1.0) - part) : k == 1 ? cap * part : (Real(1.0) - cap) / Real(3.0);
    neighbour.cosine = k < 2 ? (wv.x * sample_.x + wv.y * sample_.y) / length : k == 2 ? Real(1.0) : Real(-0.5);
    neighbour.sine = k < 2 ? (wv.x * sample_.y - wv.y * sample_.x) / length
                           : Real(0.8660254037844386) * (k == 3 ? Real(1.0) : k == 4 ? Real(-1.0) : Real(0.0));
    return neighbour;
}

SRBF_FN Vec3 su_rotated_part(Su su, Vec3 wl, Vec3 wv, int k) {
    SuNeighbour neighbour = su_rotated_neighbour(su, wv, k);
    return neighbour.weight * su_view_value(su, neighbour.view, turned(wl, neighbour.cosine, neighbour.sine));
}

// Neighbours beyond the first two contribute only within the cap. (A loop with no iterations is allowed where a branch
// is not.)
SRBF_FN Vec3 su_rotated_value(Su su, Vec3 wl, Vec3 wv) {
    Vec3 sum = su_rotated_part(su, wl, wv, 0) + su_rotated_part(su, wl, wv, 1);
    int count = wv.z > su_direction(su, su_views(su) - 1).z ? SU_ROTATED_NEIGHBOURS : 2;
    for (int k = 2; k < count; ++k) sum = sum + su_rotated_part(su, wl, wv, k);
    return sum;
}

// Plain interpolation: the K nearest views, not rotated. The weight of a view at distance d from wv is 1/d - 1/d_K,
// where d_K is the distance of the next nearest view; weights are not yet normalised. A weight falls to 0 as its view
// leaves the K nearest, and dominates as wv approaches the view. It is at least 1e-5/d_K, so that the result is the
// mean if all K+1 views are equally far, instead of rounding errors over 0.
SRBF_FN Real su_plain_weight(Su su, SuNearest nearest, Vec3 wv, int neighbours, int k) {
    Vec3 apart = wv - su_direction(su, su_nearest(nearest, k));
    Vec3 leaving = wv - su_direction(su, su_nearest(nearest, neighbours));
    Real of_next = inversesqrt(max(dot(leaving, leaving), Real(1.0e-30)));
    return max(inversesqrt(max(dot(apart, apart), Real(1.0e-30))) - of_next, Real(1.0e-5) * of_next);
}

SRBF_FN Vec3 su_plain_value(Su su, SuNearest nearest, Vec3 wl, Vec3 wv, int neighbours) {
    Vec3 sum = Vec3(Real(0.0), Real(0.0), Real(0.0));
    Real weights = Real(0.0);
    for (int k = 0; k < neighbours; ++k) {
        Real weight = su_plain_weight(su, nearest, wv, neighbours, k);
        weights = weights + weight;
        sum = sum + weight * su_view_value(su, su_nearest(nearest, k), wl);
    }
    return (Real(1.0) / max(weights, Real(1.0e-20))) * sum;
}

// ---- Lambert and GGX ---------------------------------------------------------------------------------------------

// A GGX microfacet lobe: its roughness alpha > 0, and its Fresnel term at normal incidence (F0) and at grazing
// incidence (F90).
struct GgxLobe {
    Real roughness;
    Vec3 f0;
    Real f90;
};

// D G / (4 cl cv) with the distribution of normals D = alpha^2 / (pi (sin^2(theta_h) + alpha^2 cos^2(theta_h))^2)
// (Walter et al., "Microfacet Models for Refraction through Rough Surfaces", 2007) and height-correlated
// masking-shadowing G (Heitz, "Understanding the Masking-Shadowing Function", JCGT 2014) [1/sr]. Cosines below 1e-6
// count as 1e-6.
SRBF_FN Real ggx_facets(Vec3 wl, Vec3 wv, Real roughness) {
    Vec3 sum = wl + wv;
    Real squared = max(dot(sum, sum), Real(1.0e-12));
    Real alpha2 = roughness * roughness;
    Real slope = (sum.x * sum.x + sum.y * sum.y + alpha2 * (sum.z * sum.z)) / squared;
    Real cl = max(wl.z, Real(1.0e-6));
    Real cv = max(wv.z, Real(1.0e-6));
    Real masking = cv * sqrt(alpha2 + (Real(1.0) - alpha2) * (cl * cl)) +
                   cl * sqrt(alpha2 + (Real(1.0) - alpha2) * (cv * cv));
    return alpha2 / (Real(SRBF_TWO_PI) * slope * slope * masking);
}

// The same of facets with roughness alpha_x along x and alpha_y along y [1/sr].
SRBF_FN Real ggx_stretched_facets(Vec3 wl, Vec3 wv, Real alpha_x, Real alpha_y) {
    Vec3 sum = wl + wv;
    Real squared = max(dot(sum, sum), Real(1.0e-12));
    Real product = alpha_x * alpha_y;
    Real slope = (alpha_y / alpha_x * (sum.x * sum.x) + alpha_x / alpha_y * (sum.y * sum.y) + product * (sum.z * sum.z)) /
                 squared;
    Real cl = max(wl.z, Real(1.0e-6));
    Real cv = max(wv.z, Real(1.0e-6));
    Vec3 l = Vec3(alpha_x * wl.x, alpha_y * wl.y, cl);
    Vec3 v = Vec3(alpha_x * wv.x, alpha_y * wv.y, cv);
    Real masking = cv * sqrt(dot(l, l)) + cl * sqrt(dot(v, v));
    return product / (Real(SRBF_TWO_PI) * slope * slope * masking);
}

// (1 - l.h)^5, in which Schlick's Fresnel term is linear (Schlick 1994).
SRBF_FN Real schlick_weight(Vec3 wl, Vec3 wv) {
    Vec3 sum = wl + wv;
    Real x = max(Real(1.0) - Real(0.5) * sqrt(dot(sum, sum)), Real(0.0));
    return (x * x) * (x * x) * x;
}

// ggx_facets (F0 + (F90 - F0) (1 - l.h)^5) [1/sr], for R, G, B.
SRBF_FN Vec3 ggx_lobe_value(GgxLobe lobe, Vec3 wl, Vec3 wv) {
    Real weight = schlick_weight(wl, wv);
    Real f90 = weight * lobe.f90;
    return ggx_facets(wl, wv, lobe.roughness) *
           ((Real(1.0) - weight) * lobe.f0 + Vec3(f90, f90, f90));
}

// rho(wl, wv) = kd / pi + the two lobes [1/sr]; a model of one lobe has a second one whose Fresnel term is 0.
SRBF_FN Vec3 ggx_value(Vec3 diffuse, GgxLobe first, GgxLobe second, Vec3 wl, Vec3 wv) {
    return Real(2.0 / SRBF_TWO_PI) * diffuse + ggx_lobe_value(first, wl, wv) + ggx_lobe_value(second, wl, wv);
}

// ---- Surfaces of renderers' parameters ---------------------------------------------------------------------------

// The product of two colours, and a + t (b - a).
SRBF_FN Vec3 tinted(Vec3 a, Vec3 b) { return Vec3(a.x * b.x, a.y * b.y, a.z * b.z); }
SRBF_FN Vec3 blended(Vec3 a, Vec3 b, Real t) { return (Real(1.0) - t) * a + t * b; }

// a + b y + c y^2, and x at least 0 and at most 1.
SRBF_FN Real quadratic(Real y, Real a, Real b, Real c) { return a + y * (b + y * c); }
SRBF_FN Real saturated(Real x) { return min(max(x, Real(0.0)), Real(1.0)); }

// The reflectance of an interface for unpolarised light at an angle of cosine c, from the side outside of a medium with
// relative index of refraction ior >= 1 (Fresnel's equations, in the form of Cook & Torrance 1982), and at c = 1.
SRBF_FN Real dielectric_reflectance(Real c, Real ior) {
    Real g = sqrt(max(ior * ior - Real(1.0) + c * c, Real(1.0e-12)));
    Real across = (g - c) / (g + c);
    Real turn = (c * (g + c) - Real(1.0)) / (c * (g - c) + Real(1.0));
    return Real(0.5) * (across * across) * (Real(1.0) + turn * turn);
}
SRBF_FN Real normal_reflectance(Real ior) {
    Real share = (ior - Real(1.0)) / (ior + Real(1.0));
    return share * share;
}

// The directional albedo of GGX facets with Schlick's Fresnel term, F0 facing + F90 grazing, at cosine x to the normal
// and roughness alpha = y: the rational functions that MaterialX 1.38 uses. Their sum errs by less than 0.02 from the
// integral for x >= 0.5, by less than 0.03 for x >= 0.2, where y >= 0.01.
struct FacetAlbedo {
    Real facing;
    Real grazing;
};
SRBF_FN FacetAlbedo facet_albedo(Real x, Real y) {
    FacetAlbedo albedo_;
    albedo_.facing = saturated(
        quadratic(x, quadratic(y, Real(0.1003), Real(9.748), Real(-8.245)),
                  quadratic(y, Real(-0.6303), Real(-2.038), Real(19.99)),
                  quadratic(y, Real(29.34), Real(-26.44), Real(-5.448))) /
        quadratic(x, quadratic(y, Real(1.0), Real(8.263), Real(-7.507)),
                  quadratic(y, Real(-1.765), Real(11.53), Real(15.86)),
                  quadratic(y, Real(28.96), Real(-36.11), Real(33.37))));
    albedo_.grazing = saturated(
        quadratic(x, quadratic(y, Real(0.9345), Real(2.229), Real(-0.7684)),
                  quadratic(y, Real(-2.323), Real(-3.748), Real(0.2913)),
                  quadratic(y, Real(1.424), Real(1.436), Real(0.6286))) /
        quadratic(x, quadratic(y, Real(1.0), Real(15.94), Real(41.26)),
                  quadratic(y, Real(0.2281), Real(-55.83), Real(300.2)),
                  quadratic(y, Real(13.08), Real(54.9), Real(-285.1))));
    return albedo_;
}
// (1 - E) / E, with E the albedo of facets that reflect all. Light that is scattered more than once multiplies a
// lobe by 1 + F0 (1 - E) / E (Turquin, "Practical multiple scattering compensation for microfacet models", 2019).
SRBF_FN Real scattered_again(FacetAlbedo albedo_) {
    Real whole = max(albedo_.facing + albedo_.grazing, Real(0.1));
    return max(Real(1.0) - whole, Real(0.0)) / whole;
}
// The albedo of facets of normal reflectance f0, with what they scatter again.
SRBF_FN Real lobe_albedo(FacetAlbedo albedo_, Real f0) {
    return saturated((f0 * albedo_.facing + albedo_.grazing * saturated(Real(50.0) * f0)) *
                     (Real(1.0) + f0 * scattered_again(albedo_)));
}

// The energy-preserving Oren-Nayar model, EON (Portsmouth, Kutz & Hill 2025) [1/sr], of roughness r from 0 (Lambert) to
// 1. White reflects all light; other colours reflect less if they are rough. eon_share is the albedo of white's first
// scattering, by the paper's polynomial, which errs by 1e-3.
SRBF_FN Real eon_share(Real cosine, Real r) {
    Real m = Real(1.0) - cosine;
    Real g = m * (Real(0.0571085289) + m * (Real(0.491881867) + m * (Real(-0.332181442) + m * Real(0.0714429953))));
    return (Real(1.0) + r * g) / (Real(1.0) + Real(0.28779341) * r);
}
SRBF_FN Real eon_again(Real colour, Real mean) {
    return colour * colour * mean / (Real(1.0) - colour * (Real(1.0) - mean));
}
SRBF_FN Vec3 eon_value(Vec3 colour, Real r, Vec3 wl, Vec3 wv) {
    Real s = wl.x * wv.x + wl.y * wv.y;
    Real of_first = Real(1.0) / (Real(1.0) + Real(0.28779341) * r);
    Real single = of_first * (Real(1.0) + r * select(Real(0.0) < s, s / max(max(wl.z, wv.z), Real(1.0e-6)), s));
    Real mean = of_first * (Real(1.0) + Real(0.07248821) * r);
    Real apart = max(Real(1.0) - eon_share(wl.z, r), Real(1.0e-6)) * max(Real(1.0) - eon_share(wv.z, r), Real(1.0e-6)) /
                 max(Real(1.0) - mean, Real(1.0e-6));
    Vec3 again = Vec3(eon_again(colour.x, mean), eon_again(colour.y, mean), eon_again(colour.z, mean));
    return Real(2.0 / SRBF_TWO_PI) * (single * colour + apart * again);
}

// Fuzz: the volume of fibres of Zeltner, Burley & Chiang ("Practical Multiple-Scattering Sheen Using Linearly
// Transformed Cosines", 2022), a cosine lobe transformed by ((a, 0, b), (0, a, 0), (0, 0, 1)) in the frame of the
// viewer's azimuth. Albedo, a and b are the functions of cosine and roughness that MaterialX 1.39 fits to the paper's
// table.
SRBF_FN Real fuzz_albedo(Real x, Real y) {
    Real s = y * (Real(0.0206607) + Real(1.58491) * y) / (Real(0.0379424) + y * (Real(1.32227) + y));
    Real m = y * (Real(-0.193854) + y * (Real(-1.14885) + y * (Real(1.7932) - Real(0.95943) * y * y))) /
             (Real(0.046391) + y);
    Real rest = y * (Real(0.000654023) + (Real(-0.0207818) + Real(0.119681) * y) * y) /
                (Real(1.26264) + y * (Real(-1.92021) + y));
    Real at = (x - m) / s;
    return saturated(exp_of_lobe(Real(-0.5) * at * at) * Real(0.3989422804) / s + rest);
}
SRBF_FN Real fuzz_value(Vec3 wl, Vec3 wv, Real y) {
    Real x = wv.z;
    Real a = (Real(2.58126) * x + Real(0.813703) * y) * y /
             (Real(1.0) + Real(0.310327) * x * x + Real(2.60994) * x * y);
    Real b = sqrt(max(Real(1.0) - x, Real(0.0))) * (y - Real(1.0)) * y * y * y /
             (Real(0.0000254053) + Real(1.71228) * x - Real(1.71506) * x * y + Real(1.34174) * y * y);
    Real along = (wl.x * wv.x + wl.y * wv.y) * inversesqrt(max(wv.x * wv.x + wv.y * wv.y, Real(1.0e-12)));
    Real across2 = max(wl.x * wl.x + wl.y * wl.y - along * along, Real(0.0));
    Real first = a * along + b * wl.z;
    Real a2 = max(a * a, Real(1.0e-12));
    Real squared = max(first * first + a2 * across2 + wl.z * wl.z, Real(1.0e-8));
    return fuzz_albedo(x, y) * a2 / (squared * squared) * Real(2.0 / SRBF_TWO_PI);
}

// An opaque surface by parameters of OpenPBR Surface 1.1, whose names they have; see PbrModel for their ranges.
struct PbrSurface {
    Vec3 base_color;
    Real metalness;
    Real diffuse_roughness;
    Real specular_weight;
    Vec3 specular_color;
    Real specular_roughness;
    Real specular_ior;
    Real coat_weight;
    Vec3 coat_color;
    Real coat_roughness;
    Real coat_ior;
    Real coat_darkening;
    Real fuzz_weight;
    Vec3 fuzz_color;
    Real fuzz_roughness;
};

// alpha of a roughness r: r^2, at least 1/1024.
SRBF_FN Real alpha_of(Real roughness) { return max(roughness * roughness, Real(1.0 / 1024.0)); }

// The roughness of what lies under a coat, whose interface spreads the light twice: (r^4 + 2 c^4)^(1/4), at most 1.
SRBF_FN Real roughened(Real base, Real coat, Real weight) {
    Real b2 = base * base;
    Real c2 = coat * coat;
    Real fourth = min(b2 * b2 + Real(2.0) * (c2 * c2), Real(1.0));
    return (Real(1.0) - weight) * base + weight * sqrt(sqrt(fourth));
}

// The Fresnel term of a metal at l . h = c: Schlick's with F0 and F90 = 1, times a tint that is 1 at c = 0 and 1 and
// the given one at c = 1/7, about 82 degrees ("F82", Kutz et al. 2021).
SRBF_FN Real metal_reflectance(Real c, Real weight, Real f0, Real tint) {
    Real schlick = f0 + (Real(1.0) - f0) * weight;
    Real at_82 = f0 + (Real(1.0) - f0) * Real(0.462664366);
    Real m = Real(1.0) - c;
    Real m2 = m * m;
    return max(schlick - c * (m2 * m2 * m2) * at_82 * (Real(1.0) - tint) * Real(17.651384), Real(0.0));
}

// A film on the base: weight, thickness [1e-6 m] and index of refraction.
struct PbrFilm {
    Real weight;
    Real thickness;
    Real ior;
};

// Facets of the base that are rougher along a tangent than across it: specular_roughness_anisotropy, and the cosine and
// sine of the tangent's azimuth.
struct PbrAnisotropy {
    Real amount;
    Real cosine;
    Real sine;
};

// 1 - cos(x), |x| <= 128 pi: five times the double angle, 1 - cos(2 a) = 2 v (2 - v) with v = 1 - cos(a).
SRBF_FN Real doubled(Real v) { return Real(2.0) * v * (Real(2.0) - v); }
SRBF_FN Real one_minus_cos(Real x) {
    Real s = sin(x * Real(1.0 / 64.0));
    return doubled(doubled(doubled(doubled(doubled(Real(2.0) * s * s)))));
}
// What the eye sees of a spectrum 1 + cos(2 pi path / wavelength + shift), less 1, for R, G, B, where cos(shift) is
// `turn`: Gaussians fitted to the Fourier transforms of the CIE curves (Belcour & Barla, "A Practical Extension to
// Microfacet Theory for the Modeling of Varying Iridescence", 2017). path [1e-6 m].
SRBF_FN Real film_wave(Real path, Real size, Real frequency, Real decay) {
    return size * (Real(1.0) - one_minus_cos(frequency * path)) * exp_of_lobe(-decay * path * path);
}
SRBF_FN Vec3 film_colour(Real path, Vec3 turn) {
    Real x = turn.x * (film_wave(path, Real(0.84659), Real(10.5620345), Real(0.170854696)) +
                       film_wave(path, Real(0.153868307), Real(14.0737068), Real(0.178766171)));
    Real y = turn.y * film_wave(path, Real(1.00022189), Real(11.2802026), Real(0.367330884));
    Real z = turn.z * film_wave(path, Real(1.00112249), Real(13.8757864), Real(0.261035245));
    return Vec3(Real(3.2404542) * x - Real(1.5371385) * y - Real(0.4985314) * z,
                Real(1.8760108) * y - Real(0.9692660) * x + Real(0.0415560) * z,
                Real(0.0556434) * x - Real(0.2040259) * y + Real(1.0572252) * z);
}

// The reflectance of a film on a base of reflectance f0 at an angle of cosine c: what the two interfaces reflect, with
// Schlick's Fresnel terms, and two orders of their interference, as KHR_materials_iridescence of glTF has it.
struct FilmBase {
    Real reflectance;  // of the base within the film
    Real turn;         // -1 if its wave keeps its sign
};
SRBF_FN FilmBase film_base(Real f0, Real ior, Real schlick) {
    Real root = sqrt(min(f0, Real(0.9999)));
    Real below = (Real(1.0) + root) / (Real(1.0) - root);
    Real share = (below - ior) / (below + ior);
    FilmBase base;
    base.reflectance = share * share + (Real(1.0) - share * share) * schlick;
    base.turn = select(below < ior, Real(1.0), Real(-1.0));
    return base;
}
SRBF_FN Real film_order(FilmBase base, Real above, Real first, Real second) {
    Real both = min(max(above * base.reflectance, Real(1.0e-5)), Real(0.9999));
    Real through = Real(1.0) - above;
    Real again = through * through * base.reflectance / (Real(1.0) - both);
    return max(above + again + Real(2.0) * (again - through) * (sqrt(both) * first + both * second), Real(0.0));
}
SRBF_FN Real fifth_power(Real x) { return (x * x) * (x * x) * x; }
SRBF_FN Vec3 film_reflectance(PbrFilm film, Vec3 f0, Real c) {
    Real within = sqrt(max(Real(1.0) - (Real(1.0) - c * c) / (film.ior * film.ior), Real(0.0)));
    Real normal = normal_reflectance(film.ior);
    Real above = normal + (Real(1.0) - normal) * fifth_power(Real(1.0) - c);
    Real schlick = fifth_power(Real(1.0) - within);
    FilmBase r = film_base(f0.x, film.ior, schlick);
    FilmBase g = film_base(f0.y, film.ior, schlick);
    FilmBase b = film_base(f0.z, film.ior, schlick);
    Real path = Real(2.0) * film.ior * film.thickness * within;
    Vec3 first = film_colour(path, Vec3(r.turn, g.turn, b.turn));
    Vec3 second = film_colour(Real(2.0) * path, Vec3(Real(1.0), Real(1.0), Real(1.0)));
    return Vec3(film_order(r, above, first.x, second.x), film_order(g, above, first.y, second.y),
                film_order(b, above, first.z, second.z));
}

// The base under a coat: its index of refraction is relative to the coat's. The specular weight scales F0 of the
// dielectric, whose index is that of the scaled one.
struct PbrBase {
    Real f0;
    Real ior;
    Real alpha;
};
SRBF_FN PbrBase pbr_base(PbrSurface of) {
    Real coat_ior = Real(1.0) + of.coat_weight * (of.coat_ior - Real(1.0));
    Real ratio = of.specular_ior / coat_ior;
    PbrBase base;
    base.f0 = min(of.specular_weight * normal_reflectance(max(max(ratio, Real(1.0) / ratio), Real(1.0))), Real(0.98));
    Real root = sqrt(base.f0);
    base.ior = (Real(1.0) + root) / (Real(1.0) - root);
    base.alpha = alpha_of(roughened(of.specular_roughness, of.coat_roughness, of.coat_weight));
    return base;
}
SRBF_FN Real half_cosine(Vec3 wl, Vec3 wv) {
    Vec3 sum = wl + wv;
    return min(Real(0.5) * sqrt(dot(sum, sum)), Real(1.0));
}

// The reflectances of the base's facets, for R, G, B: of the dielectric and of the metal, at l . h, and F0 of both.
struct PbrFacets {
    Vec3 dielectric;
    Vec3 metal;
    Vec3 dielectric_f0;
    Vec3 metal_f0;
};
SRBF_FN PbrFacets pbr_facets(PbrSurface of, PbrBase base, Vec3 wl, Vec3 wv) {
    Real c = half_cosine(wl, wv);
    Real schlick = schlick_weight(wl, wv);
    Real plain = dielectric_reflectance(c, base.ior);
    Vec3 f0 = of.base_color;
    PbrFacets facets;
    facets.dielectric = Vec3(plain, plain, plain);
    facets.metal = Vec3(metal_reflectance(c, schlick, f0.x, of.specular_color.x),
                        metal_reflectance(c, schlick, f0.y, of.specular_color.y),
                        metal_reflectance(c, schlick, f0.z, of.specular_color.z));
    facets.dielectric_f0 = Vec3(base.f0, base.f0, base.f0);
    facets.metal_f0 = f0;
    return facets;
}
// The same under a film, which covers its weight of the surface.
SRBF_FN PbrFacets pbr_film_facets(PbrSurface of, PbrFilm film, PbrBase base, Vec3 wl, Vec3 wv) {
    PbrFacets facets = pbr_facets(of, base, wl, wv);
    Real c = half_cosine(wl, wv);
    facets.dielectric = blended(facets.dielectric, film_reflectance(film, facets.dielectric_f0, c), film.weight);
    facets.metal = blended(facets.metal, film_reflectance(film, facets.metal_f0, c), film.weight);
    Vec3 f0 = facets.dielectric_f0;
    facets.dielectric_f0 = blended(f0, film_reflectance(film, f0, Real(1.0)), film.weight);
    f0 = facets.metal_f0;
    facets.metal_f0 = blended(f0, film_reflectance(film, f0, Real(1.0)), film.weight);
    return facets;
}

// The base: a dielectric over EON, blended with a metal by metalness [1/sr]. What the dielectric reflects towards the
// viewer is taken from the diffuse part (albedo scaling): a factor 1 - E(wv).
SRBF_FN Vec3 scattered_again_by(Vec3 f0, Real again) {
    return Vec3(Real(1.0) + f0.x * again, Real(1.0) + f0.y * again, Real(1.0) + f0.z * again);
}
SRBF_FN Vec3 pbr_base_value(PbrSurface of, PbrBase base, PbrFacets facets, Real density, Vec3 wl, Vec3 wv) {
    FacetAlbedo whole = facet_albedo(wv.z, base.alpha);
    Real again = scattered_again(whole);
    Vec3 f0 = facets.dielectric_f0;
    Vec3 dielectric = density * tinted(facets.dielectric, scattered_again_by(f0, again));
    Vec3 through = Vec3(Real(1.0) - lobe_albedo(whole, f0.x), Real(1.0) - lobe_albedo(whole, f0.y),
                        Real(1.0) - lobe_albedo(whole, f0.z));
    Vec3 glossy = tinted(dielectric, of.specular_color) +
                  tinted(through, eon_value(of.base_color, of.diffuse_roughness, wl, wv));
    Vec3 metal = (of.specular_weight * density) * tinted(facets.metal, scattered_again_by(facets.metal_f0, again));
    return blended(glossy, metal, of.metalness);
}

// What a coat leaves of light that is reflected between it and a base of this colour, relative to a base without it:
// (1 - K) / (1 - colour K), with K what the coat reflects back down of diffuse light, 1 - (1 - F0) / ior^2.
SRBF_FN Real darkened(Real colour, Real k, Real strength) {
    return Real(1.0) - strength + strength * (Real(1.0) - k) / (Real(1.0) - colour * k);
}

// rho(wl, wv) of the surface [1/sr], for R, G, B: fuzz over a coat over the base. Each layer takes its directional
// albedo at the viewer, E(wv), from what lies below, so that light and viewer may not be exchanged. The coat's
// colour is what passes it twice, at any angle.
SRBF_FN Vec3 pbr_layers_value(PbrSurface of, Vec3 base, Vec3 wl, Vec3 wv) {
    Real c = half_cosine(wl, wv);
    Real alpha = alpha_of(of.coat_roughness);
    FacetAlbedo whole = facet_albedo(wv.z, alpha);
    Real f0 = normal_reflectance(of.coat_ior);
    Real coat = of.coat_weight * ggx_facets(wl, wv, alpha) * dielectric_reflectance(c, of.coat_ior) *
                (Real(1.0) + f0 * scattered_again(whole));
    Real k = Real(1.0) - (Real(1.0) - f0) / (of.coat_ior * of.coat_ior);
    Real strength = of.coat_weight * of.coat_darkening;
    Vec3 dark = Vec3(darkened(of.base_color.x, k, strength), darkened(of.base_color.y, k, strength),
                     darkened(of.base_color.z, k, strength));
    Vec3 passed = tinted(dark, blended(Vec3(Real(1.0), Real(1.0), Real(1.0)), of.coat_color, of.coat_weight));
    Real through = Real(1.0) - of.coat_weight * lobe_albedo(whole, f0);
    Vec3 coated = Vec3(coat, coat, coat) + through * tinted(passed, base);

    Real y = max(of.fuzz_roughness, Real(0.01));
    Real below = Real(1.0) - of.fuzz_weight * fuzz_albedo(wv.z, y);
    return below * coated + (of.fuzz_weight * fuzz_value(wl, wv, y)) * of.fuzz_color;
}
SRBF_FN Vec3 pbr_value(PbrSurface of, Vec3 wl, Vec3 wv) {
    PbrBase base = pbr_base(of);
    Real density = ggx_facets(wl, wv, base.alpha);
    return pbr_layers_value(of, pbr_base_value(of, base, pbr_facets(of, base, wl, wv), density, wl, wv), wl, wv);
}
// The same with a film on the base.
SRBF_FN Vec3 pbr_film_value(PbrSurface of, PbrFilm film, Vec3 wl, Vec3 wv) {
    PbrBase base = pbr_base(of);
    PbrFacets facets = pbr_film_facets(of, film, base, wl, wv);
    return pbr_layers_value(of, pbr_base_value(of, base, facets, ggx_facets(wl, wv, base.alpha), wl, wv), wl, wv);
}
// The same with a film, whose weight may be 0, on facets that are rougher along a tangent than across it. Their albedo
// is taken for that of the geometric mean of both.
SRBF_FN Vec3 pbr_anisotropic_value(PbrSurface of, PbrFilm film, PbrAnisotropy facets_of, Vec3 wl, Vec3 wv) {
    PbrBase base = pbr_base(of);
    Real share = Real(1.0) - facets_of.amount;
    Real along = base.alpha * sqrt(Real(2.0) / (Real(1.0) + share * share));
    Real across = max(share * along, Real(1.0 / 1024.0));
    Real density = ggx_stretched_facets(turned(wl, facets_of.cosine, -facets_of.sine),
                                        turned(wv, facets_of.cosine, -facets_of.sine), along, across);
    base.alpha = sqrt(along * across);
    PbrFacets facets = pbr_film_facets(of, film, base, wl, wv);
    return pbr_layers_value(of, pbr_base_value(of, base, facets, density, wl, wv), wl, wv);
}
