// Files of texels.
#pragma once
#include "base/files.h"
#include "srbf/fit_map.h"
#include "srbf/result.h"
#include "srbf/vec.h"

namespace SRBF_NAMESPACE {

/// A .npy file of float32.
class NpyFile {
  public:
    static Result<NpyFile> open(const std::string& path);
    const std::vector<std::uint64_t>& shape() const { return shape_; }
    /// Reads numbers from the one with index `first` on, as many as fit.
    Result<Done> read(std::uint64_t first, std::span<float> numbers) const;

  private:
    explicit NpyFile(FileReader file) : file_(std::move(file)) {}

    FileReader file_;
    std::vector<std::uint64_t> shape_;
    std::uint64_t data_ = 0;
};

/// A file of f_r [1/sr]: [T, M, 3], or [T, M, 1] and [T, M] for grey texels.
class Texels {
  public:
    static Result<Texels> open(const std::string& path, std::size_t pairs);
    std::size_t count() const { return std::size_t(file_.shape()[0]); }
    /// Reads texels from `first` on, as many as fit into `f`. Numbers that stand for no value, as −999, become NaN.
    Result<Done> read(std::size_t first, std::span<Rgb> f) const;
    /// The values [T, pairs] of at most `max` texels that span the map: among equally spaced texels it chooses, one
    /// after the other, the one whose cube roots differ most from all that were chosen. Values that no other texel is
    /// near are NaN. Returns an error if a texel cannot be read.
    Result<std::vector<Rgb>> spanning(const SharedPairs& pairs, std::size_t max) const;
    /// A line about numbers that stand for no value, from the first texel that has some; empty if none has.
    const std::string& note() const { return note_; }

  private:
    Texels(NpyFile file, std::size_t pairs, std::size_t channels)
        : file_(std::move(file)), pairs_(pairs), channels_(channels) {}

    NpyFile file_;
    std::size_t pairs_, channels_;
    mutable std::string note_;
};

}  // namespace
