// The coefficients of maps (srbf/map.h) as textures.
#pragma once
#include "srbf/map.h"

namespace srbf {

/// A level of a map.
struct MapLevel {
    std::size_t width = 0, height = 0;
    std::vector<Rgb> coefficient;  ///< row-major texels, with J coefficients each
};
/// The next coarser level, of ⌊width/2⌋ × ⌊height/2⌋ texels and at least 1 × 1. A texel is the mean of the finer
/// level over the texel's area, so its BRDF is the mean of the finer BRDFs there.
MapLevel coarser(const MapLevel& finer);
/// The map and its coarser levels, down to 1 × 1.
std::vector<MapLevel> mip_levels(const TexelMap& map);

/// The number of layers of an array that OpenGL ES 3, WebGL 2, WebGPU, Vulkan and Direct3D 11 all guarantee.
inline constexpr int k_max_layers = 256;
/// The longest side of a texture that OpenGL 4, Vulkan and Direct3D 11 take on desktop processors.
inline constexpr std::size_t k_longest_side = 16384;
/// Checks that a map can be written as layers. Returns an error that names `file_name` if there are more than
/// k_max_layers lobes, a side is longer than k_longest_side, or a coefficient is above k_half_max.
Result<Done> check_layers(const TexelMap& map, const std::string& file_name);

/// The layers of a level, one after the other: R, G, B and A = 1 of each texel as 16-bit floats.
std::vector<std::uint16_t> layers_in_halves(const MapLevel& level);
/// The largest coefficient of each lobe in the map, for R, G and B.
std::vector<Rgb> layer_scales(const TexelMap& map);

/// How a texture holds coefficients. The means of levels are rounded only once.
enum class LayerNumbers {
    halves,  ///< 16-bit floats
    bytes,   ///< 8 bits of a fraction of the lobe's scale (`layer_scales`), coded as sRGB
};
/// The map as a KTX 2 file (Khronos texture container 2.0): an uncompressed array of J layers with levels down to 1
/// × 1. A layer holds the coefficients of a lobe as R, G, B, and A = 1. Row 0 of the texels is the map's Y = 0. With
/// bytes the metadata `k_scale_key` are the scales, 3 J 32-bit floats: R, G, B of each lobe.
std::vector<std::byte> map_ktx2(const TexelMap& map, LayerNumbers numbers = LayerNumbers::halves);
inline constexpr const char* k_scale_key = "srbf.scale";

}  // namespace srbf
