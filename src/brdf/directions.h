// Sets of directions, and distributions of pairs of directions.
#pragma once
#include <array>
#include <random>
#include <span>
#include <vector>

#include "srbf/vec.h"

SRBF_BEGIN

/// A double uniform in [0,1), the same on every machine.
inline double uniform(std::mt19937_64& random) { return double(random() >> 11) * 0x1p-53; }

/// Direction i of the Fibonacci set of n directions on the cap θ ≤ θmax [rad]: z = (i+½)/n (1−cos θmax) + cos θmax,
/// azimuth i times the golden angle π(3−√5). Each direction represents the solid angle 2π(1−cos θmax)/n [sr].
Vec3d fibonacci_direction(int i, int n, double theta_max);

std::vector<Vec3f> fibonacci_directions(int n, double theta_max);

/// Finds the indices of the directions nearest to `w`, in order of distance, then of index. `directions` holds at most
/// 65,536 directions with non-decreasing z. `nearest` has at most 16 elements, and no more than there are directions.
void find_nearest(std::span<const Vec3f> directions, Vec3f w, std::span<std::uint16_t> nearest);

enum class DirectionMap;  // srbf/models/su.h
/// Number of texels of a texture with `size` × `size` texels per face.
std::size_t texels(DirectionMap map, int size);
/// The direction at the centre of a texel. Texels are ordered by face, row t, column s.
Vec3f texel_direction(DirectionMap map, int size, std::size_t texel);
/// The texel that contains direction `w`. The parabolic map contains no directions near −z, for which the result is a
/// texel at its border.
std::size_t texel_of(DirectionMap map, int size, Vec3f w);

/// Directions w with weights [sr]: Σ weight g(w) approximates ∫ g dω.
struct Quadrature {
    std::vector<Vec3f> w;
    std::vector<double> weight;
    std::vector<double> pdf;  ///< density [1/sr] of the distribution of the directions
};

/// Distribution of directions that covers the features of a BRDF: uniform over the cap θ ≤ θmax, von Mises-Fisher lobes
/// about the mirror direction of a given direction, and one about the given direction itself (retroreflection).
class MirrorMixture {
  public:
    /// θmax in [rad], in (0, π/2].
    explicit MirrorMixture(double theta_max);

    /// Samples a direction given wv. A direction outside of the cap counts as a sample with value 0.
    Vec3d sample(Vec3d wv, double u0, double u1, double u2) const;
    /// Samples one component: 0 is the uniform one, the others are the lobes.
    Vec3d sample_part(int part, Vec3d wv, double u1, double u2) const;
    static constexpr double chance(int i) { return i == 0 ? k_uniform : i == k_parts - 1 ? k_retro : k_mirror; }
    /// Density [1/sr] of `sample`; inside the cap at least `k_uniform` over the cap's solid angle.
    double pdf(Vec3d wl, Vec3d wv) const;
    bool contains(Vec3d w) const { return w.z >= cos_max_; }
    /// About `count` directions over the cap, given wv. Each component has its own Fibonacci lattice, uniform with
    /// respect to its density.
    Quadrature quadrature(Vec3d wv, int count) const;
    /// The points of one component's lattice.
    Quadrature quadrature_of_part(int part, Vec3d wv, int count) const;
    /// Samples a direction uniformly over the cap; `cap_pdf` is its density [1/sr].
    Vec3d sample_cap(double u1, double u2) const;
    double cap_pdf() const { return 1 / (2 * k_pi * (1 - cos_max_)); }

    static constexpr double k_uniform = 0.4;  ///< chance of the uniform component
    static constexpr std::array<double, 5> k_mirror_bandwidths{6, 40, 300, 3000, 30000};
    static constexpr double k_mirror = 0.11;  ///< chance of each lobe about the mirror direction
    static constexpr double k_retro = 1 - k_uniform - 5 * k_mirror, k_retro_bandwidth = 60;
    static constexpr int k_parts = 7;

  private:
    double cos_max_;
    std::array<double, 5> mirror_scale_;  ///< chance of each lobe over its integral [1/sr]
    double retro_scale_;
};

/// `points` with their weights times cosθ.
Quadrature with_cosines(Quadrature points);
/// About `count` directions over the cap θ ≤ θmax for the albedo of a view; the weights include cosθl. Below cosθv =
/// 0.3, where highlights are long and narrow, they are a product of Gauss-Legendre rules over cosθl and azimuth, whose
/// intervals grow from the viewer's cosine, the horizon and the plane of incidence; otherwise MirrorMixture has them.
/// The error is about 0.1 % at most for highlights of facets with a roughness α from 0.005 on.
Quadrature albedo_quadrature(Vec3d wv, double theta_max, int count);
/// Σ weight f of each channel, without values that are not finite.
std::array<double, 3> weighted_sum(std::span<const Rgb> f, std::span<const double> weight);

/// True if the sine of the angle between wv and the plane of wl and the normal is at most 0.01: half a degree.
bool is_in_plane(Vec3f wl, Vec3f wv);

/// Three orthonormal axes.
struct Frame {
    Vec3d x, y, z;
    /// The vector with coordinates w in the frame.
    Vec3d from(Vec3d w) const { return w.x * x + w.y * y + w.z * z; }
    /// The coordinates of w in the frame.
    Vec3d to(Vec3d w) const { return {dot(w, x), dot(w, y), dot(w, z)}; }
};
/// The frame about the unit vector z with x perpendicular to `up`; with any x if they are parallel.
inline Frame frame_about(Vec3d z, Vec3d up) {
    Vec3d x = cross(up, z);
    if (dot(x, x) < 1e-12) x = cross(Vec3d{1, 0, 0}, z);
    x = normalize(x);
    return {x, cross(z, x), z};
}
/// The frame about the unit vector z with some x.
inline Frame frame_about(Vec3d z) { return frame_about(z, std::abs(z.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}); }

SRBF_END
