// Text for HTML: level 5.
#pragma once
#include <string>
#include <string_view>

namespace srbf {

/// `text` as HTML and SVG take it, between tags and in attributes.
inline std::string html_escaped(std::string_view text) {
    std::string escaped;
    for (const char c : text) switch (c) {
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

}  // namespace srbf
