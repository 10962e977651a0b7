#include "measured/tree_beam.h"

#include <algorithm>
#include <cmath>

#include "measured/klems.h"
#include "srbf/directions.h"
#include "srbf/elementary.h"

namespace srbf {
namespace {

/// A peak reaches from a leaf to those that touch it, so many widths of a leaf at most.
constexpr double k_peak_reach = 2.5;
/// Rings of a beam, 10 degrees apart, and nodes of a ring of an anisotropic tree.
constexpr int k_beam_rings = 9, k_beam_nodes = 24;
constexpr double k_ring_width = 10 * k_degree;
/// Of a node the mean over so many angles within half a ring of it: from leaf to leaf the share is up to a tenth off.
constexpr int k_beam_angles = 16;
/// Directions about a peak and elsewhere, and points across it in each coordinate.
constexpr int k_about_peak = 16, k_away_from_peak = 128, k_across_peak = 32;
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
    const TreeTable& tree;
    double reach;

    Rgb f(Vec3f wl, Vec3f wv) const { return value(tree, wl, wv); }
    /// At the edge of the peak on the viewer's side, on the other one where that is below the horizon.
    Rgb rest(Vec3f wl, Vec3f wv) const {
        const double x = double(wl.x) + double(wv.x), y = double(wl.y) + double(wv.y), apart = elementary::hypot(x, y);
        if (!(apart < reach) || !(wl.z > 0 && wv.z > 0)) return f(wl, wv);
        const double along_x = apart > 0 ? x / apart : 1, along_y = apart > 0 ? y / apart : 0;
        for (const double side : {reach, -reach})
            if (const auto edge = on_hemisphere(side * along_x - double(wl.x), side * along_y - double(wl.y)))
                return f(wl, *edge);
        return f(wl, wv);
    }
    /// ∫ (f − rest) cosθv dωv over the peak.
    Rgb share(Vec3f wl) const {
        std::array<double, 3> sum{};
        const double step = 2 * reach / k_across_peak;
        for (int i = 0; i < k_across_peak; ++i)
            for (int j = 0; j < k_across_peak; ++j) {
                const double x = (i + 0.5) * step - reach, y = (j + 0.5) * step - reach;
                const auto wv = on_hemisphere(x - double(wl.x), y - double(wl.y));
                if (!wv || !(elementary::hypot(x, y) < reach)) continue;
                const Rgb whole = f(wl, *wv), below = rest(wl, *wv);
                for (int c = 0; c < 3; ++c) sum[std::size_t(c)] += double(whole[c] - below[c]) * step * step;
            }
        const auto within = [](double x) { return float(std::clamp(x, 0.0, 1.0)); };
        return {within(sum[0]), within(sum[1]), within(sum[2])};
    }
    /// Whether it has the peak of a beam for light from this direction.
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

/// The mean share about an angle, over equal projected solid angles.
Rgb mean_share(const Peaked& peaked, double theta, double phi) {
    const auto squared_sine = [](double angle) { return elementary::square(elementary::sin(angle)); };
    const double from = squared_sine(std::max(theta - k_ring_width / 2, 0.0)),
                 to = squared_sine(std::min(theta + k_ring_width / 2, k_pi / 2));
    Rgb mean;
    for (int k = 0; k < k_beam_angles; ++k) {
        const double sine = std::sqrt(from + (k + 0.5) / k_beam_angles * (to - from));
        const Rgb share = peaked.share(to_float(spherical(elementary::asin(sine), phi)));
        for (int c = 0; c < 3; ++c) mean[c] += share[c] / k_beam_angles;
    }
    return mean;
}

}  // namespace

std::optional<SeparatedTree> separated_beam(const TreeTable& tree) {
    // The unit square has the area of the disc, π.
    const Peaked peaked{tree, k_peak_reach * double(tree.y.smallest_leaf()) * std::sqrt(k_pi)};
    const int nodes = tree.y.rank == 3 ? 1 : k_beam_nodes;
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
    return SeparatedTree{rest, std::move(beam)};
}

}  // namespace srbf
