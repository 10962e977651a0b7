#include "srbf/elementary.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace SRBF_NAMESPACE::elementary {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();
constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
constexpr double k_pi = 3.14159265358979323846, k_log2_e = 1.4426950408889634, k_ln_2 = 0.6931471805599453,
                 k_ln_10 = 2.302585092994046;
/// ln 2, ln 2 / 32 and π/2 as sums of parts (Cody and Waite). All parts but the last have so few bits that their
/// products with an exponent, or with a number of quarter turns up to 2²⁰, are exact.
constexpr double k_ln_2_high = 0x1.62e42fee00000p-1, k_ln_2_low = 0x1.a39ef35793c76p-33;
constexpr double k_ln_2_32_high = 0x1.62e42fee00000p-6, k_ln_2_32_low = 0x1.a39ef35793c76p-38;
/// 2^(i / 32)
constexpr std::array<double, 32> k_roots_of_2{
    0x1.0000000000000p+0, 0x1.059b0d3158574p+0, 0x1.0b5586cf9890fp+0, 0x1.11301d0125b51p+0, 0x1.172b83c7d517bp+0,
    0x1.1d4873168b9aap+0, 0x1.2387a6e756238p+0, 0x1.29e9df51fdee1p+0, 0x1.306fe0a31b715p+0, 0x1.371a7373aa9cbp+0,
    0x1.3dea64c123422p+0, 0x1.44e086061892dp+0, 0x1.4bfdad5362a27p+0, 0x1.5342b569d4f82p+0, 0x1.5ab07dd485429p+0,
    0x1.6247eb03a5585p+0, 0x1.6a09e667f3bcdp+0, 0x1.71f75e8ec5f74p+0, 0x1.7a11473eb0187p+0, 0x1.82589994cce13p+0,
    0x1.8ace5422aa0dbp+0, 0x1.93737b0cdc5e5p+0, 0x1.9c49182a3f090p+0, 0x1.a5503b23e255dp+0, 0x1.ae89f995ad3adp+0,
    0x1.b7f76f2fb5e47p+0, 0x1.c199bdd85529cp+0, 0x1.cb720dcef9069p+0, 0x1.d5818dcfba487p+0, 0x1.dfc97337b9b5fp+0,
    0x1.ea4afa2a490dap+0, 0x1.f50765b6e4540p+0,
};
constexpr double k_half_pi_1 = 0x1.921fb54400000p+0, k_half_pi_2 = 0x1.0b4611a600000p-34,
                 k_half_pi_3 = 0x1.3198a2e037073p-69;

/// Σ_k c[k] x^k. Even and odd terms are summed separately, so that the processor computes them in parallel.
template <std::size_t N> double polynomial(double x, const std::array<double, N>& c) {
    const double x2 = x * x;
    double even = 0, odd = 0;
    for (std::size_t k = N; k-- > 0;) {
        double& sum = k % 2 == 0 ? even : odd;
        sum = sum * x2 + c[k];
    }
    return even + x * odd;
}

/// c[k] = sign^k / (first + step k)!
template <std::size_t N> constexpr std::array<double, N> inverse_factorials(int first, int step, double sign) {
    std::array<double, N> c{};
    double factorial = 1, factor = 1;
    for (int i = 2; i <= first; ++i) factorial *= i;
    for (std::size_t k = 0; k < N; ++k) {
        c[k] = factor / factorial;
        for (int i = 1; i <= step; ++i) factorial *= first + step * int(k) + i;
        factor *= sign;
    }
    return c;
}
/// c[k] = sign^k / (2k + 3)
template <std::size_t N> constexpr std::array<double, N> inverse_odd_numbers(double sign) {
    std::array<double, N> c{};
    double factor = 1;
    for (std::size_t k = 0; k < N; ++k, factor *= sign) c[k] = factor / double(2 * k + 3);
    return c;
}

/// The nearest integer, for |x| < 2⁵¹: doubles near 1.5 · 2⁵² are integers.
double round_to_integer(double x) {
    constexpr double k_shift = 0x1.8p52;
    return (x + k_shift) - k_shift;
}

