// The von Mises-Fisher distribution.

// The density of the von Mises-Fisher distribution: G divided by its integral [1/sr].
SRBF_FN Real vmf_pdf(Vec3 omega, Vec3 centre, Real bandwidth) {
    return gaussian(omega, centre, bandwidth) / gaussian_integral(bandwidth);
}

// The direction at the angle theta from the centre, with cos(theta) = 1 + below, and at azimuth 2 pi u2 around it.
SRBF_FN Vec3 off_centre(Vec3 centre, Real below, Real u2) {
    Real sine = sqrt(max(-below * (Real(2.0) + below), Real(0.0)));
    Real phi = Real(SRBF_TWO_PI) * u2;
    return from_frame(centre, sine * cos(phi), sine * sin(phi), Real(1.0) + below);
}

// Samples vmf_pdf from u1, u2 uniform in [0,1): cos(theta) - 1 = ln(u1 + (1 - u1) e^(-2 lambda)) / lambda. For
// lambda > 0.01, with width = 1 / lambda and rest = e^(-2 lambda).
SRBF_FN Real sample_below(Real width, Real rest, Real u1) {
    return log(max(u1 + (Real(1.0) - u1) * rest, Real(1.0e-35))) * width;
}
SRBF_FN Vec3 sample_sharp_vmf(Vec3 centre, Real width, Real rest, Real u1, Real u2) {
    return off_centre(centre, max(sample_below(width, rest, u1), Real(-2.0)), u2);
}

// Samples vmf_pdf for any lambda. For lambda <= 0.01 it uses the series of the logarithm; at lambda = 0 the cosine
// is 2 u1 - 1.
SRBF_FN Vec3 sample_vmf(Vec3 centre, Real bandwidth, Real u1, Real u2) {
    Real positive = max(bandwidth, Real(1.0e-6));
    Real x = (Real(1.0) - u1) * one_minus_exp(Real(2.0) * positive);
    Real series = -x * (Real(1.0) + x * (Real(0.5) + x * (Real(1.0 / 3.0) + x * Real(0.25))));
    Real rest = exp(max(Real(-2.0) * positive, Real(-80.0)));
    Real direct = log(max(u1 + (Real(1.0) - u1) * rest, Real(1.0e-35)));
    Real below = max(select(positive < Real(0.01), series, direct) / positive, Real(-2.0));
    return off_centre(centre, below, u2);
}
