// The unit of the loops over observations and pixels.
#pragma once
#include <cstddef>

namespace srbf {

inline constexpr std::size_t k_block = 512;        ///< rows per block
inline constexpr std::size_t k_row_multiple = 64;  ///< the loops take that many rows of a block, or a multiple of it
/// How many rows of a block there are, filled up to that multiple: the last one may have fewer than others.
constexpr std::size_t rows_in_block(std::size_t block, std::size_t rows) {
    const std::size_t left = rows - block * k_block;
    return left < k_block ? (left + k_row_multiple - 1) / k_row_multiple * k_row_multiple : k_block;
}
constexpr std::size_t blocks_for(std::size_t rows) { return (rows + k_block - 1) / k_block; }

}  // namespace srbf
