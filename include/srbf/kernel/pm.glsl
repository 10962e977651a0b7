// Parameterized multivariate SRBFs. The host defines
//   Pm                      a handle of a multivariate model with the functions
//     pm_lobes(pm), pm_variates(pm)          J, N                            [int, N <= SRBF_MAX_VARIATES]
//     pm_weight_l(pm, n), pm_weight_v(pm, n) a_n, b_n of variate n
//     pm_centre(pm, j, n), pm_log2_falloff(pm, j, n)  xi_jn (unit vector), lambda_jn log2(e) / 2 >= 0
//     pm_axial(pm), pm_down(pm, j, n)        true if every centre is +z or -z; true if this one is -z  [bool]
//     pm_reciprocal(pm)                      true if light and viewer may be exchanged  [bool]
//     pm_coefficient(pm, j), pm_log2_scale(pm, j)  beta_j (R, G, B), s_j log2(e)
//     pm_features(pm), pm_exponent(pm, j, k)       F [int, <= SRBF_TERMS], kappa_jk log2(e)

#define SRBF_MAX_VARIATES 8

// psi = normalize(a wl + b wv): the half vector at (1,1), the light at (1,0), the view at (0,1). It is the zero
// vector where a wl + b wv vanishes (b = -a, wl = wv); a kernel of it is then finite, exp(-lambda / 2).
SRBF_FN Vec3 psi(Vec3 wl, Vec3 wv, Real a, Real b) {
    Vec3 d = a * wl + b * wv;
    return inversesqrt(max(dot(d, d), Real(1.0e-20))) * d;
}

// d psi / d angle for (a, b) = (cos angle, sin angle): the component of -b wl + a wv orthogonal to psi, divided by
// |a wl + b wv|.
SRBF_FN Vec3 psi_by_angle(Vec3 wl, Vec3 wv, Real a, Real b) {
    Vec3 d = a * wl + b * wv;
    Real reciprocal = inversesqrt(max(dot(d, d), Real(1.0e-20)));
    Vec3 across = reciprocal * (a * wv - b * wl);
    Vec3 direction = reciprocal * d;
    return across - dot(across, direction) * direction;
}

#define SRBF_TERMS 4

// The further features x_k, in which the exponent of a lobe is linear; srbf/models/exponent_terms.h lists their
// weights. Each is at most 0 above the horizon and symmetric in (wl, wv). Only x_0 is unbounded; its weight must be
// >= 0 so that the lobe is bounded at the horizon. The last two shape the mirror direction: measured peaks are
// pointed, and their widths in the plane of incidence and across it differ. x_2 is nearly -|cl - cv|, without the
// crease at cl = cv, which would be visible in a highlight. Cosines below 1e-6 count as 1e-6.

// The features. cl and cv are the cosines of wl and wv to the normal, h is their half vector:
//   x_0 = log(cl cv)
//   x_1 = wl . h - 1
//   x_2 = 1/20 - sqrt((cl - cv)^2 + sin^2(theta_h)/16 + 1/400)
//   x_3 = -sin(theta_h)
struct PmFeatures {
    Real x[SRBF_TERMS];
};

// The further features of (wl, wv). Only the first `count` are computed, the number in the model's form; the others
// are not read.
SRBF_FN PmFeatures pm_further_features(int count, Vec3 wl, Vec3 wv) {
    PmFeatures features;
    for (int k = 0; k < SRBF_TERMS; ++k) features.x[k] = Real(0.0);
    if (count > 0) features.x[0] = log(max(wl.z, Real(1.0e-6)) * max(wv.z, Real(1.0e-6)));
    if (count > 1) {
        Vec3 sum = wl + wv;
        Real squared = max(dot(sum, sum), Real(1.0e-12));
        Real across = (sum.x * sum.x + sum.y * sum.y) / squared;
        Real apart = wl.z - wv.z;
        features.x[1] = Real(0.5) * sqrt(squared) - Real(1.0);
        features.x[2] = Real(0.05) - sqrt(apart * apart + Real(0.0625) * across + Real(0.0025));
        features.x[3] = -sqrt(across);
    }
    return features;
}

