#include "srbf/file.h"

#include <fmt/format.h>

#include <system_error>
#include <utility>

#include "base/files.h"
#include "base/system_files.h"
#include "base/text.h"

namespace SRBF_NAMESPACE {

namespace {

namespace system = system_files;

/// The result of a system call, which is repeated while signals interrupt it.
template <typename Call> auto uninterrupted(const Call& call) {
    for (;;)
        if (const auto result = call(); result >= 0 || errno != EINTR) return result;
}

int open_file(const std::string& path, int flags, unsigned mode = 0) {
    return uninterrupted([&] { return system::open(path, flags, mode); });
}
int open_folder(const std::string& path) {
    return uninterrupted([&] { return system::open_folder(path); });
}

/// The system's text for an errno; empty for 0, which is success.
std::string reason(int code) { return code == 0 ? "" : std::generic_category().message(code); }

Error cannot_read(const std::string& path, std::string found) {
    return {path, {}, "cannot be read", "a readable file", std::move(found), ErrorCode::unreadable};
}
Error cannot_write(const std::string& path, std::string found) {
    return {path, {}, "cannot be written", "a writable file", std::move(found), ErrorCode::unreadable};
}

/// Waits until the disk has the file's content; returns 0 or errno. Some file systems do not support this for folders.
int synchronise(const Descriptor& file) {
    const int failed = uninterrupted([&] { return system::synchronise(file.number()); });
    return failed == 0 || errno == EINVAL || errno == ENOTSUP ? 0 : errno;
}

/// Writes all bytes; returns 0 or errno.
int write_all(const Descriptor& file, std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const auto written = uninterrupted([&] { return system::write(file.number(), bytes.data(), bytes.size()); });
        if (written < 0) return errno;
        bytes = bytes.subspan(std::size_t(written));
    }
    return 0;
}
/// Writes content to a file; returns 0 or errno.
using WriteContent = std::function<int(const Descriptor&)>;
/// Also closes the file. If `durable`, waits until the disk has the content.
int write_and_close(Descriptor& file, const WriteContent& content, bool durable) {
    if (const int code = content(file)) return code;
    if (const int code = durable ? synchronise(file) : 0) return code;
    return file.close();
}

std::string folder_of(const std::string& path) {
    const std::string folder = system::path_text(system::path_of(path).parent_path());
    return folder.empty() ? "." : folder;
}

/// Waits until the disk has the names in the folder of `path`; returns 0 or errno.
int synchronise_folder_of(const std::string& path) {
    const Descriptor folder(open_folder(folder_of(path)));
    if (folder.number() < 0) return errno == EACCES ? 0 : errno;  // a folder may be writable but not readable
    return synchronise(folder);
}

/// Locks the folder of a file for its lifetime: of several programs that rename files there together, only one does so
/// at a time, and the files of the last one remain. Has no effect on file systems without such locks.
class FolderLock {
  public:
    explicit FolderLock(const std::string& path) : folder_(open_folder(folder_of(path))) {
        if (folder_.number() >= 0) (void)uninterrupted([&] { return system::lock(folder_.number()); });
    }

