// Pairs of directions from a CSV file.
#pragma once
#include <array>

#include "base/files.h"
#include "base/text.h"
#include "srbf/result.h"
#include "srbf/vec.h"

namespace srbf {

inline constexpr std::array<std::string_view, 6> k_pair_columns{"wl_x", "wl_y", "wl_z", "wv_x", "wv_y", "wv_z"};

struct DirectionPairs {
    std::vector<Vec3f> wl, wv;
    std::vector<std::array<std::string, 6>> text;  ///< the numbers of a pair as the file writes them
};

/// Parses a CSV file whose first line names its columns, and keeps the columns `k_pair_columns`. Errors state the line.
class PairParser {
  public:
    explicit PairParser(std::string file_name) : file_name_(std::move(file_name)) {}
    /// Adds the pair in a line to `pairs`. The first line is the header.
    Result<Done> take(std::string_view line, std::uint64_t number, DirectionPairs& pairs);
    /// Returns an error if there was no header.
    Result<Done> finish() const;

  private:
    Result<Done> take_header(std::uint64_t number);

    std::string file_name_;
    bool has_header_ = false;
    std::array<std::size_t, 6> column_{};
    std::vector<std::string_view> fields_;
};

/// The lines of a file, as `Lines` reads them. Only a block of the file is in memory; a longer line is an error.
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

/// Reads the pairs of a file in blocks.
class PairReader {
  public:
    static Result<PairReader> open(const std::string& path);
    /// The next `max_count` pairs, or fewer at the end of the file.
    Result<DirectionPairs> next(std::size_t max_count);

  private:
    explicit PairReader(FileReader file) : parser_(file.path()), lines_(std::move(file)) {}
    PairParser parser_;
    FileLines lines_;
};

/// All pairs of a file.
Result<DirectionPairs> load_pairs(const std::string& path);

}  // namespace srbf