/// 2^k for −1022 ≤ k ≤ 1023.
double power_of_2(int k) { return std::bit_cast<double>(std::uint64_t(k + 1023) << 52); }

/// x = 2^k m with √½ ≤ m < √2.
struct Split {
    double k, m;
};
Split split(double x) {
    constexpr std::uint64_t k_root_half = 0x3fe6a09e667f3bcd;  // the bits of √½
    const auto bits = std::bit_cast<std::uint64_t>(x);
    const auto exponent = std::int64_t(bits - k_root_half) >> 52;
    return {double(exponent), std::bit_cast<double>(bits - (std::uint64_t(exponent) << 52))};
}

/// x = remainder + quarters π/2, with quarters modulo 4.
struct ReducedAngle {
    double remainder;
    int quarters;
};
ReducedAngle reduce_angle(double x) {
    if (!(std::abs(x) <= 1e5)) x = std::fmod(x, 2 * k_pi);  // exact; NaN if x is not finite
    if (std::isnan(x)) return {x, 0};
    const double n = round_to_integer(x * (2 / k_pi));
    return {((x - n * k_half_pi_1) - n * k_half_pi_2) - n * k_half_pi_3, int(std::int64_t(n) & 3)};
}
/// x − x³/3! + x⁵/5! − ..., and 1 − x²/2! + x⁴/4! − ..., for |x| ≤ π/4.
double sine_series(double x) {
    static constexpr auto c = inverse_factorials<8>(3, 2, -1);
    const double x2 = x * x;
    return x - x * x2 * polynomial(x2, c);
}
double cosine_series(double x) {
    static constexpr auto c = inverse_factorials<7>(4, 2, -1);
    const double x2 = x * x, half = 0.5 * x2, whole = 1 - half;
    return whole + (((1 - whole) - half) + x2 * x2 * polynomial(x2, c));
}
double sine(ReducedAngle x) {
    const double magnitude = x.quarters % 2 == 0 ? sine_series(x.remainder) : cosine_series(x.remainder);
    return x.quarters < 2 ? magnitude : -magnitude;
}

/// arctan x for 0 ≤ x ≤ 1. The angle is halved twice; the series t − t³/3 + t⁵/5 − ... then has t ≤ tan(π/16).
double arctangent(double x) {
    static constexpr auto c = inverse_odd_numbers<11>(-1);
    double t = x;
    for (int i = 0; i < 2; ++i) t = t / (1 + std::sqrt(1 + t * t));
    const double t2 = t * t;
    return 4 * (t - t * t2 * polynomial(t2, c));
}

}  // namespace

// With x = k ln 2 / 32 + r, |r| ≤ ln 2 / 64, the result is 2^(k / 32) (1 + r + r²/2! + ...).
double exp(double x) {
    if (!(x > -708)) return std::isnan(x) ? x : 0;
    if (x > 709.782712893384) return k_infinity;
    static constexpr auto c = inverse_factorials<5>(2, 1, 1);
    const double n = round_to_integer(x * (32 * k_log2_e)), r = (x - n * k_ln_2_32_high) - n * k_ln_2_32_low;
    const auto k = std::int32_t(n);
    const double root = k_roots_of_2[std::size_t(k & 31)], power = root + root * (r + r * r * polynomial(r, c));
    return k < 1024 * 32 ? power * power_of_2(k >> 5) : power * power_of_2(1023) * 2;
}
float exp(float x) {
    if (!(x > -87.33f)) return std::isnan(x) ? x : 0;  // results below would be subnormal
    if (x > 88.73f) return std::numeric_limits<float>::infinity();
    const double n = round_to_integer(double(x) * (32 * k_log2_e)), r = double(x) - n * (k_ln_2 / 32);
    const auto k = std::int32_t(n);
    const double power = k_roots_of_2[std::size_t(k & 31)] * power_of_2(k >> 5);
    return float(power + power * (r + r * r * (1.0 / 2 + r * (1.0 / 6))));
}
double exp2(double x) { return exp(x * k_ln_2); }

