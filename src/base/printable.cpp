#include "base/printable.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>

namespace srbf {
namespace {

/// A character and its bytes; of no valid character one byte.
struct Character {
    char32_t code;
    std::string_view bytes;
    bool is_valid;
};

/// Removes the first character. A character has the shortest form, and is no surrogate.
Character next_character(std::string_view& text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const std::size_t length = byte(0) < 0x80 ? 1 : byte(0) < 0xe0 ? 2 : byte(0) < 0xf0 ? 3 : 4;
    constexpr std::array<char32_t, 5> least{0, 0, 0x80, 0x800, 0x10000};
    bool is_valid = byte(0) < 0x80 || (byte(0) >= 0xc2 && byte(0) < 0xf5 && length <= text.size());
    char32_t code = length == 1 ? byte(0) : byte(0) & (0xffu >> (length + 1));
    for (std::size_t i = 1; is_valid && i < length; ++i) {
        is_valid = (byte(i) & 0xc0) == 0x80;
        code = code << 6 | (byte(i) & 0x3fu);
    }
    is_valid = is_valid && code >= least[length] && code <= 0x10ffff && !(code >= 0xd800 && code < 0xe000);
    const std::string_view bytes = text.substr(0, is_valid ? length : 1);
    text.remove_prefix(bytes.size());
    return {code, bytes, is_valid};
}

/// Ranges of characters that are not shown as themselves.
constexpr std::array<std::array<char32_t, 2>, 12> k_unshown{{{0, 0x1f},
                                                             {0x7f, 0x9f},
                                                             {0x61c, 0x61c},
                                                             {0x180e, 0x180e},
                                                             {0x200b, 0x200b},
                                                             {0x200e, 0x200f},
                                                             {0x2028, 0x202e},
                                                             {0x2060, 0x206f},
                                                             {0xfdd0, 0xfdef},
                                                             {0xfeff, 0xfeff},
                                                             {0xfff9, 0xfffb},
                                                             {0xe0000, 0xe0fff}}};
bool is_shown(const Character& of) {
    return of.is_valid && (of.code & 0xfffe) != 0xfffe &&  // U+FFFE, U+1FFFE, ..
           std::ranges::none_of(k_unshown, [&](auto range) { return range[0] <= of.code && of.code <= range[1]; });
}

/// `text` with `other(character)` for what is not shown as itself.
template <typename Other> std::string replaced(std::string_view text, const Other& other) {
    std::string made;
    made.reserve(text.size());
    while (!text.empty()) {
        const Character next = next_character(text);
        if (is_shown(next))
            made += next.bytes;
        else
            made += other(next);
    }
    return made;
}

/// `text` with `mark` before each of those characters.
std::string marked(const std::string& text, std::string_view characters, char mark) {
    std::string made;
    for (const char c : text) {
        if (characters.find(c) != characters.npos) made += mark;
        made += c;
    }
    return made;
}

}  // namespace

std::string printable(std::string_view text) {
    return replaced(
        text, [](const Character& of) { return of.code == '\n' || of.code == '\r' || of.code == '\t' ? ' ' : '?'; });
}
std::string printable_lines(std::string_view text) {
    return replaced(text, [](const Character& of) { return of.code == '\n' || of.code == '\t' ? char(of.code) : '?'; });
}

std::string in_comment(std::string_view text) {
    std::string line = printable(text);
    std::ranges::replace(line, '\\', '/');
    for (std::size_t at = 0; (at = line.find("?\?/", at)) != line.npos; at -= at > 0) line.erase(at, 1);
    return line;
}

std::string in_string(std::string_view text) { return marked(printable(text), "\"\\", '\\'); }
std::string in_template_literal(std::string_view text) { return marked(printable_lines(text), "`$\\", '\\'); }

std::string html_escaped(std::string_view text) {
    std::string escaped;
    for (const char c : printable_lines(text)) switch (c) {
            case '&':
                escaped += "&amp;";
                break;
            case '<':
                escaped += "&lt;";
                break;
            case '>':
                escaped += "&gt;";
                break;
            case '"':
                escaped += "&quot;";
                break;
            case '\'':
                escaped += "&#39;";
                break;
            default:
                escaped += c;
        }
    return escaped;
}

std::string in_xml_comment(std::string_view text) {
    std::string line = html_escaped(printable(text));
    std::ranges::replace(line, '-', '_');
    return line;
}

std::string in_markdown(std::string_view text) { return marked(html_escaped(printable(text)), "\\`*_[]|~", '\\'); }

std::string csv_field(std::string_view text) {
    std::string field = printable(text);
    if (!field.empty() && std::string_view("=+-@").find(field[0]) != std::string_view::npos) field.insert(0, 1, '\'');
    return field.find_first_of(",;\"") == field.npos ? field : '"' + marked(field, "\"", '"') + '"';
}

std::string printable_json(std::string_view json) {
    return replaced(json, [](const Character& of) -> std::string {
        if (of.code == '\n' || of.code == '\t' || of.code == '\r') return std::string(of.bytes);
        if (!of.is_valid) return "\\ufffd";
        if (of.code < 0x10000) return fmt::format("\\u{:04x}", std::uint32_t(of.code));
        const std::uint32_t beyond = std::uint32_t(of.code) - 0x10000;
        return fmt::format("\\u{:04x}\\u{:04x}", 0xd800 + (beyond >> 10), 0xdc00 + (beyond & 0x3ff));
    });
}
std::string json_in_script(std::string_view json) {
    std::string text = printable_json(json);
    for (std::size_t at = 0; (at = text.find('<', at)) != text.npos;) text.replace(at, 1, "\\u003c");
    return text;
}

std::string grouped(std::uint64_t n) {
    std::string digits = std::to_string(n);
    for (int at = int(digits.size()) - 3; at > 0; at -= 3) digits.insert(std::size_t(at), 1, ',');
    return digits;
}

std::string ValueRange::text() const { return least > most ? "none" : fmt::format("{:.4g} to {:.4g}", least, most); }

}  // namespace srbf
