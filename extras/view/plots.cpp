#include "extras/view/plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "extras/view/look.h"
#include "srbf/vec.h"

namespace srbf {
namespace {

constexpr ImU32 k_line = IM_COL32(255, 255, 255, 60), k_ink = IM_COL32(230, 230, 230, 255),
                k_light = IM_COL32(255, 220, 90, 255);
constexpr ImU32 k_channel[3] = {IM_COL32(255, 110, 100, 255), IM_COL32(110, 220, 110, 255),
                                IM_COL32(120, 160, 255, 255)};

void label(ImDrawList& list, ImVec2 at, const std::string& text, ImU32 colour = k_ink) {
    list.AddText(at, colour, text.c_str());
}

constexpr double k_none = std::numeric_limits<double>::quiet_NaN();
/// A lobe with less of the light is not drawn.
constexpr double k_least_share = 0.001;

/// A disc, or its upper half, on which the angle from the normal and a length are drawn. The light's side is on the left.
struct SlicePlot {
    ImDrawList& list;
    ImVec2 centre;
    float radius;
    bool is_whole, logarithmic;
    float most;  ///< the value at the rim

    ImVec2 place(double angle, double r) const {
        return {centre.x + radius * float(r * std::sin(angle)), centre.y - radius * float(r * std::cos(angle))};
    }
    double length(float f) const {
        const double share = double(f) / double(most);
        if (!logarithmic) return std::clamp(share, 0.0, 1.0);
        return std::clamp(1 + std::log10(std::max(share, 1e-30)) / k_decades, 0.0, 1.0);
    }
    /// Circles of values, and rays of angles.
    void draw_grid() const {
        const int rings = logarithmic ? int(k_decades) : 4;
        for (int ring = 1; ring <= rings; ++ring) {
            const double r = double(ring) / rings;
            list.PathClear();
            for (int i = -30; i <= (is_whole ? 90 : 30); ++i) list.PathLineTo(place(i * 3 * k_degree, r));
            list.PathStroke(k_line, 0, 1);
            const double value = double(most) * (logarithmic ? std::pow(10, ring - rings) : r);
            const ImVec2 at = place(-90 * k_degree, r);
            if (ring % 2 == 0)
                label(list, {at.x - 2, at.y + 1}, fmt::format("{:.2g}", value), IM_COL32(255, 255, 255, 150));
        }
        for (int degrees = -60; degrees <= (is_whole ? 270 : 60); degrees += 30)
            list.AddLine(centre, place(degrees * k_degree, 1), k_line);
        list.AddLine(place(-90 * k_degree, 1), place(90 * k_degree, 1), k_line);
    }
    void draw_light(double theta) const {
        list.AddLine(centre, place(-theta, 1.04), k_light, 2);
        const ImVec2 at_light = place(-theta, 1.1);
        label(list, {at_light.x - 34, at_light.y - 6}, "light", k_light);
    }
    void draw_line(const Slice& slice, int c) const {
        const std::size_t sides = slice.both_sides ? 2 : 1, of_side = slice.f.size() / sides;
        for (std::size_t side = 0; side < sides; ++side) {
            list.PathClear();
            for (std::size_t i = side * of_side; i < (side + 1) * of_side; ++i)
                list.PathLineTo(place(double(slice.angle[i]), length(slice.f[i][c])));
            list.PathStroke(k_channel[c], 0, 1.5f);
        }
    }
    void draw_dots(const Slice& slice, int c) const {
        for (std::size_t i = 0; i < slice.f.size(); i += 4)
            if (is_finite(slice.f[i]))
                list.AddCircleFilled(place(double(slice.angle[i]), length(slice.f[i][c])), 1.9f, k_channel[c], 6);
    }
    /// NaN: outside.
    double angle_at(ImVec2 point) const {
        const double x = double(point.x - centre.x), up = double(centre.y - point.y);
        if (std::hypot(x, up) > double(radius) || (up < 0 && !is_whole)) return k_none;
        return std::atan2(x, up);
    }
};

/// The hemisphere in orthographic projection: x right, the normal upwards scaled by cos(elevation).
struct Dome {
    ImDrawList& list;
    ImVec2 centre;
    float radius;
    double azimuth, elevation;

