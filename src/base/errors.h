// Errors that many functions return.
#pragma once
#include <fmt/format.h>

#include "srbf/result.h"

SRBF_BEGIN

/// The error of a computation that was cancelled.
Error cancelled_error(std::string source);

/// The error of an input that is malformed, and of an argument that is not allowed.
inline Error input_error(std::string source, std::string what, std::string expected, std::string found) {
    return {std::move(source), {}, std::move(what), std::move(expected), std::move(found)};
}
inline Error argument_error(std::string source, std::string what, std::string expected, std::string found) {
    return {std::move(source), {}, std::move(what), std::move(expected), std::move(found), ErrorCode::argument};
}

/// The error of a number that a 16-bit float does not hold.
inline Error half_range_error(std::string source, std::string what, double found) {
    return argument_error(std::move(source), std::move(what), "0, or 6e-08 to 65504, the range of 16-bit floats",
                          fmt::format("{:g}", found));
}

/// The error of missing data, which `expected` names.
inline Error no_data_error(std::string source, std::string what, std::string expected = "some") {
    return {std::move(source), {}, std::move(what), std::move(expected), "none", ErrorCode::no_data};
}

inline constexpr int k_max_threads = 1024;

/// Returns an error unless min ≤ found ≤ max.
template <typename Number>
Result<Done> require_range(const char* source, const char* what, Number found, Number min, Number max) {
    if (found >= min && found <= max) return Done{};
    return argument_error(source, what, fmt::format("{} to {}", min, max), fmt::format("{}", found));
}

SRBF_END
