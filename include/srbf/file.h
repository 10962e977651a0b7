// Reading and writing of whole files: level 1.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "srbf/result.h"

namespace [[gnu::visibility("default")]] srbf {

/// The bytes of the file at `path`. Errors: the file is missing, a folder, unreadable, or larger than `k_largest_file`.
Result<std::vector<std::byte>> read_file(const std::string& path);
inline constexpr std::uint64_t k_largest_file = std::uint64_t(1) << 34;

/// Bytes `offset`, `offset` + 1, … of the file at `path`: `most` of them, or fewer where it ends. Errors: those of
/// `read_file`.
Result<std::vector<std::byte>> read_part(const std::string& path, std::uint64_t offset, std::size_t most);

/// Writes `bytes` to a temporary file next to `path` and renames it, so that `path` holds either its previous content
/// or all of `bytes`. Errors: the folder is missing or cannot be written, `path` is a folder, the disk is full.
Result<Done> write_file(const std::string& path, std::span<const std::byte> bytes);

/// Whether the bytes begin like a safetensors container, the format of fitted models: the length of a header, then its
/// brace.
inline bool is_safetensors(std::span<const std::byte> bytes) {
    return bytes.size() > 9 && bytes[8] == std::byte('{') && bytes[7] == std::byte(0) && bytes[6] == std::byte(0);
}

inline std::span<const std::byte> as_bytes(std::string_view text) {
    return std::as_bytes(std::span(text.data(), text.size()));
}

}  // namespace srbf
