// 16-bit floats: all 65536 values, and rounding.
#include "base/half.h"

#include "properties.h"

namespace srbf::half_test {
namespace {

/// The value of 16 bits by the definition of IEEE 754 binary16.
double defined(unsigned bits) {
    const int exponent = int(bits >> 10 & 31), fraction = int(bits & 1023);
    const double sign = bits >> 15 ? -1 : 1;
    if (exponent == 31) return fraction ? NAN : sign * INFINITY;
    if (exponent == 0) return sign * std::ldexp(fraction, -24);
    return sign * std::ldexp(1024 + fraction, exponent - 25);
}

TEST(Half, EveryPatternHasItsValueAndComesBack) {
    for (unsigned bits = 0; bits < 65536; ++bits) {
        const auto half = std::uint16_t(bits);
        const double expected = defined(bits);
        const float found = from_half(half);
        if (std::isnan(expected)) {
            EXPECT_TRUE(std::isnan(found)) << bits;
            EXPECT_TRUE(std::isnan(from_half(to_half(found)))) << bits;
        } else {
            EXPECT_EQ(double(found), expected) << bits;
            EXPECT_EQ(std::signbit(found), std::signbit(expected)) << bits;
            EXPECT_EQ(to_half(found), half);
        }
    }
}

TEST(Half, RoundsToTheNearestAndTiesToEven) {
    for (unsigned bits = 0; bits < 0x7bff; ++bits) {
        const auto low = std::uint16_t(bits), high = std::uint16_t(bits + 1);
        const float middle = 0.5f * (from_half(low) + from_half(high));  // exact in float
        ASSERT_EQ(to_half(middle), bits % 2 ? high : low) << bits;
        ASSERT_EQ(to_half(std::nextafter(middle, 0.f)), low) << bits;
        ASSERT_EQ(to_half(std::nextafter(middle, INFINITY)), high) << bits;
        ASSERT_EQ(to_half(-middle), (bits % 2 ? high : low) | 0x8000) << bits;
        ASSERT_EQ(to_half(std::nextafter(-middle, 0.f)), low | 0x8000) << bits;
    }
}

TEST(Half, RoundingIsMonotoneAndIdempotent) {
    std::mt19937_64 random(1);
    for (int i = 0; i < 200000; ++i) {
        const float a = float(std::ldexp(2 * uniform(random) - 1, int(random() % 48) - 28));
        const float b = i % 2 ? a * float(1 + 1e-3 * uniform(random))
                              : float(std::ldexp(2 * uniform(random) - 1, int(random() % 48) - 28));
        EXPECT_LE(round_to_half(std::min(a, b)), round_to_half(std::max(a, b))) << a << ' ' << b;
        const float rounded = round_to_half(a);
        EXPECT_EQ(round_to_half(rounded), rounded);
        EXPECT_EQ(round_to_half(-a), -rounded);
        if (std::abs(a) >= k_half_min && std::abs(a) <= k_half_max) {
            EXPECT_WITHIN_RELATIVE(rounded, a, 0x1p-11);
        }
    }
}

}  // namespace
}  // namespace srbf::half_test
