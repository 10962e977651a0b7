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

/// The result of a system call, which is repeated as long as signals interrupt it.
template <typename Call> auto repeated(const Call& call) {
    for (;;)
        if (const auto result = call(); result >= 0 || errno != EINTR) return result;
}

/// A record's number of bytes, and the hash up to its end.
using RecordHead = std::array<std::uint64_t, 2>;

std::uint64_t hash_after(std::uint64_t before, std::span<const std::byte> record) {
    Hash hash;
    hash.add(std::as_bytes(std::span(&before, 1)));
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
        const int descriptor = repeated([&] { return ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666); });
        Journal journal(path, descriptor);
        if (descriptor < 0) return journal.cannot_write();
        // Some file systems have no locks: nobody is refused then.
        if (repeated([&] { return ::flock(descriptor, LOCK_EX | LOCK_NB); }) != 0 && errno == EWOULDBLOCK) {
            journal.records_ = 1;  // of the other process
            return Error{path, {}, "output", "one run at a time", "another run that writes it"};
        }
        if (!is_same_file(descriptor, path)) {  // the run that had it has just ended
            journal.records_ = 1;
            continue;
        }
        if (const auto begun = journal.begin(key, resume); !begun) return begun.error();
        return journal;
    }
}

Result<Done> Journal::begin(const std::string& key, bool resume) {
    records_ = 1;  // whatever is there stays there in case of an error
    const auto bytes = read_file(path_);
    if (!bytes) return bytes.error();
    const std::string head = fmt::format("{}{}\n", k_mark, key);
    const std::string_view text = as_text(*bytes), found = text.substr(0, head.size());
    Hash of_key;
    of_key.add(as_bytes(head));
    hash_ = of_key.number();
    std::size_t end = 0;
    if (found == head && resume) {
        end = head.size();
        for (RecordHead of; bytes->size() - end >= sizeof of;) {
            std::memcpy(of.data(), bytes->data() + end, sizeof of);
            if (of[0] > bytes->size() - end - sizeof of) break;
            const auto record = std::span(*bytes).subspan(end + sizeof of, std::size_t(of[0]));
            if (hash_after(hash_, record) != of[1]) break;
            kept.emplace_back(record.begin(), record.end());
            hash_ = of[1], end += sizeof of + record.size();
        }
        if (end < bytes->size())
            fmt::print(stderr, "srbf: {}: the last {} bytes are not whole, and are made again\n", path_,
                       bytes->size() - end);
    } else if (found.starts_with(k_mark) && found.size() == head.size()) {
        if (resume)
            return Error{path_,
                         {},
                         "unfinished work",
                         "that of the same input, options and version",
                         "other work; delete it or run without --resume to begin anew"};
        fmt::print(stderr, "srbf: {}: unfinished work is replaced, without --resume\n", path_);
    } else if (!std::string_view(head).starts_with(found)) {
        return Error{path_, 0, "file", "unfinished work of srbf, or none", "something else"};
    }
    records_ = kept.size();
    if (repeated([&] { return ::ftruncate(descriptor_, off_t(end)); }) != 0) return cannot_write();
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
        const ssize_t written = repeated([&] { return ::write(descriptor_, bytes.data(), bytes.size()); });
        if (written < 0) return cannot_write();
        bytes = bytes.subspan(std::size_t(written));
    }
    return Done{};
}

Result<Done> Journal::add(std::span<const std::byte> record) {
    const RecordHead head{record.size(), hash_after(hash_, record)};
    if (const auto written = write(std::as_bytes(std::span(head))); !written) return written;
    if (const auto written = write(record); !written) return written;
    const int failed = repeated([&] { return ::fsync(descriptor_); });
    if (failed != 0 && errno != EINVAL && errno != ENOTSUP) return cannot_write();
    hash_ = head[1], ++records_;
    return Done{};
}

void Journal::remove() { ::unlink(path_.c_str()); }

}  // namespace srbf
