// Text of files for people.
#pragma once
#include <string>

namespace [[gnu::visibility("default")]] srbf {

/// `text` with a question mark for each control character, so that what a file says is a line that no terminal obeys.
inline std::string printable(std::string text) {
    const auto code = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    for (std::size_t i = 0; i < text.size(); ++i)
        if (code(i) < 0x20 || code(i) == 0x7f) text[i] = '?';
    for (std::size_t i = 0; i + 1 < text.size(); ++i)  // U+0080 to U+009F in UTF-8
        if (code(i) == 0xc2 && code(i + 1) >= 0x80 && code(i + 1) < 0xa0) text.replace(i, 2, "?");
    return text;
}

}  // namespace srbf
