// Reading and writing of OpenEXR files with float channels: level 5.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "render/image.h"

namespace srbf {

/// A named channel: "R", "normal.X", "Z".
struct Channel {
    std::string name;
    std::vector<float> pixels;  ///< rows from the top
};
/// The channels R, G, B of an image; `layer` ("" or "albedo.") is a prefix of their names.
std::vector<Channel> channels_of(const Image& image, const std::string& layer = {}, std::string_view names = "RGB");

/// Writes the channels as 32-bit floats with lossless compression. Errors: those of write_file, and those of the
/// library.
Result<Done> write_exr(int width, int height, std::span<const Channel> channels, const std::string& path);

/// Reads the channels R, G and B of an EXR file. Errors: not an EXR file, other channels, damaged, more than
/// `k_most_texels` pixels. `file_name` appears in errors only.
Result<Image> read_exr(std::span<const std::byte> bytes, const std::string& file_name);
/// An error where the header, with which a file starts, tells of more than `k_most_texels` pixels.
Result<Done> check_exr_size(std::span<const std::byte> start, const std::string& file_name);
inline constexpr std::int64_t k_most_texels = std::int64_t(1) << 26;
bool is_exr(std::span<const std::byte> bytes);

}  // namespace srbf
