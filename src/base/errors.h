#pragma once
#include <fmt/format.h>

#include "srbf/result.h"

SRBF_BEGIN

/// The error of a computation that was cancelled.
Error cancelled_error(std::string source);

inline Error argument_error(std::string source, std::string what, std::string expected, std::string found) {
    return {std::move(source), {}, std::move(what), std::move(expected), std::move(found), ErrorCode::argument};
}

/// `expected` names what is missing.
inline Error no_data_error(std::string source, std::string what, std::string expected = "some") {
    return {std::move(source), {}, std::move(what), std::move(expected), "none", ErrorCode::no_data};
}

/// Returns an error unless least ≤ found ≤ most.
template <typename Number>
Result<Done> require_range(const char* source, const char* what, Number found, Number least, Number most) {
    if (found >= least && found <= most) return Done{};
    return argument_error(source, what, fmt::format("{} to {}", least, most), fmt::format("{}", found));
}

SRBF_END
