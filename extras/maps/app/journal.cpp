#include "extras/maps/app/journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "app/hash.h"
#include "base/files.h"
#include "base/text.h"
#include "srbf/file.h"

namespace SRBF_NAMESPACE {
namespace {

constexpr std::string_view k_mark = "srbf part 1, key ";

/// Repeats a system call as long as signals interrupt it, and returns its result.
template <typename Call> auto repeat_if_interrupted(const Call& call) {
    for (;;)
        if (const auto result = call(); result >= 0 || errno != EINTR) return result;
}

/// The number of bytes of a record, and the hash up to its end.
using LengthAndHash = std::array<std::uint64_t, 2>;

std::uint64_t hash_after(std::uint64_t previous, std::span<const std::byte> record) {
    Hash hash;
    hash.add(std::as_bytes(std::span(&previous, 1)));
    hash.add(record);
    return hash.number();
}

bool is_same_file(int descriptor, const std::string& path) {
    struct stat open, named;
    return ::fstat(descriptor, &open) == 0 && ::stat(path.c_str(), &named) == 0 && open.st_ino == named.st_ino &&
           open.st_dev == named.st_dev;
}

}  // namespace

Error Journal::cannot_write() const {
    return {path_,
            {},
            "cannot be written",
            "a writable file",
            std::generic_category().message(errno),
            ErrorCode::unreadable};
}

Result<Journal> Journal::open(const std::string& output, const std::string& key, bool resume) {
    for (;;) {
        const std::string path = output + ".part";
        const int descriptor =
            repeat_if_interrupted([&] { return ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666); });
        Journal journal(path, descriptor);
        if (descriptor < 0) return journal.cannot_write();
        // Some file systems have no locks: no run is refused there.
        if (repeat_if_interrupted([&] { return ::flock(descriptor, LOCK_EX | LOCK_NB); }) != 0 &&
            errno == EWOULDBLOCK) {
            journal.is_kept_ = true;  // the records of the other process, which must not be deleted
            return Error{path, {}, "output", "one run at a time", "another run that writes it"};
        }
        if (!is_same_file(descriptor, path)) {  // the run that had it open has just ended
            journal.is_kept_ = true;
            continue;
        }
        if (const auto ready = journal.begin(key, resume); !ready) return ready.error();
        return journal;
    }
}

Result<Done> Journal::begin(const std::string& key, bool resume) {
    is_kept_ = true;  // in case of an error
    std::error_code code;
    const std::uint64_t size = std::filesystem::file_size(path_, code);
    if (code) return cannot_write();
    const std::string head = fmt::format("{}{}\n", k_mark, key);
    const auto bytes = read_part(path_, 0, head.size());
    if (!bytes) return bytes.error();
    const std::string_view beginning = as_text(*bytes);
    Hash key_hash;
    key_hash.add(as_bytes(head));
    hash_ = key_hash.number();
    if (beginning == head && resume) {
        end_ = head.size();
        if (const auto kept = keep_records(size); !kept) return kept;
        if (end_ < size)
            fmt::print(stderr, "srbf: {}: the last {} bytes are not whole, and are made again\n", path_, size - end_);
    } else if (beginning.starts_with(k_mark) && beginning.size() == head.size()) {
        if (resume)
            return Error{path_,
                         {},
                         "unfinished work",
                         "that of the same input, options and version",
                         "other work; delete it or run without --resume to begin anew"};
        fmt::print(stderr, "srbf: {}: unfinished work is replaced, without --resume\n", path_);
    } else if (!std::string_view(head).starts_with(beginning)) {
        return Error{path_, 0, "file", "unfinished work of srbf, or none", "something else"};
    }
    is_kept_ = false;
    if (repeat_if_interrupted([&] { return ::ftruncate(descriptor_, off_t(end_)); }) != 0) return cannot_write();
    if (::lseek(descriptor_, off_t(end_), SEEK_SET) < 0) return cannot_write();
    return end_ > 0 ? Done{} : write(as_bytes(head));
}

/// Finds the whole records between `end_` and `size`.
Result<Done> Journal::keep_records(std::uint64_t size) {
    for (LengthAndHash head; size - end_ >= sizeof head;) {
        const auto head_bytes = read_part(path_, end_, sizeof head);
        if (!head_bytes) return head_bytes.error();
        std::memcpy(head.data(), head_bytes->data(), head_bytes->size());
        if (head_bytes->size() < sizeof head || head[0] > size - end_ - sizeof head) break;
        const Record record{end_ + sizeof head, head[0]};
        const auto bytes = read(record);
        if (!bytes) return bytes.error();
        if (hash_after(hash_, *bytes) != head[1]) break;
        records_.push_back(record);
        hash_ = head[1], end_ = record.offset + record.size;
    }
    return Done{};
}

Result<std::vector<std::byte>> Journal::read(const Record& record, std::uint64_t offset, std::size_t size) const {
    auto bytes = read_part(path_, record.offset + offset, size);
    if (bytes && bytes->size() != size) return Error{path_, record.offset, "record", "all of it", "a part"};
    return bytes;
}

Journal::Journal(Journal&& other) noexcept
    : path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      records_(std::move(other.records_)),
      is_kept_(other.is_kept_),
      end_(other.end_),
      hash_(other.hash_) {}

Journal::~Journal() {
    if (descriptor_ < 0) return;
    if (records_.empty() && !is_kept_) remove();
    ::close(descriptor_);
}

Result<Done> Journal::write(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t written = repeat_if_interrupted([&] { return ::write(descriptor_, bytes.data(), bytes.size()); });
        if (written < 0) return cannot_write();
        bytes = bytes.subspan(std::size_t(written)), end_ += std::uint64_t(written);
    }
    return Done{};
}

Result<Done> Journal::add(std::span<const std::byte> record) {
    const LengthAndHash head{record.size(), hash_after(hash_, record)};
    if (const auto written = write(std::as_bytes(std::span(head))); !written) return written;
    if (const auto written = write(record); !written) return written;
    const int failed = repeat_if_interrupted([&] { return ::fsync(descriptor_); });
    if (failed != 0 && errno != EINVAL && errno != ENOTSUP) return cannot_write();
    hash_ = head[1], records_.push_back({end_ - record.size(), record.size()});
    return Done{};
}

void Journal::remove() { ::unlink(path_.c_str()); }

}  // namespace srbf
