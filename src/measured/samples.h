// Collection of scattered samples: private to the readers.
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <string>

#include "base/text.h"
#include "brdf/colour.h"
#include "measured/tables.h"
#include "srbf/elementary.h"
#include "srbf/measured.h"

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
    /// The samples, without an index. What stands for a missing value (`missing_value`) is masked, and noted. Errors: no
    /// samples are left; there were too many.
    Result<ScatteredSamples> finish(const std::string& file_name, std::string description, bool isotropic) &&;

  private:
    void mask_missing();

    Values values_;
    std::vector<Rgb> weights_;
    ScatteredSamples samples_;
    std::size_t bytes_, most_ = 0;
    bool too_many_ = false;
};

/// Keeps the samples whose numbers `keep` accepts, and counts the others as masked.
void keep_samples(ScatteredSamples& samples, const std::function<bool(std::size_t)>& keep);

/// Divides values by what they are times f. Those that become too large are masked.
void to_bsdf(ScatteredSamples& samples, Quantity quantity);

enum class AngleKind { polar, azimuth };
/// The kind of each of θ_l, φ_l, θ_v, φ_v.
inline constexpr std::array k_angle_kinds{AngleKind::polar, AngleKind::azimuth, AngleKind::polar, AngleKind::azimuth};
struct AngleUnit {
    double radians;
    std::string_view name;
};
inline constexpr AngleUnit k_in_degrees{k_degree, "degrees"}, k_in_radians{1, "radians"};
/// The expectation of an error message where `number` cannot be one in that unit; empty: it can. A polar angle is within half a
/// turn on either side of the normal, an azimuth within two turns. Not a number passes, for its sample is masked.
std::string expected_angle(AngleKind kind, double number, AngleUnit unit);

/// The readers without `make_index`, which can wait until the text is freed.
Result<ScatteredSamples> read_cornell_samples(std::span<const std::byte> bytes, const std::string& file_name);
Result<ScatteredSamples> read_astm_samples(std::span<const std::byte> bytes, const std::string& file_name);
Result<ScatteredSamples> read_alta_samples(std::span<const std::byte> bytes, const std::string& file_name);
/// Rows of numbers with the names of columns, in the text or in `options`.
Result<ScatteredSamples> read_csv_samples(std::span<const std::byte> bytes, const std::string& file_name,
                                          const ReadOptions& options);
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

/// Stands for a separator that is no single character: blanks, tabs or commas.
inline constexpr char k_any_separator = 0;
/// The fields of a row; for ' ' and for `k_any_separator`, its words.
inline void split_row(std::string_view line, char separator, std::vector<std::string_view>& fields) {
    if (separator != k_any_separator && separator != ' ') return split_fields(line, fields, separator);
    const std::string_view at = separator == ' ' ? " \t" : " \t,";
    fields.clear();
    for (auto word = next_word(line, at); !word.empty() && fields.size() < k_most_fields; word = next_word(line, at))
        fields.push_back(word);
}

/// The number in a field, which may have a decimal comma.
template <typename T> std::optional<T> number_in(std::string_view field) {
    if (const auto number = to_number<T>(field)) return number;
    const auto comma = field.find(',');
    constexpr std::size_t longest = 40;
    if (comma == field.npos || field.find('.') != field.npos || field.size() > longest) return {};
    std::string text(field);
    text[comma] = '.';
    return to_number<T>(text);
}

/// A row of numbers. After its first error, which is kept, its numbers are 0.
class NumberRow {
  public:
    NumberRow(std::size_t columns, const std::string& file_name) : columns_(columns), file_name_(file_name) {}
    /// Takes the fields of a line, as `split_row` has them; an error if there are not as many as columns.
    void read(std::string_view text, std::uint64_t line, char separator = ',') {
        line_ = line;
        split_row(text, separator, fields_);
        if (separator == '\t' && fields_.size() < columns_) fields_.resize(columns_);  // the ends of lines are trimmed
        if (fields_.size() != columns_)
            fail("sample", std::to_string(columns_) + " numbers", std::to_string(fields_.size()));
    }
    /// The number in a column, which an error calls `what`, or by its position.
    template <typename T> T number(std::size_t column, std::string_view what = {}) {
        if (error_) return 0;
        const std::string_view field = fields_[column];
        if (const auto number = number_in<T>(field)) {
            has_decimal_commas_ |= field.find(',') != field.npos;
            return *number;
        }
        fail(what.empty() ? "column " + std::to_string(column + 1) : std::string(what), "a number", quoted(field));
        return 0;
    }
    /// The angle in a column [rad].
    double angle(std::size_t column, std::string_view what, AngleKind kind, AngleUnit unit) {
        const double angle = number<double>(column, what);
        if (auto expected = expected_angle(kind, angle, unit); !expected.empty())
            fail(fmt::format("column {}, {}", column + 1, what),
                 expected + (unit.radians == 1 ? " (--columns names angles in degrees)" : ""),
                 fmt::format("{:g}", angle));
        return angle * unit.radians;
    }
    /// The value in a column; an empty field is not a number.
    double value(std::size_t column) {
        return !error_ && fields_[column].empty() ? std::nan("") : number<double>(column);
    }
    bool has_decimal_commas() const { return has_decimal_commas_; }
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
    bool has_decimal_commas_ = false;
};

/// Upper bound on the rows of a text: its number of lines.
inline std::size_t lines_of(std::span<const std::byte> bytes) {
    return std::size_t(std::ranges::count(bytes, std::byte('\n'))) + 1;
}

/// True if a colour can be computed from wavelengths [nm]: at least three, from blue to red.
bool has_colours(std::span<const float> wavelengths);

/// True if the first kilobytes of `bytes` are text.
bool is_text(std::span<const std::byte> bytes);
/// Recognition of the formats by their first lines.
bool is_cornell(std::string_view text);
bool is_astm(std::string_view text);
bool is_alta(std::string_view text);
bool is_csv(std::string_view text);
/// True if one of the comments before the header of a CSV is "both sides".
bool is_csv_of_both_sides(std::string_view text);

}  // namespace srbf
