#include "extras/render/drawing.h"

#include <fmt/format.h>

#include <cmath>

namespace SRBF_NAMESPACE {

std::string svg_text(double x, double y, std::string_view anchor, std::string_view content) {
    return fmt::format("<text x='{:.1f}' y='{:.1f}' text-anchor='{}'>{}</text>", x, y, anchor, content);
}

std::string svg_line(std::string_view kind, double x0, double y0, double x1, double y1) {
    return fmt::format("<path class='{}' d='M{:.1f} {:.1f}L{:.1f} {:.1f}'/>", kind, x0, y0, x1, y1);
}

std::string power_of_ten(int exponent) {
    if (exponent >= -2 && exponent <= 3) return fmt::format("{:g}", std::pow(10.0, exponent));
    return fmt::format("10<tspan dy='-4' font-size='8'>{}</tspan>", exponent);
}

}  // namespace srbf
