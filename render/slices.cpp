#include "render/slices.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "render/html.h"

namespace srbf {
namespace {

/// The plot's frame within the drawing.
constexpr double k_width = 360, k_height = 250, k_left = 40, k_right = 344, k_top = 36, k_bottom = 210;

std::vector<double> angles_of(double mirror) {
    std::vector<double> degrees;
    for (double at = -89; at <= 89; at += 0.5) degrees.push_back(at);
    for (int i = -40; i <= 40; ++i) degrees.push_back(std::clamp(mirror + 0.1 * i, -89.0, 89.0));
    std::ranges::sort(degrees);
    return degrees;
}

std::vector<double> luminances(const Evaluate& brdf, double theta_l, std::span<const double> degrees) {
    const std::vector<Vec3f> wl(degrees.size(), {float(std::sin(theta_l)), 0, float(std::cos(theta_l))});
    std::vector<Vec3f> wv;
    for (const double at : degrees) wv.push_back({float(-std::sin(at * k_degree)), 0, float(std::cos(at * k_degree))});
    std::vector<Rgb> f(wv.size());
    brdf(wl, wv, f);
    std::vector<double> y;
    for (const Rgb& value : f) y.push_back(luminance(value));
    return y;
}

std::string text(double x, double y, std::string_view anchor, std::string_view content) {
    return fmt::format("<text x='{:.1f}' y='{:.1f}' text-anchor='{}'>{}</text>", x, y, anchor, content);
}
std::string line(std::string_view kind, double x0, double y0, double x1, double y1) {
    return fmt::format("<path class='{}' d='M{:.1f} {:.1f}L{:.1f} {:.1f}'/>", kind, x0, y0, x1, y1);
}
std::string power_of_ten(int exponent) {
    if (exponent >= -2 && exponent <= 3) return fmt::format("{:g}", std::pow(10.0, exponent));
    return fmt::format("10<tspan dy='-4' font-size='8'>{}</tspan>", exponent);
}

}  // namespace

std::string slice_drawing(std::span<const SliceCurve> curves, double theta_l) {
    const double light = theta_l / k_degree;
    const std::vector<double> degrees = angles_of(light);
    std::vector<std::vector<double>> values;
    double most = 0, least = std::numeric_limits<double>::infinity();
    for (const SliceCurve& curve : curves) {
        values.push_back(luminances(curve.brdf, theta_l, degrees));
        for (const double y : values.back())
            if (y > 0 && std::isfinite(y)) most = std::max(most, y), least = std::min(least, y);
    }
    if (most == 0) most = least = 1;
    const int highest = std::max(int(std::ceil(std::log10(most))), int(std::floor(std::log10(least))) + 1);
    const int lowest = std::max(int(std::floor(std::log10(least))), highest - k_slice_decades);
    const auto x_of = [&](double at) { return k_left + (at + 90) / 180 * (k_right - k_left); };
    const auto y_of = [&](double y) {
        const double decades = std::clamp(std::log10(y) - lowest, 0.0, double(highest - lowest));
        return k_bottom - decades / (highest - lowest) * (k_bottom - k_top);
    };

    std::string svg = fmt::format(
        "<svg class='slice' viewBox='0 0 {} {}' role='img' aria-label='Reflectance for light at {:g}° from the "
        "normal'>",
        k_width, k_height, light);
    svg += text(k_left, 14, "start", fmt::format("<tspan font-weight='bold'>light at {:g}°</tspan>", light));
    for (int exponent = lowest; exponent <= highest; ++exponent) {
        const double y = y_of(std::pow(10.0, exponent));
        svg += line("grid", k_left, y, k_right, y) + text(k_left - 5, y + 4, "end", power_of_ten(exponent));
    }
    for (int at = -90; at <= 90; at += 30)
        svg += line("grid", x_of(at), k_bottom, x_of(at), k_bottom + 4) +
               text(x_of(at), k_bottom + 16, "middle", fmt::format("{}°", std::abs(at)));
    svg += line("axis", x_of(0), k_top, x_of(0), k_bottom);
    if (light > 0) {
        svg += line("mark", x_of(light), k_top, x_of(light), k_bottom) +
               line("mark", x_of(-light), k_top, x_of(-light), k_bottom);
        svg += text(x_of(-light), k_top - 4, "middle", "light") + text(x_of(light), k_top - 4, "middle", "mirror");
    }
    svg += text((k_left + k_right) / 2, k_height - 8, "middle", "seen from this angle; light comes from the left");
    for (std::size_t c = 0; c < curves.size(); ++c) {
        std::string path;
        bool is_drawing = false;
        for (std::size_t i = 0; i < degrees.size(); ++i) {
            const double y = values[c][i];
            if (!std::isnan(y))
                path +=
                    fmt::format("{}{:.1f} {:.1f}", is_drawing ? 'L' : 'M', x_of(degrees[i]), y_of(std::max(y, 1e-300)));
            is_drawing = !std::isnan(y);
        }
        svg += fmt::format("<path class='curve' stroke='{}' stroke-width='{}' d='{}'><title>{}</title></path>",
                           curves[c].colour, c == 0 ? 3 : 1.5, path, html_escaped(curves[c].name));
    }
    return svg + "</svg>\n";
}

}  // namespace srbf
