// Sets of directions and distributions of pairs of them: level 1.
#pragma once
#include <array>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "srbf/vec.h"

namespace srbf {

/// A double even in [0,1), the same on every machine.
inline double uniform(std::mt19937_64& random) { return double(random() >> 11) * 0x1p-53; }

/// Direction i of n of the Fibonacci set on the cap θ ≤ θmax [rad]: z = (i+½)/n (1−cos θmax) + cos θmax,
/// azimuth i times the golden angle π(3−√5). Each stands for the solid angle 2π(1−cos θmax)/n.
Vec3d fibonacci_direction(int i, int n, double theta_max);

/// All n of them.
std::vector<Vec3f> fibonacci_directions(int n, double theta_max);

/// The numbers of those of `directions`, at most 65,536 whose z does not fall, that are nearest to `w`, the nearest first,
/// of equally near ones the lower number first. As many as `nearest` takes; there are at least as many directions.
void find_nearest(std::span<const Vec3f> directions, Vec3f w, std::span<std::uint16_t> nearest);

/// How a square texture holds a function of direction.
enum class DirectionMap {
    cube,       ///< six faces +x, −x, +y, −y, +z, −z, each laid out as OpenGL's
    parabolic,  ///< one square, its point (s, t) in [−1, 1]² standing for (2s, 2t, 1−s²−t²) / (1+s²+t²)
};
/// Texels of a texture of `size` × `size` a face.
std::size_t texels(DirectionMap map, int size);
/// The direction at a texel's centre; texels by face, row t, column s.
Vec3f texel_direction(DirectionMap map, int size, std::size_t texel);
/// The texel that holds direction `w`; the parabolic map holds none below the horizon near −z, and gives one at its border.
std::size_t texel_of(DirectionMap map, int size, Vec3f w);

/// Directions and weights [sr]: Σ weight g(w) stands for ∫ g dω.
struct Quadrature {
    std::vector<Vec3f> w;
    std::vector<double> weight;
};

/// Directions about a given one that find a BRDF's features: even over the cap θ ≤ θmax, von Mises-Fisher
/// lobes about the mirror direction and one about the given direction itself (retroreflection).
class MirrorMixture {
  public:
    /// θmax in [rad], in (0, π/2].
    explicit MirrorMixture(double theta_max);

    /// A direction given wv; it may lie outside of the cap, and is then no sample (value 0) but counts as a draw.
    Vec3d sample(Vec3d wv, double u0, double u1, double u2) const;
    /// The same from one of the parts alone: 0 the even one, then the lobes.
    Vec3d sample_part(int part, Vec3d wv, double u1, double u2) const;
    static constexpr double share(int part) { return part == 0 ? k_even : part == k_parts - 1 ? k_retro : k_mirror; }
    /// Its density [1/sr]; at least `k_even` over the cap's solid angle inside of it.
    double pdf(Vec3d wl, Vec3d wv) const;
    bool contains(Vec3d w) const { return w.z >= cos_max_; }
    /// About `count` directions over the cap, given wv: each part by a Fibonacci lattice of its own, whose points lie evenly in
    /// its lobe.
    Quadrature quadrature(Vec3d wv, int count) const;
    /// A direction even over the cap, and its density.
    Vec3d sample_cap(double u1, double u2) const;
    double cap_pdf() const { return 1 / (2 * k_pi * (1 - cos_max_)); }

    static constexpr double k_even = 0.4;  ///< share of the even part
    static constexpr std::array<double, 5> k_mirror_bandwidths{6, 40, 300, 3000, 30000};
    static constexpr double k_mirror = 0.11;  ///< share of each lobe about the mirror direction
    static constexpr double k_retro = 1 - k_even - 5 * k_mirror, k_retro_bandwidth = 60;
    static constexpr int k_parts = 7;

  private:
    double cos_max_;
    std::array<double, 5> mirror_scale_;  ///< of each lobe its share over its integral [1/sr]
    double retro_scale_;
};

}  // namespace srbf
