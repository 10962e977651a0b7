// Work in progress, beside the file that it is for.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "srbf/result.h"

namespace srbf {

/// A file OUTPUT.part of what a long run has done: a line with the key of the work, then records. A record has its number
/// of bytes and a hash of the key and of all bytes up to its end, so that records that are torn, changed, or of other work
/// are not taken for its own. While the journal is open no other process can open it.
class Journal {
  public:
    /// Begins a journal, or with `resume` continues one of the same key. A line on standard error names an older one, if it
    /// is replaced or if its end is damaged. Errors: another process has it; `resume`, and it is of another key; the file
    /// is no journal; it cannot be written.
    static Result<Journal> open(const std::string& output, const std::string& key, bool resume);
    Journal(Journal&& other) noexcept;
    Journal& operator=(Journal&&) = delete;
    /// Deletes the file if it has no record.
    ~Journal();

    /// The records of earlier runs; they are moved from here.
    std::vector<std::vector<std::byte>> kept;
    /// Adds a record, and waits until the disk has it.
    Result<Done> add(std::span<const std::byte> record);
    /// Deletes the file: the output is written.
    void remove();

  private:
    Journal(std::string path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {}
    Result<Done> begin(const std::string& key, bool resume);
    Result<Done> write(std::span<const std::byte> bytes);
    Error cannot_write() const;

    std::string path_;
    int descriptor_;
    std::size_t records_ = 0;
    std::uint64_t hash_ = 0;  ///< of the last record, or of the key
};

}  // namespace srbf