  private:
    Descriptor folder_;
};

/// A new file next to `target` with a unique name.
Descriptor create_beside(const std::string& target, unsigned mode, std::string& name) {
    for (int attempt = 0;; ++attempt) {
        name = system::path_text(system::path_of(target).parent_path() /
                                 fmt::format(".srbf-{}-{}.tmp", system::process(), attempt));
        const int number = open_file(name, O_WRONLY | O_CREAT | O_EXCL, mode);
        if (number >= 0 || errno != EEXIST) return Descriptor(number);
    }
}

/// The file that `path` names: follows a link, which a rename would otherwise replace.
std::string target_of(const std::string& path) {
    std::error_code unresolved;
    const std::filesystem::path link = system::path_of(path);
    if (!std::filesystem::is_symlink(link, unresolved)) return path;
    const bool leads_somewhere = std::filesystem::exists(link, unresolved);
    const std::string target =
        system::path_text(leads_somewhere ? std::filesystem::canonical(link, unresolved)
                                          : link.parent_path() / std::filesystem::read_symlink(link, unresolved));
    return unresolved || target.empty() ? path : target;
}

/// A temporary file beside its target, which `publish` replaces by it. The destructor deletes it otherwise.
class Replacement {
  public:
    static Result<Replacement> write(const std::string& path, const WriteContent& content) {
        Replacement replacement(path);
        if (const std::string failed = replacement.write(content); !failed.empty()) return cannot_write(path, failed);
        return replacement;
    }
    static Result<Replacement> write(const std::string& path, std::span<const std::byte> bytes) {
        return write(path, [bytes](const Descriptor& file) { return write_all(file, bytes); });
    }
    Replacement(Replacement&& other) noexcept
        : path_(std::move(other.path_)),
          target_(std::move(other.target_)),
          temporary_(std::exchange(other.temporary_, {})) {}
    Replacement& operator=(Replacement&&) = delete;
    ~Replacement() {
        if (!temporary_.empty()) system::remove(temporary_);
    }

    Result<Done> publish() {
        if (temporary_.empty()) return Done{};  // a device was written directly
        if (system::rename(temporary_, target_) != 0) return cannot_write(path_, reason(errno));
        temporary_.clear();
        return Done{};
    }
    Result<Done> synchronise_name() const {
        if (target_.empty()) return Done{};
        if (const int code = synchronise_folder_of(target_)) return cannot_write(path_, reason(code));
        return Done{};
    }

  private:
    explicit Replacement(const std::string& path) : path_(path) {}

    /// Returns the reason of a failure, or an empty string.
    std::string write(const WriteContent& content) {
        system::Status status;
        const bool exists = system::status(path_, status) == 0;
        if (exists && S_ISDIR(status.st_mode)) return "a folder";
        if (exists && !S_ISREG(status.st_mode)) {  // a device or a pipe is written directly
            Descriptor file(open_file(path_, O_WRONLY));
            if (file.number() < 0) return reason(errno);
            return reason(write_and_close(file, content, false));
        }
        target_ = target_of(path_);
        std::string name;
        Descriptor file = create_beside(target_, exists ? status.st_mode & 0777 : 0666, name);
        if (file.number() < 0) return reason(errno);
        temporary_ = std::move(name);
        return reason(write_and_close(file, content, true));
    }

    std::string path_, target_, temporary_;
};

/// The bytes of an open file, to its end or one byte beyond `max`.
Result<std::vector<std::byte>> read_open(const Descriptor& file, const std::string& path, const MaxBytes& max) {
    system::Status status;
    if (system::status(file.number(), status) != 0) return cannot_read(path, reason(errno));
    if (S_ISDIR(status.st_mode)) return cannot_read(path, "a folder");
    const auto too_large = [&path] { return cannot_read(path, fmt::format("more than {} bytes", k_largest_file)); };
    const std::uint64_t size = S_ISREG(status.st_mode) ? std::uint64_t(status.st_size) : 0;
    if (size > k_largest_file && !max) return too_large();

    // One byte more than expected detects the end of the file. The size of a pipe is unknown, and its buffer grows.
    const auto expected = [&](std::uint64_t limit) { return std::size_t(std::min(size, limit) + 1); };
    std::uint64_t limit = max ? k_head_bytes : k_largest_file;
    std::vector<std::byte> bytes(size > 0 ? expected(limit) : 1 << 16);
    bool is_head_complete = !max;
    for (std::size_t filled = 0;;) {
        const auto count =
            uninterrupted([&] { return system::read(file.number(), bytes.data() + filled, bytes.size() - filled); });
        if (count < 0) return cannot_read(path, reason(errno));
        filled += std::size_t(count);
        if (!is_head_complete && filled >= k_head_bytes) {
            is_head_complete = true;
            limit = std::min(max(std::span(bytes).first(k_head_bytes)), k_largest_file);
            if (limit == k_largest_file && size > limit) return too_large();
            if (filled <= limit && size > filled) bytes.resize(std::max(filled, expected(limit)));
        }
        if (filled > k_largest_file) return too_large();
        if (count == 0 || (is_head_complete && filled > limit)) {
            bytes.resize(filled);
            return bytes;
        }
        if (filled == bytes.size()) bytes.resize(std::size_t(std::min(2 * std::uint64_t(filled), limit + 1)));
    }
}

/// Fills `bytes` by calls of `read(place, size, filled)`, or as many as there are.
template <typename Read>
Result<std::size_t> fill(std::span<std::byte> bytes, const std::string& path, const Read& read) {
    std::size_t filled = 0;
    while (filled < bytes.size()) {
        const auto count = uninterrupted([&] { return read(bytes.data() + filled, bytes.size() - filled, filled); });
        if (count < 0) return cannot_read(path, errno == EISDIR ? "a folder" : reason(errno));
        if (count == 0) break;
        filled += std::size_t(count);
    }
    return filled;
}

Result<Done> publish(Result<Replacement> file) {
    if (!file) return file.error();
    if (const auto published = file->publish(); !published) return published;
    return file->synchronise_name();
}

}  // namespace

