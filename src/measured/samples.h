// Collection of scattered samples: private to the readers.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "srbf/colour.h"
#include "srbf/elementary.h"
#include "srbf/measured.h"
#include "srbf/text.h"

namespace srbf {

/// The kind of values of a sample.
enum class Values { grey, rgb, xyz, spectrum };

/// Limit on the columns of a file, far above those of any measurement.
inline constexpr std::size_t k_most_columns = 4096;
inline constexpr std::size_t k_absent = k_most_columns;  ///< the position of a column that a file has not

/// Collects samples, and drops invalid ones.
class SampleBuilder {
  public:
    /// For a file with `bytes` bytes and at most `rows` rows. The number of samples is limited such that they fit, with
    /// their index, into 4 × the file and 32 MB.
    SampleBuilder(Values values, std::vector<float> wavelengths, std::size_t bytes, std::size_t rows);
    /// Number of values of a sample.
    std::size_t width() const {
        return values_ == Values::grey ? 1 : values_ == Values::spectrum ? weights_.size() : 3;
    }
    /// Adds a sample with values f[width()]. It is masked if a number is not finite or a direction is below the
    /// horizon.
    void add(Vec3d wl, Vec3d wv, std::span<const float> f, float weight = 1);
    bool empty() const { return samples_.wl.empty(); }
    /// The samples, without an index. Errors: no samples are left; there were too many.
    Result<ScatteredSamples> finish(const std::string& file_name, std::string description, bool isotropic) &&;

  private:
    Values values_;
    std::vector<Rgb> weights_;
    ScatteredSamples samples_;
    std::size_t bytes_, most_ = 0;
    bool too_many_ = false;
};

/// The readers without `make_index`, which can wait until the text is freed.
Result<ScatteredSamples> read_cornell_samples(std::span<const std::byte> bytes, const std::string& file_name);
Result<ScatteredSamples> read_astm_samples(std::span<const std::byte> bytes, const std::string& file_name);
Result<ScatteredSamples> read_alta_samples(std::span<const std::byte> bytes, const std::string& file_name);
Result<ScatteredSamples> read_csv_samples(std::span<const std::byte> bytes, const std::string& file_name);
Result<ScatteredSamples> read_openmaterial_samples(std::span<const std::byte> bytes, const std::string& file_name);
Result<ScatteredSamples> read_bird_samples(std::span<const std::byte> bytes, const std::string& file_name);
/// FRED's text: `type bsdf_data`, `format angles=deg bsdf=value scale=1`, then lines of θ_l φ_l and of θ_v φ_v f [1/sr].
Result<ScatteredSamples> read_fred_samples(std::span<const std::byte> bytes, const std::string& file_name);
/// Rows of numbers whose columns `columns` names.
Result<ScatteredSamples> read_columns(std::span<const std::byte> bytes, const std::string& file_name,
                                      const std::string& columns);
Result<ScatteredSamples> indexed(Result<ScatteredSamples> samples);

/// Azimuths [rad] within this are equal: files state them with four digits or more. Components of directions too.
inline constexpr double k_azimuth_rounding = 1e-4;
/// The azimuths of the lights of a file. Where all have one, whichever it is, the file holds an isotropic measurement.
class LightAzimuths {
  public:
    /// A light along the normal has no azimuth.
    void add(const Vec3d& wl) {
        const double sine = elementary::hypot(wl.x, wl.y);
        if (sine <= k_azimuth_rounding) return;
        if (!first_) first_ = {wl.x / sine, wl.y / sine};
        const auto [x, y] = *first_;
        one_ &= std::abs(x * wl.y - y * wl.x) <= k_azimuth_rounding && x * wl.x + y * wl.y > 0;
    }
    bool are_one() const { return one_; }

  private:
    std::optional<std::array<double, 2>> first_;
    bool one_ = true;
};

/// A row of numbers with commas between them. After its first error, which is kept, its numbers are 0.
class NumberRow {
  public:
    NumberRow(std::size_t columns, const std::string& file_name) : columns_(columns), file_name_(file_name) {}
    /// Takes the fields of a line; an error if there are not as many as columns.
    void read(std::string_view text, std::uint64_t line) {
        line_ = line;
        split_fields(text, fields_);
        check();
    }
    /// The same of words.
    void read_words(std::string_view text, std::uint64_t line) {
        line_ = line;
        fields_.clear();
        for (auto word = next_word(text, " \t,"); !word.empty() && fields_.size() < k_most_fields;
             word = next_word(text, " \t,"))
            fields_.push_back(word);
        check();
    }
    void check() {
        if (fields_.size() != columns_)
            fail("sample", std::to_string(columns_) + " numbers", std::to_string(fields_.size()));
    }
    /// The number in a column, which an error calls `what`, or by its position.
    template <typename T> T number(std::size_t column, std::string_view what = {}) {
        if (error_) return 0;
        const std::string_view field = fields_[column];
        if (const auto number = to_number<T>(field)) return *number;
        fail(what.empty() ? "column " + std::to_string(column + 1) : std::string(what), "a number", quoted(field));
        return 0;
    }
    void fail(const std::string& what, std::string expected, std::string found) {
        if (!error_) error_ = at_line(file_name_, line_, what, std::move(expected), std::move(found));
    }
    const std::optional<Error>& error() const { return error_; }

  private:
    std::size_t columns_;
    const std::string& file_name_;
    std::uint64_t line_ = 0;
    std::vector<std::string_view> fields_;
    std::optional<Error> error_;
};

/// Upper bound on the rows of a text: its number of lines.
inline std::size_t lines_of(std::span<const std::byte> bytes) {
    return std::size_t(std::ranges::count(bytes, std::byte('\n'))) + 1;
}

/// Whether wavelengths [nm] tell of a colour: at least three, from blue to red.
bool has_colours(std::span<const float> wavelengths);

/// Whether the first kilobytes of `bytes` are text.
bool is_text(std::span<const std::byte> bytes);
/// Recognition of the formats by their first lines.
bool is_cornell(std::string_view text);
bool is_astm(std::string_view text);
bool is_alta(std::string_view text);
bool is_csv(std::string_view text);
/// Whether one of the comments before the header of a CSV is "both sides".
bool is_csv_of_both_sides(std::string_view text);
bool is_xml(std::string_view text);
bool is_fred(std::string_view text);
bool is_openmaterial(std::string_view text);
bool is_bird(std::string_view text);

}  // namespace srbf
