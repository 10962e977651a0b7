// NumPy's file format of an array.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "srbf/result.h"

SRBF_BEGIN

/// The head of a file of float32 numbers in C order. The file has the magic "\x93NUMPY", a version, the length of
/// the header, the header (a Python dictionary of descr, fortran_order and shape), and the numbers.
struct NpyHead {
    std::vector<std::uint64_t> shape;
    std::uint64_t data = 0;  ///< offset of the numbers [bytes]
};
/// Reads the head of a file of `size` bytes. `beginning` holds the first k_max_npy_head bytes or the whole file.
/// Returns an error if the file is of another kind, if numbers have another type or order, or if the size does not
/// match the shape.
Result<NpyHead> read_npy_head(std::span<const std::byte> beginning, std::uint64_t size, const std::string& file_name);
inline constexpr std::size_t k_max_npy_head = 4096;

SRBF_END
