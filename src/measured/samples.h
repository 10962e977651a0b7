// How the readers of scattered measurements gather samples: private to them.
#pragma once
#include <algorithm>
#include <string>

#include "srbf/colour.h"
#include "srbf/measured.h"
#include "srbf/text.h"

namespace srbf {

/// What the values of a sample are.
enum class Values { grey, rgb, xyz, spectrum };

/// A limit on the columns of a file: no measurement comes near.
inline constexpr std::size_t k_most_columns = 4096;

/// Gathers samples, and leaves out those that are none.
class SampleBuilder {
  public:
    /// For a file of so many bytes and at most so many rows. No more samples are taken than fit, with their index, into 4 × the file and
    /// 32 MB.
    SampleBuilder(Values values, std::vector<float> wavelengths, std::size_t bytes, std::size_t rows);
    /// Values a sample has.
    std::size_t width() const {
        return values_ == Values::grey ? 1 : values_ == Values::spectrum ? weights_.size() : 3;
    }
    /// A sample, f[width()]: masked where a number is not finite or a direction lies below the horizon.
    void add(Vec3d wl, Vec3d wv, std::span<const float> f);
    /// The samples, without an index. Errors: not one sample is left; there were too many.
    Result<Scattered> finish(const std::string& source, std::string description, bool isotropic) &&;

  private:
    Values values_;
    std::vector<Rgb> weights_;
    Scattered samples_;
    std::size_t bytes_, most_ = 0;
    bool too_many_ = false;
};

/// Each reader but for the index that `make_index` makes: it can wait until the text is out of memory.
Result<Scattered> read_cornell_samples(std::span<const std::byte> bytes, const std::string& source);
Result<Scattered> read_astm_samples(std::span<const std::byte> bytes, const std::string& source);
Result<Scattered> read_alta_samples(std::span<const std::byte> bytes, const std::string& source);
Result<Scattered> read_csv_samples(std::span<const std::byte> bytes, const std::string& source);
Result<Scattered> indexed(Result<Scattered> samples);

/// A bound on the rows of a text: its lines.
inline std::size_t lines_of(std::span<const std::byte> bytes) {
    return std::size_t(std::ranges::count(bytes, std::byte('\n'))) + 1;
}

/// Whether `bytes` are text, as far as their first kilobytes tell.
bool is_text(std::span<const std::byte> bytes);
/// The formats told apart by their first lines.
bool is_cornell(std::string_view text);
bool is_astm(std::string_view text);
bool is_alta(std::string_view text);
bool is_csv(std::string_view text);

}  // namespace srbf
