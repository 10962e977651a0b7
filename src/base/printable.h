// Text of unknown origin, such as names of files and what files say, for people and within languages. A function for each
// place where such text goes.
#pragma once
#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

namespace [[gnu::visibility("default")]] srbf {

/// `text` as one line that no terminal obeys: a blank for each tab and end of a line, and a question mark for each byte
/// that is not UTF-8 and for each character that is not shown as itself: controls (C0, DEL, C1), U+2028 and U+2029,
/// directions of writing (as U+202E), characters without width but joiners, noncharacters.
std::string printable(std::string_view text);
/// `printable` that keeps tabs and line feeds.
std::string printable_lines(std::string_view text);

/// In a comment to the end of the line, of Python, USD and languages with those of C: a slash for each backslash, which
/// with its trigraph would continue the line.
std::string in_comment(std::string_view text);
/// Between double quotes, or between three of them, in C, JavaScript, Python and USD.
std::string in_string(std::string_view text);
/// In a template literal of JavaScript, whose lines it keeps.
std::string in_template_literal(std::string_view text);
/// In HTML, SVG and XML, between tags and in attributes. Keeps lines.
std::string html_escaped(std::string_view text);
/// In a comment of XML, which two hyphens would end.
std::string in_xml_comment(std::string_view text);
/// In a paragraph or a table of Markdown, without mark-up.
std::string in_markdown(std::string_view text);
/// A field of CSV, in quotes where it needs them. What spreadsheets would take for a formula begins with an apostrophe.
std::string csv_field(std::string_view text);
/// JSON of the same value, which terminals do not obey: what `printable` replaces is escaped.
std::string printable_json(std::string_view json);
/// `printable_json` within a script of HTML, which it does not end.
std::string json_in_script(std::string_view json);

/// "1,234,567".
std::string grouped(std::uint64_t n);

/// The least and the largest of numbers, without those that are not a number.
struct ValueRange {
    float least = std::numeric_limits<float>::infinity(), most = -least;
    void add(float x) {
        if (x != x) return;
        least = std::min(least, x);
        most = std::max(most, x);
    }
    /// "0.1 to 23", with four digits; "none" without a number.
    std::string text() const;
};

}  // namespace srbf
