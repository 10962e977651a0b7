#include "extras/view/plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "extras/view/display_state.h"
#include "srbf/vec.h"

namespace SRBF_NAMESPACE {
namespace {

constexpr ImU32 k_line = IM_COL32(255, 255, 255, 60), k_ink = IM_COL32(230, 230, 230, 255),
                k_light = IM_COL32(255, 220, 90, 255);
constexpr ImU32 k_channel[3] = {IM_COL32(255, 110, 100, 255), IM_COL32(110, 220, 110, 255),
                                IM_COL32(120, 160, 255, 255)};

void label(ImDrawList& list, ImVec2 position, const std::string& text, ImU32 colour = k_ink) {
    list.AddText(position, colour, text.c_str());
}

constexpr double k_none = std::numeric_limits<double>::quiet_NaN();
/// Lobes with a smaller fraction of the light are not drawn.
constexpr double k_least_share = 0.001;

/// A disc, or its upper half, in which the angle from the normal and a value are drawn in polar coordinates. The
/// light is on the left.
struct SlicePlot {
    ImDrawList& list;
    ImVec2 centre;
    float radius;
    bool is_whole, logarithmic;
    float rim_value;  ///< the value at the rim

    ImVec2 point_at(double angle, double r) const {
        return {centre.x + radius * float(r * std::sin(angle)), centre.y - radius * float(r * std::cos(angle))};
    }
    double length(float f) const {
        const double ratio = double(f) / double(rim_value);
        if (!logarithmic) return std::clamp(ratio, 0.0, 1.0);
        return std::clamp(1 + std::log10(std::max(ratio, 1e-30)) / k_decades, 0.0, 1.0);
    }
    /// Draws circles of constant value and rays of constant angle.
    void draw_grid() const {
        const int rings = logarithmic ? int(k_decades) : 4;
        for (int ring = 1; ring <= rings; ++ring) {
            const double r = double(ring) / rings;
            list.PathClear();
            for (int i = -30; i <= (is_whole ? 90 : 30); ++i) list.PathLineTo(point_at(i * 3 * k_degree, r));
            list.PathStroke(k_line, 0, 1);
            const double value = double(rim_value) * (logarithmic ? std::pow(10, ring - rings) : r);
            const ImVec2 label_position = point_at(-90 * k_degree, r);
            if (ring % 2 == 0)
                label(list, {label_position.x - 2, label_position.y + 1}, fmt::format("{:.2g}", value),
                      IM_COL32(255, 255, 255, 150));
        }
        for (int degrees = -60; degrees <= (is_whole ? 270 : 60); degrees += 30)
            list.AddLine(centre, point_at(degrees * k_degree, 1), k_line);
        list.AddLine(point_at(-90 * k_degree, 1), point_at(90 * k_degree, 1), k_line);
    }
    void draw_light(double theta) const {
        list.AddLine(centre, point_at(-theta, 1.04), k_light, 2);
        const ImVec2 tip = point_at(-theta, 1.1);
        label(list, {tip.x - 34, tip.y - 6}, "light", k_light);
    }
    void draw_line(const Slice& slice, int c) const {
        const std::size_t sides = slice.both_sides ? 2 : 1, side_size = slice.f.size() / sides;
        for (std::size_t side = 0; side < sides; ++side) {
            list.PathClear();
            for (std::size_t i = side * side_size; i < (side + 1) * side_size; ++i)
                list.PathLineTo(point_at(double(slice.angle[i]), length(slice.f[i][c])));
            list.PathStroke(k_channel[c], 0, 1.5f);
        }
    }
    void draw_dots(const Slice& slice, int c) const {
        for (std::size_t i = 0; i < slice.f.size(); i += 4)
            if (is_finite(slice.f[i]))
                list.AddCircleFilled(point_at(double(slice.angle[i]), length(slice.f[i][c])), 1.9f, k_channel[c], 6);
    }
    /// The angle of a point [rad]; NaN outside the plot.
    double angle_at(ImVec2 point) const {
        const double x = double(point.x - centre.x), up = double(centre.y - point.y);
        if (std::hypot(x, up) > double(radius) || (up < 0 && !is_whole)) return k_none;
        return std::atan2(x, up);
    }
};

/// The hemisphere in orthographic projection. x points right; the normal points up, scaled by cos(elevation).
struct Dome {
    ImDrawList& list;
    ImVec2 centre;
    float radius;
    double azimuth, elevation;

