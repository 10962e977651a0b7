// Lambert and GGX.

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

// ggx_facets for facets with roughness alpha_x along x and alpha_y along y [1/sr].
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

// rho(wl, wv) = kd / pi + the two lobes [1/sr]. In a model with one lobe, the Fresnel term of the second one is 0.
SRBF_FN Vec3 ggx_value(Vec3 diffuse, GgxLobe first, GgxLobe second, Vec3 wl, Vec3 wv) {
    return Real(2.0 / SRBF_TWO_PI) * diffuse + ggx_lobe_value(first, wl, wv) + ggx_lobe_value(second, wl, wv);
}
