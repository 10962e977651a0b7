// Monte Carlo simulation of a rough dielectric coat on a material.
#pragma once
#include "brdf/directions.h"
#include "brdf/values.h"
#include "srbf/kernel.h"
#include "srbf/models/ggx.h"
#include "statistics.h"

namespace srbf {

/// Random walks of light between the facets of the interface and the material. The interface is the random surface of
/// Heitz et al., "Multiple-Scattering Microfacet BSDFs with the Smith Model", 2016, so that light that meets it several
/// times is not lost. The material is Lambert and one lobe of GGX.
class MicrosurfaceWalk {
  public:
    MicrosurfaceWalk(const GgxModel& base, double roughness, double ior) : base_(base), alpha_(roughness), ior_(ior) {}

    struct Path {
        Vec3d direction;  ///< of the light, away from the surface
        Vec3d weight;     ///< R, G, B; 0: absorbed
    };
    /// A path from the viewer to the light.
    Path walk(Vec3d wv, std::mt19937_64& random) const {
        Vec3d weight{1, 1, 1}, w = scatter_at_interface(wv, random);
        for (int bounce = 0; w.z < 0; ++bounce) {
            const Vec3d up = scatter_at_base(-1.0 * w, weight, random);
            if (!(up.z > 1e-6) || bounce == k_max_bounces) return {{0, 0, 1}, {}};
            w = scatter_at_interface(-1.0 * up, random);
        }
        return {w, weight};
    }

  private:
    static constexpr int k_max_bounces = 100;

    static Vec3d visible_normal(Vec3d w, double alpha, std::mt19937_64& random) {
        const Vec3d seen = normalize(Vec3d{alpha * w.x, alpha * w.y, w.z});
        const double phi = 2 * k_pi * uniform(random), z = (1 - uniform(random)) * (1 + seen.z) - seen.z,
                     radius = std::sqrt(std::max(1 - z * z, 0.0));
        const Vec3d n{seen.x + radius * std::cos(phi), seen.y + radius * std::sin(phi), seen.z + z};
        return normalize(Vec3d{alpha * n.x, alpha * n.y, n.z});
    }
    /// Smith's Λ of GGX, also for directions that point downwards.
    static double lambda(Vec3d w, double alpha) {
        const double slope = alpha * std::sqrt(std::max(1 - w.z * w.z, 0.0)) / w.z;
        return 0.5 * (std::copysign(std::sqrt(1 + slope * slope), w.z) - 1);
    }
    /// The height where light along w, now at a height of −1..1, meets the surface next; infinite if it leaves.
    double next_height(Vec3d w, double height, std::mt19937_64& random) const {
        const double u = uniform(random), below = 0.5 * (height + 1);
        if (w.z < -0.9999) return 2 * u * below - 1;
        if (w.z > 0.9999 || (w.z > 0 && u > 1 - std::pow(below, lambda(w, alpha_)))) return INFINITY;
        if (std::abs(w.z) < 1e-4) return height;
        return std::clamp(2 * below / std::pow(1 - u, 1 / lambda(w, alpha_)) - 1, -1.0, 1.0);
    }
    /// The next direction of light that comes from w, on either side of the interface.
    Vec3d scatter_at_interface(Vec3d w, std::mt19937_64& random) const {
        const double first_side = w.z > 0 ? 1 : -1, ior = w.z > 0 ? ior_ : 1 / ior_;
        Vec3d direction{-w.x, -w.y, -std::abs(w.z)};  // in the frame of the side where the walk begins
        double height = 1, side = 1;                  // 1 on that side, −1 on the other
        for (int bounce = 0; bounce < k_max_bounces; ++bounce) {
            const Vec3d along{direction.x, direction.y, side * direction.z};
            height = side * next_height(along, side * height, random);
            if (std::isinf(height)) return {direction.x, direction.y, first_side * direction.z};
            const Vec3d back = -1.0 * along, m = visible_normal(back, alpha_, random);
            const double cosine = std::max(dot(back, m), 1e-6), eta = side > 0 ? ior : 1 / ior,
                         squared = 1 - (1 - cosine * cosine) / (eta * eta);
            // The fraction from inside is that from outside along the refracted direction.
            const double fraction = squared <= 0 ? 1
                                    : eta > 1    ? Kernel<double>::dielectric_reflectance(cosine, eta)
                                                 : Kernel<double>::dielectric_reflectance(std::sqrt(squared), 1 / eta);
            const bool reflects = uniform(random) < fraction;
            const Vec3d next = normalize(reflects ? 2 * cosine * m - back
                                                  : (-1 / eta) * back + (cosine / eta - std::sqrt(squared)) * m);
            direction = {next.x, next.y, side * next.z};
            if (!reflects) side = -side;
        }
        return {0, 0, -first_side};
    }
    /// The direction of light from w after the material scatters it, by Lambert or by facets.
    Vec3d scatter_at_base(Vec3d w, Vec3d& weight, std::mt19937_64& random) const {
        const bool is_diffuse = luminance(base_.diffuse) > 0;
        const double diffuse_probability = is_diffuse ? 0.5 : 0;
        const auto times = [&](const Rgb& colour, double factor) {
            weight = {weight.x * double(colour.r) * factor, weight.y * double(colour.g) * factor,
                      weight.z * double(colour.b) * factor};
        };
        if (uniform(random) < diffuse_probability) {
            times(base_.diffuse, 1 / diffuse_probability);
            const double u = uniform(random), phi = 2 * k_pi * uniform(random);
            return {std::sqrt(u) * std::cos(phi), std::sqrt(u) * std::sin(phi), std::sqrt(1 - u)};
        }
        const GgxModel::Lobe& lobe = base_.lobes[0];
        const auto alpha = double(lobe.roughness);
        const Vec3d h = visible_normal(w, alpha, random), up = 2 * dot(w, h) * h - w;
        if (!(up.z > 1e-6)) return up;
        const double lambda_w = lambda(w, alpha), masked = (1 + lambda_w) / (1 + lambda_w + lambda(up, alpha));
        Rgb fresnel = mixed(lobe.f0, {lobe.f90, lobe.f90, lobe.f90}, float(std::pow(1 - dot(w, h), 5)));
        times(fresnel, masked / (1 - diffuse_probability));
        return up;
    }

