// A journal of work in progress, beside the file that it is for.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "srbf/result.h"

namespace SRBF_NAMESPACE {

/// A file OUTPUT.part that records what a long run has done: a line with the key of the work, then records. A
/// record has its number of bytes and a hash of the key and of all bytes up to its end, so that torn or changed
/// records, and records of other work, are recognised. While the journal is open, no other process can open it.
class Journal {
  public:
    /// Begins a journal, or with `resume` continues one with the same key. Reports on standard error if an older
    /// one is replaced or its end is damaged. Errors: another process has it open; `resume` with another key; the
    /// file is not a journal; it cannot be written.
    static Result<Journal> open(const std::string& output, const std::string& key, bool resume);
    Journal(Journal&& other) noexcept;
    Journal& operator=(Journal&&) = delete;
    /// Deletes the file if it has no record.
    ~Journal();

    /// The place of a record in the file.
    struct Record {
        std::uint64_t offset, size;
    };
    /// All records, first those of earlier runs.
    const std::vector<Record>& records() const { return records_; }
    /// A part of a record.
    Result<std::vector<std::byte>> read(const Record& record, std::uint64_t offset, std::size_t size) const;
    Result<std::vector<std::byte>> read(const Record& record) const { return read(record, 0, record.size); }
    /// Adds a record, and waits until it is on the disk.
    Result<Done> add(std::span<const std::byte> record);
    /// Deletes the file, once the output is written.
    void remove();

  private:
    Journal(std::string path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {}
    Result<Done> begin(const std::string& key, bool resume);
    Result<Done> write(std::span<const std::byte> bytes);
    Result<Done> keep_records(std::uint64_t size);
    Error cannot_write() const;

    std::string path_;
    int descriptor_;
    std::vector<Record> records_;
    bool is_kept_ = false;    ///< whether the file remains if it has no record
    std::uint64_t end_ = 0;   ///< its size
    std::uint64_t hash_ = 0;  ///< hash of the last record, or of the key
};

}  // namespace srbf
