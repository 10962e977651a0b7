// Parameterizations and multivariate models of kernel.glsl, also with a dual-number type.
#include "models.h"
#include "properties.h"
#include "srbf/kernel.h"

namespace srbf::variate_test::dual {

/// v + d ε with ε² = 0: a value v and its derivative d.
struct Dual {
    double v = 0, d = 0;
    Dual() = default;
    explicit Dual(double value, double derivative = 0) : v(value), d(derivative) {}
};
inline Dual operator+(Dual a, Dual b) { return Dual(a.v + b.v, a.d + b.d); }
inline Dual operator-(Dual a, Dual b) { return Dual(a.v - b.v, a.d - b.d); }
inline Dual operator-(Dual a) { return Dual(-a.v, -a.d); }
inline Dual operator*(Dual a, Dual b) { return Dual(a.v * b.v, a.d * b.v + a.v * b.d); }
inline Dual operator/(Dual a, Dual b) { return Dual(a.v / b.v, (a.d * b.v - a.v * b.d) / (b.v * b.v)); }
inline bool operator<(Dual a, Dual b) { return a.v < b.v; }
inline Dual exp(Dual a) { return Dual(std::exp(a.v), std::exp(a.v) * a.d); }
inline Dual exp2(Dual a) { return exp(Dual(std::log(2.0)) * a); }
inline Dual log(Dual a) { return Dual(std::log(a.v), a.d / a.v); }
inline Dual sqrt(Dual a) { return Dual(std::sqrt(a.v), a.d / (2 * std::sqrt(a.v))); }
inline Dual inversesqrt(Dual a) { return Dual(1) / sqrt(a); }
inline Dual cos(Dual a) { return Dual(std::cos(a.v), -std::sin(a.v) * a.d); }
inline Dual sin(Dual a) { return Dual(std::sin(a.v), std::cos(a.v) * a.d); }
inline Dual min(Dual a, Dual b) { return b < a ? b : a; }
inline Dual max(Dual a, Dual b) { return a < b ? b : a; }
inline Dual select(bool condition, Dual a, Dual b) { return condition ? a : b; }

}  // namespace srbf::variate_test::dual

