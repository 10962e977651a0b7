// Choices by uniform random numbers.
#pragma once

namespace SRBF_NAMESPACE {

/// The largest float below 1.
inline constexpr float k_below_one = 0x1.fffffep-1f;

/// A choice made by a number in [0,1), and that number rescaled, so that it is uniform again.
struct Choice {
    int index;
    float u;
};

}  // namespace srbf
