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
    std::vector<Rgb> coefficient;  ///< texels in rows, each with J of them
};
/// The level of ⌊width/2⌋ × ⌊height/2⌋ texels, at least 1 each: a texel is the mean of the finer level over its share of
/// the area, so that a BRDF is the mean of the finer BRDFs there.
MapLevel coarser(const MapLevel& finer);

/// Each of OpenGL ES 3, WebGL 2, WebGPU, Vulkan and Direct3D 11 has this number of layers in an array.
inline constexpr int k_most_layers = 256;
/// Errors, of `file_name`: a sparse library, one that is no map, more lobes than that.
Result<Done> check_layers(const Library& library, const std::string& file_name);

/// Such a map as Khronos' texture container 2.0 (.ktx2): an array of J layers with levels down to 1 × 1, uncompressed
/// 16-bit floats R, G, B, the coefficients of a lobe, and A = 1. Row 0 of texels is the map's Y = 0.
std::vector<std::byte> map_ktx2(const Library& map);

}  // namespace srbf
