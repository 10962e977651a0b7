#include "extras/environment/lit_views.h"

#include <algorithm>

#include "base/r_sequence.h"
#include "brdf/colour.h"
#include "brdf/directions.h"
#include "sampling/elevation_nodes.h"

namespace SRBF_NAMESPACE {

namespace {

using Eigen::MatrixXd;

constexpr int k_lights_per_size = 256;  ///< number of lights of a size for each view
/// Errors are relative to the radiance, as visible errors are. The radiance includes a fraction of its luminance,
/// so that a channel that reflects little is not fitted as closely as the others.
constexpr double k_luminance_fraction = 0.3;
/// More lights of the least size, side by side along the plane of incidence, in which all lobes lie. A lobe sharper
/// than the BRDF would show a small lamp as a dot, which the other lights miss. These lights represent a band of
/// this solid angle [sr]; with 1, errors of pictures of metals are a tenth larger.
constexpr int k_lights_along = 120;
constexpr double k_band = 0.3;

/// Lights for a view, half of them in directions from which light is reflected, half of them in any direction. For
/// each size they estimate the mean, over directions, of the squared error under a light of radiance 1.
std::vector<KernelLight> place_lights(const PreparedBrdf& brdf, const Vec3f& wv,
                                      const std::vector<Reflected>& reflected) {
    std::vector<KernelLight> lights;
    RSequence<2> sphere_points;
    RSequence<1> reflected_points;
    for (std::size_t size = 0; size < k_light_sizes.size(); ++size)
        for (int i = 0; i < k_lights_per_size; ++i) {
            Vec3d centre;
            if (i % 2 == 0 && !reflected.empty()) {
                centre = reflected[std::size_t(reflected_points.next()[0] * double(reflected.size()))].w;
            } else {
                const auto u = sphere_points.next();
                const double c = 1 - 2 * u[0], s = std::sqrt(std::max(1 - c * c, 0.0)), phi = 2 * k_pi * u[1];
                centre = {s * elementary::cos(phi), s * elementary::sin(phi), c};
            }
            const double density = 0.5 * pdf(brdf, to_float(centre), wv) + 0.5 / (4 * k_pi);
            lights.push_back({size, centre, 1 / std::sqrt(density * k_lights_per_size)});
        }
    for (int i = 0; i < k_lights_along; ++i) {
        const double angle = k_pi * ((i + 0.5) / k_lights_along - 0.5);
        lights.push_back({0, {elementary::sin(angle), 0, elementary::cos(angle)}, std::sqrt(k_band / k_lights_along)});
    }
    return lights;
}

/// Samples of the reflected light as columns, for compilers that vectorise loops over them: directions, k_view_samples
/// times the density, and half of its product with the weight.
struct ReflectedBlock {
    static constexpr std::size_t k_size = 8;
    std::array<double, k_size> x{}, y{}, z{}, densities{}, r{}, g{}, b{};
};
std::vector<ReflectedBlock> blocks_of(const std::vector<Reflected>& reflected) {
    constexpr std::size_t n = ReflectedBlock::k_size;
    std::vector<ReflectedBlock> blocks((reflected.size() + n - 1) / n);
    for (std::size_t i = 0; i < reflected.size(); ++i) {
        const auto& [w, weight, density] = reflected[i];
        auto& [x, y, z, densities, r, g, b] = blocks[i / n];
        const std::size_t j = i % n;
        densities[j] = k_view_samples * density;
        const Vec3d part = 0.5 * densities[j] * weight;
        x[j] = w.x;
        y[j] = w.y;
        z[j] = w.z;
        r[j] = part.x;
        g[j] = part.y;
        b[j] = part.z;
    }
    return blocks;
}

/// ∫ K(size, centre · w) f cosθ dω from samples of the BRDF and of the light, combined with the balance heuristic
/// (Veach & Guibas 1995): samples of the BRDF alone rarely hit a small light, and their noise would be fitted.
Vec3d radiance_under(const KernelLight& light, const AveragedBrdf& brdf, const Vec3f& wv,
                     const std::vector<ReflectedBlock>& reflected) {
    const auto& [kernel, samples] = light_kernels()[light.size];
    const Vec3d c = light.centre;
    ReflectedBlock sums;
    for (const auto& [x, y, z, densities, r, g, b] : reflected)
        for (std::size_t j = 0; j < ReflectedBlock::k_size; ++j) {
            // An isotropic BRDF is symmetric about the plane of incidence.
            const double along = x[j] * c.x + z[j] * c.z, across = y[j] * c.y;
            const double balanced =
                kernel.over_densities(along + across, along - across, densities[j], k_light_samples);
            sums.r[j] += balanced * r[j];
            sums.g[j] += balanced * g[j];
            sums.b[j] += balanced * b[j];
        }
    Vec3d sum{};
    for (std::size_t j = 0; j < ReflectedBlock::k_size; ++j) sum = sum + Vec3d{sums.r[j], sums.g[j], sums.b[j]};
    const Frame axes = frame_about(light.centre);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const Vec3f w = to_float(axes.from(samples[i].w));
        if (!(w.z > 0)) continue;
        const auto [f, density] = brdf.at(int(i), w, wv);
        if (!is_finite(f)) continue;  // not measured
        const double scale =
            kernel.over_densities(samples[i].w.z, k_view_samples * density, k_light_samples) * double(w.z);
        sum = sum + scale * Vec3d{double(f.r), double(f.g), double(f.b)};
    }
    return sum;
}

/// See ExtendedLight::width.
float width_of(const Vec3d& albedo, const std::vector<Reflected>& reflected) {
    double largest = 1e-9;
    for (const auto& [w, weight, density] : reflected)
        largest = std::max(largest, k_view_samples * density * (weight.x + weight.y + weight.z));
    return float((albedo.x + albedo.y + albedo.z) / largest);
}

/// The weights of errors of R, G, B for this radiance.
Vec3d error_weights(const Vec3d& radiance) {
    const double luminance_part =
        k_luminance_fraction * double(luminance(Rgb{float(radiance.x), float(radiance.y), float(radiance.z)}));
    const auto weight = [&](double channel) {
        return 1 / std::max((1 - k_luminance_fraction) * channel + luminance_part, 1e-9);
    };
    return {weight(radiance.x), weight(radiance.y), weight(radiance.z)};
}

/// Sets the light that the view reflects: its albedo, and the radiance under each light.
void set_reflected(LitView& view, const Vec3d& total, const MatrixXd& radiances) {
    view.albedo = {float(total.x), float(total.y), float(total.z)};
    view.weight.resize(radiances.rows(), 3);
    for (Eigen::Index i = 0; i < radiances.rows(); ++i) {
        const Vec3d sum{radiances(i, 0), radiances(i, 1), radiances(i, 2)};
        const Vec3d weight = view.lights[std::size_t(i)].root_weight * error_weights(sum + k_ambient * total);
        view.weight.row(i) << weight.x, weight.y, weight.z;
    }
    view.radiance = view.weight.cwiseProduct(radiances);
}

}  // namespace

