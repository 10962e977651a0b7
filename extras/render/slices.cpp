#include "extras/render/slices.h"

#include <cstdlib>

#include "base/printable.h"
#include "brdf/directions.h"
#include "extras/render/drawing.h"

namespace SRBF_NAMESPACE {
namespace {

constexpr int k_tick = 30;  // degrees
/// The frame of the plot within the drawing.
constexpr double k_width = 360, k_height = 250, k_left = 40, k_right = 344, k_top = 36, k_bottom = 210;

/// Adds the angles of one side around its normal at `normal` [degrees], with the mirror direction, or the straight
/// direction of transmission, at `peak`.
void add_angles(std::vector<double>& degrees, double normal, double peak) {
    const auto first = std::ptrdiff_t(degrees.size());
    for (double angle = -89; angle <= 89; angle += 0.5) degrees.push_back(normal + angle);
    for (int i = -40; i <= 40; ++i) degrees.push_back(std::clamp(peak + 0.1 * i, normal - 89.0, normal + 89.0));
    std::sort(degrees.begin() + first, degrees.end());
}

/// The points of a curve as a path. It is interrupted where `y` is not finite, and omits points that nearly
/// coincide with the previous one.
struct Outline {
    std::string path;
    double x = 0, y = 0;
    bool is_drawing = false;
    void add(double to_x, double to_y, double min_step) {
        if (!std::isfinite(to_y)) {
            is_drawing = false;
            return;
        }
        if (is_drawing && std::hypot(to_x - x, to_y - y) < min_step) return;
        path += fmt::format("{}{:.1f} {:.1f}", is_drawing ? 'L' : 'M', to_x, to_y);
        x = to_x;
        y = to_y;
        is_drawing = true;
    }
};
std::string curve_path(const SliceCurve& curve, const Outline& outline, bool is_first) {
    return fmt::format("<path class='curve' style='stroke:{}' stroke-width='{}' d='{}'><title>{}</title></path>",
                       curve.colour, is_first ? 3 : 1.5, outline.path, html_escaped(curve.name));
}

/// x with two significant digits: "0.52", "1100".
std::string two_digits(double x) { return fmt::format("{:g}", std::strtod(fmt::format("{:.2g}", x).c_str(), nullptr)); }

/// The powers of ten around positive values, at most `decades` of them.
struct Decades {
    int lowest = -1, highest = 0;
    Decades(double min, double max, int decades) {
        if (!(max > 0)) return;
        highest = std::max(int(std::ceil(std::log10(max))), int(std::floor(std::log10(min))) + 1);
        lowest = std::max(int(std::floor(std::log10(min))), highest - decades);
    }
    /// The position on the scale: 0 at the lowest power, 1 at the highest; NaN is kept.
    double position(double value) const {
        return std::isnan(value) ? value : (std::log10(std::max(value, 1e-300)) - lowest) / (highest - lowest);
    }
};

/// A plot of values over degrees, on a scale of decades.
struct DecadePlot {
    Decades decades;
    double left, right;  ///< [degrees]

