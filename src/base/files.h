// Parts of files, and several files at once.
#pragma once
#include <functional>
#include <new>

#include "srbf/file.h"

SRBF_BEGIN

inline constexpr std::uint64_t k_largest_file = std::uint64_t(1) << 34;
/// So much of a file tells its format.
inline constexpr std::size_t k_head_bytes = std::size_t(1) << 20;

/// The size that a file may have that begins with `head`, its first `k_head_bytes`.
using MostBytes = std::function<std::uint64_t(std::span<const std::byte> head)>;
/// The whole file if its first bytes are of a known format, otherwise these bytes only.
template <typename IsKnown> MostBytes all_if(const IsKnown& is_known) {
    return [is_known](std::span<const std::byte> head) { return is_known(head) ? k_largest_file : head.size(); };
}

/// The bytes of the file at `path`; of one that is larger than `most` allows, the beginning alone, so that input of no
/// known format is not read to its end. Errors: the file is missing, a folder, unreadable, or larger than
/// `k_largest_file`; there is not enough memory for it.
Result<std::vector<std::byte>> read_file(const std::string& path, const MostBytes& most);

/// Bytes `offset`, `offset` + 1, … of the file at `path`: `most` of them, or fewer where it ends. Errors: those of
/// `read_file`.
Result<std::vector<std::byte>> read_part(const std::string& path, std::uint64_t offset, std::size_t most);

/// The error where memory runs out.
Error out_of_memory_error(std::string source);

/// The result of read(), or an error that names the file where memory runs out.
template <typename Read> auto within_memory(const std::string& path, const Read& read) -> decltype(read()) {
    try {
        return read();
    } catch (const std::bad_alloc&) {
        return out_of_memory_error(path);
    }
}

/// Content for a file.
struct NewFile {
    std::string path;
    std::vector<std::byte> bytes;
};
/// Writes all of them, and renames them in this order once all are written and `before_renaming`, if any, has
/// succeeded: an error before that leaves the previous content of each. Of several programs that write the same files
/// at once one after the other renames all of its own. Devices and pipes are written directly.
Result<Done> write_files(std::span<const NewFile> files, const std::function<Result<Done>()>& before_renaming = {});

/// Renames a file or a folder, and waits until the disk has the new name.
Result<Done> rename_path(const std::string& from, const std::string& to);

/// True if the bytes begin like a safetensors container, the format of fitted models: the length of a header, then its
/// brace.
inline bool is_safetensors(std::span<const std::byte> bytes) {
    return bytes.size() > 9 && bytes[8] == std::byte('{') && bytes[7] == std::byte(0) && bytes[6] == std::byte(0);
}

SRBF_END