std::vector<Reflected> sample_reflected(const AveragedBrdf& brdf, const Vec3f& wv) {
    std::vector<Reflected> reflected;
    RSequence<3> numbers;
    for (int i = 0; i < k_view_samples; ++i) {
        const auto u = numbers.next();
        const LightSample light = brdf.sample(i, wv, {float(u[0]), float(u[1])}, float(u[2]));
        if (!(light.pdf > 0)) continue;
        const Vec3d weight{light.weight.r, light.weight.g, light.weight.b};
        reflected.push_back({to_double(light.wl), 1.0 / k_view_samples * weight, double(light.pdf)});
    }
    return reflected;
}

MatrixXd radiances_of(const LitView& view, const AveragedBrdf& brdf, const std::vector<Reflected>& reflected) {
    MatrixXd radiances(Eigen::Index(view.lights.size()), 3);
    const auto blocks = blocks_of(reflected);
    for (std::size_t i = 0; i < view.lights.size(); ++i) {
        const Vec3d sum = radiance_under(view.lights[i], brdf, to_float(view.wv), blocks);
        radiances.row(Eigen::Index(i)) << sum.x, sum.y, sum.z;
    }
    return radiances;
}
LitView lit_view(const AveragedBrdf& brdf, double cosine) {
    const Vec3d wv{std::sqrt(1 - cosine * cosine), 0, cosine};
    const std::vector<Reflected> reflected = sample_reflected(brdf, to_float(wv));
    LitView view{wv, {}, 0, place_lights(brdf.brdf(), to_float(wv), reflected), {}, {}};
    const Rgb whole_albedo = albedo(brdf.brdf(), float(cosine));
    const Vec3d total{whole_albedo.r, whole_albedo.g, whole_albedo.b};
    view.width = width_of(total, reflected);
    set_reflected(view, total, radiances_of(view, brdf, reflected));
    return view;
}

double fitted_cosine(std::size_t view) { return std::clamp(ExtendedLight::cosine(int(view)), 1e-4, 0.9999); }

}  // namespace
