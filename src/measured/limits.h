// Limits of the sizes and values that readers accept, and NaN, which marks masked values.
#pragma once
#include <cstdint>
#include <limits>

namespace SRBF_NAMESPACE {

inline constexpr std::uint32_t k_largest_dimension = 4096;  ///< the largest dimension of a table
/// The largest f_r [1/sr]: far above any measurement, while sums and products of such numbers stay finite.
inline constexpr float k_largest_value = 1e12f;
inline constexpr float k_most_float = std::numeric_limits<float>::max();
inline constexpr float k_nan = std::numeric_limits<float>::quiet_NaN();

}  // namespace srbf
