// Reading and writing of OpenEXR files with float channels.
#pragma once
#include <cstdint>
#include <span>
#include <string>

#include "extras/render/tone.h"

namespace SRBF_NAMESPACE {

/// A named channel: "R", "normal.X", "Z".
struct Channel {
    std::string name;
    std::vector<float> pixels;  ///< rows from the top
};
/// The channels R, G, B of an image; `layer` ("" or "albedo.") prefixes their names.
std::vector<Channel> channels_of(const Image& image, const std::string& layer = {}, std::string_view names = "RGB");

/// Writes the channels as 32-bit floats with lossless compression. Returns an error if write_file or the EXR library
/// does.
Result<Done> write_exr(int width, int height, std::span<const Channel> channels, const std::string& path);

/// Writes 16-bit floats. `halves` has one number for each of `names`, pixel after pixel.
Result<Done> write_half_exr(int width, int height, std::span<const std::string> names,
                            std::span<const std::uint16_t> halves, const std::string& path);

/// Reads the channels R, G and B of an EXR file. Returns an error if the file is not EXR, lacks these channels, is
/// damaged or has more than `k_max_texels` pixels. `file_name` appears in errors only.
Result<Image> read_exr(std::span<const std::byte> bytes, const std::string& file_name);
/// Checks a header before the library reads it, because the library allocates whatever the header declares. `start`
/// is the beginning of a file of `size` bytes. Returns an error if the header is longer than the file or 1 MB, or if it
/// declares more than `k_max_texels` pixels, more pixels than 2²¹ plus 8 per byte of the file, or more blocks of
/// pixels than a file of that size can have. All other damage is left to the library.
Result<Done> check_exr_header(std::span<const std::byte> start, std::uint64_t size, const std::string& file_name);
inline constexpr std::int64_t k_max_texels = std::int64_t(1) << 26;
bool is_exr(std::span<const std::byte> bytes);

}  // namespace
