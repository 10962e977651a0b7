#include "extras/environment/filter_kernels.h"

#include "base/parallel.h"
#include "base/r_sequence.h"

namespace SRBF_NAMESPACE {
namespace {

KernelSample direction_at(double cosine, double azimuth, double weight) {
    const double sine = std::sqrt(std::max(1 - cosine * cosine, 0.0));
    return {{sine * elementary::cos(azimuth), sine * elementary::sin(azimuth), cosine}, weight};
}
/// Directions that each represent an equal part of `density`, with weights that sum to 1. They cover only y > 0;
/// the other half is its mirror image.
std::vector<KernelSample> sample_kernel(const LevelKernel& kernel) {
    constexpr int k_rings = 64, k_per_ring = 16;
    std::vector<KernelSample> samples;
    double sum = 0;
    for (int i = 0; i < k_rings; ++i) {
        const double c = kernel.cosine((i + 0.5) / k_rings);
        if (!(c > 0)) continue;
        for (int j = 0; j < k_per_ring; ++j) {
            samples.push_back(direction_at(c, k_pi * (j + 0.5) / k_per_ring, c));
            sum += c;
        }
    }
    for (KernelSample& sample : samples) sample.weight /= sum;
    return samples;
}

double level_by_roughness(double r, MapLevels levels) {
    return (ExtendedLight::k_levels - 1) * (levels == MapLevels::root ? 0.5 / std::sqrt(r) : 2 * (1 - r));
}

}  // namespace

LightKernel::LightKernel(double roughness) : kernel(roughness) {
    RSequence<2> numbers;
    for (int i = 0; i < k_light_samples; ++i) {
        const auto u = numbers.next();
        samples.push_back(direction_at(kernel.cosine(u[0]), 2 * k_pi * u[1], 1));
    }
}
const std::vector<LightKernel>& light_kernels() {
    static const std::vector<LightKernel> kernels(k_light_sizes.begin(), k_light_sizes.end());
    return kernels;
}

BlurredKernels::BlurredKernels(MapLevels levels, int threads)
    : levels_(levels), values_(k_light_sizes.size() * k_levels * k_angles) {
    parallel_for(k_light_sizes.size() * k_levels, threads, [&](std::size_t i) {
        const double size = k_light_sizes[i / k_levels], roughness = roughness_of_level(double(i % k_levels), levels);
        const auto samples = sample_kernel(LevelKernel(std::min(size, roughness)));
        const LevelKernel wider(std::max(size, roughness));
        for (std::size_t angle = 0; angle < k_angles; ++angle) {
            const double u = double(angle) / (k_angles - 1), sine = u * u;  // sine of half the angle
            const double c = 1 - 2 * sine * sine, s = 2 * sine * std::sqrt(1 - sine * sine);
            double sum = 0;
            for (const KernelSample& sample : samples) sum += sample.weight * wider(s * sample.w.x + c * sample.w.z);
            values_[i * k_angles + angle] = sum;
        }
    });
}
BlurredKernels::Value BlurredKernels::at(std::size_t size, double roughness, double cosine) const {
    const double sine2 = std::clamp((1 - cosine) / 2, 1e-12, 1.0);  // squared sine of half the angle
    const double sine = std::sqrt(sine2), u = std::sqrt(sine);
    const double x = level_of_roughness(roughness, levels_), y = u * (k_angles - 1);
    const auto i = std::size_t(std::min(int(x), int(k_levels) - 2)),
               j = std::size_t(std::min(int(y), int(k_angles) - 2));
    const double s = x - double(i), t = y - double(j);
    const double* values = &values_[(size * k_levels + i) * k_angles + j];
    const double low = values[0] + t * (values[1] - values[0]),
                 high = values[k_angles] + t * (values[k_angles + 1] - values[k_angles]);
    const double slope_y = (1 - s) * (values[1] - values[0]) + s * (values[k_angles + 1] - values[k_angles]);
    // u⁴ = (1 − cosine) / 2
    return {low + s * (high - low), (high - low) * level_by_roughness(roughness, levels_),
            -slope_y * (k_angles - 1) / (8 * u * sine)};
}

double level_of_roughness(double r, MapLevels levels) {
    return (ExtendedLight::k_levels - 1) * (levels == MapLevels::root ? std::sqrt(r) : r * (2 - r));
}
double roughness_of_level(double level, MapLevels levels) {
    const double x = level / (ExtendedLight::k_levels - 1);
    return levels == MapLevels::root ? x * x : 1 - std::sqrt(1 - x);
}

float filter_kernel(float roughness, float cosine, MapLevels levels) {
    const double x = level_of_roughness(double(roughness), levels);
    const int below = std::min(int(x), ExtendedLight::k_levels - 2);
    const auto at_level = [&](int level) { return LevelKernel(roughness_of_level(level, levels))(double(cosine)); };
    return float(at_level(below) + (x - below) * (at_level(below + 1) - at_level(below)));
}

}  // namespace
