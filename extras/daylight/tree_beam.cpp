#include "extras/daylight/tree_beam.h"

#include <algorithm>

#include "base/r_sequence.h"
#include "brdf/directions.h"
#include "extras/daylight/klems.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

/// The radius of a peak in widths of a leaf. The far corners of the leaves that touch the peak's leaf are 2.8
/// widths away, where the disc does not stretch leaves. It stretches them by up to a quarter along the radius.
constexpr double k_peak_reach = 3.5;
/// Rings of a beam, 5 degrees apart, and nodes in a ring of an anisotropic tree.
constexpr int k_beam_rings = 18, k_beam_nodes = 24;
constexpr double k_ring_width = 5 * k_degree;
/// A node is the mean over this many points of the peak and of angles within half a ring of the node. From leaf to
/// leaf the fraction varies by up to a tenth.
constexpr int k_fraction_points = 16384;
/// Directions around a peak, and directions over the hemisphere.
constexpr int k_about_peak = 16, k_away_from_peak = 128;
/// Directions belong to the hemisphere up to this sine of the polar angle.
constexpr double k_max_disc_radius = 0.999;

/// The direction of a point of the unit disc, in which areas are projected solid angles; none beyond the horizon.
std::optional<Vec3f> on_hemisphere(double x, double y) {
    const double squared = x * x + y * y;
    if (squared > k_max_disc_radius * k_max_disc_radius) return {};
    return to_float({x, y, std::sqrt(1 - squared)});
}

/// A tree, and the radius in the disc of its peak around the mirror direction.
struct PeakedTree {
    std::shared_ptr<const TreeTable> tree;
    double reach;

    Rgb f(Vec3f wl, Vec3f wv) const { return value(*tree, wl, wv); }
    /// f without the peak: within it, the value at its edge on the viewer's side, or on the other side if that is
    /// below the horizon.
    Rgb without_peak(Vec3f wl, Vec3f wv) const {
        const double x = double(wl.x) + double(wv.x), y = double(wl.y) + double(wv.y),
                     distance = elementary::hypot(x, y);
        if (!(distance < reach) || !above_horizon(wl, wv)) return f(wl, wv);
        const double along_x = distance > 0 ? x / distance : 1, along_y = distance > 0 ? y / distance : 0;
        for (const double side : {reach, -reach})
            if (const auto edge = on_hemisphere(side * along_x - double(wl.x), side * along_y - double(wl.y)))
                return f(wl, *edge);
        return f(wl, wv);
    }
    /// True if the tree has a beam's peak for light from this direction.
    bool is_beam(Vec3f wl) const {
        double largest_around = 0;
        for (int k = 0; k < k_about_peak; ++k) {
            const double phi = 2 * k_pi * k / k_about_peak;
            if (const auto edge = on_hemisphere(reach * elementary::cos(phi) - double(wl.x),
                                                reach * elementary::sin(phi) - double(wl.y)))
                largest_around = std::max(largest_around, double(f(wl, *edge).g));
        }
        std::vector<double> values;
        for (const Vec3f& wv : fibonacci_directions(k_away_from_peak, k_pi / 2)) values.push_back(double(f(wl, wv).g));
        std::ranges::nth_element(values, values.begin() + k_away_from_peak / 2);
        return is_peak_of_beam(double(f(wl, mirror(wl)).g), largest_around, values[k_away_from_peak / 2]);
    }
};

/// The mean of ∫ (f − without_peak) cosθv dωv over the peak, for angles within half a ring of (theta, phi),
/// weighted by projected solid angle.
Rgb mean_fraction(const PeakedTree& peaked, double theta, double phi) {
    const auto squared_sine = [](double angle) { return elementary::square(elementary::sin(angle)); };
    const double lower = squared_sine(std::max(theta - k_ring_width / 2, 0.0)),
                 upper = squared_sine(std::min(theta + k_ring_width / 2, k_pi / 2)), reach = peaked.reach;
    std::array<double, 3> sum{};
    RSequence<3> sequence;
    for (int k = 0; k < k_fraction_points; ++k) {
        const auto& u = sequence.next();
        const double sine = std::sqrt(lower + u[0] * (upper - lower)), x = (2 * u[1] - 1) * reach,
                     y = (2 * u[2] - 1) * reach;
        if (!(elementary::hypot(x, y) < reach)) continue;
        const Vec3f wl = to_float(spherical(elementary::asin(sine), phi));
        const auto wv = on_hemisphere(x - double(wl.x), y - double(wl.y));
        if (!wv) continue;
        const Rgb whole = peaked.f(wl, *wv), base = peaked.without_peak(wl, *wv);
        for (int c = 0; c < 3; ++c) sum[std::size_t(c)] += double(whole[c] - base[c]);
    }
    const double area = elementary::square(2 * reach) / k_fraction_points;
    const auto fraction = [&](int c) { return float(std::clamp(sum[std::size_t(c)] * area, 0.0, 1.0)); };
    return {fraction(0), fraction(1), fraction(2)};
}

}  // namespace

std::optional<SeparatedBeam> separated_beam(const std::shared_ptr<const TreeTable>& tree) {
    // The unit square corresponds to the disc, whose area is π.
    const PeakedTree peaked{tree, k_peak_reach * double(tree->y.smallest_leaf()) * std::sqrt(k_pi)};
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
            beam.fraction.push_back(mean_fraction(peaked, theta, phi));
        }
    }
    if (!is_beam) return {};
    if (nodes == 1) beam.azimuths.clear();
    const Evaluate base = [peaked](std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
        for (std::size_t i = 0; i < f.size(); ++i) f[i] = peaked.without_peak(wl[i], wv[i]);
    };
    return SeparatedBeam{base, std::move(beam)};
}

}  // namespace
