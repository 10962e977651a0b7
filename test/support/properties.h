// Parts of all tests: expectations of numbers and texts, the location of data, random directions.
#pragma once
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

#include "brdf/directions.h"
#include "srbf/result.h"
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

/// The message of a result's error; empty if there is none.
template <typename T> std::string error_text(const Result<T>& result) { return result ? "" : message(result.error()); }

/// The result itself. An error ends the test, with its message.
template <typename T> Result<T> checked(Result<T> result) {
    if (!result) throw std::runtime_error(message(result.error()));
    return result;
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

/// A random direction. With probability ¼ it is within a degree of the horizon or of the normal.
inline Vec3f direction_with_extremes(std::mt19937_64& random) {
    const double pick = uniform(random);
    if (pick < 0.125) return to_float(spherical(k_pi / 2 - uniform(random) * k_degree, 7 * uniform(random)));
    if (pick < 0.25) return to_float(spherical(uniform(random) * k_degree, 7 * uniform(random)));
    return to_float(random_direction(random, 1e-4));
}

/// ω rotated about the normal.
inline Vec3f rotate(Vec3f w, double phi) {
    const double c = std::cos(phi), s = std::sin(phi);
    return to_float(Vec3d{c * double(w.x) - s * double(w.y), s * double(w.x) + c * double(w.y), double(w.z)});
}

/// True if `f` is zero below the horizon, and elsewhere finite and not negative. If `may_be_missing`, NaN in every
/// channel is valid, too.
inline bool satisfies_contract(const Rgb& f, Vec3f wl, Vec3f wv, bool may_be_missing) {
    if (wl.z <= 0 || wv.z <= 0) return f == Rgb{};
    if (may_be_missing && std::isnan(f.r) && std::isnan(f.g) && std::isnan(f.b)) return true;
    return is_finite(f) && f.r >= 0 && f.g >= 0 && f.b >= 0;
}

}  // namespace srbf
