// Functions that readers of scattered samples share.
#pragma once
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "base/text.h"
#include "brdf/colour.h"
#include "measured/tables.h"
#include "srbf/elementary.h"
#include "srbf/measured.h"

namespace SRBF_NAMESPACE {

/// The kinds of numbers in a sample. The two numbers of a polarized one are averaged.
enum class Values { grey, rgb, xyz, spectrum, polarized };

/// Limit on the columns of a file, far above those of any measurement.
inline constexpr std::size_t k_max_columns = 4096;
inline constexpr std::size_t k_absent = k_max_columns;  ///< the position of a column that a file lacks

/// Collects the valid samples of a file.
class SampleBuilder {
  public:
    /// Prepares for a file with `bytes` bytes and at most `rows` rows. Samples and their index may take at most four
    /// times the size of the file and 32 MB, which limits their number.
    SampleBuilder(Values values, std::vector<float> wavelengths, std::size_t bytes, std::size_t rows);
    std::size_t width() const {
        return values_ == Values::grey        ? 1
               : values_ == Values::polarized ? 2
               : values_ == Values::spectrum  ? weights_.size()
                                              : 3;
    }
    /// Adds a sample with values f[width()]. It is masked if a number is not finite or a direction is below the
    /// horizon.
    void add(Vec3d wl, Vec3d wv, std::span<const float> f, float weight = 1);
    bool empty() const { return samples_.wl.empty(); }
    /// Returns the samples, without an index. Masks numbers that stand for no value (`mask_missing`), with a note.
    /// Returns an error if no samples are left, or if there were too many. `isotropic`: true if the file says so;
    /// otherwise `change_by_azimuth` decides.
    Result<ScatteredSamples> finish(const std::string& file_name, std::string description, bool isotropic = false) &&;

