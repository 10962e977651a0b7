// Parts of all tests: expectations of numbers and texts, the location of data, random directions.
#pragma once
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string_view>

#include "brdf/directions.h"
#include "srbf/vec.h"

namespace srbf {

/// |a − b| ≤ tolerance, with a finite.
inline bool near(double a, double b, double tolerance) { return std::isfinite(a) && std::abs(a - b) <= tolerance; }
/// |a − b| ≤ tolerance |b|, with a finite.
inline bool near_relative(double a, double b, double tolerance) { return near(a, b, tolerance * std::abs(b)); }
/// Skips a long test whose input other tests read, too, if everything is compiled with sanitizers. Programs are slow
/// then, and keep freed memory.
constexpr bool k_is_sanitized = SRBF_IS_SANITIZED;
#define SKIP_UNDER_SANITIZERS(reason) \
    if (::srbf::k_is_sanitized) GTEST_SKIP() << reason

/// Expects what these predicates say, and prints the three numbers if they are false.
#define EXPECT_WITHIN(a, b, tolerance) EXPECT_PRED3(::srbf::near, a, b, tolerance)
#define ASSERT_WITHIN(a, b, tolerance) ASSERT_PRED3(::srbf::near, a, b, tolerance)
#define EXPECT_WITHIN_RELATIVE(a, b, tolerance) EXPECT_PRED3(::srbf::near_relative, a, b, tolerance)

/// Expects that a text contains a part, or lacks it. A failure prints the part and the beginning of the text.
#define EXPECT_CONTAINS(text, part) EXPECT_PRED_FORMAT2(::srbf::contains, text, part)
#define EXPECT_LACKS(text, part) EXPECT_PRED_FORMAT2(::srbf::lacks, text, part)
inline testing::AssertionResult contains(const char*, const char*, std::string_view text, std::string_view part) {
    return testing::AssertionResult(text.find(part) != text.npos) << part << "\nis not in\n" << text.substr(0, 4096);
}
inline testing::AssertionResult lacks(const char*, const char*, std::string_view text, std::string_view part) {
    return testing::AssertionResult(text.find(part) == text.npos) << part << "\nis in\n" << text.substr(0, 4096);
}

/// The measurements bundled with the project.
inline std::filesystem::path bundled_data() { return std::filesystem::path(SRBF_SOURCE_DIR) / "data"; }
/// More measurements, if available: $SRBF_DATA, otherwise shared/data beside the checkout; may not exist.
inline std::filesystem::path shared_data() {
    const char* folder = std::getenv("SRBF_DATA");
    return folder ? std::filesystem::path(folder) : std::filesystem::path(SRBF_SOURCE_DIR) / ".." / "shared" / "data";
}

/// A direction uniform on the sphere (for z ≥ z_min).
inline Vec3d random_direction(std::mt19937_64& random, double z_min = -1) {
    const double z = z_min + (1 - z_min) * uniform(random), phi = 2 * k_pi * uniform(random);
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    return {r * elementary::cos(phi), r * elementary::sin(phi), z};
}

}  // namespace srbf
