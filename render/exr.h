// OpenEXR files: float channels in and out: level 5.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "render/image.h"

namespace srbf {

/// One number a pixel under a name: "R", "normal.X", "Z".
struct Channel {
    std::string name;
    std::vector<float> pixels;  ///< rows, the uppermost first
};
/// R, G, B of an image; `layer` "" or "albedo." stands before their names.
std::vector<Channel> channels_of(const Image& image, const std::string& layer = {}, std::string_view names = "RGB");

/// Writes the channels as 32-bit floats, compressed without loss. Errors: those of write_file, and what the library refuses.
Result<Done> write_exr(int width, int height, std::span<const Channel> channels, const std::string& path);

/// The channels R, G and B of an EXR file. Errors: not such a file, other channels, damaged, more than `k_most_texels` pixels. `source`
/// is for errors alone.
Result<Image> read_exr(std::span<const std::byte> bytes, const std::string& source);
inline constexpr std::int64_t k_most_texels = std::int64_t(1) << 26;
bool is_exr(std::span<const std::byte> bytes);

}  // namespace srbf
