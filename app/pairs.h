// Pairs of directions from a CSV file.
#pragma once
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "srbf/result.h"
#include "srbf/vec.h"

namespace srbf {

inline constexpr std::array<std::string_view, 6> k_pair_columns{"wl_x", "wl_y", "wl_z", "wv_x", "wv_y", "wv_z"};

struct Pairs {
    std::vector<Vec3f> wl, wv;
    std::vector<std::array<std::string, 6>> text;  ///< as written in the file
};
/// Reads the columns `k_pair_columns` of a CSV whose first line names its columns. Errors name the line.
Result<Pairs> read_pairs(std::string_view csv, const std::string& file_name);

}  // namespace srbf
