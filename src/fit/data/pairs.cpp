#include "fit/data/pairs.h"

namespace srbf {
namespace {

// Angles of the grid [degrees], closer to each other near the normal, the horizon and the plane of incidence.
constexpr double k_grid_theta[] = {0,  2,  5,  10, 15, 20, 25, 30, 35, 40, 45,   50,  55,
                                   60, 65, 70, 75, 79, 82, 85, 87, 88, 89, 89.5, 89.9};
/// Light and view are never equal: there ψ of (1, −1) has no direction, and nearby its direction changes abruptly.
constexpr double k_grid_phi[] = {0.5, 1,   3,   6,   10,  15,  20,  30,  40,  50,  60,  75, 90,
                                 105, 120, 130, 140, 150, 160, 165, 170, 174, 177, 179, 180};
/// The view's polar angle [degrees] where both are 0.
constexpr double k_beside_normal = 0.25;

}  // namespace

std::vector<DirectionPair> horizon_grid() {
    std::vector<DirectionPair> grid;
    for (const double l : k_grid_theta)
        for (const double v : k_grid_theta)
            for (const double phi : k_grid_phi) {
                const double turn = k_golden_angle * double(grid.size());  // isotropic data need no certain azimuth
                const double of_view = l == 0 && v == 0 ? k_beside_normal : v;
                grid.push_back({to_float(spherical(l * k_degree, phi * k_degree + turn)),
                                to_float(spherical(of_view * k_degree, turn))});
            }
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
