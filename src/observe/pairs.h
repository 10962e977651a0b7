// Pairs of directions at which a measurement is observed.
#pragma once
#include <optional>

#include "base/r_sequence.h"
#include "brdf/directions.h"

namespace SRBF_NAMESPACE {

/// The angle from the normal up to which a fit is bounded, whatever its θmax; at 90° f cosθl cosθv vanishes.
inline constexpr double k_horizon_theta = 89.9 * k_degree;

/// The golden angle π(3 − √5) [rad], rounded. Multiples of it spread evenly over all azimuths, whatever their number.
inline constexpr double k_golden_angle = 2.4;

/// Number of bound pairs of a table around the mirror direction: enough to find a lobe between the nodes of the grid.
inline constexpr std::size_t k_mirror_pairs = 32768;

struct DirectionPair {
    Vec3f wl, wv;
};

/// A grid of pairs up to `k_horizon_theta`, including in-plane pairs and the horizon. A sum of exponentials that
/// diverges between observations does so towards an edge.
std::vector<DirectionPair> horizon_grid();
/// Pairs beyond that grid: light, viewer or both at 89.99 or 89.999°.
std::vector<DirectionPair> grazing_grid();
/// cos 89.95°, between the two grids.
inline constexpr double k_grazing_cosine = 8.7e-4;

/// A sequence of points of the unit cube that begins with a random one.
RSequence<6> random_sequence(std::mt19937_64& random);

/// A pair within the cap, from the last five coordinates of a point: wv is uniform, wl often close to its mirror
/// direction. No value if wl is outside the cap.
std::optional<DirectionPair> pair_within(const MirrorMixture& cap, const std::array<double, 6>& point);

/// A pair drawn for a table.
struct DrawnPair {
    DirectionPair pair;
    double weight = 0;  ///< 1 / density within the caps; 0 for a pair that is not sampled from them
};

/// Distribution of view directions: three quarters uniform over the cap, one quarter uniform in log cosθ, so that
/// directions close to the horizon are not rare.
class ViewMixture {
  public:
    explicit ViewMixture(double cos_max) : cos_max_(cos_max) {}
    Vec3d sample(double u0, double u1, double u2) const;
    double pdf(Vec3d w) const;  // [1/sr]

  private:
    double cos_max_;
};

/// The pairs at which a table is observed, by index; none where a direction is below the horizon or outside the cap.
class PairDraws {
  public:
    PairDraws(double theta_max, bool with_grazing_grid, std::size_t mirror_pairs, std::mt19937_64 random);
    std::optional<DrawnPair> fitted(std::size_t i) const;
    /// A node of the grid, or a pair in which at least one direction is beyond θmax, equally often wl and wv.
    std::optional<DrawnPair> horizon(std::size_t i) const;
    std::optional<DrawnPair> bound(std::size_t i) const;
    std::size_t bound_pairs() const;

  private:
    RSequence<6> fitted_points_, horizon_points_, bound_points_;
    double cos_max_;
    std::size_t mirror_pairs_;
    ViewMixture views_;
    MirrorMixture lights_, to_horizon_{k_horizon_theta};
    std::vector<DirectionPair> grid_ = horizon_grid(), grazing_;
};

}  // namespace
