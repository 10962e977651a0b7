// How the readers of scattered measurements gather samples: private to them.
#pragma once
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
    /// Room for as many samples of `columns` numbers as the rest of a file can spell: two bytes for each number.
    SampleBuilder(Values values, std::vector<float> wavelengths, std::size_t bytes, std::size_t columns);
    /// Values a sample has.
    std::size_t width() const {
        return values_ == Values::grey ? 1 : values_ == Values::spectrum ? weights_.size() : 3;
    }
    /// A sample, f[width()]: masked where a number is not finite or a direction lies below the horizon.
    void add(Vec3d wl, Vec3d wv, std::span<const float> f);
    /// Errors: not one sample is left.
    Result<Scattered> finish(const std::string& source, std::string description, bool isotropic) &&;

  private:
    Values values_;
    std::vector<Rgb> weights_;
    Scattered samples_;
};

/// Whether `bytes` are text, as far as their first kilobytes tell.
bool is_text(std::span<const std::byte> bytes);
/// The formats told apart by their first lines.
bool is_cornell(std::string_view text);
bool is_astm(std::string_view text);
bool is_alta(std::string_view text);
bool is_csv(std::string_view text);

}  // namespace srbf
