// Gaussian SRBFs.

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
};

// G(omega.xi1 | l1) G(omega.xi2 | l2) is exp(bandwidth - l1 - l2) G(omega.centre | bandwidth), where bandwidth centre =
// l1 xi1 + l2 xi2. The width is 1 / bandwidth. The centre is the zero vector if the bandwidth is 0.
SRBF_FN GaussianProduct gaussian_product(Vec3 centre1, Real bandwidth1, Vec3 centre2, Real bandwidth2) {
    Vec3 axis = bandwidth1 * centre1 + bandwidth2 * centre2;
    Real squared = dot(axis, axis);
    GaussianProduct product;
    product.width = inversesqrt(max(squared, Real(1.0e-30)));
    product.bandwidth = squared * product.width;
    product.centre = product.width * axis;
    return product;
}
