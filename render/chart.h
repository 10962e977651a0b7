// Errors over numbers of lobes or bytes, as plots: level 6.
#pragma once
#include <string>
#include <vector>

namespace srbf {

struct ChartSeries {
    std::string name;
    std::string colour;     ///< of CSS
    std::string dash;       ///< of CSS, "4 3"; empty: a whole line
    bool is_joined = true;  ///< by a line, in the order of x
    struct Point {
        double x, y;        ///< both above 0 and finite, or left out
        std::string title;  ///< what the point says when it is pointed at
    };
    std::vector<Point> points;
};

struct Chart {
    std::string title, x_title;
    std::vector<double> x_ticks;  ///< what is named along the axis; empty: powers of ten
    std::vector<ChartSeries> series;
};

/// A drawing (SVG) of the series, both axes logarithmic; y is a ratio, and named in per cent.
std::string chart_drawing(const Chart& chart);

}  // namespace srbf
