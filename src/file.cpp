#include "srbf/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>

namespace srbf {

namespace {

/// A file descriptor that is closed at the end of its scope.
class Descriptor {
  public:
    explicit Descriptor(int number) : number_(number) {}
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    ~Descriptor() { (void)close(); }

    int number() const { return number_; }
    /// Closes; returns 0 or errno. A full disk may be reported only here.
    int close() { return number_ < 0 || ::close(std::exchange(number_, -1)) == 0 ? 0 : errno; }

  private:
    int number_;
};

std::string reason(int code) { return std::generic_category().message(code); }

Error cannot_read(const std::string& path, std::string found) {
    return {path, {}, "cannot be read", "a readable file", std::move(found), ErrorCode::unreadable};
}
Error cannot_write(const std::string& path, std::string found) {
    return {path, {}, "cannot be written", "a writable file", std::move(found), ErrorCode::unreadable};
}

/// Writes all of `bytes` and closes; returns 0 or errno.
int write_all(Descriptor& file, std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(file.number(), bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return errno;
        bytes = bytes.subspan(std::size_t(written));
    }
    return file.close();
}

/// A new file next to `target` with a unique name.
Descriptor create_beside(const std::string& target, mode_t mode, std::string& name) {
    for (int attempt = 0;; ++attempt) {
        const auto folder = std::filesystem::path(target).parent_path();
        name = (folder / fmt::format(".srbf-{}-{}.tmp", ::getpid(), attempt)).string();
        const int number = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
        if (number >= 0 || errno != EEXIST) return Descriptor(number);
    }
}

}  // namespace

Result<std::vector<std::byte>> read_file(const std::string& path) {
    Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    if (file.number() < 0) return cannot_read(path, reason(errno));
    struct stat status;
    if (::fstat(file.number(), &status) != 0) return cannot_read(path, reason(errno));
    if (S_ISDIR(status.st_mode)) return cannot_read(path, "a folder");
    const auto too_large = [&path] { return cannot_read(path, fmt::format("more than {} bytes", k_largest_file)); };
    const std::uint64_t size = S_ISREG(status.st_mode) ? std::uint64_t(status.st_size) : 0;
    if (size > k_largest_file) return too_large();

    // One byte more than the file size, so that the end is detected without growing; a pipe has no size in advance, and
    // the buffer grows.
    std::vector<std::byte> bytes(size > 0 ? size + 1 : 1 << 16);
    for (std::size_t filled = 0;;) {
        const ssize_t count = ::read(file.number(), bytes.data() + filled, bytes.size() - filled);
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) return cannot_read(path, reason(errno));
        filled += std::size_t(count);
        if (filled > k_largest_file) return too_large();
        if (count == 0) {
            bytes.resize(filled);
            return bytes;
        }
        if (filled == bytes.size()) bytes.resize(std::min<std::size_t>(2 * filled, k_largest_file + 1));
    }
}

Result<std::vector<std::byte>> read_part(const std::string& path, std::uint64_t offset, std::size_t most) {
    const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    if (file.number() < 0) return cannot_read(path, reason(errno));
    std::vector<std::byte> bytes(most);
    for (std::size_t filled = 0;;) {
        const ssize_t count = ::pread(file.number(), bytes.data() + filled, most - filled, off_t(offset + filled));
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) return cannot_read(path, errno == EISDIR ? "a folder" : reason(errno));
        filled += std::size_t(count);
        if (count > 0 && filled < most) continue;
        bytes.resize(filled);
        return bytes;
    }
}

Result<Done> write_file(const std::string& path, std::span<const std::byte> bytes) {
    // Follows a link; the rename would otherwise replace the link instead of its target.
    std::error_code unresolved;
    std::string target = path;
    if (std::filesystem::is_symlink(path, unresolved)) {
        const std::filesystem::path link(path);
        const bool leads_somewhere = std::filesystem::exists(link, unresolved);
        target = (leads_somewhere ? std::filesystem::canonical(link, unresolved)
                                  : link.parent_path() / std::filesystem::read_symlink(link, unresolved))
                     .string();
    }
    if (unresolved || target.empty()) target = path;

    struct stat status;
    const bool exists = ::stat(path.c_str(), &status) == 0;
    if (exists && S_ISDIR(status.st_mode)) return cannot_write(path, "a folder");
    if (exists && !S_ISREG(status.st_mode)) {  // a device or a pipe is written directly
        Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
        if (file.number() < 0) return cannot_write(path, reason(errno));
        if (const int code = write_all(file, bytes)) return cannot_write(path, reason(code));
        return Done{};
    }

    std::string temporary;
    Descriptor file = create_beside(target, exists ? status.st_mode & 0777 : 0666, temporary);
    if (file.number() < 0) return cannot_write(path, reason(errno));
    int code = write_all(file, bytes);
    if (code == 0 && std::rename(temporary.c_str(), target.c_str()) != 0) code = errno;
    if (code == 0) return Done{};
    ::unlink(temporary.c_str());
    return cannot_write(path, reason(code));
}

}  // namespace srbf
