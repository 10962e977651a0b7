#include "app/peak.h"

#include <fmt/format.h>

#include "base/floating_point.h"
#include "brdf/directions.h"
#include "measured/angles.h"
#include "measured/tables.h"
#include "srbf/elementary.h"

namespace srbf {

namespace {

// The numbers below are described at `peak_of`.
constexpr std::size_t k_positions = 4;  // mirror, retro, beside, elsewhere, as in PeakPosition
constexpr double k_around = 10 * k_degree;
constexpr double k_min_ratio = 2;
/// Bounds of the intervals of θ_l.
constexpr std::array<double, 5> k_light{10 * k_degree, 25 * k_degree, 40 * k_degree, 55 * k_degree, 70 * k_degree};
constexpr double k_max_view = 75 * k_degree;
constexpr std::array<double, 3> k_shells{0.25 * k_degree, 1 * k_degree, 4 * k_degree};

double angle_between(const Vec3d& a, const Vec3d& b) {
    const Vec3d d = a - b;
    return 2 * elementary::asin(std::min(1.0, std::sqrt(dot(d, d)) / 2));
}

/// The level of a position in an interval, from means over shells.
struct Level {
    std::array<double, k_shells.size() + 1> sum{}, count{};
    void add(std::size_t shell, double y) {
        sum[shell] += y;
        count[shell] += 1;
    }
    /// Negative if there are no pairs.
    double value() const {
        double max = -1;
        for (std::size_t s = 0; s < sum.size(); ++s)
            if (count[s] > 0) max = std::max({max, sum[s] / count[s], 0.0});
        return max;
    }
};
using Levels = std::array<std::array<Level, k_positions>, k_light.size() - 1>;

void add(Levels& levels, const Vec3d& wl, const Vec3d& wv, double y) {
    const double theta_l = polar_angle(wl);
    if (!(theta_l >= k_light.front() && theta_l < k_light.back() && polar_angle(wv) <= k_max_view)) return;
    const std::size_t interval = std::size_t(std::ranges::upper_bound(k_light, theta_l) - k_light.begin()) - 1;
    const Vec3d side{-wl.y, wl.x, wl.z};
    const std::array<double, 3> angle{angle_between(wv, mirror(wl)), angle_between(wv, wl),
                                      std::min(angle_between(wv, side), angle_between(wv, mirror(side)))};
    const std::size_t nearest = std::size_t(std::ranges::min_element(angle) - angle.begin());
    const bool is_near = angle[nearest] <= k_around;
    const auto shell = std::size_t(std::ranges::upper_bound(k_shells, angle[nearest]) - k_shells.begin());
    if (is_near)
        levels[interval][nearest].add(shell, y);
    else
        levels[interval][k_positions - 1].add(0, y);
}

Peak peak_of(const Levels& levels) {
    std::array<double, k_positions> score{}, ratio{}, count{};
    for (const auto& interval : levels) {
        std::array<double, k_positions> level{};
        double min = -1, max = 0;
        std::size_t measured = 0;
        for (std::size_t p = 0; p < k_positions; ++p) {
            level[p] = interval[p].value();
            if (level[p] < 0) continue;
            ++measured;
            min = min < 0 ? level[p] : std::min(min, level[p]);
            max = std::max(max, level[p]);
        }
        if (measured < 2 || (level[0] < 0 && level[1] < 0)) continue;
        for (std::size_t p = 0; p < k_positions; ++p) {
            if (level[p] < 0) continue;
            const double quotient =
                max > 0 ? std::max(level[p], max / k_max_peak) / std::max(min, max / k_max_peak) : 1;
            score[p] += elementary::log(quotient);
            count[p] += 1;
            ratio[p] = std::max(ratio[p], quotient);
        }
    }
    Peak peak;
    double max = -1;
    for (std::size_t p = 0; p < k_positions; ++p) {
        if (!(count[p] > 0) || score[p] / count[p] <= max) continue;
        max = score[p] / count[p];
        peak = {PeakPosition(p), ratio[p]};
    }
    if (peak.position != PeakPosition::unknown && peak.ratio < k_min_ratio) peak.position = PeakPosition::none;
    return peak;
}

}  // namespace

const char* name(PeakPosition position) {
    constexpr std::array names{"mirror", "retro", "beside", "elsewhere", "none", "unknown"};
    return names[std::size_t(position)];
}

Peak peak_of(std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<const Rgb> f) {
    const StandardArithmetic mode;
    Levels levels;
    for (std::size_t i = 0; i < wl.size(); ++i)
        if (is_finite(f[i]) && wl[i].z > 0 && wv[i].z > 0)
            add(levels, to_double(wl[i]), to_double(wv[i]), luminance(f[i]));
    return peak_of(levels);
}

Peak peak_of(const Evaluate& brdf) {
    constexpr int k_turns = 8;
    std::vector<Vec3f> wl, wv;
    for (std::size_t interval = 0; interval + 1 < k_light.size(); ++interval)
        for (int turn = 0; turn < k_turns; ++turn) {
            const double theta_l = (k_light[interval] + k_light[interval + 1]) / 2, phi_l = turn * 2 * k_pi / k_turns;
            std::vector<Vec3d> views;
            for (int side = 0; side < 4; ++side) {
                const Vec3d centre = spherical(theta_l, phi_l + side * k_pi / 2);
                const Frame frame = frame_about(centre);
                views.push_back(centre);
                for (const double radius : {0.5, 0.9, 2.0, 3.5, 5.0, 7.5})
                    for (int k = 0; k < k_turns; ++k)
                        views.push_back(frame.from(spherical(radius * k_degree, k * 2 * k_pi / k_turns)));
            }
            for (int theta = 10; theta <= 70; theta += 15)
                for (int k = 0; k < 12; ++k) views.push_back(spherical(theta * k_degree, phi_l + k * k_pi / 6));
            for (const Vec3d& view : views) wv.push_back(to_float(view));
            wl.resize(wv.size(), to_float(spherical(theta_l, phi_l)));
        }
    std::vector<Rgb> f(wl.size());
    brdf(wl, wv, f);
    return peak_of(wl, wv, f);
}

Peak peak_of(const Measured& measured) {
    if (const auto* samples = std::get_if<ScatteredSamples>(&measured.table))
        return peak_of(samples->wl, samples->wv, samples->colour);
    if (const auto* bsdf = std::get_if<BsdfTable>(&measured.table)) {
        const auto& parts = bsdf->band().part;
        const auto first = std::ranges::find_if(parts, [](const auto& part) { return part != nullptr; });
        return first == parts.end() ? Peak{} : peak_of(**first);
    }
    return peak_of(signed_evaluator(measured));
}

std::string peak_text(const Peak& peak, bool is_transmission) {
    const std::string times =
        fmt::format("{}{:.0f} times f elsewhere", peak.ratio >= k_max_peak ? "over " : "", peak.ratio);
    switch (peak.position) {
        case PeakPosition::mirror:
            return fmt::format("highlight {}, {}", is_transmission ? "straight through" : "at the mirror direction",
                               times);
        case PeakPosition::retro:
            return fmt::format("highlight at the {}, {}: are the azimuths exchanged?",
                               is_transmission ? "azimuth of the light" : "retro direction", times);
        case PeakPosition::beside:
            return fmt::format("highlight beside the plane of incidence, {}: are the azimuths off by 90°?", times);
        case PeakPosition::elsewhere:
            return fmt::format(
                "highlight away from the mirror and the retro direction, {}: are angles from the normal?", times);
        case PeakPosition::none:
            return "no highlight (matte): no direction at the angle of the light has twice f of others";
        case PeakPosition::unknown:
            break;
    }
    return "unknown: too little was measured about the mirror and the retro direction";
}

}  // namespace srbf