    GgxModel base_;
    double alpha_, ior_;
};

/// The BRDF estimated from paths: `approximation` times the ratio of the simulated to the approximated light in each
/// bin of directions. Bins are equal steps of sin²θ of viewer and light and of the azimuth between them. The BRDF is
/// symmetrized.
class SimulatedCoat {
  public:
    SimulatedCoat(const MicrosurfaceWalk& coat, Evaluate approximation, int paths)
        : approximation_(std::move(approximation)) {
        std::mt19937_64 random(1);
        for (int view = 0; view < k_views; ++view) {
            const Vec3d wv = direction((view + 0.5) / k_views, 0);
            std::vector<Vec3d> sum(std::size_t(k_rings * k_azimuths));
            for (int i = 0; i < paths; ++i) {
                const MicrosurfaceWalk::Path path = coat.walk(wv, random);
                const Vec3d w = path.direction;
                Vec3d& bin =
                    sum[index(std::min(int((1 - w.z * w.z) * k_rings), k_rings - 1),
                              std::min(int(std::abs(std::atan2(w.y, w.x)) / k_pi * k_azimuths), k_azimuths - 1))];
                bin = bin + (1.0 / paths) * path.weight;
            }
            for (int ring = 0; ring < k_rings; ++ring)
                for (int azimuth = 0; azimuth < k_azimuths; ++azimuth) {
                    const Vec3d expected = mean_of_approximation(wv, ring, azimuth), found = sum[index(ring, azimuth)];
                    ratio_.push_back({found.x / expected.x, found.y / expected.y, found.z / expected.z});
                }
        }
    }
    Rgb value(Vec3f wl, Vec3f wv) const {
        std::array<Rgb, 1> f;
        approximation_(std::span(&wl, 1), std::span(&wv, 1), f);
        if (!(wl.z > 0 && wv.z > 0)) return f[0];
        const Vec3d l = to_double(wl), v = to_double(wv), factor = 0.5 * (ratio(l, v) + ratio(v, l));
        return {f[0].r * float(factor.x), f[0].g * float(factor.y), f[0].b * float(factor.z)};
    }

  private:
    static constexpr int k_views = 10, k_rings = 12, k_azimuths = 12;
    static std::size_t index(int ring, int azimuth) { return std::size_t(ring * k_azimuths + azimuth); }
    static Vec3d direction(double squared_sine, double phi) {
        const double sine = std::sqrt(squared_sine);
        return {sine * std::cos(phi), sine * std::sin(phi), std::sqrt(1 - squared_sine)};
    }
    /// The fraction of light that `approximation_` reflects into a bin.
    Vec3d mean_of_approximation(Vec3d wv, int ring, int azimuth) const {
        constexpr int k_points = 8;
        std::vector<Vec3f> wl;
        for (int i = 0; i < k_points * k_points; ++i)
            wl.push_back(to_float(direction((ring + (i / k_points + 0.5) / k_points) / k_rings,
                                            k_pi * (azimuth + (i % k_points + 0.5) / k_points) / k_azimuths)));
        const std::vector<Vec3f> same(wl.size(), to_float(wv));
        std::vector<Rgb> f(wl.size());
        approximation_(wl, same, f);
        Vec3d sum{};
        for (const Rgb& x : f) sum = sum + Vec3d{double(x.r), double(x.g), double(x.b)};
        return (k_pi / (k_rings * k_azimuths) / double(f.size())) * sum;
    }
    Vec3d ratio(Vec3d l, Vec3d v) const {
        const double sines = std::sqrt((1 - l.z * l.z) * (1 - v.z * v.z));
        const double phi = sines > 1e-9 ? std::acos(std::clamp((l.x * v.x + l.y * v.y) / sines, -1.0, 1.0)) : 0;
        const std::array<double, 3> at{(1 - v.z * v.z) * k_views - 0.5, (1 - l.z * l.z) * k_rings - 0.5,
                                       phi / k_pi * k_azimuths - 0.5};
        constexpr std::array<int, 3> count{k_views, k_rings, k_azimuths};
        Vec3d sum{};
        for (int corner = 0; corner < 8; ++corner) {
            double weight = 1;
            std::size_t i = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const double x = std::clamp(at[k], 0.0, count[k] - 1.0);
                const int below = std::min(int(x), count[k] - 2), step = corner >> k & 1;
                weight *= step ? x - below : 1 - (x - below);
                i = i * std::size_t(count[k]) + std::size_t(below + step);
            }
            sum = sum + weight * ratio_[i];
        }
        return sum;
    }

    Evaluate approximation_;
    std::vector<Vec3d> ratio_;
};

}  // namespace srbf
