// The table of the formats of measurements: recognition, reading, and what messages name.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "srbf/measured.h"

namespace srbf {

struct Format {
    std::string_view name;
    bool is_text;  ///< its first kilobytes are text
    /// Whether a file, or its first bytes, is of the format.
    bool (*recognise)(std::span<const std::byte> head);
    /// A measurement without the index of samples; `read_as` adds the name and the size. `options`: how columns are read.
    Result<Measured> (*read)(std::span<const std::byte> bytes, const std::string& file_name,
                             const ReadOptions& options);
    /// Of a format without a mark, which its size tells: the bytes of a file that begins so; 0: it is none. Otherwise null.
    std::uint64_t (*size)(std::span<const std::byte> head) = nullptr;
};

/// All formats, in the order in which they are tried.
std::span<const Format> formats();
/// The first format that recognises the bytes; otherwise null.
const Format* format_of(std::span<const std::byte> bytes);
Result<Measured> read_as(const Format& format, std::span<const std::byte> bytes, const std::string& file_name,
                         const ReadOptions& options);
/// The bytes that a file may have that begins with `head`, by all formats.
std::uint64_t most_bytes(std::span<const std::byte> head);
/// "RGL, MBSDF, .. or UTIA".
std::string names_of_formats();

}  // namespace srbf