// psi(wl, wv) in the form that axial lobes need: sin^2 and cos of its angle to the normal.
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
//     s_j log2(e) + sum_k (kappa_jk log2(e)) x_k - sum_n (lambda_jn log2(e) / 2) |psi_n - xi_jn|^2.
// pm_with_variate adds the term of a variate, pm_with_features those of the features. pm_power clamps the exponent
// to at most 100, so that every sum of lobes of a stored model is finite in float. It also clamps it to at least
// -100 (8e-31 of the coefficient), so that no product with a stored coefficient is subnormal, where arithmetic is
// many times slower.

SRBF_FN Real pm_with_variate(Pm pm, int j, int n, Real exponent, Real squared_distance_) {
    return exponent - Real(pm_log2_falloff(pm, j, n)) * squared_distance_;
}
SRBF_FN Real pm_with_features(Pm pm, int j, Real exponent, PmFeatures features) {
    Real sum = exponent;
    for (int k = 0; k < pm_features(pm); ++k) sum = sum + Real(pm_exponent(pm, j, k)) * features.x[k];
    return sum;
}
SRBF_FN Real pm_power(Real exponent) { return exp2(max(min(exponent, Real(100.0)), Real(-100.0))); }

// The variates of a pair: psi_n, or of axial lobes its squared distances from +z and -z, which suffice.
struct PmVariates {
    Vec3 x[SRBF_MAX_VARIATES];
};
SRBF_FN PmVariates pm_variates_of(Pm pm, Vec3 wl, Vec3 wv) {
    PmVariates of_pair;
    for (int n = 0; n < pm_variates(pm); ++n) {
        if (pm_axial(pm)) {
            AxialPsi psi_ = axial_psi(wl, wv, Real(pm_weight_l(pm, n)), Real(pm_weight_v(pm, n)));
            of_pair.x[n] = Vec3(squared_distance_from_pole(psi_, Real(1.0)),
                                squared_distance_from_pole(psi_, Real(-1.0)), Real(0.0));
        } else {
            of_pair.x[n] = psi(wl, wv, Real(pm_weight_l(pm, n)), Real(pm_weight_v(pm, n)));
        }
    }
    return of_pair;
}
// Lobe j with the terms of its variates, from the exponent of its scale and features on.
SRBF_FN Real pm_lobe(Pm pm, int j, Real exponent, PmVariates of_pair) {
    Real sum = exponent;
    for (int n = 0; n < pm_variates(pm); ++n) {
        if (pm_axial(pm))
            sum = pm_with_variate(pm, j, n, sum, pm_down(pm, j, n) ? of_pair.x[n].y : of_pair.x[n].x);
        else
            sum = pm_with_variate(pm, j, n, sum, squared_distance(of_pair.x[n], pm_centre(pm, j, n)));
    }
    return pm_power(sum);
}

// g(wl, wv) = sum_j beta_j e^(s_j) prod_n G(psi_n . xi_jn | lambda_jn) prod_k e^(kappa_jk x_k(wl, wv)) [1/sr], for
// R, G, B. Here psi_n = normalize(a_n wl + b_n wv), and x_k are the further features, which are symmetric.
// rho(wl, wv) = g(wl, wv), or the mean of g(wl, wv) and g(wv, wl) in a reciprocal model. A negative sum counts as 0:
// the colour of a spectral model's lobe may have a negative channel.
SRBF_FN Vec3 pm_value(Pm pm, Vec3 wl, Vec3 wv) {
    PmVariates of_pair = pm_variates_of(pm, wl, wv);
    PmVariates exchanged = pm_variates_of(pm, wv, wl);
    PmFeatures features = pm_further_features(pm_features(pm), wl, wv);
    Vec3 sum = Vec3(Real(0.0), Real(0.0), Real(0.0));
    for (int j = 0; j < pm_lobes(pm); ++j) {
        Real exponent = pm_with_features(pm, j, Real(pm_log2_scale(pm, j)), features);
        Real power = pm_lobe(pm, j, exponent, of_pair);
        if (pm_reciprocal(pm)) power = Real(0.5) * (power + pm_lobe(pm, j, exponent, exchanged));
        sum = sum + power * pm_coefficient(pm, j);
    }
    return Vec3(max(sum.x, Real(0.0)), max(sum.y, Real(0.0)), max(sum.z, Real(0.0)));
}
