// UTIA tables. The tables are synthetic, since no file of the database is available.
#include "base/printable.h"
#include "measured/readers.h"
#include "measured/tables.h"
#include "measured_files.h"

namespace srbf::utia_test {
namespace {

/// Linear in θ, and in φ by a triangle wave, so that interpolation gives it back.
double wave(double i) { return std::abs(i - 24); }
double function_at(double l, double p, double v, double q, int c) {
    return (c + 1) * (1 + 0.2 * l) * (3 - 0.3 * v) * (1 + 0.1 * wave(p)) * (2 - 0.05 * wave(q));
}

EvaluatedTable table() {
    return *read_utia(utia_file([](int l, int p, int v, int q, int c) { return function_at(l, p, v, q, c); }), "t");
}

TEST(Utia, InterpolatesItsNodes) {
    const EvaluatedTable t = table();
    std::mt19937_64 random(1);
    for (int i = 0; i < 20000; ++i) {
        // The angles reach 89°: beyond 75° extrapolation is linear.
        const double l = 5.93 * uniform(random), v = 5.93 * uniform(random), p = 48 * uniform(random),
                     q = 48 * uniform(random);
        const Vec3f wl = to_float(spherical(l * 15 * k_degree, p * 7.5 * k_degree));
        const Vec3f wv = to_float(spherical(v * 15 * k_degree, q * 7.5 * k_degree));
        const Rgb f = value(t, wl, wv);
        for (int c = 0; c < 3; ++c) EXPECT_WITHIN_RELATIVE(f[c], function_at(l, p, v, q, c), 3e-4);
    }
}

TEST(Utia, IsReadByItsSize) {
    const Bytes bytes = utia_file([](int, int, int, int, int c) { return c == 0 ? -0.25 : 0.5; });
    const auto measured = checked(read_measured(bytes, "t"));
    EXPECT_EQ(measured->format, "UTIA");
    EXPECT_FALSE(is_isotropic(*measured));
    // Negative values are not masked: a colour may lie outside of the gamut.
    const Vec3f wl{0, 0, 1}, wv{0.6f, 0, 0.8f};
    EXPECT_EQ(signed_value(*measured, wl, wv), (Rgb{-0.25f, 0.5f, 0.5f}));
    EXPECT_EQ(value(*measured, wl, wv), (Rgb{0, 0.5f, 0.5f}));
    for (const std::size_t size : {bytes.size() - 8, bytes.size() - 1, std::size_t(8), std::size_t(0)})
        EXPECT_FALSE(read_utia(std::span(bytes).first(size), "t").ok());
}

TEST(Utia, NonFiniteValuesAreMasked) {
    const auto t =
        checked(read_utia(utia_file([](int l, int, int v, int, int c) {
                              return l == 2 && v == 3 && c == 1 ? std::nan("") : l == 4 && c == 0 ? INFINITY : 1.0;
                          }),
                          "t"));
    EXPECT_EQ(t->functions->lines()[1].text, grouped(48 * 48 + 48 * 288) + " of " + grouped(288 * 288));
    const auto at = [&](double theta_l, double theta_v) {
        return value(*t, to_float(spherical(theta_l * k_degree, 0.1)), to_float(spherical(theta_v * k_degree, 2.0)));
    };
    EXPECT_TRUE(std::isnan(at(31, 44).r) && std::isnan(at(31, 44).g) && std::isnan(at(31, 44).b));
    EXPECT_TRUE(std::isnan(at(55, 5).b));
    EXPECT_EQ(at(10, 10), (Rgb{1, 1, 1}));
    const double nan = std::nan("");
    EXPECT_FALSE(read_utia(utia_file([&](int, int, int, int, int) { return nan; }), "t").ok());
}

TEST(Utia, SatisfiesTheContractOfABrdf) {
    std::mt19937_64 random(2);
    const auto t = checked(read_utia(utia_file([&](int, int, int, int, int) { return 3 * uniform(random) - 1; }), "t"));
    for (int i = 0; i < 20000; ++i) {
        const Vec3f wl = direction_with_extremes(random), wv = to_float(random_direction(random));
        ASSERT_TRUE(satisfies_contract(value(*t, wl, wv), wl, wv, false));
    }
}

}  // namespace
}  // namespace srbf::utia_test
