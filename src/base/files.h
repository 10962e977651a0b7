// Parts of files, and several files at once.
#pragma once
#include <functional>
#include <new>
#include <utility>

#include "base/text.h"
#include "srbf/file.h"
#include "srbf/result.h"

SRBF_BEGIN

inline constexpr std::uint64_t k_largest_file = std::uint64_t(1) << 34;
/// The number of first bytes of a file that identify its format.
inline constexpr std::size_t k_head_bytes = std::size_t(1) << 20;

/// Returns the largest size of a file that begins with `head`, its first `k_head_bytes`.
using MaxBytes = std::function<std::uint64_t(std::span<const std::byte> head)>;
/// The whole file if its first bytes are of a known format, otherwise these bytes only.
template <typename IsKnown> MaxBytes all_if(const IsKnown& is_known) {
    return [is_known](std::span<const std::byte> head) { return is_known(head) ? k_largest_file : head.size(); };
}

/// The bytes of the file at `path`, or the first ones if it is larger than `max(first bytes)`: input of no known format
/// is not read to its end. Returns an error if the file is missing, a folder, unreadable, larger than
/// `k_largest_file` or too large for the memory.
Result<std::vector<std::byte>> read_file(const std::string& path, const MaxBytes& max);

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
/// Writes all files, and renames them in this order once all are written and `before_renaming`, if any, has succeeded.
/// An error before that leaves the previous content of each. If several programs write the same files, each renames all
/// of its own before the next one does. Devices and pipes are written directly.
Result<Done> write_files(std::span<const NewFile> files, const std::function<Result<Done>()>& before_renaming = {});

/// Renames a file or a folder, and waits until the disk has the new name.
Result<Done> rename_path(const std::string& from, const std::string& to);

/// True if the bytes begin like a safetensors container, the format of fitted models: the length of a header, then its
/// brace.
inline bool is_safetensors(std::span<const std::byte> bytes) {
    return bytes.size() > 9 && bytes[8] == std::byte('{') && bytes[7] == std::byte(0) && bytes[6] == std::byte(0);
}

/// A file descriptor that is closed at the end of its scope.
class Descriptor {
  public:
    explicit Descriptor(int number) : number_(number) {}
    Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
    Descriptor& operator=(Descriptor&&) = delete;
    ~Descriptor() { (void)close(); }

    int number() const { return number_; }
    /// Closes the file, also if a signal interrupts the call; returns 0 or errno. A full disk may be reported only
    /// here.
    int close();

  private:
    int number_;
};

class FileReader {
  public:
    /// Returns an error if `read_file` would.
    static Result<FileReader> open(const std::string& path);

    const std::string& path() const { return path_; }
    /// Fills `bytes` with the next bytes of the file, fewer at its end; returns their number.
    Result<std::size_t> read(std::span<std::byte> bytes);
    /// Fills `bytes` with the file's bytes from `offset` on, fewer at its end, and returns their number. The position
    /// of the other `read` stays the same.
    Result<std::size_t> read(std::uint64_t offset, std::span<std::byte> bytes) const;

  private:
    FileReader(std::string path, Descriptor file) : path_(std::move(path)), file_(std::move(file)) {}
    std::string path_;
    Descriptor file_;
};

/// The next bytes of a file's content; none at its end.
using NextBytes = std::function<Result<std::vector<std::byte>>()>;
/// `write_file` of content that is made while it is written. Also returns an error if `next` does; then `path` holds
/// its previous content.
Result<Done> write_file(const std::string& path, const NextBytes& next);

SRBF_END
