#include "observe/pairs.h"

#include <cmath>

#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

// Angles of the grid [degrees], denser near the normal, the horizon and the plane of incidence.
constexpr double k_grid_theta[] = {0,  2,  5,  10, 15, 20, 25, 30, 35, 40, 45,   50,  55,
                                   60, 65, 70, 75, 79, 82, 85, 87, 88, 89, 89.5, 89.9};
/// Angles beyond the grid [degrees], where a lobe may still rise by any factor.
constexpr double k_grazing_theta[] = {89.99, 89.999};
/// Light and view are never equal: there ψ of (1, −1) is undefined, and its direction changes abruptly nearby.
constexpr double k_grid_phi[] = {0.5, 1,   3,   6,   10,  15,  20,  30,  40,  50,  60,  75, 90,
                                 105, 120, 130, 140, 150, 160, 165, 170, 174, 177, 179, 180};
/// The view's polar angle [degrees] if both polar angles are 0.
constexpr double k_beside_normal = 0.25;
/// This fraction of the views is uniform over the cap; the others are uniform in log cosθ.
constexpr double k_uniform_views = 0.75;
/// This fraction of the horizon pairs are nodes of the grid.
constexpr double k_grid_fraction = 0.5;

/// The unit vector with the given z and azimuth.
Vec3d direction(double z, double phi) {
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    return {r * elementary::cos(phi), r * elementary::sin(phi), z};
}

/// Adds the pairs with these polar angles, at all azimuths of the grid.
void add_grid(std::vector<DirectionPair>& grid, std::span<const double> lights, std::span<const double> views) {
    for (const double l : lights)
        for (const double v : views)
            for (const double phi : k_grid_phi) {
                const double azimuth = k_golden_angle * double(grid.size());  // isotropic data need no certain azimuth
                const double view_theta = l == 0 && v == 0 ? k_beside_normal : v;
                grid.push_back({to_float(spherical(l * k_degree, phi * k_degree + azimuth)),
                                to_float(spherical(view_theta * k_degree, azimuth))});
            }
}

}  // namespace

std::vector<DirectionPair> horizon_grid() {
    std::vector<DirectionPair> grid;
    add_grid(grid, k_grid_theta, k_grid_theta);
    return grid;
}

std::vector<DirectionPair> grazing_grid() {
    std::vector<DirectionPair> grid;
    add_grid(grid, k_grazing_theta, k_grazing_theta);
    add_grid(grid, k_grazing_theta, k_grid_theta);
    add_grid(grid, k_grid_theta, k_grazing_theta);
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

Vec3d ViewMixture::sample(double u0, double u1, double u2) const {
    return direction(u0 < k_uniform_views ? 1 - u1 * (1 - cos_max_) : elementary::pow(cos_max_, u1), 2 * k_pi * u2);
}

double ViewMixture::pdf(Vec3d w) const {
    return (k_uniform_views / (1 - cos_max_) + (1 - k_uniform_views) / (w.z * -elementary::log(cos_max_))) / (2 * k_pi);
}

PairDraws::PairDraws(double theta_max, bool with_grazing_grid, std::size_t mirror_pairs, std::mt19937_64 random)
    : fitted_points_(random_sequence(random)),
      horizon_points_(random_sequence(random)),
      bound_points_(random_sequence(random)),
      cos_max_(elementary::cos(theta_max)),
      mirror_pairs_(mirror_pairs),
      views_(cos_max_),
      lights_(theta_max) {
    if (with_grazing_grid) grazing_ = grazing_grid();
}

std::optional<DrawnPair> PairDraws::fitted(std::size_t i) const {
    const auto u = fitted_points_.at(i);
    const Vec3d wv = views_.sample(u[0], u[1], u[2]), wl = lights_.sample(wv, u[3], u[4], u[5]);
    if (!lights_.contains(wl)) return std::nullopt;
    return DrawnPair{{to_float(wl), to_float(wv)}, 1 / (views_.pdf(wv) * lights_.pdf(wl, wv))};
}

std::optional<DrawnPair> PairDraws::horizon(std::size_t i) const {
    const auto u = horizon_points_.at(i);
    if (u[0] < k_grid_fraction) return DrawnPair{grid_[std::size_t(u[0] / k_grid_fraction * double(grid_.size()))]};
    const double cos_horizon = elementary::cos(k_horizon_theta);
    const Vec3d edge = direction(cos_horizon + u[1] * (cos_max_ - cos_horizon), 2 * k_pi * u[2]);
    const Vec3d other = to_horizon_.sample(edge, u[3], u[4], u[5]);
    if (!to_horizon_.contains(other)) return std::nullopt;
    const Vec3f w_edge = to_float(edge), w_other = to_float(other);
    return u[0] < (1 + k_grid_fraction) / 2 ? DrawnPair{{w_edge, w_other}} : DrawnPair{{w_other, w_edge}};
}

std::size_t PairDraws::bound_pairs() const { return grid_.size() + mirror_pairs_ + grazing_.size(); }

std::optional<DrawnPair> PairDraws::bound(std::size_t i) const {
    if (i < grid_.size()) return DrawnPair{grid_[i]};
    if (i >= grid_.size() + mirror_pairs_) return DrawnPair{grazing_[i - grid_.size() - mirror_pairs_]};
    const auto pair = pair_within(to_horizon_, bound_points_.at(i - grid_.size()));
    return pair ? std::optional(DrawnPair{*pair}) : std::nullopt;
}

}  // namespace
