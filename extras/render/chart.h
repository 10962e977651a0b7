// Plots of errors over numbers of lobes or bytes.
#pragma once
#include <string>
#include <vector>

namespace SRBF_NAMESPACE {

struct ChartSeries {
    std::string name;
    std::string colour;  ///< CSS colour
    std::string dash;    ///< CSS dash pattern, "4 3"; empty: solid
    struct Point {
        double x, y;        ///< skipped unless both are positive and finite
        std::string title;  ///< tooltip of the point
    };
    std::vector<Point> points;
};

struct Chart {
    std::string title, x_title;
    std::vector<double> x_ticks;  ///< labels along the axis; empty: powers of ten
    std::vector<ChartSeries> series;
};

/// A drawing (SVG) of the series with two logarithmic axes. y is a ratio, labelled in per cent.
std::string chart_drawing(const Chart& chart);

}  // namespace