// With x = 2^k m, √½ ≤ m < √2, the result is k ln 2 + 2 (s + s³/3 + s⁵/5 + ...), where s = (m − 1) / (m + 1).
double log(double x) {
    if (!(x > 0)) return x == 0 ? -k_infinity : k_nan;
    if (x == k_infinity) return x;
    if (x < std::numeric_limits<double>::min()) return log(x * 0x1p54) - 54 * k_ln_2;
    static constexpr auto c = inverse_odd_numbers<10>(1);
    const auto [k, m] = split(x);
    // ln m = f − f²/2 + s (f²/2 + 2 (s²/3 + s⁴/5 + ...)) with f = m − 1, which is exact.
    const double f = m - 1, s = f / (2 + f), s2 = s * s, half = 0.5 * f * f;
    const double rest = s * (half + 2 * s2 * polynomial(s2, c));
    return k * k_ln_2_high - ((half - (rest + k * k_ln_2_low)) - f);
}
float log(float x) {
    if (!(x > 0)) return float(log(double(x)));
    if (x == std::numeric_limits<float>::infinity()) return x;
    static constexpr auto c = inverse_odd_numbers<5>(1);
    const auto [k, m] = split(double(x));
    const double s = (m - 1) / (m + 1), s2 = s * s;
    return float(k * k_ln_2 + 2 * (s + s * s2 * polynomial(s2, c)));
}
double log2(double x) { return log(x) * k_log2_e; }
double log10(double x) { return log(x) / k_ln_10; }

// The second term corrects the rounding error of 1 + x.
double log1p(double x) {
    const double sum = 1 + x;
    if (!(sum > 0) || sum == k_infinity) return log(sum);
    return log(sum) + (x - (sum - 1)) / sum;
}

double pow(double x, double y) {
    if (y == 0 || x == 1) return 1;
    if (x < 0 && y == std::trunc(y)) return std::fmod(y, 2) == 0 ? pow(-x, y) : -pow(-x, y);
    return exp(y * log(x));
}

// Dividing the bits by 3 divides the exponent by 3. The offset restores the exponent's bias and balances the error,
// which is at most 4 %. Two steps of Halley's method cube the error each; one of Newton's method corrects rounding.
double cbrt(double x) {
    constexpr std::uint64_t k_offset = 0x2a9f789300000000;
    const double magnitude = std::abs(x);
    if (!(magnitude > 0) || magnitude == k_infinity) return x;
    if (magnitude < std::numeric_limits<double>::min()) return cbrt(x * 0x1p54) * 0x1p-18;
    if (magnitude > 0x1p1000) return cbrt(x * 0x1p-54) * 0x1p18;
    auto y = std::bit_cast<double>(std::bit_cast<std::uint64_t>(magnitude) / 3 + k_offset);
    for (int i = 0; i < 2; ++i) {
        const double cube = y * y * y;
        y *= (cube + 2 * magnitude) / (2 * cube + magnitude);
    }
    return std::copysign(y - (y * y * y - magnitude) / (3 * y * y), x);
}

double sin(double x) { return sine(reduce_angle(x)); }
double cos(double x) {
    const auto [remainder, quarters] = reduce_angle(x);
    return sine({remainder, (quarters + 1) % 4});
}

double atan2(double y, double x) {
    if (std::isnan(x) || std::isnan(y)) return k_nan;
    const double abs_x = std::abs(x), abs_y = std::abs(y);
    double angle = 0;  // arctan(|y| / |x|), in [0, π/2]
    if (abs_x == k_infinity && abs_y == k_infinity)
        angle = k_pi / 4;
    else if (abs_y <= abs_x)
        angle = abs_y > 0 ? arctangent(abs_y / abs_x) : 0;
    else
        angle = k_pi / 2 - arctangent(abs_x / abs_y);
    return std::copysign(std::signbit(x) ? k_pi - angle : angle, y);
}
double asin(double x) { return atan2(x, std::sqrt((1 - x) * (1 + x))); }
double acos(double x) { return atan2(std::sqrt((1 - x) * (1 + x)), x); }

double hypot(double x, double y) { return std::sqrt(x * x + y * y); }
double hypot(double x, double y, double z) { return std::sqrt(x * x + y * y + z * z); }

}  // namespace srbf::elementary