    double x_of(double degrees) const { return k_left + (degrees - left) / (right - left) * (k_right - k_left); }
    double y_of(double value) const {
        const double position = decades.position(value);
        return std::isnan(position) ? position : k_bottom - std::clamp(position, 0.0, 1.0) * (k_bottom - k_top);
    }
    /// The opening of the drawing, its heading, and a line for each power of ten.
    std::string begin(const std::string& label, const std::string& heading) const {
        std::string svg =
            fmt::format("<svg class='slice' viewBox='0 0 {} {}' role='img' aria-label='{}'>", k_width, k_height, label);
        svg += svg_text(k_left, 14, "start", fmt::format("<tspan font-weight='bold'>{}</tspan>", heading));
        for (int exponent = decades.lowest; exponent <= decades.highest; ++exponent) {
            const double y = y_of(std::pow(10.0, exponent));
            svg += svg_line("grid", k_left, y, k_right, y) + svg_text(k_left - 5, y + 4, "end", power_of_ten(exponent));
        }
        return svg;
    }
    std::string tick(double degrees, const std::string& name) const {
        return svg_line("grid", x_of(degrees), k_bottom, x_of(degrees), k_bottom + 4) +
               svg_text(x_of(degrees), k_bottom + 16, "middle", name);
    }
    std::string caption(const std::string& text) const {
        return svg_text((k_left + k_right) / 2, k_height - 8, "middle", text);
    }
    /// The curve of a slice, whose angles are the plot's angles plus `shift`.
    std::string curve_path(const SliceCurve& curve, const LuminanceSlice& slice, double shift, bool is_first) const {
        Outline outline;
        for (std::size_t i = 0; i < slice.degrees.size(); ++i)
            outline.add(x_of(slice.degrees[i] - shift), y_of(slice.luminance[i]), 0);
        return srbf::curve_path(curve, outline, is_first);
    }
};

/// The drawing of lobes in polar coordinates: the radius is a value, and the angle is the viewer's.
struct LobePlot {
    static constexpr double radius = 140, x0 = 180, outside = 1.04;
    bool is_circle, is_linear;                // front and back; not logarithmic
    double max = 0, lowest = 0, highest = 0;  // the largest value, and logarithms at the centre and the outermost ring

    LobePlot(const LuminanceSlice& slice, bool both_sides, LobeScale scale)
        : is_circle(both_sides), is_linear(scale == LobeScale::linear) {
        constexpr double counted_theta = 85;
        double min = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < slice.degrees.size(); ++i)
            if (const double y = slice.luminance[i];
                std::abs(std::cos(slice.degrees[i] * k_degree)) >= std::cos(counted_theta * k_degree) && y > 0) {
                max = std::max(max, y);
                min = std::min(min, y);
            }
        if (max == 0) max = min = 1;
        highest = std::log10(max);
        // With front and back, the smallest value is still a visible lobe.
        lowest = std::max(std::min(std::log10(min), highest - 1) - (is_circle ? 1 : 0), highest - k_lobe_decades);
    }
    double y0() const { return is_circle ? 186 : 190; }
    double height() const { return is_circle ? 366 : 218; }
    double r_of(double y) const {
        const double position = is_linear ? y / max : (std::log10(std::max(y, 1e-300)) - lowest) / (highest - lowest);
        return radius * std::max(position, 0.0);
    }
    double x_of(double r, double degrees) const { return x0 + r * std::sin(degrees * k_degree); }
    double y_of(double r, double degrees) const { return y0() - r * std::cos(degrees * k_degree); }

    std::string ring(double r) const {
        const auto arc = [&](int sweep) {
            return fmt::format("<path class='grid' fill='none' d='M{:.1f} {}A{:.1f} {:.1f} 0 0 {} {:.1f} {}'/>", x0 - r,
                               y0(), r, r, sweep, x0 + r, y0());
        };
        return is_circle ? arc(1) + arc(0) : arc(1);
    }
    std::string ring_label(double r, const std::string& label) const {
        return svg_text(x0 + r, y0() + 13, "middle", label);
    }
    /// Rings and axes; the labels, which are drawn over the curves, are appended to `labels`.
    std::string grid(std::string& labels) const {
        std::string svg;
        const auto add = [&](double r, const std::string& label) {
            svg += ring(r);
            labels += ring_label(r, label);
        };
        if (is_linear) {
            add(radius / 2, two_digits(max / 2));
            add(radius, two_digits(max));
        } else
            for (int exponent = int(std::floor(lowest)) + 1; exponent <= highest; ++exponent)
                add(r_of(std::pow(10.0, exponent)), power_of_ten(exponent));
        if (is_circle) labels += svg_text(4, y0() - 6, "start", "front") + svg_text(4, y0() + 13, "start", "back");
        return svg + svg_line("axis", x0 - radius, y0(), x0 + radius, y0()) +
               svg_line("axis", x0, is_circle ? y0() + radius : y0(), x0, y0() - radius);
    }
    std::string curve(const SliceCurve& style, const LuminanceSlice& slice, bool is_first) const {
        constexpr double min_step = 1.5;
        Outline outline;
        for (std::size_t i = 0; i < slice.degrees.size(); ++i) {
            const double y = slice.luminance[i], angle = slice.degrees[i];
            const double r = std::isnan(y) ? y : std::min(r_of(y), outside * radius);
            outline.add(x_of(r, angle), y_of(r, angle), min_step);
        }
        return curve_path(style, outline, is_first);
    }
};

}  // namespace

