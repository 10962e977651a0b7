#include "base/printable.h"

#include <fmt/format.h>

#include <array>
#include <iterator>

namespace SRBF_NAMESPACE {
namespace {

/// A character of UTF-8, or one byte that does not belong to a valid character.
struct Character {
    char32_t code;
    std::string_view bytes;
    bool is_valid;
};

/// Removes the first character of `text`. A valid character has the shortest encoding and is no surrogate.
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

/// Ranges of characters that terminals do not show as themselves: controls, format characters, noncharacters and tags.
constexpr char32_t k_unsafe[][2] = {{0, 0x1f},        {0x7f, 0x9f},     {0x61c, 0x61c},   {0x180e, 0x180e},
                                    {0x200b, 0x200b}, {0x200e, 0x200f}, {0x2028, 0x202e}, {0x2060, 0x206f},
                                    {0xfdd0, 0xfdef}, {0xfeff, 0xfeff}, {0xfff9, 0xfffb}, {0xe0000, 0xe0fff}};
bool is_safe(const Character& character) {
    const char32_t code = character.code;
    return character.is_valid && (code & 0xfffe) != 0xfffe &&  // U+FFFE, U+1FFFE, ...
           std::ranges::none_of(k_unsafe, [&](const auto& range) { return range[0] <= code && code <= range[1]; });
}

/// Replaces each character that is not safe by `replacement(character)`.
template <typename Replacement> std::string replace_unsafe(std::string_view text, const Replacement& replacement) {
    std::string result;
    result.reserve(text.size());
    while (!text.empty()) {
        const Character next = next_character(text);
        if (is_safe(next))
            result += next.bytes;
        else
            result += replacement(next);
    }
    return result;
}

/// Inserts `escape` before each of the given characters.
std::string escape_characters(const std::string& text, std::string_view characters, char escape) {
    std::string result;
    for (const char c : text) {
        if (characters.find(c) != characters.npos) result += escape;
        result += c;
    }
    return result;
}

}  // namespace

std::string printable(std::string_view text) {
    return replace_unsafe(
        text, [](const Character& c) { return c.code == '\n' || c.code == '\r' || c.code == '\t' ? ' ' : '?'; });
}
std::string printable_lines(std::string_view text) {
    return replace_unsafe(text,
                          [](const Character& c) { return c.code == '\n' || c.code == '\t' ? char(c.code) : '?'; });
}

std::string in_comment(std::string_view text) {
    std::string line = printable(text);
    std::ranges::replace(line, '\\', '/');
    for (std::size_t i = 0; (i = line.find("?\?/", i)) != line.npos; i -= i > 0) line.erase(i, 1);
    return line;
}

std::string in_string(std::string_view text) { return escape_characters(printable(text), "\"\\", '\\'); }
std::string in_template_literal(std::string_view text) {
    return escape_characters(printable_lines(text), "`$\\", '\\');
}

std::string html_escaped(std::string_view text) {
    constexpr std::string_view characters = "&<>\"'";
    constexpr std::array<std::string_view, 5> entities{"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"};
    std::string escaped;
    for (const char c : printable_lines(text)) {
        const std::size_t i = characters.find(c);
        escaped += i == characters.npos ? std::string_view(&c, 1) : entities[i];
    }
    return escaped;
}

std::string in_xml_comment(std::string_view text) {
    std::string line = html_escaped(printable(text));
    std::ranges::replace(line, '-', '_');
    return line;
}

std::string csv_field(std::string_view text) {
    std::string field = printable(text);
    if (!field.empty() && std::string_view("=+-@").find(field[0]) != std::string_view::npos) field.insert(0, 1, '\'');
    return field.find_first_of(",;\"") == field.npos ? field : '"' + escape_characters(field, "\"", '"') + '"';
}

std::string printable_json(std::string_view json) {
    return replace_unsafe(json, [](const Character& c) -> std::string {
        if (c.code == '\n' || c.code == '\t' || c.code == '\r') return std::string(c.bytes);
        if (!c.is_valid) return "\\ufffd";
        if (c.code < 0x10000) return fmt::format("\\u{:04x}", std::uint32_t(c.code));
        const std::uint32_t beyond = std::uint32_t(c.code) - 0x10000;
        return fmt::format("\\u{:04x}\\u{:04x}", 0xd800 + (beyond >> 10), 0xdc00 + (beyond & 0x3ff));
    });
}
std::string json_in_script(std::string_view json) {
    std::string text = printable_json(json);
    for (std::size_t i = 0; (i = text.find('<', i)) != text.npos;) text.replace(i, 1, "\\u003c");
    return text;
}

std::string grouped(std::uint64_t n) {
    std::string digits = std::to_string(n);
    for (int i = int(digits.size()) - 3; i > 0; i -= 3) digits.insert(std::size_t(i), 1, ',');
    return digits;
}

std::string ValueRange::text() const { return min > max ? "none" : fmt::format("{:.4g} to {:.4g}", min, max); }

}  // namespace
