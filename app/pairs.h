// Pairs of directions from a CSV file.
#pragma once
#include <array>

#include "base/files.h"
#include "srbf/result.h"
#include "srbf/vec.h"

namespace srbf {

inline constexpr std::array<std::string_view, 6> k_pair_columns{"wl_x", "wl_y", "wl_z", "wv_x", "wv_y", "wv_z"};

struct DirectionPairs {
    std::vector<Vec3f> wl, wv;
    std::vector<std::array<std::string, 6>> text;  ///< the numbers of a pair as the file writes them
};

/// Parses the lines of a CSV file whose first line names its columns, and keeps the columns `k_pair_columns`.
/// Errors state the line.
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
