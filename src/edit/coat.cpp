// A surface under a clear layer.
#include <Eigen/Dense>
#include <memory>
#include <utility>

#include "brdf/directions.h"
#include "brdf/values.h"
#include "edit/lobes.h"
#include "srbf/kernel.h"

namespace SRBF_NAMESPACE {
namespace {

/// The values of the rough interface itself: GGX facets with Fresnel's reflectance.
double interface_value(const Coat& coat, Vec3d wl, Vec3d wv) {
    const Vec3d sum = wl + wv;
    return Kernel<double>::ggx_facets(wl, wv, coat.roughness) *
           Kernel<double>::dielectric_reflectance(0.5 * std::sqrt(dot(sum, sum)), coat.ior);
}

/// Rings of directions between equal steps of the polar angle.
struct Rings {
    static constexpr int k_count = 32;
    static double angle(int ring) { return (ring + 0.5) * (k_pi / 2) / k_count; }
    /// ∫ cosθ dω over a ring.
    static double projected(int ring) {
        const auto squared_sine = [](int edge) {
            return elementary::square(elementary::sin(edge * (k_pi / 2) / k_count));
        };
        return k_pi * (squared_sine(ring + 1) - squared_sine(ring));
    }
    /// The two rings nearest to a direction, and the fraction t of the second.
    struct RingPosition {
        int first;
        double t;
        explicit RingPosition(double cosine) {
            const double position = std::clamp(elementary::acos(std::min(cosine, 1.0)) * k_count / (k_pi / 2) - 0.5,
                                               0.0, double(k_count - 1));
            first = std::min(int(position), k_count - 2);
            t = position - first;
        }
    };
};

/// The paths of light through a coat.
class Layer {
  public:
    Layer(const Evaluate& base, const Coat& coat) : coat_(coat) {
        for (int ring = 0; ring < Rings::k_count; ++ring) passed_.push_back(transmitted_at(Rings::angle(ring)));
        Harmonics base_harmonics = harmonics(base);
        // Light that the base reflects returns from the interface, and is reflected again: B R B + B R B R B + .. Each
        // return rotates the direction to the light by half a turn.
        Eigen::VectorXd returned(Rings::k_count);
        for (int ring = 0; ring < Rings::k_count; ++ring)
            returned[ring] = Rings::projected(ring) * (1 - escaping(elementary::cos(Rings::angle(ring))));
        for (std::size_t m = 0; m < k_harmonics; ++m)
            for (std::size_t c = 0; c < 3; ++c) {
                const Eigen::MatrixXd& once = base_harmonics[m][c];
                const Eigen::MatrixXd repeated = (m % 2 ? -1.0 : 1.0) * once * returned.asDiagonal();
                const Eigen::MatrixXd remaining = Eigen::MatrixXd::Identity(Rings::k_count, Rings::k_count) - repeated;
                repeated_[m][c] = (m ? 2 : 1) * remaining.partialPivLu().solve(repeated * once);
            }
    }

    /// The direction below the interface.
    Vec3d refracted(Vec3d w) const {
        const double n = coat_.ior, x = w.x / n, y = w.y / n;
        return {x, y, std::sqrt(1 - x * x - y * y)};
    }
    /// The value of the coated surface, if the base has the value `below` at the refracted directions.
    Rgb value(Vec3d l, Vec3d v, const Rgb& below) const {
        const double n = coat_.ior, reflected = interface_value(coat_, l, v);
        const double passed = transmitted(l.z) * transmitted(v.z) / (n * n);
        const double cosine_l = refracted(l).z, cosine_v = refracted(v).z;
        const double power = 0.5 * (1 / cosine_l + 1 / cosine_v);
        const std::array<double, 3> repeated =
            repeated_at(l, v, Rings::RingPosition(cosine_l), Rings::RingPosition(cosine_v));
        Rgb f;
        for (int c = 0; c < 3; ++c) {
            const double tint = coat_.tint[c] < 1 ? elementary::pow(std::max(double(coat_.tint[c]), 1e-6), power) : 1;
            f[c] = float(reflected + passed * tint * std::max(double(below[c]) + repeated[std::size_t(c)], 0.0));
        }
        return f;
    }

  private:
    /// Matrices between rings, for each channel: a function of two polar angles and of a difference of azimuths φ is
    /// Σ_m cos(mφ) times its harmonics, times 2 except for m = 0.
    static constexpr std::size_t k_harmonics = 6;
    using Harmonics = std::array<std::array<Eigen::MatrixXd, 3>, k_harmonics>;

