// The unit of the loops over observations and pixels.
#pragma once
#include <cstddef>

namespace srbf {

inline constexpr std::size_t k_block = 512;  ///< rows per block
constexpr std::size_t blocks_for(std::size_t rows) { return (rows + k_block - 1) / k_block; }

}  // namespace srbf
