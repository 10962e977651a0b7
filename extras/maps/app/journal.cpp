#include "extras/maps/app/journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "app/hash.h"
#include "base/text.h"
#include "srbf/file.h"

namespace srbf {
namespace {

constexpr std::string_view k_mark = "srbf part 1, key ";

/// Repeats a system call as long as signals interrupt it, and returns its result.
template <typename Call> auto repeat_if_interrupted(const Call& call) {
    for (;;)
        if (const auto result = call(); result >= 0 || errno != EINTR) return result;
}

/// The number of bytes of a record, and the hash up to its end.
using RecordHead = std::array<std::uint64_t, 2>;

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
            journal.records_ = 1;  // the records of the other process, which must not be deleted
            return Error{path, {}, "output", "one run at a time", "another run that writes it"};
        }
        if (!is_same_file(descriptor, path)) {  // the run that had it open has just ended
            journal.records_ = 1;
            continue;
        }
        if (const auto ready = journal.begin(key, resume); !ready) return ready.error();
        return journal;
    }
}

Result<Done> Journal::begin(const std::string& key, bool resume) {
    records_ = 1;  // keeps existing records in case of an error
    const auto bytes = read_file(path_);
    if (!bytes) return bytes.error();
    const std::string head = fmt::format("{}{}\n", k_mark, key);
    const std::string_view text = as_text(*bytes), beginning = text.substr(0, head.size());
    Hash key_hash;
    key_hash.add(as_bytes(head));
    hash_ = key_hash.number();
    std::size_t end = 0;
    if (beginning == head && resume) {
        end = head.size();
        for (RecordHead record_head; bytes->size() - end >= sizeof record_head;) {
            std::memcpy(record_head.data(), bytes->data() + end, sizeof record_head);
            if (record_head[0] > bytes->size() - end - sizeof record_head) break;
            const auto record = std::span(*bytes).subspan(end + sizeof record_head, std::size_t(record_head[0]));
            if (hash_after(hash_, record) != record_head[1]) break;
            kept.emplace_back(record.begin(), record.end());
            hash_ = record_head[1], end += sizeof record_head + record.size();
        }
        if (end < bytes->size())
            fmt::print(stderr, "srbf: {}: the last {} bytes are not whole, and are made again\n", path_,
                       bytes->size() - end);
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
    records_ = kept.size();
    if (repeat_if_interrupted([&] { return ::ftruncate(descriptor_, off_t(end)); }) != 0) return cannot_write();
    if (::lseek(descriptor_, off_t(end), SEEK_SET) < 0) return cannot_write();
    return end > 0 ? Done{} : write(as_bytes(head));
}

Journal::Journal(Journal&& other) noexcept
    : kept(std::move(other.kept)),
      path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      records_(other.records_),
      hash_(other.hash_) {}

Journal::~Journal() {
    if (descriptor_ < 0) return;
    if (records_ == 0) remove();
    ::close(descriptor_);
}

Result<Done> Journal::write(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t written = repeat_if_interrupted([&] { return ::write(descriptor_, bytes.data(), bytes.size()); });
        if (written < 0) return cannot_write();
        bytes = bytes.subspan(std::size_t(written));
    }
    return Done{};
}

Result<Done> Journal::add(std::span<const std::byte> record) {
    const RecordHead head{record.size(), hash_after(hash_, record)};
    if (const auto written = write(std::as_bytes(std::span(head))); !written) return written;
    if (const auto written = write(record); !written) return written;
    const int failed = repeat_if_interrupted([&] { return ::fsync(descriptor_); });
    if (failed != 0 && errno != EINVAL && errno != ENOTSUP) return cannot_write();
    hash_ = head[1], ++records_;
    return Done{};
}

void Journal::remove() { ::unlink(path_.c_str()); }

}  // namespace srbf
