#include "observe/observations.h"

#include <cmath>

#include "base/parallel.h"
#include "observe/pair_weights.h"
#include "observe/pairs.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

/// θv of the albedos [degrees], cosθv of those near the horizon, and the number of directions for each.
constexpr double k_albedo_angles[] = {0, 15, 30, 45, 60, 70, 75, 80, 85};
constexpr double k_horizon_cosines[] = {0.03, 0.01, 0.003};
constexpr int k_albedo_points = 4096;
/// The uncertainty of an albedo of a noisy table is this many standard deviations of its sum, or
/// `albedo_error_of_noise` if that is larger (docs/notes/noise.md).
constexpr double k_deviations_of_albedo = 0.1;
/// Noise is independent between samples, so that its sums need this many times as many directions as smooth values.
constexpr int k_finer_for_noise = 8;
/// A noisy table has samples of one azimuth at the normal. A view at this angle from the normal uses all azimuths.
constexpr double k_beside_normal_of_noise = 0.5 * k_degree;

/// The standard deviation of a sum of noisy values, √Σ w² |f − s|², where s is the smooth values.
double deviation_of_sum(const ObservedIntegral& albedo, std::span<const Rgb> smooth) {
    double square = 0;
    for (std::size_t i = 0; i < smooth.size(); ++i)
        if (is_finite(smooth[i]))
            square += elementary::square(albedo.weight[i] * double(luminance(albedo.f[i]) - luminance(smooth[i])));
    return std::sqrt(square);
}

/// The mean of f − s towards a view, weighted by cosθl, where f is the noisy values and s the smooth ones.
Rgb mean_of_noise(const Evaluate& f, const Evaluate& smooth, Vec3d wv, double theta_max) {
    const Quadrature points = MirrorMixture(theta_max).quadrature(wv, k_finer_for_noise * k_albedo_points);
    const std::vector<Rgb> noisy = values_towards(f, points.w, to_float(wv)),
                           smoothed = values_towards(smooth, points.w, to_float(wv));
    Vec3d sum{};
    double total = 0;
    for (std::size_t i = 0; i < noisy.size(); ++i) {
        if (!is_finite(noisy[i]) || !is_finite(smoothed[i])) continue;
        const double weight = points.weight[i] * points.w[i].z;
        total += weight;
        sum =
            sum + weight * Vec3d{double(noisy[i].r) - double(smoothed[i].r), double(noisy[i].g) - double(smoothed[i].g),
                                 double(noisy[i].b) - double(smoothed[i].b)};
    }
    if (total > 0) sum = (1 / total) * sum;
    return {float(sum.x), float(sum.y), float(sum.z)};
}

/// Replaces the values by smooth ones plus a constant that keeps their sum.
void smooth_values(ObservedIntegral& albedo, const Evaluate& f, const ObserveOptions& options, Vec3d wv,
                   double theta_max) {
    std::vector<Rgb> values = values_towards(options.smoothed, albedo.wl, to_float(wv));
    albedo.noise_unit =
        k_deviations_of_albedo * deviation_of_sum(albedo, values) / albedo_error_of_noise(options.noise);
    const Rgb noise = mean_of_noise(f, options.smoothed, wv, theta_max);
    for (Rgb& value : values)
        for (int c = 0; c < 3; ++c) value[c] = std::isfinite(value[c]) ? value[c] + noise[c] : 0;
    albedo.f = std::move(values);
}

/// The albedo of a view, over light directions to θmax.
ObservedIntegral observe_albedo(const Evaluate& f, const ObserveOptions& options, Vec3d wv, double theta_max) {
    Quadrature points = MirrorMixture(theta_max).quadrature(wv, k_albedo_points / int(options.fewer));
    std::vector<Rgb> values = values_towards(f, points.w, to_float(wv));
    // The noise of a sum is small, so that negative values of noisy tables are kept.
    for (Rgb& value : values)
        if (!options.smoothed) clamp_negative(value);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const bool valid = is_finite(values[i]);
        points.weight[i] *= valid ? double(points.w[i].z) : 0;
        if (!valid) values[i] = {};
    }
    ObservedIntegral albedo;
    albedo.wv.assign(points.w.size(), to_float(wv));
    albedo.wl = std::move(points.w);
    albedo.f = std::move(values);
    albedo.weight = std::move(points.weight);
    if (options.smoothed) smooth_values(albedo, f, options, wv, theta_max);
    return albedo;
}

}  // namespace

std::vector<ObservedIntegral> observe_albedos(const Evaluate& f, const ObserveOptions& options, double theta_max) {
    std::vector<double> angles;
    for (const double theta : k_albedo_angles)
        if (!(theta * k_degree > theta_max)) angles.push_back(theta * k_degree);
    const std::size_t steeper = angles.size();
    // A caller who asks for less than the default does not trust values beyond it.
    const bool trusts_all = !(theta_max < default_max_theta(options.objective));
    if (traits(options.objective).uses_pictures && options.horizon_albedos && trusts_all)
        for (const double cosine : k_horizon_cosines) angles.push_back(elementary::acos(cosine));
    std::vector<ObservedIntegral> albedos(angles.size());
    parallel_for(albedos.size(), options.threads, [&](std::size_t k) {
        // Isotropic data allow any azimuth; for other data the azimuths are spread.
        const double min = options.smoothed ? k_beside_normal_of_noise : 0;
        const Vec3d wv = spherical(std::max(angles[k], min), k_golden_angle * double(k));
        const bool at_horizon = k >= steeper;
        albedos[k] = observe_albedo(f, options, wv, at_horizon ? k_horizon_theta : theta_max);
        if (at_horizon) albedos[k].min_unit = k_horizon_albedo;
        albedos[k].in_search = k % 2 == 0;
    });
    // The last albedo is a bound. It would act as a target for tables that diverge beyond their last measured angle.
    if (albedos.size() > steeper && luminance(albedos.back()) > 1) albedos.pop_back();
    return albedos;
}

}  // namespace
