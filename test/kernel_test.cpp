// Elementary functions, frames and Gaussian SRBFs of kernel.glsl.
#include "srbf/kernel.h"

#include "properties.h"

namespace srbf::kernel_test {
namespace {

template <typename Real> class KernelOf : public testing::Test {
  protected:
    static constexpr double k_epsilon = std::numeric_limits<Real>::epsilon();
    static Vec3<Real> convert(Vec3d w) { return {Real(w.x), Real(w.y), Real(w.z)}; }
    static Vec3d widen(Vec3<Real> w) { return {double(w.x), double(w.y), double(w.z)}; }
    std::mt19937_64 random{1};
};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(KernelOf, Reals);

double length(Vec3d a) { return std::sqrt(dot(a, a)); }

/// A direction at 1 − cos θ = t from `axis`, at azimuth phi.
Vec3d about(Vec3d axis, double t, double phi) {
    const Vec3d other = std::abs(axis.x) < 0.7 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
    const Vec3d x = normalize(cross(other, axis)), y = cross(axis, x);
    const double r = std::sqrt(std::max(0.0, t * (2 - t)));
    return r * std::cos(phi) * x + r * std::sin(phi) * y + (1 - t) * axis;
}

TYPED_TEST(KernelOf, OneMinusExpKeepsItsRelativeError) {
    using Real = TypeParam;
    double worst = 0;
    const auto check = [&](Real x) {
        const double exact = -std::expm1(-double(x));
        const double error = std::abs(double(Kernel<Real>::one_minus_exp(x)) - exact) / exact;
        worst = std::max(worst, std::isfinite(error) ? error : INFINITY);
    };
    for (double x = 1e-30; x < 700; x *= 1.003) check(Real(x));
    for (double x = 0.1; x < 0.15; x += 1e-6) check(Real(x));
    check(Real(700));
    EXPECT_LE(worst, (std::is_same_v<Real, float> ? 3e-7 : 5e-8));
    EXPECT_EQ(Kernel<Real>::one_minus_exp(Real(0)), Real(0));
}

TYPED_TEST(KernelOf, FramesAreOrthonormalAndRightHanded) {
    using Real = TypeParam;
    std::vector<Vec3d> axes{{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {1, 0, -0.0}};
    for (const double tilt : {1e-30, 1e-20, 1e-8, 1e-6, 1e-4, 1e-2, 0.1})
        for (const double z : {1.0, -1.0}) axes.push_back(normalize(Vec3d(tilt, -0.5 * tilt, z)));
    for (const double z : {1e-30, -1e-30, 1e-4, -1e-4}) axes.push_back(normalize(Vec3d(0.6, 0.8, z)));
    for (int i = 0; i < 2000; ++i) axes.push_back(random_direction(this->random));
    const double tolerance = 8 * this->k_epsilon;
    for (const Vec3d& axis : axes) {
        const Vec3<Real> n = this->convert(axis);
        const Vec3d x = this->widen(Kernel<Real>::from_frame(n, Real(1), Real(0), Real(0)));
        const Vec3d y = this->widen(Kernel<Real>::from_frame(n, Real(0), Real(1), Real(0)));
        const Vec3d z = this->widen(Kernel<Real>::from_frame(n, Real(0), Real(0), Real(1)));
        EXPECT_EQ(z.x, double(n.x));
        EXPECT_EQ(z.y, double(n.y));
        EXPECT_EQ(z.z, double(n.z));
        EXPECT_WITHIN(dot(x, x), 1, tolerance) << axis.x << ' ' << axis.y << ' ' << axis.z;
        EXPECT_WITHIN(dot(y, y), 1, tolerance) << axis.x << ' ' << axis.y << ' ' << axis.z;
        EXPECT_WITHIN(dot(x, y), 0, tolerance);
        EXPECT_WITHIN(dot(x, z), 0, tolerance);
        EXPECT_WITHIN(dot(y, z), 0, tolerance);
        EXPECT_WITHIN(dot(cross(x, y), z), 1, tolerance);
    }
    // Linear in its coordinates.
    const Vec3<Real> n = this->convert(axes.back());
    const Vec3d sum = this->widen(Kernel<Real>::from_frame(n, Real(2), Real(-3), Real(0.5)));
    EXPECT_WITHIN(length(sum), std::sqrt(4 + 9 + 0.25), 4 * tolerance);
}

TYPED_TEST(KernelOf, BothFormsOfTheGaussianAgree) {
    using Real = TypeParam;
    using K = Kernel<Real>;
    for (const double lambda : {0.0, 1e-3, 0.5, 10.0, 300.0}) {
        for (int i = 0; i < 1000; ++i) {
            const Vec3<Real> xi = this->convert(random_direction(this->random));
            const Vec3<Real> omega = this->convert(random_direction(this->random));
            const double exponent = lambda * (dot(this->widen(omega), this->widen(xi)) - 1);
            // Rounded to Real, the directions are unit vectors to that precision only.
            const double tolerance = 8 * this->k_epsilon * lambda;
            EXPECT_WITHIN(double(K::gaussian_exponent(omega, xi, Real(lambda))), exponent, tolerance);
            if (exponent < -60) continue;
            EXPECT_WITHIN_RELATIVE(double(K::gaussian(omega, xi, Real(lambda))), std::exp(exponent),
                                   tolerance + 8 * this->k_epsilon * (1 - exponent));
        }
    }
    for (const double lambda : {0.0, 1.0, 65504.0}) {
        const Vec3<Real> xi = this->convert(random_direction(this->random));
        EXPECT_EQ(K::gaussian(xi, xi, Real(lambda)), Real(1));
    }
}

TEST(Kernel, GaussianExponentKeepsItsDigitsInFloat) {
    // Relative errors of G at lambda = 1e4, where it is at least e^-4, against the unrounded directions.
    std::mt19937_64 random(2);
    const double lambda = 1e4;
    double worst = 0;
    for (int i = 0; i < 100000; ++i) {
        const Vec3d xi = random_direction(random);
        const double exponent = -4 * uniform(random);
        const Vec3d omega = about(xi, -exponent / lambda, 2 * k_pi * uniform(random));
        const Vec3f o = to_float(omega), x = to_float(xi);
        const float second = Kernel<float>::gaussian_exponent(o, x, float(lambda));
        worst = std::max(worst, std::abs(std::expm1(double(second) - exponent)));
    }
    EXPECT_WITHIN_RELATIVE(worst, 2.2e-5, 0.1);
}

TYPED_TEST(KernelOf, GaussianIntegralIsTheIntegralOfTheGaussian) {
    using Real = TypeParam;
    using K = Kernel<Real>;
    for (const double lambda : {0.0, 1e-3, 0.0624, 0.0626, 1.0, 30.0, 1e3, 6e4}) {
        const Vec3d xi = random_direction(this->random);
        // Simpson's rule over 1 - cos(theta) within the lobe; uniform azimuths.
        const double reach = std::min(2.0, 40 / std::max(lambda, 1e-9));
        constexpr int steps = 2000, turns = 3;
        double sum = 0;
        for (int i = 0; i <= steps; ++i)
            for (int k = 0; k < turns; ++k)
                sum += (i == 0 || i == steps ? 1
                        : i % 2              ? 4
                                             : 2) *
                       Kernel<double>::gaussian(about(xi, reach * i / steps, 2 * k_pi * k / turns), xi, lambda);
        const double integral = sum * reach / (3 * steps) * 2 * k_pi / turns;
        const double closed = lambda > 0 ? 2 * k_pi * -std::expm1(-2 * lambda) / lambda : 4 * k_pi;
        EXPECT_WITHIN_RELATIVE(closed, integral, 1e-8) << lambda;
        const double found = double(K::gaussian_integral(Real(lambda)));
        EXPECT_WITHIN_RELATIVE(found, integral, (std::is_same_v<Real, float> ? 2e-6 : 1.1e-6)) << lambda;
    }
    EXPECT_WITHIN_RELATIVE(double(K::gaussian_integral(Real(0))), 4 * k_pi, 2e-6);
}

TYPED_TEST(KernelOf, GaussianProductIsTheProduct) {
    using Real = TypeParam;
    using K = Kernel<Real>;
    for (int i = 0; i < 5000; ++i) {
        const Vec3d a = random_direction(this->random), b = random_direction(this->random);
        const double la = std::pow(10.0, -3 + 5 * uniform(this->random));
        const double lb = i % 10 == 0 ? 0.0 : std::pow(10.0, -3 + 5 * uniform(this->random));
        const auto product = K::gaussian_product(this->convert(a), Real(la), this->convert(b), Real(lb));
        const Vec3d omega = random_direction(this->random);
        const double tolerance = 8 * this->k_epsilon * (1 + la + lb);
        const Vec3d axis = la * a + lb * b;
        EXPECT_WITHIN(double(product.bandwidth), length(axis), tolerance);
        EXPECT_WITHIN(length(this->widen(product.centre)), 1, 4 * this->k_epsilon);
        EXPECT_LE(length(cross(this->widen(product.centre), axis)), tolerance);
        const double scale = length(axis) - la - lb;
        const double exponent = la * (dot(omega, a) - 1) + lb * (dot(omega, b) - 1);
        if (exponent < -60) continue;
        const double found =
            std::exp(scale) * double(K::gaussian(this->convert(omega), product.centre, product.bandwidth));
        EXPECT_WITHIN_RELATIVE(found, std::exp(exponent), 2 * tolerance) << la << ' ' << lb;
    }
}

TYPED_TEST(KernelOf, GaussianProductOfOppositeLobesIsAConstant) {
    using Real = TypeParam;
    using K = Kernel<Real>;
    for (const double lambda : {0.0, 0.5, 20.0}) {
        const Vec3<Real> xi = this->convert(random_direction(this->random));
        const auto product = K::gaussian_product(xi, Real(lambda), Real(-1) * xi, Real(lambda));
        EXPECT_EQ(product.bandwidth, Real(0));
        EXPECT_EQ(length(this->widen(product.centre)), 0);
        EXPECT_EQ(K::gaussian(xi, product.centre, product.bandwidth), Real(1));
    }
}

}  // namespace
}  // namespace srbf::kernel_test
