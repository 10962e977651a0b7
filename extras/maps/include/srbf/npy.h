// NumPy's file of an array.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "srbf/result.h"

namespace [[gnu::visibility("default")]] srbf {

/// A file of float32 numbers in C order: the magic "\x93NUMPY", a version, the length of a header, the header (a Python
/// dictionary of descr, fortran_order and shape), the numbers.
struct NpyHead {
    std::vector<std::uint64_t> shape;
    std::uint64_t data = 0;  ///< offset of the numbers [bytes]
};
/// The head of a file of `size` bytes, of which `beginning` are the first, k_most_npy_head of them or all. Errors: not
/// such a file, numbers of another type or order, another size than the shape requires.
Result<NpyHead> read_npy_head(std::span<const std::byte> beginning, std::uint64_t size, const std::string& file_name);
inline constexpr std::size_t k_most_npy_head = 4096;

}  // namespace srbf
