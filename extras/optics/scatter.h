// Text of files of scatter tables: private to their readers and writers.
#pragma once
#include <optional>
#include <string_view>

#include "measured/samples.h"
#include "srbf/measured.h"

namespace srbf {

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

/// Degrees with the digits that a float has.
std::string written_degrees(float radians);
/// The azimuth φ_l of the light at a rotation of the sample [rad].
double light_azimuth(const ScatterTable& table, double rotation);
/// Masks and counts values of 0, which were not measured unless all of a slice is 0: instruments leave gaps, never a
/// value of 0.
void mask_gaps(ScatterTable& table);

}  // namespace srbf
