// The beginning of DDS files, textures of Direct3D.
#pragma once
#include <array>
#include <cstdint>

namespace SRBF_NAMESPACE {

/// The words before the texels of a file whose texels are four 16-bit floats: DDS_HEADER with its DDS_PIXELFORMAT, of
/// Microsoft's "Programming Guide for DDS". `format` stands in the place of the four characters.
inline std::array<std::uint32_t, 32> dds_header(std::uint32_t width, std::uint32_t height, std::uint32_t levels,
                                                std::uint32_t format) {
    constexpr std::uint32_t caps_height_width_pitch_format_levels = 0x1 | 0x2 | 0x4 | 0x8 | 0x1000 | 0x20000;
    constexpr std::uint32_t four_characters = 0x4, complex_texture_mipmap = 0x8 | 0x1000 | 0x400000;
    std::array<std::uint32_t, 32> header{
        0x20534444, 124, caps_height_width_pitch_format_levels, height, width, 8 * width, 0, levels};
    header[19] = 32, header[20] = four_characters, header[21] = format, header[27] = complex_texture_mipmap;
    return header;
}

}  // namespace srbf
