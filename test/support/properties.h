// Parts of all tests: expectations of numbers and texts, the location of data, and properties of values.
#pragma once
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

#include "random_directions.h"
#include "srbf/result.h"

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

/// |a − b| ≤ relative |b| + absolute in each channel. A failure names the channel.
#define EXPECT_RGB_WITHIN_RELATIVE(a, b, relative, absolute) \
    EXPECT_PRED_FORMAT4(::srbf::rgb_near, a, b, relative, absolute)
#define ASSERT_RGB_WITHIN_RELATIVE(a, b, relative, absolute) \
    ASSERT_PRED_FORMAT4(::srbf::rgb_near, a, b, relative, absolute)
#define EXPECT_RGB_WITHIN(a, b, absolute) EXPECT_RGB_WITHIN_RELATIVE(a, b, 0, absolute)
#define ASSERT_RGB_WITHIN(a, b, absolute) ASSERT_RGB_WITHIN_RELATIVE(a, b, 0, absolute)
inline double channel(const Rgb& colour, int c) { return double(colour[c]); }
template <typename Channels> double channel(const Channels& channels, int c) {
    return double(channels[std::size_t(c)]);
}
template <typename A, typename B>
testing::AssertionResult rgb_near(const char* a_text, const char* b_text, const char*, const char*, const A& a,
                                  const B& b, double relative, double absolute) {
    for (int c = 0; c < 3; ++c)
        if (!near(channel(a, c), channel(b, c), relative * std::abs(channel(b, c)) + absolute))
            return testing::AssertionFailure() << a_text << " has " << channel(a, c) << " and " << b_text << ' '
                                               << channel(b, c) << " in channel " << c;
    return testing::AssertionSuccess();
}

/// Expects that a text contains a part, or lacks it. A failure prints the part and the beginning of the text.
#define EXPECT_CONTAINS(text, part) EXPECT_PRED_FORMAT2(::srbf::contains, text, part)
#define EXPECT_LACKS(text, part) EXPECT_PRED_FORMAT2(::srbf::lacks, text, part)
inline testing::AssertionResult contains(const char*, const char*, std::string_view text, std::string_view part) {
    return testing::AssertionResult(text.find(part) != text.npos) << part << "\nis not in\n" << text.substr(0, 4096);
}
inline testing::AssertionResult lacks(const char*, const char*, std::string_view text, std::string_view part) {
    return testing::AssertionResult(text.find(part) == text.npos) << part << "\nis in\n" << text.substr(0, 4096);
}

inline std::size_t count_of(std::string_view text, std::string_view part) {
    std::size_t count = 0;
    for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + part.size())) ++count;
    return count;
}
/// The text with the first `part` replaced.
inline std::string replaced(std::string text, std::string_view part, std::string_view replacement) {
    const std::size_t position = text.find(part);
    EXPECT_NE(position, text.npos) << "no " << part;
    return position == text.npos ? text : text.replace(position, part.size(), replacement);
}

/// Expects one line with its end, which begins like this.
#define EXPECT_ONE_LINE(text, beginning) EXPECT_PRED_FORMAT2(::srbf::is_one_line, text, beginning)
inline testing::AssertionResult is_one_line(const char*, const char*, std::string_view text, std::string_view begin) {
    return testing::AssertionResult(text.starts_with(begin) && text.find('\n') + 1 == text.size())
           << "expected one line that begins with \"" << begin << "\", found\n"
           << text.substr(0, 4096);
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

/// True if `f` is zero below the horizon, and elsewhere finite and not negative. If `may_be_missing`, NaN in every
/// channel is valid, too.
inline bool satisfies_contract(const Rgb& f, Vec3f wl, Vec3f wv, bool may_be_missing) {
    if (wl.z <= 0 || wv.z <= 0) return f == Rgb{};
    if (may_be_missing && std::isnan(f.r) && std::isnan(f.g) && std::isnan(f.b)) return true;
    return is_finite(f) && f.r >= 0 && f.g >= 0 && f.b >= 0;
}

}  // namespace srbf
