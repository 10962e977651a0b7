// Sizes of libraries, and their files by content.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "srbf/library.h"

SRBF_BEGIN

/// Bytes of the shared lobes, and of one material: 6 for each coefficient, and 2 for each index.
std::size_t basis_bytes(const Library& library);
std::size_t material_bytes(const Library& library);

/// The library with every number rounded to a 16-bit float.
Library rounded(Library library);

/// The file of a dense library without names whose texels are written elsewhere: `head`, the errors of T texels as 16-bit
/// floats, `middle`, their coefficients [T, J, 3] likewise, and `tail`. No part is empty.
struct LibraryParts {
    std::vector<std::byte> head, middle, tail;
};
LibraryParts parts_of_library(const Library& library, std::size_t texels);

/// True if these are the bytes of a library.
bool is_library(std::span<const std::byte> bytes);

SRBF_END
