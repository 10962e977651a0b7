#include "app/html.h"

#include <algorithm>
#include <cassert>

namespace srbf {

std::string base64(std::span<const std::byte> bytes) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        unsigned bits = 0;
        for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (i + k < bytes.size() ? unsigned(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : digits[bits >> (18 - 6 * k) & 63];
    }
    return text;
}

std::string filled(std::string_view text, std::span<const std::pair<std::string_view, std::string>> parts) {
    std::string html;
    while (true) {
        const auto begin = text.find("{{"), end = text.find("}}", begin);
        html += text.substr(0, begin);
        if (end == text.npos) return html;
        const auto part =
            std::ranges::find(parts, text.substr(begin + 2, end - begin - 2), [](const auto& p) { return p.first; });
        assert(part != parts.end());
        html += part->second;
        text.remove_prefix(end + 2);
    }
}

}  // namespace srbf
