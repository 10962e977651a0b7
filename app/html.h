// Templates of HTML, and bytes in HTML.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace srbf {

/// Bytes in Base64 with padding.
std::string base64(std::span<const std::byte> bytes);
/// `text` with each {{name}} replaced by its value in `parts`.
std::string filled(std::string_view text, std::span<const std::pair<std::string_view, std::string>> parts);

}  // namespace srbf
