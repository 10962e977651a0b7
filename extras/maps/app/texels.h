// Files of texels.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "base/files.h"
#include "srbf/result.h"
#include "srbf/vec.h"

namespace SRBF_NAMESPACE {

/// A file of f_r [1/sr]: float32 [T, M, 3], or [T, M, 1] and [T, M] for grey texels.
class Texels {
  public:
    static Result<Texels> open(const std::string& path, std::size_t pairs);
    std::size_t count() const { return count_; }
    /// Reads texels from `first` on, as many as fit into `f`. Numbers that stand for no value, as −999, become NaN.
    Result<Done> read(std::size_t first, std::span<Rgb> f) const;
    /// A line on such numbers, of the first texel that was read and has them; empty if none has.
    const std::string& note() const { return note_; }

  private:
    explicit Texels(FileReader file) : file_(std::move(file)) {}

    FileReader file_;
    std::uint64_t data_ = 0;
    std::size_t pairs_ = 0, channels_ = 3, count_ = 0;
    mutable std::string note_;
};

}  // namespace srbf
