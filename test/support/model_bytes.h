// Parts of the bytes of a model file.
#pragma once
#include <nlohmann/json.hpp>

#include "base/text.h"

namespace srbf {

/// The length of the header of a model file [bytes], and the header, which stands behind it.
inline std::size_t header_length_of(std::span<const std::byte> file) {
    std::size_t length = 0;
    for (std::size_t i = 8; i-- > 0;) length = length << 8 | std::to_integer<std::size_t>(file[i]);
    return length;
}
inline nlohmann::json header_of(std::span<const std::byte> file) {
    return nlohmann::json::parse(as_text(file.subspan(8, header_length_of(file))));
}
/// The 16-bit number at a position of a file.
inline std::uint16_t uint16_at(std::span<const std::byte> file, std::size_t position) {
    return std::uint16_t(std::to_integer<unsigned>(file[position]) | std::to_integer<unsigned>(file[position + 1])
                                                                         << 8);
}

}  // namespace srbf
