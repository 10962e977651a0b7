// Makes text of unknown origin, such as names and contents of files, safe for terminals and within languages.
#pragma once
#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "srbf/version.h"

SRBF_BEGIN

/// `text` as one line without control sequences. Tabs and line ends become blanks. A question mark replaces each byte
/// that is not UTF-8, control (C0, DEL, C1), U+2028, U+2029, direction of writing (such as U+202E), noncharacter, and
/// character without width except joiners.
std::string printable(std::string_view text);
/// Like `printable`, but keeps tabs and line feeds.
std::string printable_lines(std::string_view text);

/// `text` for a comment up to the end of the line, in Python, USD and languages with C's comments. Backslashes, which
/// could continue the line, also as trigraphs, become slashes.
std::string in_comment(std::string_view text);
/// `text` for a string between double quotes, or three of them, in C, JavaScript, Python and USD.
std::string in_string(std::string_view text);
/// `text` for a template literal of JavaScript. Keeps line ends.
std::string in_template_literal(std::string_view text);
/// `text` for text and attributes in HTML, SVG and XML. Keeps line ends.
std::string html_escaped(std::string_view text);
/// `text` for a comment of XML: hyphens, of which two would end it, become underscores.
std::string in_xml_comment(std::string_view text);
/// A field of CSV, in quotes if necessary. An apostrophe precedes text that spreadsheets would evaluate as a formula.
std::string csv_field(std::string_view text);
/// JSON of the same value, in which the characters that `printable` replaces are escaped.
std::string printable_json(std::string_view json);
/// `printable_json` for a script in HTML: also escapes "<", which could end the script.
std::string json_in_script(std::string_view json);

/// A number with separators of thousands: "1,234,567".
std::string grouped(std::uint64_t n);

/// The smallest and the largest of numbers; NaNs are ignored.
struct ValueRange {
    float min = std::numeric_limits<float>::infinity(), max = -min;
    void add(float x) {
        if (x != x) return;
        min = std::min(min, x);
        max = std::max(max, x);
    }
    /// "0.1 to 23", with four digits; "none" if there are no numbers.
    std::string text() const;
};

SRBF_END