  private:
    Values values_;
    std::vector<Rgb> weights_;
    ScatteredSamples samples_;
    std::size_t bytes_, max_ = 0;
    bool too_many_ = false;
};

/// Masks numbers that stand for no value in a measurement, such as −999, in rows of `width` numbers: sets every number
/// of their rows to NaN. Such a number is
/// * the least of all, like −999 among numbers from −0.2 to 50.5, if it is below 0; is an integer or in several rows;
///   is ten times as far below 0 as those of other rows; and is twice as far from 0 as the median of positive numbers,
///   or an integer among fractions. If its row has a number as large above 0, it is a saturated colour instead;
/// * the largest of all, if several rows have it; it is an integer of nines or the largest of a type (9999, 65535); and
///   it is twice as large as numbers of other rows.
/// The numbers are in the unit of their file. `notes`: receives a line for each of them.
void mask_missing(std::span<float> rows, std::size_t width, std::vector<std::string>* notes = nullptr);

/// Keeps the samples whose numbers `keep` accepts, and counts the others as masked.
void keep_samples(ScatteredSamples& samples, const std::function<bool(std::size_t)>& keep);
/// Gives the samples the spectra of the BRDF that they were taken from, if it has some.
void set_spectra(ScatteredSamples& samples, const Channels& spectra);

/// Σ_k w_k colour_k / Σ_k w_k with the w_k of `ScatteredSamples`, for colours that are no f_r.
Rgb mean_of_neighbours(const ScatteredSamples& samples, Vec3f wl, Vec3f wv);

/// Converts values to f, and masks values that become too large. `unit`: factor of the values.
void to_bsdf(ScatteredSamples& samples, Quantity quantity, double unit = 1);

enum class AngleKind { polar, azimuth };
/// The kind of each of θ_l, φ_l, θ_v, φ_v.
inline constexpr std::array k_angle_kinds{AngleKind::polar, AngleKind::azimuth, AngleKind::polar, AngleKind::azimuth};
struct AngleUnit {
    double radians;
    std::string_view name;
};
inline constexpr AngleUnit k_in_degrees{k_degree, "degrees"}, k_in_radians{1, "radians"};
/// Checks an angle: a polar angle lies within 180° on either side of the normal, an azimuth within two turns; NaN
/// passes, since its sample is masked. Returns the expectation for an error message, empty for a valid angle.
std::string expected_angle(AngleKind kind, double number, AngleUnit unit);

/// The text between the lines of a header in a description.
inline constexpr std::string_view k_line_end = "; ";

// Readers without `make_index`, which can wait until the text is freed.
/// Reads a `.brdf` of Cornell's Program of Computer Graphics: the number of wavelengths, the wavelengths [nm], then for
/// each sample θ_i φ_i θ_s φ_s [rad] of the light and the viewer and the spectrum of f_r. '#' starts a comment.
Result<ScatteredSamples> read_cornell(std::span<const std::byte> bytes, const std::string& file_name);
/// Reads an ASTM E1392 file (`.astm`): lines of a key and its text. The last key is VARS, which names the columns of
/// the following rows: theta_i, phi_i, theta_s, phi_s [rad] and the values, which are R, G, B, or X, Y, Z, or one
/// column of any name.
Result<ScatteredSamples> read_astm(std::span<const std::byte> bytes, const std::string& file_name);
/// Reads ALTA's text format: `#DIM nX nY`, `#PARAM_IN` with one of sixteen parameterizations (docs/formats.md),
/// `#PARAM_OUT`, `#VS` (error bars, ignored), then rows of nX + nY numbers.
Result<ScatteredSamples> read_alta(std::span<const std::byte> bytes, const std::string& file_name);
/// Reads rows of numbers below a line that names their columns. Directions: wl_x, wl_y, wl_z, wv_x, wv_y, wv_z, or
/// theta_l, phi_l, theta_v, phi_v with the unit as the suffix _deg or _rad. Values [1/sr]: r, g, b, or x, y, z, or one
/// column `value`, or a spectrum in columns named by wavelength (450nm or nm450). Lines that begin with '#' are
/// comments; the comment `# isotropic` declares the samples isotropic. docs/formats.md lists other names, separators,
/// and assumptions about missing azimuths and units, which `notes` states. `options` may name the columns.
Result<ScatteredSamples> read_csv(std::span<const std::byte> bytes, const std::string& file_name,
                                  const ReadOptions& options);
Result<ScatteredSamples> build_index(Result<ScatteredSamples> samples);

/// Tolerance of azimuths [rad] and of components of directions, which files state with four digits or more.
inline constexpr double k_azimuth_rounding = 1e-4;

/// The separator that is any number of blanks, tabs or commas.
inline constexpr char k_any_separator = 0;
/// Splits a row into fields; for ' ' and `k_any_separator`, into words.
inline void split_row(std::string_view line, char separator, std::vector<std::string_view>& fields) {
    if (separator != k_any_separator && separator != ' ') return split_fields(line, fields, separator);
    const std::string_view separators = separator == ' ' ? " \t" : " \t,";
    fields.clear();
    for (auto word = next_word(line, separators); !word.empty() && fields.size() < k_max_fields;
         word = next_word(line, separators))
        fields.push_back(word);
}

/// Reads the number in a field, which may have a decimal comma. A spreadsheet's words for no value are NaN.
template <typename T> std::optional<T> number_in(std::string_view field) {
    if (const auto number = to_number<T>(field)) return number;
    constexpr std::string_view missing[] = {"n/a",   "na",     "n.a.", "#n/a", "#div/0!", "#value!", "#ref!",
                                            "#num!", "#null!", "null", "none", "missing", "-",       "--"};
    if (std::ranges::any_of(missing, [&](std::string_view word) { return equal_ignoring_case(field, word); }))
        return std::numeric_limits<T>::quiet_NaN();
    const auto comma = field.find(',');
    constexpr std::size_t longest = 40;
    if (comma == field.npos || field.find('.') != field.npos || field.size() > longest) return {};
    std::string text(field);
    text[comma] = '.';
    return to_number<T>(text);
}

/// Reads a row of numbers. It keeps the first error, after which numbers are 0.
class NumberRow {
  public:
    NumberRow(std::size_t columns, const std::string& file_name) : columns_(columns), file_name_(file_name) {}
    /// Splits a line into fields (`split_row`). It is an error if their number is not the number of columns.
    void read(std::string_view text, std::uint64_t line, char separator = ',') {
        line_ = line;
        split_row(text, separator, fields_);
        if (separator == '\t' && fields_.size() < columns_) fields_.resize(columns_);  // `Lines` trims empty fields
        if (fields_.size() != columns_)
            fail("sample", std::to_string(columns_) + " numbers", std::to_string(fields_.size()));
    }
    /// The number in a column. An error names it `what`, or by its position.
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
    /// The value in a column; NaN if the field is empty.
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

/// The number of lines of a text, an upper bound on its rows.
inline std::size_t lines_of(std::span<const std::byte> bytes) {
    return std::size_t(std::ranges::count(bytes, std::byte('\n'))) + 1;
}

/// True if wavelengths [nm] determine a colour: at least three, from blue to red.
bool has_colours(std::span<const float> wavelengths);

/// True if the first kilobytes of `bytes` are text.
bool is_text(std::span<const std::byte> bytes);
/// Text in UTF-16 with a byte-order mark, or with lines ended by CR alone, as UTF-8 with lines ended by LF. No value
/// for any other bytes.
std::optional<std::string> plain_text(std::span<const std::byte> bytes);

/// θ_l, φ_l, θ_v, φ_v [rad], wavelength [nm], f [1/sr], weight. f is NaN where nothing was measured.
using SpectralRow = std::array<float, 7>;
inline constexpr std::size_t k_wavelength_column = 4, k_value_column = 5, k_weight_column = 6;

/// Groups rows into pairs of directions with their spectra. Rows that differ only in the value, such as
/// polarizations, are averaged. Pairs that lack a wavelength are masked. Sorts `rows`. Returns an error if wavelengths
/// are out of range, or if there are no samples.
Result<ScatteredSamples> samples_of_rows(std::vector<SpectralRow>& rows, std::size_t bytes,
                                         const std::string& file_name, std::string description, bool isotropic = false);

}  // namespace
