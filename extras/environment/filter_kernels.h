// The kernels of filtered maps, and lights of their shapes seen through them.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "srbf/elementary.h"
#include "srbf/extended_light.h"

namespace SRBF_NAMESPACE {

/// GGX's kernel at a level of a filtered map. The first level is the environment itself, except for a kernel too
/// narrow to be resolved. With a = α² = r⁴ it is scale c / (1 + a − (1 − a) c)², c > 0.
class LevelKernel {
  public:
    explicit LevelKernel(double roughness) : a_(elementary::square(elementary::square(std::max(roughness, 0.01)))) {
        const double b = 1 - a_;
        const double integral =
            b < 1e-4 ? 1.0 / 8 : ((1 + a_) / (2 * a_) - 1 + elementary::log(2 * a_ / (1 + a_))) / (b * b);
        scale_ = 1 / (2 * k_pi * integral);
    }
    double operator()(double c) const { return c > 0 ? scale_ * c / elementary::square(1 + a_ - (1 - a_) * c) : 0; }
    /// K / (other + count D) for a factor of the balance heuristic, where D, a density over all directions that is high
    /// where K is, is (a / π) (1 + a − (1 − a) c)⁻².
    double over_densities(double c, double other, double count) const {
        return scale_ * std::max(c, 0.0) / densities(c, other, count);
    }
    /// The sum of `over_densities` at two cosines, with one division.
    double over_densities(double c0, double c1, double other, double count) const {
        const double D0 = densities(c0, other, count), D1 = densities(c1, other, count);
        return 0.5 * scale_ * ((c0 + std::abs(c0)) * D1 + (c1 + std::abs(c1)) * D0) / (D0 * D1);  // without branches
    }
    /// The cosine to the axis within which the given fraction of D lies.
    double cosine(double fraction) const { return (1 - fraction - a_ * fraction) / (1 - fraction + a_ * fraction); }

  private:
    /// (other + count D) (1 + a − (1 − a) c)²
    double densities(double c, double other, double count) const {
        return other * elementary::square(1 + a_ - (1 - a_) * c) + count * a_ / k_pi;
    }
    double a_, scale_ = 0;
};

/// A direction in the frame of the kernel's axis z, and its weight.
struct KernelSample {
    Vec3d w;
    double weight;
};

/// The sizes of the lights used by the fit, as roughnesses of K, whose half width is approximately 2 r² radians:
/// from 1.6 degrees, which a picture of a sphere 128 pixels wide resolves, to the cosine.
inline constexpr std::array<double, 6> k_light_sizes{0.12, 0.25, 0.4, 0.6, 0.8, 1};
inline constexpr int k_light_samples = 64;  ///< number of samples of a light's emission

/// K of a light, and samples of its density over all directions.
struct LightKernel {
    LevelKernel kernel;
    std::vector<KernelSample> samples;
    explicit LightKernel(double roughness);
};
/// The kernels of `k_light_sizes`.
const std::vector<LightKernel>& light_kernels();

/// ∫ K(roughness, a · w) K(k_light_sizes[size], b · w) dω as a function of the angle between a and b.
class BlurredKernels {
  public:
    BlurredKernels(MapLevels levels, int threads);
    /// The value, linear between levels, with its derivatives by roughness and by the cosine between the axes.
    struct Value {
        double value, by_roughness, by_cosine;
    };
    Value at(std::size_t size, double roughness, double cosine) const;

  private:
    static constexpr std::size_t k_levels = ExtendedLight::k_levels, k_angles = 129;
    MapLevels levels_;
    std::vector<double> values_;
};

}  // namespace
