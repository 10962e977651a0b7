// Block compression of textures by libastcenc, where the program is built with it.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace srbf {

/// True if the program is built with libastcenc.
bool has_astc();
/// Texels R, G, B, A of 8 bits coded as sRGB as ASTC blocks of 4 × 4 texels, 16 bytes each. Requires `has_astc`.
std::vector<std::byte> astc_blocks(std::size_t width, std::size_t height, std::span<const std::byte> texels);

}  // namespace srbf
