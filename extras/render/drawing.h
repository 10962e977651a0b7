// Elements of plots, as SVG.
#pragma once
#include <fmt/format.h>

#include <cmath>
#include <string>
#include <string_view>

namespace SRBF_NAMESPACE {

/// A line of text at (x, y). `anchor` is start, middle or end; `content` is already SVG.
inline std::string svg_text(double x, double y, std::string_view anchor, std::string_view content) {
    return fmt::format("<text x='{:.1f}' y='{:.1f}' text-anchor='{}'>{}</text>", x, y, anchor, content);
}
/// A straight line with a CSS class.
inline std::string svg_line(std::string_view kind, double x0, double y0, double x1, double y1) {
    return fmt::format("<path class='{}' d='M{:.1f} {:.1f}L{:.1f} {:.1f}'/>", kind, x0, y0, x1, y1);
}
/// 10^exponent as a label: "0.01" to "1000", beyond these "10" with a superscript.
inline std::string power_of_ten(int exponent) {
    if (exponent >= -2 && exponent <= 3) return fmt::format("{:g}", std::pow(10.0, exponent));
    return fmt::format("10<tspan dy='-4' font-size='8'>{}</tspan>", exponent);
}

}  // namespace
