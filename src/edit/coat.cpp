// A surface under a clear layer.
#include <algorithm>
#include <array>
#include <cmath>

#include "brdf/directions.h"
#include "brdf/values.h"
#include "edit/reshape.h"
#include "srbf/kernel.h"

namespace srbf {
namespace {

/// A function of the cosine, linear between equal steps.
template <typename Value> struct OfCosine {
    static constexpr int k_steps = 64;
    std::array<Value, k_steps + 1> at{};

    template <typename F> explicit OfCosine(const F& f) {
        for (int i = 0; i <= k_steps; ++i) at[std::size_t(i)] = f(std::max(double(i) / k_steps, 1e-3));
    }
    Value operator()(double cosine) const {
        const double x = std::clamp(cosine, 0.0, 1.0) * k_steps;
        const auto i = std::min(std::size_t(x), std::size_t(k_steps - 1));
        return mixed(at[i], at[i + 1], float(x - double(i)));
    }
};

/// The values of the rough interface itself: GGX facets with Fresnel's reflectance.
double interface_value(const Coat& coat, Vec3d wl, Vec3d wv) {
    const Vec3d sum = wl + wv;
    return Kernel<double>::ggx_facets(wl, wv, coat.roughness) *
           Kernel<double>::dielectric_reflectance(0.5 * std::sqrt(dot(sum, sum)), coat.ior);
}

/// ∫ f(l, v) weight(l) cosθl dωl for v of this cosine.
template <typename F> Rgb reflected(double cosine, int count, const F& f) {
    static const MirrorMixture mixture(k_pi / 2);
    const Vec3d v{std::sqrt(1 - cosine * cosine), 0, cosine};
    const Quadrature light = mixture.quadrature(v, count);
    std::array<double, 3> sum{};
    const std::vector<Rgb> values = f(light.w, v);
    for (std::size_t i = 0; i < values.size(); ++i)
        for (int c = 0; c < 3; ++c)
            sum[std::size_t(c)] += light.weight[i] * double(light.w[i].z) * double(values[i][c]);
    return {float(sum[0]), float(sum[1]), float(sum[2])};
}

/// What a coat does to light: all of it depends on one direction only.
class Layer {
  public:
    Layer(const Evaluate& base, const Coat& coat)
        : coat_(coat),
          through_([&](double cosine) {
              return reflected(cosine, 2048, [&](std::span<const Vec3f> l, Vec3d v) {
                  std::vector<Rgb> f;
                  for (const Vec3f& w : l) {
                      const auto value = float(interface_value(coat, to_double(w), v));
                      f.push_back({value, value, value});
                  }
                  return f;
              });
          }),
          back_([&](double cosine) {
              return reflected(cosine, 4096, [&](std::span<const Vec3f> l, Vec3d v) {
                  std::vector<Rgb> f = values_towards(base, l, to_float(v));
                  for (std::size_t i = 0; i < f.size(); ++i) f[i] = times(f[i], 1 - escaping(double(l[i].z)));
                  return f;
              });
          }),
          albedo_([&](double cosine) {
              return reflected(cosine, 4096, [&](std::span<const Vec3f> l, Vec3d v) {
                  return values_towards(base, l, to_float(v));
              });
          }) {
        // Means over diffuse light, ∫ 2 cosθ dcosθ.
        Rgb mean_albedo{};
        for (std::size_t i = 0; i < back_.at.size(); ++i) {
            const float weight = 2 * float(i) / float(elementary::square(back_.k_steps));
            for (int c = 0; c < 3; ++c)
                mean_back_[c] += weight * back_.at[i][c], mean_albedo[c] += weight * albedo_.at[i][c];
        }
        // K π (1 − r̄), with r̄ = K ā what diffuse light loses to the next bounce
        for (int c = 0; c < 3; ++c)
            series_[c] = mean_albedo[c] > 0
                             ? 1 / (float(k_pi) * (mean_back_[c] / mean_albedo[c]) * (1 - std::min(mean_back_[c], 0.99f)))
                             : 0;
    }

    /// The direction below the interface.
    Vec3d refracted(Vec3d w) const {
        const double n = coat_.ior, x = w.x / n, y = w.y / n;
        return {x, y, std::sqrt(1 - x * x - y * y)};
    }
    /// What passes the interface.
    double transmitted(double cosine) const { return 1 - double(through_(cosine).g); }
    Rgb value(Vec3d l, Vec3d v, const Rgb& below) const {
        const double n = coat_.ior, own = interface_value(coat_, l, v);
        const double passed = transmitted(l.z) * transmitted(v.z) / (n * n);
        const double cosine_l = refracted(l).z, cosine_v = refracted(v).z;
        const Rgb r = back_(cosine_l), s = back_(cosine_v);
        const double power = 0.5 * (1 / cosine_l + 1 / cosine_v);
        Rgb f;
        for (int c = 0; c < 3; ++c) {
            const double tint = coat_.tint[c] < 1 ? elementary::pow(std::max(double(coat_.tint[c]), 1e-6), power) : 1;
            f[c] = float(own + passed * tint * double(below[c] + r[c] * s[c] * series_[c]));
        }
        return f;
    }

  private:
    static Rgb times(const Rgb& f, double factor) {
        return {float(factor * double(f.r)), float(factor * double(f.g)), float(factor * double(f.b))};
    }
    /// The share that passes the interface from below: by reciprocity that of the refracted direction.
    double escaping(double cosine) const {
        const double n = coat_.ior, outside = 1 - n * n * (1 - cosine * cosine);
        return outside > 0 ? transmitted(std::sqrt(outside)) : 0;
    }

    Coat coat_;
    OfCosine<Rgb> through_;  ///< reflected by the interface, from outside
    OfCosine<Rgb> back_;     ///< reflected by the base and then by the interface, from below
    OfCosine<Rgb> albedo_;   ///< of the base
    Rgb mean_back_{}, series_{};
};

}  // namespace

Evaluate coated(Evaluate base, const Coat& coat) {
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

}  // namespace srbf
