// Compares elementary functions with the functions of `long double`, at the ends of their ranges, and where quadrants
// meet.
#include "srbf/elementary.h"

#include <limits>

#include "properties.h"

namespace srbf::elementary_test {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity(), k_nan = std::numeric_limits<double>::quiet_NaN();
constexpr int k_count = 100000;

/// |x − exact| in units of the last place of `exact`.
double error_in_ulp(double x, long double exact) {
    if (double(exact) == x) return 0;
    return double(std::abs((long double)(x)-exact) / std::ldexp(1.0L, std::ilogb(double(exact)) - 52));
}

using Function = double (*)(double);
using Exact = long double (*)(long double);
enum class Spacing { linear, logarithmic };
/// The largest error of f at numbers that are uniform in [low, high], or whose logarithms are [units of the last place].
double largest_error(Function f, Exact exact, double low, double high, Spacing spacing = Spacing::linear) {
    std::mt19937_64 random(1);
    double largest = 0;
    for (int i = 0; i < k_count; ++i) {
        const double u = uniform(random),
                     x = spacing == Spacing::logarithmic ? low * std::pow(high / low, u) : low + u * (high - low);
        largest = std::max(largest, error_in_ulp(f(x), exact(x)));
    }
    return largest;
}

TEST(Elementary, ErrorsAreThoseThatAreStated) {
    using namespace elementary;
    using enum Spacing;
    EXPECT_LE(largest_error(exp, std::exp, -700, 700), 1.1);
    EXPECT_LE(largest_error(exp, std::exp, -1, 1), 1.1);
    EXPECT_LE(largest_error(exp2, std::exp2, -1, 1), 2);
    EXPECT_LE(largest_error(log, std::log, 1e-300, 1e300, logarithmic), 2);
    EXPECT_LE(largest_error(log, std::log, 0.5, 2), 2);
    EXPECT_LE(largest_error(log2, std::log2, 1e-3, 1e3, logarithmic), 3);
    EXPECT_LE(largest_error(log10, std::log10, 1e-3, 1e3, logarithmic), 3);
    EXPECT_LE(largest_error(log1p, std::log1p, 1e-17, 100, logarithmic), 3);
    EXPECT_LE(largest_error(log1p, std::log1p, -0.999, -1e-17, logarithmic), 3);
    EXPECT_LE(largest_error(cbrt, std::cbrt, 1e-80, 1e80, logarithmic), 1.1);
    EXPECT_LE(largest_error(sin, std::sin, -1e5, 1e5), 3);
    EXPECT_LE(largest_error(cos, std::cos, -1e5, 1e5), 3);
    EXPECT_LE(largest_error(asin, std::asin, -1, 1), 6);
    EXPECT_LE(largest_error(acos, std::acos, -1, 1), 6);
    const auto angle = [](double x) { return elementary::atan2(x, 1.0); };
    const auto obtuse = [](double x) { return elementary::atan2(x, -1.0); };
    EXPECT_LE(largest_error(
                  angle, [](long double x) { return std::atan2(x, 1.0L); }, 1e-17, 1e17, logarithmic),
              4);
    EXPECT_LE(largest_error(
                  obtuse, [](long double x) { return std::atan2(x, -1.0L); }, 1e-17, 1e17, logarithmic),
              4);
    for (const double y : {1.0 / 6, 2.4, -4.0 / 3, 20.0}) {
        std::mt19937_64 random(2);
        for (int i = 0; i < k_count; ++i) {
            const double x = std::pow(1e6, 2 * uniform(random) - 1);
            const double log_error = 2 + 2 * std::abs(y * std::log(x));
            ASSERT_LE(error_in_ulp(elementary::pow(x, y), std::pow((long double)(x), (long double)(y))), log_error)
                << x << ' ' << y;
        }
    }
}

TEST(Elementary, FunctionsOfFloatsAreNearlyRoundedOnce) {
    std::mt19937_64 random(3);
    const auto error = [](float x, double exact) {
        return std::abs(double(x) - exact) / std::ldexp(1.0, std::ilogb(exact) - 23);
    };
    for (int i = 0; i < k_count; ++i) {
        const auto x = float(-87 + 175 * uniform(random)), y = float(std::exp(-80 + 160 * uniform(random)));
        ASSERT_LE(error(elementary::exp(x), std::exp(double(x))), 0.51) << x;
        ASSERT_LE(error(elementary::log(y), std::log(double(y))), 0.51) << y;
        const auto near_1 = float(0.5 + uniform(random));
        ASSERT_LE(error(elementary::log(near_1), std::log(double(near_1))), 0.51) << near_1;
    }
    EXPECT_EQ(elementary::exp(-100.f), 0);
    EXPECT_EQ(elementary::exp(89.f), std::numeric_limits<float>::infinity());
    EXPECT_EQ(elementary::exp(0.f), 1);
    EXPECT_EQ(elementary::log(1.f), 0);
    EXPECT_EQ(elementary::log(0.f), -std::numeric_limits<float>::infinity());
    EXPECT_TRUE(std::isnan(elementary::log(-1.f)) && std::isnan(elementary::exp(float(k_nan))));
}

TEST(Elementary, FunctionsAreExactAtTheEndsOfTheirRanges) {
    namespace e = elementary;
    EXPECT_EQ(e::exp(0.0), 1);
    EXPECT_EQ(e::exp(-708.1), 0);
    EXPECT_EQ(e::exp(-k_infinity), 0);
    EXPECT_WITHIN_RELATIVE(e::exp(709.78), std::exp(709.78), 1e-15);
    EXPECT_EQ(e::exp(709.8), k_infinity);
    EXPECT_EQ(e::log(1.0), 0);
    EXPECT_EQ(e::log(0.0), -k_infinity);
    EXPECT_EQ(e::log(k_infinity), k_infinity);
    EXPECT_TRUE(std::isnan(e::log(-1.0)));
    EXPECT_WITHIN_RELATIVE(e::log(1e-310), std::log(1e-310), 1e-15);
    EXPECT_EQ(e::log1p(-1.0), -k_infinity);
    EXPECT_EQ(e::log1p(1e-20), 1e-20);
    EXPECT_EQ(e::pow(0.0, 0.5), 0);
    EXPECT_EQ(e::pow(0.0, 0.0), 1);
    EXPECT_EQ(e::pow(0.0, -1.0), k_infinity);
    EXPECT_EQ(e::pow(1.0, 1e300), 1);
    EXPECT_WITHIN_RELATIVE(e::pow(-2.0, 3.0), -8, 1e-15);
    EXPECT_WITHIN_RELATIVE(e::pow(-2.0, 4.0), 16, 1e-15);
    EXPECT_TRUE(std::isnan(e::pow(-2.0, 0.5)));
    EXPECT_EQ(e::cbrt(0.0), 0);
    EXPECT_EQ(e::cbrt(-8.0), -2);
    EXPECT_EQ(e::cbrt(k_infinity), k_infinity);
    EXPECT_EQ(e::cbrt(0x1p1023), 0x1p341);
    EXPECT_EQ(e::cbrt(-0x1p-1074), -0x1p-358);
    for (const double x : {1.5, -1.5}) EXPECT_TRUE(std::isnan(e::acos(x)) && std::isnan(e::asin(x)));
    EXPECT_EQ(e::acos(1.0), 0);
    for (const Function f : {Function(e::sin), Function(e::cos)}) EXPECT_TRUE(std::isnan(f(k_infinity)));
    // Reduced modulo the double 2π, which is exact.
    EXPECT_EQ(e::sin(1e22), e::sin(std::fmod(1e22, 2 * k_pi)));
    for (const Function f : {Function(e::exp), Function(e::log), Function(e::log1p), Function(e::cbrt),
                             Function(e::sin), Function(e::cos), Function(e::asin), Function(e::acos)})
        EXPECT_TRUE(std::isnan(f(k_nan)));
}

TEST(Elementary, AnglesAreThoseOfTheirQuadrant) {
    const double values[] = {0.0, -0.0, 1.0, -1.0, 1e-300, -1e-300, 1e300, k_infinity, -k_infinity};
    for (const double y : values)
        for (const double x : values) {
            const double expected = std::atan2(y, x), found = elementary::atan2(y, x);
            EXPECT_WITHIN(found, expected, 1e-15) << y << ' ' << x;
            EXPECT_EQ(std::signbit(found), std::signbit(expected)) << y << ' ' << x;
        }
    EXPECT_TRUE(std::isnan(elementary::atan2(k_nan, 1.0)) && std::isnan(elementary::atan2(1.0, k_nan)));
}

}  // namespace
}  // namespace srbf::elementary_test
