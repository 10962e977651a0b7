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
    /// True if a file, or its first bytes, is of the format.
    bool (*recognise)(std::span<const std::byte> head);
    /// A measurement without the index of samples; `read_as` adds the name and the size. `options`: how columns are read.
    Result<Measured> (*read)(std::span<const std::byte> bytes, const std::string& file_name,
                             const ReadOptions& options);
    /// For a format without a mark: the size of a file that begins so, by which it is recognised; 0: it is of another
    /// format. Null for formats with a mark.
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
