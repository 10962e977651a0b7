// Documented properties that fuzz targets require.
#pragma once
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace srbf {

/// Aborts if a documented property is violated, so that the fuzzer keeps the input.
inline void require(bool holds, std::string_view promise) {
    if (holds) return;
    fmt::print(stderr, "broken: {}\n", promise);
    std::abort();
}

}  // namespace srbf
