// No include guard: angles.h includes this file for plain numbers, SIMD code once per instruction set.

/// θ = atan2(√sine2, c) [rad] for sine2, c ≥ 0 of any scale; 0 for the zero vector. The relative error is at most 4e-7,
/// also near 0 and π/2, where an arc cosine or arc sine loses half the digits. With t = sin²(θ/2), the polynomial
/// interpolates (arcsin(√t) / √t)² at Chebyshev nodes on [0, ½].
template <typename Real> Real polar_angle(Real sine2, Real c) {
    const Real length = sqrt(sine2 + c * c);
    const Real t = Real(0.5) * sine2 / max(length * (length + c), Real(k_min_length));
    Real p = Real(0.319542848);
    p = p * t - Real(0.265949534);
    p = p * t + Real(0.217428188);
    p = p * t + Real(0.0412315376);
    p = p * t + Real(0.119678547);
    p = p * t + Real(0.177428973);
    p = p * t + Real(0.333341786);
    p = p * t + Real(0.999999967);
    return Real(2.0) * sqrt(t * p);
}

/// φ = atan2(y, x) [rad], in [−π, π]; 0 for the zero vector. The absolute error is at most 4e-7. With
/// q = min(|x|,|y|) / max(|x|,|y|), arctan q = q P(q²), where P interpolates at Chebyshev nodes on [0, 1].
template <typename Real> Real azimuth(Real y, Real x) {
    const Real a = abs(x), b = abs(y), q = min(a, b) / max(max(a, b), Real(k_min_length)), t = q * q;
    Real p = Real(0.0027662835);
    p = p * t - Real(0.0157312491);
    p = p * t + Real(0.0421376236);
    p = p * t - Real(0.0745685483);
    p = p * t + Real(0.106183706);
    p = p * t - Real(0.141977978);
    p = p * t + Real(0.19991872);
    p = p * t - Real(0.333330367);
    p = p * t + Real(0.999999982);
    Real phi = q * p;
    phi = select(a < b, Real(k_pi / 2) - phi, phi);
    phi = select(x < Real(0.0), Real(k_pi) - phi, phi);
    return copysign(phi, y);
}