int Descriptor::close() {
    return number_ < 0 || system::close(std::exchange(number_, -1)) == 0 || errno == EINTR ? 0 : errno;
}

Result<std::vector<std::byte>> read_file(const std::string& path) { return read_file(path, {}); }

Result<std::vector<std::byte>> read_file(const std::string& path, const MaxBytes& max) {
    return within_memory(path, [&]() -> Result<std::vector<std::byte>> {
        const Descriptor file(open_file(path, O_RDONLY));
        if (file.number() < 0) return cannot_read(path, reason(errno));
        return read_open(file, path, max);
    });
}

Result<FileReader> FileReader::open(const std::string& path) {
    Descriptor file(open_file(path, O_RDONLY));
    if (file.number() < 0) return cannot_read(path, reason(errno));
    return FileReader(path, std::move(file));
}

Result<std::size_t> FileReader::read(std::span<std::byte> bytes) {
    return fill(bytes, path_, [&](auto* to, auto size, auto) { return system::read(file_.number(), to, size); });
}

Result<std::size_t> FileReader::read(std::uint64_t offset, std::span<std::byte> bytes) const {
    return fill(bytes, path_, [&](auto* to, std::size_t size, std::size_t filled) {
        return system::read_at(file_.number(), to, size, offset + filled);
    });
}

Result<Done> write_file(const std::string& path, std::span<const std::byte> bytes) {
    return publish(Replacement::write(path, bytes));
}

Result<Done> write_file(const std::string& path, const NextBytes& next) {
    std::optional<Error> failed;
    auto file = Replacement::write(path, [&](const Descriptor& to) {
        for (;;) {
            const auto bytes = next();
            if (!bytes) failed = bytes.error();
            if (!bytes || bytes->empty()) return failed ? ECANCELED : 0;
            if (const int code = write_all(to, *bytes)) return code;
        }
    });
    if (failed) return *failed;
    return publish(std::move(file));
}

Result<Done> write_files(std::span<const NewFile> files, const std::function<Result<Done>()>& lines_before_renaming) {
    std::vector<Replacement> written;
    for (const NewFile& new_file : files) {
        auto file = Replacement::write(new_file.path, new_file.bytes);
        if (!file) return file.error();
        written.push_back(*std::move(file));
    }
    if (lines_before_renaming)
        if (const auto done = lines_before_renaming(); !done) return done;
    {
        const FolderLock lock(files.empty() ? "" : files[0].path);
        for (Replacement& file : written)
            if (const auto published = file.publish(); !published) return published;
    }
    for (const Replacement& file : written)
        if (const auto synchronised = file.synchronise_name(); !synchronised) return synchronised;
    return Done{};
}

Result<Done> rename_path(const std::string& from, const std::string& to) {
    if (system::rename(from, to) != 0) return cannot_write(to, reason(errno));
    if (const int code = synchronise_folder_of(to)) return cannot_write(to, reason(code));
    return Done{};
}

}  // namespace
