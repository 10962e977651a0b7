// Escaping and templates for HTML.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace srbf {

/// Escapes `text` for HTML and SVG, between tags and in attributes.
std::string html_escaped(std::string_view text);
/// Base64 with padding.
std::string base64(std::span<const std::byte> bytes);
/// `text` with each {{name}} replaced by its value.
std::string filled(std::string_view text, std::span<const std::pair<std::string_view, std::string>> parts);

}  // namespace srbf
