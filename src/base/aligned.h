// Arrays for SIMD, and the blocks of rows in which loops pass over them.
#pragma once
#include <tbb/cache_aligned_allocator.h>

#include <cstddef>
#include <vector>

namespace SRBF_NAMESPACE {

/// A vector that begins at a cache line.
template <typename T> using Aligned = std::vector<T, tbb::cache_aligned_allocator<T>>;

inline constexpr std::size_t k_block = 512;  ///< rows per block
/// Loops process a multiple of this number of rows.
inline constexpr std::size_t k_row_multiple = 64;
/// The number of rows of a block, rounded up to `k_row_multiple`. The last block may have fewer than `k_block`.
constexpr std::size_t rows_in_block(std::size_t block, std::size_t rows) {
    const std::size_t left = rows - block * k_block;
    return left < k_block ? (left + k_row_multiple - 1) / k_row_multiple * k_row_multiple : k_block;
}
constexpr std::size_t blocks_for(std::size_t rows) { return (rows + k_block - 1) / k_block; }

}  // namespace
