// 16-bit floating point (IEEE 754 binary16), in which models are stored.
#pragma once
#include <cstdint>

#include "srbf/version.h"

SRBF_BEGIN

inline constexpr float k_half_max = 65504;  ///< the largest finite half
/// the smallest normal half, which has the full precision of 11 bits
inline constexpr float k_half_min = 6.103515625e-05f;

/// The half nearest to `x`, ties to even; ±infinity from ±65520 on.
std::uint16_t to_half(float x);
float from_half(std::uint16_t bits);

inline float round_to_half(float x) { return from_half(to_half(x)); }

SRBF_END
