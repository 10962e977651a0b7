#include "extras/daylight/tree_beam.h"

#include <algorithm>
#include <cmath>

#include "base/r_sequence.h"
#include "brdf/directions.h"
#include "extras/daylight/klems.h"
#include "srbf/elementary.h"

namespace srbf {
namespace {

/// A peak reaches from a leaf to those that touch it, so many widths of a leaf: their far corners are 2.8 widths away where
/// the disc does not stretch leaves, which it does by up to a quarter along the radius.
constexpr double k_peak_reach = 3.5;
/// Rings of a beam, 5 degrees apart, and nodes of a ring of an anisotropic tree.
constexpr int k_beam_rings = 18, k_beam_nodes = 24;
constexpr double k_ring_width = 5 * k_degree;
/// A node is the mean over this many points of the angles within half a ring of it and of the peak. From leaf to leaf the
/// share is up to a tenth off.
constexpr int k_share_points = 16384;
/// Directions about a peak and elsewhere.
constexpr int k_about_peak = 16, k_away_from_peak = 128;
/// A direction counts as one of the hemisphere up to this sine.
constexpr double k_most_disc_radius = 0.999;

/// A point of the unit disc, in which areas are projected solid angles, as a direction; none beyond the horizon.
std::optional<Vec3f> on_hemisphere(double x, double y) {
    const double squared = x * x + y * y;
    if (squared > k_most_disc_radius * k_most_disc_radius) return {};
    return to_float({x, y, std::sqrt(1 - squared)});
}

/// A tree, and how far about the mirror direction its peak is in the disc.
struct Peaked {
    std::shared_ptr<const TreeTable> tree;
    double reach;

    Rgb f(Vec3f wl, Vec3f wv) const { return value(*tree, wl, wv); }
    /// At the edge of the peak on the viewer's side, on the other one where that is below the horizon.
    Rgb rest(Vec3f wl, Vec3f wv) const {
        const double x = double(wl.x) + double(wv.x), y = double(wl.y) + double(wv.y), apart = elementary::hypot(x, y);
        if (!(apart < reach) || !above_horizon(wl, wv)) return f(wl, wv);
        const double along_x = apart > 0 ? x / apart : 1, along_y = apart > 0 ? y / apart : 0;
        for (const double side : {reach, -reach})
            if (const auto edge = on_hemisphere(side * along_x - double(wl.x), side * along_y - double(wl.y)))
                return f(wl, *edge);
        return f(wl, wv);
    }
    /// True if it has the peak of a beam for light from this direction.
    bool is_beam(Vec3f wl) const {
        double most = 0;
        for (int k = 0; k < k_about_peak; ++k) {
            const double phi = 2 * k_pi * k / k_about_peak;
            if (const auto edge = on_hemisphere(reach * elementary::cos(phi) - double(wl.x),
                                                reach * elementary::sin(phi) - double(wl.y)))
                most = std::max(most, double(f(wl, *edge).g));
        }
        std::vector<double> all;
        for (const Vec3f& wv : fibonacci_directions(k_away_from_peak, k_pi / 2)) all.push_back(double(f(wl, wv).g));
        std::ranges::nth_element(all, all.begin() + k_away_from_peak / 2);
        return is_peak_of_beam(double(f(wl, mirror(wl)).g), most, all[k_away_from_peak / 2]);
    }
};

/// The mean of ∫ (f − rest) cosθv dωv over the peak, within half a ring of an angle, over equal projected solid angles.
Rgb mean_share(const Peaked& peaked, double theta, double phi) {
    const auto squared_sine = [](double angle) { return elementary::square(elementary::sin(angle)); };
    const double from = squared_sine(std::max(theta - k_ring_width / 2, 0.0)),
                 to = squared_sine(std::min(theta + k_ring_width / 2, k_pi / 2)), reach = peaked.reach;
    std::array<double, 3> sum{};
    RSequence<3> sequence;
    for (int k = 0; k < k_share_points; ++k) {
        const auto& u = sequence.next();
        const double sine = std::sqrt(from + u[0] * (to - from)), x = (2 * u[1] - 1) * reach,
                     y = (2 * u[2] - 1) * reach;
        if (!(elementary::hypot(x, y) < reach)) continue;
        const Vec3f wl = to_float(spherical(elementary::asin(sine), phi));
        const auto wv = on_hemisphere(x - double(wl.x), y - double(wl.y));
        if (!wv) continue;
        const Rgb whole = peaked.f(wl, *wv), below = peaked.rest(wl, *wv);
        for (int c = 0; c < 3; ++c) sum[std::size_t(c)] += double(whole[c] - below[c]);
    }
    const double area = elementary::square(2 * reach) / k_share_points;
    const auto share = [&](int c) { return float(std::clamp(sum[std::size_t(c)] * area, 0.0, 1.0)); };
    return {share(0), share(1), share(2)};
}

}  // namespace

std::optional<SeparatedBeam> separated_beam(const std::shared_ptr<const TreeTable>& tree) {
    // The unit square has the area of the disc, π.
    const Peaked peaked{tree, k_peak_reach * double(tree->y.smallest_leaf()) * std::sqrt(k_pi)};
    const int nodes = tree->y.rank == 3 ? 1 : k_beam_nodes;
    Beam beam;
    bool is_beam = false;
    for (int ring = 0; ring < k_beam_rings; ++ring) {
        const double theta = k_ring_width * ring;
        const int n = ring == 0 ? 1 : nodes;
        beam.theta.push_back(float(theta));
        beam.azimuths.push_back(n);
        for (int k = 0; k < n; ++k) {
            const double phi = 2 * k_pi * k / n;
            is_beam = is_beam || peaked.is_beam(to_float(spherical(theta, phi)));
            beam.share.push_back(mean_share(peaked, theta, phi));
        }
    }
    if (!is_beam) return {};
    if (nodes == 1) beam.azimuths.clear();
    const Evaluate rest = [peaked](std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
        for (std::size_t i = 0; i < f.size(); ++i) f[i] = peaked.rest(wl[i], wv[i]);
    };
    return SeparatedBeam{rest, std::move(beam)};
}

}  // namespace srbf