LuminanceSlice luminance_slice(const Evaluate& brdf, double theta_l, bool both_sides) {
    // The light is at −light. `mirror` is its mirror direction, or the straight direction of transmission, from the
    // nearer normal.
    const double light = theta_l / k_degree, mirror = light <= 90 ? light : 180 - light;
    LuminanceSlice slice;
    add_angles(slice.degrees, 0, mirror);
    const auto front = std::ptrdiff_t(slice.degrees.size());
    if (both_sides) add_angles(slice.degrees, 180, 180 - mirror);
    const std::vector<Vec3f> wl(slice.degrees.size(), {float(std::sin(theta_l)), 0, float(std::cos(theta_l))});
    std::vector<Vec3f> wv;
    for (const double angle : slice.degrees)
        wv.push_back({float(-std::sin(angle * k_degree)), 0, float(std::cos(angle * k_degree))});
    std::vector<Rgb> f(wv.size());
    brdf(wl, wv, f);
    for (const Rgb& value : f) slice.luminance.push_back(luminance(value));
    if (both_sides) {  // a gap between the sides
        slice.degrees.insert(slice.degrees.begin() + front, 90);
        slice.luminance.insert(slice.luminance.begin() + front, std::numeric_limits<double>::quiet_NaN());
    }
    return slice;
}

std::string slice_drawing(std::span<const SliceCurve> curves, double theta_l) {
    const double light = theta_l / k_degree;
    std::vector<LuminanceSlice> slices;
    double max = 0, min = std::numeric_limits<double>::infinity();
    for (const SliceCurve& curve : curves) {
        slices.push_back(luminance_slice(curve.brdf, theta_l));
        for (const double y : slices.back().luminance)
            if (y > 0 && std::isfinite(y)) {
                max = std::max(max, y);
                min = std::min(min, y);
            }
    }
    const DecadePlot plot{Decades(min, max, k_slice_decades), -90, 90};
    const auto x_of = [&](double degrees) { return plot.x_of(degrees); };
    std::string svg = plot.begin(fmt::format("Reflectance for light at {:g}° from the normal", light),
                                 fmt::format("light at {:g}°", light));
    for (int degrees = -90; degrees <= 90; degrees += k_tick)
        svg += plot.tick(degrees, fmt::format("{}°", std::abs(degrees)));
    svg += svg_line("axis", x_of(0), k_top, x_of(0), k_bottom);
    if (light > 0) {
        svg += svg_line("mark", x_of(light), k_top, x_of(light), k_bottom) +
               svg_line("mark", x_of(-light), k_top, x_of(-light), k_bottom);
        svg +=
            svg_text(x_of(-light), k_top - 4, "middle", "light") + svg_text(x_of(light), k_top - 4, "middle", "mirror");
    }
    svg += plot.caption("seen from this angle; light comes from the left");
    for (std::size_t c = 0; c < curves.size(); ++c) svg += plot.curve_path(curves[c], slices[c], 0, c == 0);
    return svg + "</svg>\n";
}

