// The coefficients of maps (srbf/library.h) as textures.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "srbf/library.h"

namespace srbf {

/// A level of a map.
struct MapLevel {
    std::size_t width = 0, height = 0;
    std::vector<Rgb> coefficient;  ///< row-major texels, with J coefficients each
};
/// The next coarser level, of ⌊width/2⌋ × ⌊height/2⌋ texels and at least 1 × 1. A texel is the mean of the finer
/// level over the texel's area, so its BRDF is the mean of the finer BRDFs there.
MapLevel coarser(const MapLevel& finer);

/// The number of layers of an array that OpenGL ES 3, WebGL 2, WebGPU, Vulkan and Direct3D 11 all guarantee.
inline constexpr int k_most_layers = 256;
/// Checks that a library can be written as layers. Errors, which name `file_name`: it is sparse, it is not a map,
/// or it has more than k_most_layers lobes.
Result<Done> check_layers(const Library& library, const std::string& file_name);

/// The map as a KTX 2 file (Khronos texture container 2.0): an uncompressed array of J layers with levels down to 1
/// × 1. A layer holds the coefficients of a lobe as 16-bit floats R, G, B, and A = 1. Row 0 of the texels is the
/// map's Y = 0.
std::vector<std::byte> map_ktx2(const Library& map);

}  // namespace srbf
