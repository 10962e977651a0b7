#include "extras/render/chart.h"

#include "base/printable.h"
#include "extras/render/drawing.h"

namespace SRBF_NAMESPACE {
namespace {

/// The frame of the plot within the drawing.
constexpr double k_width = 440, k_height = 300, k_left = 52, k_right = 416, k_top = 30, k_bottom = 258;

bool is_shown(const ChartSeries::Point& point) {
    return point.x > 0 && point.y > 0 && std::isfinite(point.x) && std::isfinite(point.y);
}

struct Range {
    double min = std::numeric_limits<double>::infinity(), max = 0;
    void add(double value) {
        min = std::min(min, value);
        max = std::max(max, value);
    }
    double position(double value) const { return std::log(value / min) / std::log(max / min); }
};

}  // namespace

std::string chart_drawing(const Chart& chart) {
    Range x, y;
    for (const ChartSeries& series : chart.series)
        for (const auto& point : series.points)
            if (is_shown(point)) {
                x.add(point.x);
                y.add(point.y);
            }
    for (const double tick : chart.x_ticks) x.add(tick);
    if (y.max == 0) {
        x.add(1);
        y.add(1);
    }
    // The axis of errors has whole decades, the axis of x some space at both ends.
    const int lowest = int(std::floor(std::log10(y.min))),
              highest = std::max(int(std::ceil(std::log10(y.max))), lowest + 1);
    y = {std::pow(10.0, lowest), std::pow(10.0, highest)};
    const double space = std::max(std::pow(x.max / x.min, 0.04), 1.05);
    x.add(x.min / space);
    x.add(x.max * space);
    const auto x_of = [&](double value) { return k_left + x.position(value) * (k_right - k_left); };
    const auto y_of = [&](double value) { return k_bottom - y.position(value) * (k_bottom - k_top); };

    std::string svg = fmt::format("<svg class='slice chart' viewBox='0 0 {} {}' role='img' aria-label='{}'>", k_width,
                                  k_height, html_escaped(chart.title));
    svg += svg_text(4, 14, "start", fmt::format("<tspan font-weight='bold'>{}</tspan>", html_escaped(chart.title)));
    for (int exponent = lowest; exponent <= highest; ++exponent) {
        const double tick_y = y_of(std::pow(10.0, exponent));
        svg += svg_line("grid", k_left, tick_y, k_right, tick_y) +
               svg_text(k_left - 5, tick_y + 4, "end", fmt::format("{:g} %", std::pow(10.0, exponent + 2)));
    }
    std::vector<double> ticks = chart.x_ticks;
    if (ticks.empty())
        for (int exponent = int(std::ceil(std::log10(x.min))); std::pow(10.0, exponent) <= x.max; ++exponent)
            ticks.push_back(std::pow(10.0, exponent));
    for (const double tick : ticks)
        svg += svg_line("grid", x_of(tick), k_top, x_of(tick), k_bottom + 4) +
               svg_text(x_of(tick), k_bottom + 17, "middle", fmt::format("{:.0f}", tick));
    svg += svg_line("axis", k_left, k_bottom, k_right, k_bottom) + svg_line("axis", k_left, k_top, k_left, k_bottom);
    svg += svg_text((k_left + k_right) / 2, k_height - 6, "middle", html_escaped(chart.x_title));
    for (const ChartSeries& series : chart.series) {
        std::vector<ChartSeries::Point> points;
        std::ranges::copy_if(series.points, std::back_inserter(points), is_shown);
        std::ranges::stable_sort(points, {}, &ChartSeries::Point::x);
        std::string path;
        for (const auto& point : points)
            path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? 'M' : 'L', x_of(point.x), y_of(point.y));
        if (points.size() > 1)
            svg +=
                fmt::format("<path class='curve' style='stroke:{}' stroke-width='1.5' stroke-dasharray='{}' d='{}'/>",
                            series.colour, series.dash.empty() ? "none" : series.dash, path);
        for (const auto& point : points)
            svg += fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='3.2' style='fill:{}'><title>{}</title></circle>",
                               x_of(point.x), y_of(point.y), series.colour, html_escaped(point.title));
    }
    return svg + "</svg>\n";
}

}  // namespace