    struct Point {
        ImVec2 position;
        double depth;  ///< towards the viewer
    };
    Point project(Vec3f w) const {
        const double x = std::cos(azimuth) * double(w.x) - std::sin(azimuth) * double(w.y),
                     y = std::sin(azimuth) * double(w.x) + std::cos(azimuth) * double(w.y), z = double(w.z);
        const double up = std::sin(elevation) * y + std::cos(elevation) * z;
        return {{centre.x + radius * float(x), centre.y - radius * float(up)},
                -std::cos(elevation) * y + std::sin(elevation) * z};
    }
    template <typename Direction> void draw_curve(const Direction& direction, int first, int end) const {
        for (int i = first; i < end; ++i) {
            const Point a = project(direction(i)), b = project(direction(i + 1));
            list.AddLine(a.position, b.position, a.depth < 0 ? (k_line & 0x00ffffff) | 0x18000000 : k_line, 1);
        }
    }
    void draw_grid() const {
        for (const double theta : {30.0, 60.0, 90.0})
            draw_curve([&](int i) { return to_float(spherical(theta * k_degree, i * 5 * k_degree)); }, 0, 72);
        for (int meridian = 0; meridian < 6; ++meridian)
            draw_curve([&](int i) { return to_float(spherical(i * 5 * k_degree, meridian * 30 * k_degree)); }, -18, 18);
    }
    void draw_arrow(Vec3f w, ImU32 colour, const char* text) const {
        const ImVec2 tip = project(w).position;
        list.AddLine(centre, tip, colour, 2);
        label(list, {tip.x + 4, tip.y - 14}, text, colour);
    }
    /// Draws the contour of lobe k at half of its peak, from the projected `view_directions`.
    void draw_contour(const LobeSlice& lobe, std::size_t k, const std::vector<Point>& points) const {
        for (int ring = 0; ring < k_rings; ++ring)
            for (int i = 0; i < k_ring_azimuths; ++i) {
                const int next = (i + 1) % k_ring_azimuths;
                draw_cell(
                    lobe, k, points,
                    {std::size_t(ring * k_ring_azimuths + i), std::size_t(ring * k_ring_azimuths + next),
                     std::size_t((ring + 1) * k_ring_azimuths + next), std::size_t((ring + 1) * k_ring_azimuths + i)});
            }
    }
    /// Draws a cell of the contour, by marching squares.
    void draw_cell(const LobeSlice& lobe, std::size_t k, const std::vector<Point>& points,
                   const std::array<std::size_t, 4>& corners) const {
        ImVec2 crossed[4];
        int crossings = 0, above = 0;
        bool visible = true;
        for (std::size_t e = 0; e < 4; ++e) {
            const std::size_t a = corners[e], b = corners[(e + 1) % 4];
            const float fa = lobe.relative[a] - 0.5f, fb = lobe.relative[b] - 0.5f;
            above += fa >= 0;
            visible = visible && points[a].depth > -0.02;
            if ((fa >= 0) == (fb >= 0)) continue;
            const float t = fa / (fa - fb);
            const ImVec2 p = points[a].position, q = points[b].position;
            crossed[crossings++] = {p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)};
        }
        if (above == 4 && visible)
            list.AddQuadFilled(points[corners[0]].position, points[corners[1]].position, points[corners[2]].position,
                               points[corners[3]].position, lobe_colour(k, 0.08f + 0.35f * float(lobe.share)));
        if (crossings >= 2) list.AddLine(crossed[0], crossed[1], lobe_colour(k, visible ? 1 : 0.25f), 2);
    }
};

}  // namespace

ImU32 lobe_colour(std::size_t k, float alpha) {
    return ImColor::HSV(std::fmod(0.58f + 0.381966f * float(k), 1.f), 0.75f, 1.f, alpha);
}

double draw_slices(const Slice* reference, const Slice* fit, double theta_l, double phi, bool logarithmic,
                   float width) {
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    // Front and back take a full circle of half the radius.
    const bool is_whole = (reference && reference->both_sides) || (fit && fit->both_sides);
    const float margin = ImGui::GetTextLineHeight(), radius = (width / 2 - margin) * (is_whole ? 0.5f : 1.f);
    ImGui::Dummy({width, (is_whole ? 2 : 1) * radius + 2 * margin});
    const bool is_hovered = ImGui::IsItemHovered();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const float rim_value = reference ? reference->most() : fit ? fit->most() : 0;
    if (!(rim_value > 0)) return label(list, corner, "nothing to plot"), k_none;

    const SlicePlot plot{list,     {corner.x + width / 2, corner.y + radius + margin}, radius, is_whole, logarithmic,
                         rim_value};
    plot.draw_grid();
    if (phi == 0) plot.draw_light(theta_l);  // in other planes the light is not in the plane
    for (int c = 0; c < 3; ++c) {
        if (fit) plot.draw_line(*fit, c);
        if (reference) plot.draw_dots(*reference, c);
    }
    const double angle = is_hovered ? plot.angle_at(ImGui::GetMousePos()) : k_none;
    if (std::isnan(angle)) return k_none;
    list.AddLine(plot.centre, plot.point_at(angle, 1), k_ink);
    return angle < -k_pi / 2 ? angle + 2 * k_pi : angle;
}

void draw_lobes(const std::vector<LobeSlice>& lobes, const char* other_name, double theta_l, double azimuth,
                double elevation, float width) {
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const float radius = 0.44f * width;
    ImGui::Dummy({width, radius * float(1.12 + std::sin(elevation))});
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const Dome dome{list, {corner.x + width / 2, corner.y + radius * 1.06f}, radius, azimuth, elevation};
    dome.draw_grid();
    static const std::vector<Vec3f> views = view_directions();
    std::vector<Dome::Point> points;
    for (const Vec3f& view : views) points.push_back(dome.project(view));
    for (std::size_t k = 0; k < lobes.size(); ++k)
        if (lobes[k].share >= k_least_share) dome.draw_contour(lobes[k], k, points);
    for (std::size_t k = 0; k < lobes.size(); ++k) {
        if (lobes[k].share < k_least_share) continue;
        const ImVec2 position = dome.project(lobes[k].centre).position;
        list.AddCircleFilled(position, 4, lobe_colour(k));
        list.AddCircle(position, 4, IM_COL32(0, 0, 0, 255));
    }
    dome.draw_arrow({0, 0, 1}, k_ink, "normal");
    dome.draw_arrow(to_float(spherical(theta_l, k_pi)), k_light, other_name);
}

}  // namespace srbf
