// Text for HTML: level 5.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace srbf {

/// `text` as HTML and SVG take it, between tags and in attributes.
std::string html_escaped(std::string_view text);
/// Bytes as a page holds them: base64, padded.
std::string base64(std::span<const std::byte> bytes);
/// `text` with each {{name}} replaced by what stands beside the name.
std::string filled(std::string_view text, std::span<const std::pair<std::string_view, std::string>> parts);

}  // namespace srbf