    std::array<double, 3> repeated_at(Vec3d l, Vec3d v, Rings::RingPosition at_l, Rings::RingPosition at_v) const {
        const double sines = std::sqrt((l.x * l.x + l.y * l.y) * (v.x * v.x + v.y * v.y));
        const double cosine = sines > 1e-9 ? (l.x * v.x + l.y * v.y) / sines : 1;
        std::array<double, 3> sum{};
        double previous = cosine, now = 1;  // cos((m − 1)φ), cos(mφ)
        for (const auto& term : repeated_) {
            for (std::size_t c = 0; c < 3; ++c) {
                const auto along = [&](int ring) {
                    return (1 - at_v.t) * term[c](ring, at_v.first) + at_v.t * term[c](ring, at_v.first + 1);
                };
                sum[c] += now * ((1 - at_l.t) * along(at_l.first) + at_l.t * along(at_l.first + 1));
            }
            previous = std::exchange(now, 2 * cosine * now - previous);
        }
        return sum;
    }
    /// The fraction of light from this angle that the interface does not reflect.
    double transmitted_at(double theta) const {
        constexpr int k_light_directions = 2048;
        const Vec3d v = spherical(theta, 0.0);
        const Quadrature light = MirrorMixture(k_pi / 2).quadrature(v, k_light_directions);
        double reflected = 0;
        for (std::size_t i = 0; i < light.w.size(); ++i)
            reflected += light.weight[i] * double(light.w[i].z) * interface_value(coat_, to_double(light.w[i]), v);
        return 1 - reflected;
    }
    double transmitted(double cosine) const {
        const Rings::RingPosition at(cosine);
        return (1 - at.t) * passed_[std::size_t(at.first)] + at.t * passed_[std::size_t(at.first) + 1];
    }
    /// The fraction of light from below that passes the interface: by reciprocity `passed_` at the refracted direction.
    double escaping(double cosine) const {
        const double n = coat_.ior, outside = 1 - n * n * (1 - cosine * cosine);
        return outside > 0 ? transmitted(std::sqrt(outside)) : 0;
    }
    /// The harmonics of the base, as if it depended on the difference of the azimuths alone.
    static Harmonics harmonics(const Evaluate& base) {
        constexpr int k_light_directions = 8192;
        const MirrorMixture mixture(k_pi / 2);
        Harmonics all;
        for (auto& term : all) term.fill(Eigen::MatrixXd::Zero(Rings::k_count, Rings::k_count));
        for (int ring_v = 0; ring_v < Rings::k_count; ++ring_v) {
            const Vec3d v = spherical(Rings::angle(ring_v), 0.0);
            const Quadrature light = mixture.quadrature(v, k_light_directions);
            const std::vector<Rgb> f = values_towards(base, light.w, to_float(v));
            for (std::size_t i = 0; i < f.size(); ++i) {
                const double theta = elementary::acos(double(light.w[i].z));
                const int ring_l = std::min(int(theta / (k_pi / 2) * Rings::k_count), Rings::k_count - 1);
                const double weight = light.weight[i] * double(light.w[i].z) / Rings::projected(ring_l);
                const double phi = elementary::atan2(double(light.w[i].y), double(light.w[i].x));
                for (std::size_t m = 0; m < k_harmonics; ++m)
                    for (int c = 0; c < 3; ++c)
                        all[m][std::size_t(c)](ring_l, ring_v) +=
                            weight * double(f[i][c]) * elementary::cos(double(m) * phi);
            }
        }
        for (auto& term : all)
            for (Eigen::MatrixXd& channel : term) channel = (0.5 * (channel + channel.transpose())).eval();
        return all;
    }

    Coat coat_;
    std::vector<double> passed_;  ///< light that passes the interface from outside, by rings
    Harmonics repeated_;          ///< reflected more than once below the interface [1/sr], times 2 but for m = 0
};

}  // namespace

Evaluate apply_coat(Evaluate base, const Coat& coat) {
    auto layer = std::make_shared<const Layer>(base, coat);
    return [layer, base = std::move(base)](std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
        std::vector<Vec3f> l(wl.size()), v(wl.size());
        for (std::size_t i = 0; i < wl.size(); ++i) {
            l[i] = to_float(layer->refracted(to_double(wl[i])));
            v[i] = to_float(layer->refracted(to_double(wv[i])));
        }
        base(l, v, f);
        for (std::size_t i = 0; i < wl.size(); ++i)
            f[i] = above_horizon(wl[i], wv[i]) ? layer->value(to_double(wl[i]), to_double(wv[i]), f[i]) : Rgb{};
    };
}

}  // namespace
