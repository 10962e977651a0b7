#include "fit/data/pairs.h"

namespace srbf {
namespace {

// Angles of the grid [degrees], closer to each other near the normal, the horizon and the plane of incidence.
constexpr double k_grid_theta[] = {0,  2,  5,  10, 15, 20, 25, 30, 35, 40, 45,   50,  55,
                                   60, 65, 70, 75, 79, 82, 85, 87, 88, 89, 89.5, 89.9};
/// Beyond them, where a lobe may still rise by any factor.
constexpr double k_brink_theta[] = {89.99, 89.999};
/// Light and view are never equal: there ψ of (1, −1) has no direction, and nearby its direction changes abruptly.
constexpr double k_grid_phi[] = {0.5, 1,   3,   6,   10,  15,  20,  30,  40,  50,  60,  75, 90,
                                 105, 120, 130, 140, 150, 160, 165, 170, 174, 177, 179, 180};
/// The view's polar angle [degrees] where both are 0.
constexpr double k_beside_normal = 0.25;

/// Adds the pairs with these polar angles, at all azimuths of the grid.
void add_grid(std::vector<DirectionPair>& to, std::span<const double> lights, std::span<const double> views) {
    for (const double l : lights)
        for (const double v : views)
            for (const double phi : k_grid_phi) {
                const double turn = k_golden_angle * double(to.size());  // isotropic data need no certain azimuth
                const double of_view = l == 0 && v == 0 ? k_beside_normal : v;
                to.push_back({to_float(spherical(l * k_degree, phi * k_degree + turn)),
                              to_float(spherical(of_view * k_degree, turn))});
            }
}

}  // namespace

std::vector<DirectionPair> horizon_grid() {
    std::vector<DirectionPair> grid;
    add_grid(grid, k_grid_theta, k_grid_theta);
    return grid;
}

std::vector<DirectionPair> brink_grid() {
    std::vector<DirectionPair> grid;
    add_grid(grid, k_brink_theta, k_brink_theta);
    add_grid(grid, k_brink_theta, k_grid_theta);
    add_grid(grid, k_grid_theta, k_brink_theta);
    return grid;
}

RSequence<6> random_sequence(std::mt19937_64& random) {
    std::array<double, 6> first;
    for (double& x : first) x = uniform(random);
    return RSequence<6>(first);
}

std::optional<DirectionPair> pair_within(const MirrorMixture& cap, const std::array<double, 6>& point) {
    const auto [unused, u1, u2, u3, u4, u5] = point;
    const Vec3d wv = cap.sample_cap(u1, u2), wl = cap.sample(wv, u3, u4, u5);
    if (!cap.contains(wl)) return std::nullopt;
    return DirectionPair{to_float(wl), to_float(wv)};
}

}  // namespace srbf
