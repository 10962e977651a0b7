// Lines, fields and numbers in text files.
#pragma once
#include <algorithm>
#include <charconv>
#include <span>
#include <vector>

#include "srbf/result.h"

SRBF_BEGIN

inline std::string_view as_text(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// `text` without surrounding blanks; the '\r' of a DOS line end counts as a blank.
inline std::string_view trimmed(std::string_view text) {
    constexpr std::string_view blank = " \t\r";
    const auto first = text.find_first_not_of(blank);
    return first == text.npos ? std::string_view() : text.substr(first, text.find_last_not_of(blank) - first + 1);
}

/// True if two words are equal except for the case of ASCII letters.
inline bool equal_ignoring_case(std::string_view a, std::string_view b) {
    const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? char(c + ('a' - 'A')) : c; };
    return std::ranges::equal(a, b, {}, lower, lower);
}

/// Iterates over the lines of a text, trimmed. Skips a byte-order mark at the beginning.
class Lines {
  public:
    explicit Lines(std::string_view text) : rest_(text) {
        if (constexpr std::string_view mark = "\xef\xbb\xbf"; rest_.starts_with(mark)) rest_.remove_prefix(mark.size());
    }
    std::optional<std::string_view> next() {
        while (!rest_.empty()) {
            const auto end = std::min(rest_.find('\n'), rest_.size());
            const std::string_view line = trimmed(rest_.substr(0, end));
            rest_.remove_prefix(std::min(end + 1, rest_.size()));
            ++number_;
            if (!line.empty()) return line;
        }
        return {};
    }
    /// Number of the last line that was returned, counted from 1.
    std::uint64_t number() const { return number_; }

  private:
    std::string_view rest_;
    std::uint64_t number_ = 0;
};

/// Removes the next word, which ends at one of `separators`, from `line` and returns it. Empty at the end of the line.
inline std::string_view next_word(std::string_view& line, std::string_view separators = " \t") {
    const auto first = std::min(line.find_first_not_of(separators), line.size());
    const auto end = std::min(line.find_first_of(separators, first), line.size());
    const std::string_view word = line.substr(first, end - first);
    line.remove_prefix(end);
    return word;
}

/// Splits a line of CSV into fields without surrounding blanks and quotes. A separator within quotes does not separate
/// fields. Fields after the first `k_max_fields`, which no table has, are ignored.
inline constexpr std::size_t k_max_fields = 1 << 16;
inline void split_fields(std::string_view line, std::vector<std::string_view>& fields, char separator = ',') {
    fields.clear();
    bool quoted = false;
    for (std::size_t end = 0, begin = 0; end <= line.size() && fields.size() < k_max_fields; ++end) {
        if (end < line.size() && line[end] == '"') quoted = !quoted;
        if (end < line.size() && (quoted || line[end] != separator)) continue;
        std::string_view field = trimmed(line.substr(begin, end - begin));
        if (field.size() >= 2 && field.front() == '"' && field.back() == '"')
            field = trimmed(field.substr(1, field.size() - 2));
        fields.push_back(field);
        begin = end + 1;
    }
}

/// Reads `text` as a number with an optional sign; "nan" and "inf" are numbers. No value if it is anything else.
template <typename T> std::optional<T> to_number(std::string_view text) {
    if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
    T number{};
    const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || rest != text.data() + text.size()) return {};
    return number;
}

/// A word in quotes, shortened for error messages.
inline std::string quoted(std::string_view text) {
    std::string shown = "'";
    shown += text.substr(0, 40);
    return shown += "'";
}

inline Error at_line(const std::string& file_name, std::uint64_t line, const std::string& what, std::string expected,
                     std::string found) {
    return {file_name, {}, "line " + std::to_string(line) + ": " + what, std::move(expected), std::move(found)};
}

SRBF_END