std::vector<Scan> scans_in_plane(const ScatteredSamples& samples) {
    constexpr double k_min_scan_step = 0.1;  // degrees
    constexpr std::size_t k_fewest = 8;
    struct Point {
        double light, view, luminance;
    };
    std::vector<Point> points;
    for (std::size_t i = 0; i < samples.wl.size(); ++i) {
        const Vec3f wl = samples.wl[i], wv = samples.wv[i];
        if (!is_in_plane(wl, wv)) continue;
        // At normal incidence there is no mirror side; the side of +x is used.
        const float along = std::hypot(wl.x, wl.y) > 1e-4f ? -(wl.x * wv.x + wl.y * wv.y) : wv.x;
        const double side = along < 0 ? -1 : 1;
        const auto theta = [](Vec3f w) { return std::atan2(std::hypot(w.x, w.y), w.z) / float(k_degree); };
        points.push_back({double(theta(wl)), side * double(theta(wv)), luminance(samples.colour[i])});
    }
    std::ranges::stable_sort(points, {}, &Point::light);
    std::vector<Scan> scans;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (i == 0 || points[i].light - points[i - 1].light > k_min_scan_step)
            scans.emplace_back().theta_l = points[i].light;
        scans.back().degrees.push_back(points[i].view);
        scans.back().luminance.push_back(points[i].luminance);
    }
    std::erase_if(scans, [](const Scan& scan) { return scan.degrees.size() < k_fewest; });
    return scans;
}

std::string scan_drawing(const Scan& scan, std::span<const SliceCurve> models) {
    constexpr double k_around = 1;  // decade
    constexpr int k_max_decades = 12;
    double max = 0, min = std::numeric_limits<double>::infinity();
    for (const double y : scan.luminance)
        if (y > 0 && std::isfinite(y)) {
            max = std::max(max, y);
            min = std::min(min, y);
        }
    const double margin = std::pow(10.0, k_around);
    const DecadePlot plot{Decades(min / margin, max * margin, k_max_decades), -90 - scan.theta_l, 90 - scan.theta_l};
    std::string svg = plot.begin(fmt::format("Scan of f for light at {:.3g}° from the normal", scan.theta_l),
                                 fmt::format("light at {:.3g}°", scan.theta_l));
    for (int degrees = int(std::ceil(plot.left / k_tick)) * k_tick; degrees <= plot.right; degrees += k_tick)
        svg += plot.tick(degrees, fmt::format("{}°", degrees));
    svg += svg_line("axis", plot.x_of(0), k_top, plot.x_of(0), k_bottom);
    svg += plot.caption("angle from the mirror direction; f in 1/sr");
    for (std::size_t i = 0; i < scan.degrees.size(); ++i)
        if (scan.luminance[i] > 0)
            svg += fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='1.6' style='fill:var(--measured)'/>",
                               plot.x_of(scan.degrees[i] - scan.theta_l), plot.y_of(scan.luminance[i]));
    for (const SliceCurve& model : models)
        svg += plot.curve_path(model, luminance_slice(model.brdf, scan.theta_l * k_degree), scan.theta_l, false);
    return svg + "</svg>\n";
}

std::string lobe_drawing(std::span<const SliceCurve> curves, double theta_l, LobeScale scale) {
    const double light = theta_l / k_degree;
    std::vector<LuminanceSlice> slices;
    for (const SliceCurve& curve : curves) slices.push_back(luminance_slice(curve.brdf, theta_l, curve.both_sides));
    const LobePlot plot(slices[0], std::ranges::any_of(curves, &SliceCurve::both_sides), scale);

    std::string svg = fmt::format(
        "<svg class='slice lobes' viewBox='0 0 360 {}' role='img' aria-label='Lobes for light at {:g}° from the "
        "normal{}'>",
        plot.height(), light <= 90 ? light : 180 - light, light <= 90 ? "" : " of the back");
    svg += svg_text(
        4, 14, "start",
        fmt::format("<tspan font-weight='bold'>light at {:g}°{}</tspan>, {}", light <= 90 ? light : 180 - light,
                    light <= 90 ? "" : " behind", plot.is_linear ? "linear" : "every ring ten times the one within"));
    std::string labels;
    svg += plot.grid(labels);
    const double light_radius = 1.1 * LobePlot::radius, x = plot.x_of(light_radius, -light),
                 y = plot.y_of(light_radius, -light);
    svg += svg_line("mark", LobePlot::x0, plot.y0(), x, y);
    labels += svg_text(x, y + (light <= 90 ? -3 : 11), "middle", "light");
    for (std::size_t c = 0; c < curves.size(); ++c) svg += plot.curve(curves[c], slices[c], c == 0);
    return svg + labels + "</svg>\n";
}

}  // namespace
