// Sizes of libraries, and their files by content.
#pragma once
#include <cstddef>
#include <span>

#include "srbf/library.h"

namespace [[gnu::visibility("default")]] srbf {

/// Bytes of the shared lobes, and of one material: 6 for each coefficient, and 2 for each index.
std::size_t basis_bytes(const Library& library);
std::size_t material_bytes(const Library& library);

/// The library with every number rounded to a 16-bit float.
Library rounded(Library library);

/// True if these are the bytes of a library.
bool is_library(std::span<const std::byte> bytes);

}  // namespace srbf