    struct Point {
        ImVec2 at;
        double depth;
    };
    Point place(Vec3f w) const {
        const double x = std::cos(azimuth) * double(w.x) - std::sin(azimuth) * double(w.y),
                     y = std::sin(azimuth) * double(w.x) + std::cos(azimuth) * double(w.y), z = double(w.z);
        const double up = std::sin(elevation) * y + std::cos(elevation) * z;
        return {{centre.x + radius * float(x), centre.y - radius * float(up)},
                -std::cos(elevation) * y + std::sin(elevation) * z};
    }
    template <typename Direction> void draw_curve(const Direction& direction, int from, int to) const {
        for (int i = from; i < to; ++i) {
            const Point a = place(direction(i)), b = place(direction(i + 1));
            list.AddLine(a.at, b.at, a.depth < 0 ? (k_line & 0x00ffffff) | 0x18000000 : k_line, 1);
        }
    }
    void draw_grid() const {
        for (const double theta : {30.0, 60.0, 90.0})
            draw_curve([&](int i) { return to_float(spherical(theta * k_degree, i * 5 * k_degree)); }, 0, 72);
        for (int meridian = 0; meridian < 6; ++meridian)
            draw_curve([&](int i) { return to_float(spherical(i * 5 * k_degree, meridian * 30 * k_degree)); }, -18, 18);
    }
    void draw_arrow(Vec3f w, ImU32 colour, const char* text) const {
        const ImVec2 tip = place(w).at;
        list.AddLine(centre, tip, colour, 2);
        label(list, {tip.x + 4, tip.y - 14}, text, colour);
    }
    /// The contour of lobe k at half of its peak, given the places of `view_directions`.
    void draw_contour(const SeenLobe& lobe, std::size_t k, const std::vector<Point>& places) const {
        for (int ring = 0; ring < k_rings; ++ring)
            for (int i = 0; i < k_around; ++i) {
                const int next = (i + 1) % k_around;
                draw_cell(lobe, k, places,
                          {std::size_t(ring * k_around + i), std::size_t(ring * k_around + next),
                           std::size_t((ring + 1) * k_around + next), std::size_t((ring + 1) * k_around + i)});
            }
    }
    /// A cell of it, with crossings of the cell's edges: marching squares.
    void draw_cell(const SeenLobe& lobe, std::size_t k, const std::vector<Point>& places,
                   const std::array<std::size_t, 4>& corners) const {
        ImVec2 crossed[4];
        int crossings = 0, above = 0;
        bool visible = true;
        for (std::size_t e = 0; e < 4; ++e) {
            const std::size_t a = corners[e], b = corners[(e + 1) % 4];
            const float fa = lobe.relative[a] - 0.5f, fb = lobe.relative[b] - 0.5f;
            above += fa >= 0;
            visible = visible && places[a].depth > -0.02;
            if ((fa >= 0) == (fb >= 0)) continue;
            const float t = fa / (fa - fb);
            const ImVec2 p = places[a].at, q = places[b].at;
            crossed[crossings++] = {p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)};
        }
        if (above == 4 && visible)
            list.AddQuadFilled(places[corners[0]].at, places[corners[1]].at, places[corners[2]].at,
                               places[corners[3]].at, lobe_colour(k, 0.08f + 0.35f * float(lobe.share)));
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
    // Front and back take a full circle, half as large.
    const bool whole = (reference && reference->both_sides) || (fit && fit->both_sides);
    const float margin = ImGui::GetTextLineHeight(), radius = (width / 2 - margin) * (whole ? 0.5f : 1.f);
    ImGui::Dummy({width, (whole ? 2 : 1) * radius + 2 * margin});
    const bool is_hovered = ImGui::IsItemHovered();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const float most = reference ? reference->most() : fit ? fit->most() : 0;
    if (!(most > 0)) return label(list, corner, "nothing to plot"), k_none;

    const SlicePlot plot{list, {corner.x + width / 2, corner.y + radius + margin}, radius, whole, logarithmic, most};
    plot.draw_grid();
    if (phi == 0) plot.draw_light(theta_l);  // otherwise the light is not in the plane
    for (int c = 0; c < 3; ++c) {
        if (fit) plot.draw_line(*fit, c);
        if (reference) plot.draw_dots(*reference, c);
    }
    const double angle = is_hovered ? plot.angle_at(ImGui::GetMousePos()) : k_none;
    if (std::isnan(angle)) return k_none;
    list.AddLine(plot.centre, plot.place(angle, 1), k_ink);
    return angle < -k_pi / 2 ? angle + 2 * k_pi : angle;
}

void draw_lobes(const std::vector<SeenLobe>& lobes, const char* other, double theta_l, double azimuth, double elevation,
                float width) {
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const float radius = 0.44f * width;
    ImGui::Dummy({width, radius * float(1.12 + std::sin(elevation))});
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const Dome dome{list, {corner.x + width / 2, corner.y + radius * 1.06f}, radius, azimuth, elevation};
    dome.draw_grid();
    static const std::vector<Vec3f> views = view_directions();
    std::vector<Dome::Point> places;
    for (const Vec3f& view : views) places.push_back(dome.place(view));
    for (std::size_t k = 0; k < lobes.size(); ++k)
        if (lobes[k].share >= k_least_share) dome.draw_contour(lobes[k], k, places);
    for (std::size_t k = 0; k < lobes.size(); ++k) {
        if (lobes[k].share < k_least_share) continue;
        const ImVec2 at = dome.place(lobes[k].centre).at;
        list.AddCircleFilled(at, 4, lobe_colour(k));
        list.AddCircle(at, 4, IM_COL32(0, 0, 0, 255));
    }
    dome.draw_arrow({0, 0, 1}, k_ink, "normal");
    dome.draw_arrow(to_float(spherical(theta_l, k_pi)), k_light, other);
}

}  // namespace srbf
