// Elements of plots, as SVG.
#pragma once
#include <string>
#include <string_view>

namespace SRBF_NAMESPACE {

/// A line of text at (x, y). `anchor` is start, middle or end; `content` is already SVG.
std::string svg_text(double x, double y, std::string_view anchor, std::string_view content);
/// A straight line with a CSS class.
std::string svg_line(std::string_view kind, double x0, double y0, double x1, double y1);
/// 10^exponent as a label: "0.01" to "1000", beyond these "10" with a superscript.
std::string power_of_ten(int exponent);

}  // namespace srbf
