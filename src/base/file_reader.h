#pragma once
#include <cstddef>
#include <functional>

#include "base/text.h"
#include "srbf/result.h"

SRBF_BEGIN

class FileReader {
  public:
    /// Errors: those of `read_file`.
    static Result<FileReader> open(const std::string& path);
    FileReader(FileReader&& other) noexcept;
    FileReader& operator=(FileReader&&) = delete;
    ~FileReader();

    const std::string& path() const { return path_; }
    /// Fills `bytes` with the next bytes of the file, fewer at its end; returns their number.
    Result<std::size_t> read(std::span<std::byte> bytes);
    /// Fills `bytes` with those from `offset` on, fewer at the end of the file, and returns their number. The next bytes
    /// of the other `read` stay the same.
    Result<std::size_t> read(std::uint64_t offset, std::span<std::byte> bytes) const;

  private:
    FileReader(std::string path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {}
    std::string path_;
    int descriptor_;
};

/// The next bytes of a file's content; none at its end.
using NextBytes = std::function<Result<std::vector<std::byte>>()>;
/// `write_file` of content that is made while it is written. Errors: also those of `next`, after which `path` holds its
/// previous content.
Result<Done> write_file(const std::string& path, const NextBytes& next);

/// The lines of a file, as those of `Lines`. Only a block of the file is in memory; a longer line is an error.
class FileLines {
  public:
    explicit FileLines(FileReader file) : file_(std::move(file)), lines_({}) {}
    /// The next line that is not empty, valid until the next call; no value at the end.
    Result<std::optional<std::string_view>> next();
    /// Number of the last line that was returned, counted from 1.
    std::uint64_t number() const { return lines_before_ + lines_.number(); }

  private:
    Result<Done> read_block();

    FileReader file_;
    std::vector<std::byte> block_;
    std::size_t complete_ = 0;        ///< bytes of the block's complete lines
    std::uint64_t lines_before_ = 0;  ///< number of lines before the block
    bool at_end_ = false;
    Lines lines_;
};

SRBF_END
