// Text of files of scatter tables: private to their readers and writers.
#pragma once
#include <optional>
#include <string_view>

#include "measured/formats.h"
#include "measured/samples.h"
#include "srbf/optics.h"

namespace srbf {

template <typename Each> void members(ScatterTable::Slice& of, const Each& each) {
    each(of.theta_l), each(of.polar), each(of.azimuth), each(of.f);
}
template <typename Each> void members(ScatterTable& of, const Each& each) {
    each(of.about_mirror), each(of.transmission), each(of.rotation), each(of.first), each(of.slices), each(of.tint);
    each(of.masked), each(of.channels);
}

std::vector<TableLine> lines_about(const ScatterTable& table);

/// The numbers of a text, line by line or word by word, with errors that name the line. After its first error, which is
/// kept, all numbers are 0.
class ScatterText {
  public:
    /// `comments`: a '#' begins one, to the end of its line.
    ScatterText(std::string_view text, const std::string& file_name, bool comments)
        : text_(text), file_name_(file_name), comments_(comments) {}

    /// The rest of the line, trimmed.
    std::string_view raw_line();
    /// The next word, across lines; empty at the end.
    std::string_view word();
    void skip(std::size_t bytes) { at_ = std::min(at_ + bytes, text_.size()); }
    std::size_t left() const { return text_.size() - at_; }
    template <typename T> T number(std::string_view what) {
        if (error_) return 0;
        const std::string_view text = word();
        const auto number = to_number<T>(text);
        if (number) return *number;
        fail(what, "a number", text.empty() ? "the end of the file" : quoted(text));
        return 0;
    }
    /// A count between 1 and `most`.
    std::size_t count(std::string_view what, std::size_t most);
    /// Rising angles in degrees, as radians, within the limits.
    std::vector<float> angles(std::string_view what, std::size_t count, double least, double most);
    /// Numbers within the range of values, each times `scale`.
    void values(std::size_t count, std::vector<float>& to, double scale = 1);
    void fail(std::string_view what, std::string expected, std::string found);
    const std::optional<Error>& error() const { return error_; }

  private:
    std::string_view text_;
    std::size_t at_ = 0;
    std::uint64_t line_ = 1;
    const std::string& file_name_;
    bool comments_;
    std::optional<Error> error_;
};

/// Tables of reflection and transmission as a measurement: of reflection alone a BRDF.
Measured measured_of(std::array<std::optional<ScatterTable>, 2> tables, const std::string& file_name,
                     const char* format);
/// The tables of reflection and transmission of light from the front: measured ones, if they are of that kind.
std::vector<ScatterTable> scatter_tables(const TableSource& source, bool about_mirror, int threads);

/// Degrees with the digits that a float has.
std::string written_degrees(float radians);
/// The azimuth φ_l of the light at a rotation of the sample [rad].
double light_azimuth(const ScatterTable& table, double rotation);
/// Masks and counts values of 0, which were not measured unless all of a slice is 0: instruments leave gaps, never a
/// value of 0.
void mask_gaps(ScatterTable& table);

}  // namespace srbf