namespace srbf::variate_test {
namespace {

using dual::Dual;
using K = Kernel<double>;

double length(Vec3d a) { return std::sqrt(dot(a, a)); }
Vec3<Dual> constant(Vec3d w) { return {Dual(w.x), Dual(w.y), Dual(w.z)}; }
bool all_near(Vec3d a, Vec3d b, double relative, double absolute = 0) {
    const auto is_near = [&](double x, double y) { return near(x, y, relative * std::abs(y) + absolute); };
    return is_near(a.x, b.x) && is_near(a.y, b.y) && is_near(a.z, b.z);
}

/// g of PmModel's docstring, written out in long double.
Vec3d written_sum(const PmModel& model, Vec3d wl, Vec3d wv) {
    const long double l[3] = {wl.x, wl.y, wl.z}, v[3] = {wv.x, wv.y, wv.z};
    long double sum[3] = {0, 0, 0};
    for (int j = 0; j < model.lobes; ++j) {
        long double product = std::exp((long double)(model.log_scale[std::size_t(j)]));
        for (int n = 0; n < model.variates; ++n) {
            const auto i = std::size_t(j * model.variates + n);
            const long double a = model.parameterization[std::size_t(n)].a,
                              b = model.parameterization[std::size_t(n)].b;
            const long double xi[3] = {model.centre[i].x, model.centre[i].y, model.centre[i].z};
            long double cosine = 0, square = 0, unit = 0;
            for (int k = 0; k < 3; ++k) {
                cosine += (a * l[k] + b * v[k]) * xi[k];
                square += (a * l[k] + b * v[k]) * (a * l[k] + b * v[k]);
                unit += xi[k] * xi[k];
            }
            // Centres are unit vectors to float's precision.
            product *= std::exp((long double)(model.bandwidth[i]) * (cosine / std::sqrt(square * unit) - 1));
        }
        if (const int F = features(model.form); F > 0) {
            const float* kappa = &model.exponent[std::size_t(j * F)];
            const long double area = std::max(l[2], 1e-6L) * std::max(v[2], 1e-6L);
            long double square = 0;
            for (int k = 0; k < 3; ++k) square += (l[k] + v[k]) * (l[k] + v[k]);
            const long double cos2_theta_h = (l[2] + v[2]) * (l[2] + v[2]) / square;  // cos²θh
            product *= std::pow(area, (long double)(kappa[0]));
            const long double across = std::max(1 - cos2_theta_h, 0.0L), cosine_difference = l[2] - v[2];
            if (F > 1)
                product *= std::exp(kappa[1] * (std::sqrt(square) / 2 - 1) +
                                    kappa[2] * (1 / 20.0L - std::sqrt(cosine_difference * cosine_difference +
                                                                      across / 16 + 1 / 400.0L)) -
                                    kappa[3] * std::sqrt(across));
        }
        for (int c = 0; c < 3; ++c) sum[c] += product * (long double)(model.coefficient[std::size_t(j)][c]);
    }
    return {double(sum[0]), double(sum[1]), double(sum[2])};
}

/// The formula of PmModel's docstring.
Vec3d written_value(const PmModel& model, Vec3d wl, Vec3d wv) {
    const Vec3d sum = written_sum(model, wl, wv);
    return is_reciprocal(model.form) ? 0.5 * (sum + written_sum(model, wv, wl)) : sum;
}

TEST(Variate, PsiIsTheNormalisedSum) {
    std::mt19937_64 random(1);
    for (int i = 0; i < 2000; ++i) {
        const Vec3d wl = random_direction(random), wv = random_direction(random);
        const double angle = 2 * k_pi * uniform(random), a = std::cos(angle), b = std::sin(angle);
        const Vec3d p = K::psi(wl, wv, a, b);
        EXPECT_WITHIN(length(p), 1, 1e-14);
        EXPECT_WITHIN(length(cross(p, a * wl + b * wv)), 0, 1e-14);
        EXPECT_GT(dot(p, a * wl + b * wv), 0);
        EXPECT_LE(length(K::psi(wl, wv, 7 * a, 7 * b) - p), 1e-14);  // independent of the scale of (a, b)
        EXPECT_LE(length(K::psi(wv, wl, b, a) - p), 1e-14);          // swapping the directions and the weights
        EXPECT_LE(length(K::psi(wl, wv, -a, -b) + p), 1e-14);
        EXPECT_LE(length(K::psi(wl, wv, 1, 0) - wl), 1e-14);
        EXPECT_LE(length(K::psi(wl, wv, 0, 1) - wv), 1e-14);
        const Vec3d h = K::psi(wl, wv, 1, 1);
        EXPECT_WITHIN(dot(h, wl), dot(h, wv), 1e-12 / length(wl + wv));
    }
}

TEST(Variate, PsiIsAUnitVectorUntilTheSumVanishes) {
    std::mt19937_64 random(9);
    for (const double distance : {1e-1, 1e-3, 1e-6, 1e-9}) {
        const Vec3d wl = random_direction(random), tangent = normalize(cross(wl, random_direction(random)));
        const Vec3d p = K::psi(wl, wl + distance * tangent, -1, 1);
        EXPECT_WITHIN(length(p), 1, 1e-14) << distance;
        EXPECT_WITHIN(dot(p, tangent), 1, 1e-6) << distance;
    }
}

TEST(Variate, PsiVanishesWhereTheSumDoes) {
    const Vec3f w = to_float(normalize(Vec3d(0.3, -0.5, 0.8))), zero = Kernel<float>::psi(w, w, -0.7f, 0.7f);
    EXPECT_EQ(zero.x, 0);
    EXPECT_EQ(zero.y, 0);
    EXPECT_EQ(zero.z, 0);
    EXPECT_WITHIN_RELATIVE(Kernel<float>::gaussian(zero, w, 6.0f), std::exp(-3.0), 1e-6);
    EXPECT_EQ(length(to_double(Kernel<float>::psi_by_angle(w, w, 0.0f, 0.0f))), 0);
    EXPECT_TRUE(std::isfinite(length(to_double(Kernel<float>::psi_by_angle(w, w, -0.7f, 0.7f)))));
}

TEST(Variate, PsiByAngleIsTheDerivative) {
    std::mt19937_64 random(2);
    for (int i = 0; i < 2000; ++i) {
        const Vec3d wl = random_direction(random), wv = random_direction(random);
        const double angle = 2 * k_pi * uniform(random), h = 1e-6;
        const auto psi_at = [&](double t) { return K::psi(wl, wv, std::cos(t), std::sin(t)); };
        const Vec3d derivative = K::psi_by_angle(wl, wv, std::cos(angle), std::sin(angle));
        const double steepness = 1 / length(std::cos(angle) * wl + std::sin(angle) * wv);
        const Vec3d difference = (0.5 / h) * (psi_at(angle + h) - psi_at(angle - h));
        EXPECT_LE(length(derivative - difference), 1e-9 * std::pow(steepness, 3));
        EXPECT_WITHIN(dot(derivative, psi_at(angle)), 0, 1e-13 * steepness);

        using D = Kernel<Dual>;
        const auto p = D::psi(constant(wl), constant(wv), Dual(std::cos(angle), -std::sin(angle)),
                              Dual(std::sin(angle), std::cos(angle)));
        EXPECT_LE(length(derivative - Vec3d(p.x.d, p.y.d, p.z.d)), 1e-13 * std::pow(steepness, 2));
        const auto f =
            Kernel<float>::psi_by_angle(to_float(wl), to_float(wv), float(std::cos(angle)), float(std::sin(angle)));
        EXPECT_LE(length(derivative - to_double(f)), 1e-6 * std::pow(steepness, 2));
    }
}

TEST(Variate, ModelMatchesTheFormula) {
    std::mt19937_64 random(3);
    for (int trial = 0; trial < 60; ++trial) {
        const PmModel model = random_model(random, {.axial = trial % 2 == 0,
                                                    .log_scale = trial % 3 == 0,
                                                    .form = k_forms[std::size_t(trial) / 6 % k_forms.size()]});
        for (int i = 0; i < 50; ++i) {
            const Vec3d wl = random_direction(random), wv = random_direction(random);
            const Vec3d f = K::pm_value(model, wl, wv);
            // A distant lobe is clamped at 2^-100 of its coefficient, which here is at most 1.
            const Vec3d written = written_value(model, wl, wv);
            EXPECT_TRUE(all_near(f, written, 1e-5, 1.001 * model.lobes * 0x1p-100));
            const Vec3f g = Kernel<float>::pm_value(model, to_float(wl), to_float(wv));
            if (std::min({f.x, f.y, f.z}) > 1e-25) {
                EXPECT_TRUE(all_near(to_double(g), f, 1e-4));
            }
        }
    }
}

TEST(Variate, DualNumbersDifferentiateTheModel) {
    std::mt19937_64 random(4);
    for (int trial = 0; trial < 200; ++trial) {
        const PmModel model = random_model(
            random,
            {.axial = trial % 2 == 0, .max_bandwidth = 30, .form = k_forms[std::size_t(trial) % k_forms.size()]});
        const Vec3d wl = random_direction(random), wv = random_direction(random), tangent = random_direction(random);
        const Vec3<Dual> dual_wl(Dual(wl.x, tangent.x), Dual(wl.y, tangent.y), Dual(wl.z, tangent.z));
        const Vec3<Dual> f = Kernel<Dual>::pm_value(model, dual_wl, constant(wv));
        const double h = 1e-6;
        const Vec3d difference =
            (0.5 / h) * (K::pm_value(model, wl + h * tangent, wv) - K::pm_value(model, wl - h * tangent, wv));
        const Vec3d value = K::pm_value(model, wl, wv);
        EXPECT_TRUE(all_near(Vec3d(f.x.v, f.y.v, f.z.v), value, 1e-13));
        for (const auto& [derivative, expected, scale] :
             {std::tuple(f.x.d, difference.x, value.x), {f.y.d, difference.y, value.y}, {f.z.d, difference.z, value.z}})
            EXPECT_WITHIN(derivative, expected, 1e-6 * (std::abs(expected) + 10 * scale));
    }
}

TEST(Variate, AxialModelsAreIsotropicAndOthersAreNot) {
    std::mt19937_64 random(6);
    int anisotropic = 0;
    for (int trial = 0; trial < 100; ++trial) {
        const PmModel axial = random_model(random, {.axial = true}), general = random_model(random, {.axial = false});
        const Vec3d wl = random_direction(random), wv = random_direction(random);
        const double angle = 1 + 4 * uniform(random);
        const Vec3d tl = rotate(wl, angle), tv = rotate(wv, angle);
        EXPECT_TRUE(all_near(K::pm_value(axial, tl, tv), K::pm_value(axial, wl, wv), 1e-11));
        const Vec3d f = to_double(Kernel<float>::pm_value(axial, to_float(wl), to_float(wv)));
        if (std::min({f.x, f.y, f.z}) > 1e-25) {
            const Vec3d t = to_double(Kernel<float>::pm_value(axial, to_float(tl), to_float(tv)));
            EXPECT_TRUE(all_near(t, f, 1e-4));
        }
        anisotropic += !all_near(K::pm_value(general, tl, tv), K::pm_value(general, wl, wv), 1e-3);
    }
    EXPECT_GT(anisotropic, 90);
}

TEST(Variate, FurtherFeaturesAreReciprocalAndNotPositive) {
    std::mt19937_64 random(10);
    for (int trial = 0; trial < 2000; ++trial) {
        const Vec3d wl = random_direction(random, 0), wv = trial % 4 == 0 ? mirror(wl) : random_direction(random, 0);
        const auto features = K::pm_further_features(SRBF_TERMS, wl, wv),
                   exchanged = K::pm_further_features(SRBF_TERMS, wv, wl);
        for (int k = 0; k < SRBF_TERMS; ++k) {
            EXPECT_LE(features.x[k], 1e-15) << k;
            EXPECT_WITHIN(features.x[k], exchanged.x[k], 1e-12) << k;
        }
        for (int count = 0; count < SRBF_TERMS; ++count) {
            const auto first = K::pm_further_features(count, wl, wv);
            for (int k = 0; k < count; ++k) EXPECT_EQ(first.x[k], features.x[k]) << k;
        }
    }
}

TEST(Variate, EqualWeightsMakeAModelReciprocal) {
    std::mt19937_64 random(7);
    int nonreciprocal = 0;
    for (int trial = 0; trial < 100; ++trial) {
        PmModel model = random_model(random, {.axial = trial % 2 == 0});
        const Vec3d wl = random_direction(random), wv = random_direction(random);
        nonreciprocal += !all_near(K::pm_value(model, wv, wl), K::pm_value(model, wl, wv), 1e-3);
        for (Parameterization& p : model.parameterization) p.b = p.a;
        EXPECT_TRUE(all_near(K::pm_value(model, wv, wl), K::pm_value(model, wl, wv), 1e-13));
    }
    EXPECT_GT(nonreciprocal, 90);
}

TEST(Variate, ExtremeStoredNumbersStayFinite) {
    std::mt19937_64 random(8);
    for (const float bandwidth : {0.f, k_half_max})
        for (const float scale : {-k_half_max, k_half_max})
            for (const Parameterization p : {Parameterization{k_half_max, k_half_max},
                                             {k_half_max, -k_half_max},
                                             {-k_half_max, k_half_max},
                                             {0x1p-24f, 0x1p-24f},
                                             {-0x1p-24f, 0x1p-24f}}) {
                PmModel model;
                model.lobes = k_max_lobes;
                model.variates = k_max_variates;
                model.coefficient.assign(k_max_lobes, {k_half_max, k_half_max, k_half_max});
                model.log_scale.assign(k_max_lobes, scale);
                model.centre.assign(k_max_lobes * k_max_variates, {0, 0, -1});
                model.bandwidth.assign(k_max_lobes * k_max_variates, bandwidth);
                model.parameterization.assign(k_max_variates, p);
                const Vec3f up(0, 0, 1), w = to_float(random_direction(random, 0)),
                                         low = to_float(spherical(1.57, 1.0));
                for (const auto& [wl, wv] : {std::pair(up, up), {up, w}, {w, w}, {w, mirror(w)}, {low, mirror(low)}}) {
                    const Rgb f = value(model, wl, wv);
                    EXPECT_TRUE(is_finite(f) && f.r >= 0 && f.g >= 0 && f.b >= 0) << bandwidth << ' ' << scale;
                }
            }
}

}  // namespace
}  // namespace srbf::variate_test
