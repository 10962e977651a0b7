// Reading and writing of whole files.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "srbf/result.h"

SRBF_BEGIN

/// The bytes of the file at `path`. Returns an error if the file is missing, a folder, unreadable, larger than 16 GiB
/// or too large for the memory.
Result<std::vector<std::byte>> read_file(const std::string& path);
/// Writes `bytes` to a temporary file next to `path`, waits until the disk has them and renames it, so that `path`
/// holds either its previous content or all of `bytes`, after a loss of power too. Returns an error if the folder is
/// missing or cannot be written, `path` is a folder, or the disk is full.
Result<Done> write_file(const std::string& path, std::span<const std::byte> bytes);

inline std::span<const std::byte> as_bytes(std::string_view text) {
    return std::as_bytes(std::span(text.data(), text.size()));
}

SRBF_END
