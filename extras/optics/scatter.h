// Parsing files of scatter tables. Private to their readers and writers.
#pragma once
#include "measured/formats.h"
#include "measured/samples.h"
#include "measured/tables.h"
#include "srbf/optics.h"

namespace SRBF_NAMESPACE {

template <typename Each> void members(ScatterTable::Slice& value, const Each& each) {
    each(value.theta_l);
    each(value.polar);
    each(value.azimuth);
    each(value.f);
}
template <typename Each> void members(ScatterTable& value, const Each& each) {
    each(value.about_mirror);
    each(value.transmission);
    each(value.rotation);
    each(value.first);
    each(value.slices);
    each(value.tint);
    each(value.masked);
    each(value.channels);
}

std::vector<TableLine> lines_about(const ScatterTable& table);

/// Reads the numbers of a text, line by line or word by word. Errors state the line. The first error is kept, and
/// after it all numbers are 0.
class ScatterText {
  public:
    /// `comments`: '#' begins a comment, to the end of its line.
    ScatterText(std::string_view text, const std::string& file_name, bool comments)
        : text_(text), file_name_(file_name), comments_(comments) {}

    /// The remainder of the line, trimmed.
    std::string_view raw_line();
    /// The next word, on this line or a later one; empty at the end.
    std::string_view word();
    void skip(std::size_t bytes) { offset_ = std::min(offset_ + bytes, text_.size()); }
    std::size_t left() const { return text_.size() - offset_; }
    template <typename T> T number(std::string_view what) {
        if (error_) return 0;
        const std::string_view text = word();
        const auto number = to_number<T>(text);
        if (number) return *number;
        fail(what, "a number", text.empty() ? "the end of the file" : quoted(text));
        return 0;
    }
    /// A count between 1 and `max_count`.
    std::size_t count(std::string_view what, std::size_t max_count);
    /// Rising angles in degrees within [lower, upper], converted to radians.
    std::vector<float> angles(std::string_view what, std::size_t count, double lower, double upper);
    /// Appends numbers within the range of values to `target`, each multiplied by `scale`.
    void values(std::size_t count, std::vector<float>& target, double scale = 1);
    void fail(std::string_view what, std::string expected, std::string found);
    const std::optional<Error>& error() const { return error_; }

  private:
    std::string_view text_;
    std::size_t offset_ = 0;
    std::uint64_t line_ = 1;
    const std::string& file_name_;
    bool comments_;
    std::optional<Error> error_;
};

/// Makes a measurement from tables of reflection and transmission. Reflection by itself is a BRDF.
Measured measured_of(std::array<std::optional<ScatterTable>, 2> tables, const std::string& file_name,
                     const char* format);
/// The tables of reflection and transmission for light from the front. Measured tables of the requested kind are
/// returned unchanged.
std::vector<ScatterTable> scatter_tables(const TableSource& source, bool about_mirror, int threads);

/// Degrees with the precision of a float.
std::string written_degrees(float radians);
/// The azimuth φ_l [rad] of the light at a rotation of the sample [rad].
double light_azimuth(const ScatterTable& table, double rotation);
/// Masks and counts values of 0, unless a whole slice is 0. Instruments leave gaps as 0, but never measure a value
/// of 0.
void mask_gaps(ScatterTable& table);

}  // namespace
