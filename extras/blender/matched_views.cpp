#include "extras/blender/matched_views.h"

#include <limits>

#include "base/parallel.h"
#include "base/weighted_quantile.h"
#include "brdf/directions.h"
#include "brdf/values.h"
#include "errors/itp.h"
#include "errors/sphere.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

constexpr double k_last_view = 88.5 * k_degree, k_last_light = 88.9 * k_degree;
constexpr int k_light_points = 440;   ///< directions to the light of a view, and more of others
constexpr int k_further_points = 13;  ///< times 0 to 6, so that neighbouring views have other directions
/// A closure is blurred to this fraction of a direction's solid angle: enough that none hides between directions.
constexpr double k_blur = 0.1;
constexpr double k_grazing_weight = 0.06;  ///< a term of a view's weight, beside sin θv cos θv, its fraction of a disc
/// Weights of directional lights are the density of the points to this power; −1 would make them uniform over the
/// hemisphere, and 0 prefer highlights.
constexpr double k_density_power = -0.6;
/// Weights are divided by the sine of the phase, at least this, so that all phases of the light count.
constexpr double k_min_sine = 0.1;
constexpr int k_azimuths = 6;  ///< around the viewer, of points of a sphere under each extended light
/// Azimuth between neighbouring views [rad], so that a BRDF that is not isotropic is seen from all around.
constexpr double k_turn_of_views = 2.4;

/// White light from all around, and lamps of several sizes.
std::vector<Lighting> extended_lights() {
    const auto grey = [](double x) { return Rgb{float(x), float(x), float(x)}; };
    const auto lamp = [&](double phase, double radius, double power) {
        return Lighting::Source{spherical(phase * k_degree, 0.0), radius, grey(power)};
    };
    const auto surrounded = [&](double x, std::vector<Lighting::Source> lamps) {
        return Lighting{"", grey(x), grey(x), grey(x), std::move(lamps)};
    };
    return {surrounded(1, {}), surrounded(0.05, {lamp(35, 20, 8), lamp(125, 12, 25)}),
            surrounded(0.3, {lamp(65, 9, 30)}), surrounded(0.08, {lamp(90, 25, 6)})};
}

/// A view without pixels. Directions without a measurement are left out. If a channel reflects more than all light, as
/// in tables towards the horizon, its values are divided by its albedo.
MatchedView matched_view(const Evaluate& f, double theta, double azimuth, int count) {
    MatchedView view{theta,
                     elementary::sin(theta) * elementary::cos(theta) + k_grazing_weight,
                     {-elementary::sin(theta), 0, elementary::cos(theta)},
                     {},
                     {},
                     {},
                     {}};
    const Quadrature points = MirrorMixture(k_last_light).quadrature(view.wv, count);
    const double c = elementary::cos(azimuth), s = elementary::sin(azimuth);
    const auto turned = [&](Vec3d w) { return to_float(Vec3d{c * w.x - s * w.y, s * w.x + c * w.y, w.z}); };
    std::vector<Vec3f> wl;
    for (const Vec3f w : points.w) wl.push_back(turned(to_double(w)));
    const std::vector<Rgb> values = values_towards(f, wl, turned(view.wv));
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!is_finite(values[i])) continue;
        const Vec3d l = to_double(points.w[i]);
        Rgb radiance = non_negative(values[i]);
        for (int channel = 0; channel < 3; ++channel) radiance[channel] *= float(l.z);
        view.lights.emplace_back(l, view.wv, k_blur * points.weight[i]);
        view.pdf.push_back(1 / points.weight[i]);
        view.radiance.push_back(radiance);
    }
    for (int channel = 0; channel < 3; ++channel) {
        double albedo = 0;
        for (std::size_t i = 0; i < view.lights.size(); ++i) albedo += double(view.radiance[i][channel]) / view.pdf[i];
        for (Rgb& radiance : view.radiance) radiance[channel] /= float(std::max(albedo, 1.0));
    }
    return view;
}

/// Exposures of pictures under one directional light, by its phase: the angle to the viewer.
class PhaseExposures {
  public:
    explicit PhaseExposures(const std::vector<MatchedView>& views) {
        std::array<std::vector<std::pair<double, double>>, k_phases> values;
        for (const MatchedView& view : views)
            for (std::size_t i = 0; i < view.lights.size(); ++i)
                if (const double value = largest_of(view.radiance[i]); value > 0)
                    for (std::size_t k = 0; k < k_phases; ++k)
                        if (std::abs(place(view.lights[i].wl, view.wv) - double(k)) <= 1)
                            values[k].emplace_back(value, view.weight / view.pdf[i]);
        double last = 1;
        for (std::size_t k = 0; k < k_phases; ++k) {
            if (const double value = weighted_quantile(values[k], k_exposed_quantile); value > 0) last = value;
            exposure_[k] = k_exposed_value / last;
        }
    }
    double at(Vec3d wl, Vec3d wv) const {
        const double x = place(wl, wv);
        const std::size_t k = std::min(std::size_t(x), k_phases - 2);
        return exposure_[k] + (x - double(k)) * (exposure_[k + 1] - exposure_[k]);
    }

  private:
    static constexpr std::size_t k_phases = 19;  ///< each 10°
    static double place(Vec3d wl, Vec3d wv) {
        return elementary::acos(std::clamp(dot(wl, wv), -1.0, 1.0)) / k_pi * double(k_phases - 1);
    }
    std::array<double, k_phases> exposure_;
};

Colour colour_of(const MatchedView& view, const MatchedPixel& pixel) {
    Colour sum{};
    for (std::size_t i = 0; i < pixel.weight.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) sum[c] += pixel.weight[i] * double(view.radiance[pixel.first + i][int(c)]);
    return sum;
}

void add_directional_pixels(std::vector<MatchedView>& views) {
    const PhaseExposures exposures(views);
    double total = 0;
    for (MatchedView& view : views) {
        double sum = 0;
        for (std::size_t i = 0; i < view.lights.size(); ++i) {
            const double sine = std::sqrt(std::max(1 - elementary::square(dot(view.lights[i].wl, view.wv)), 0.0)),
                         fraction = elementary::pow(view.pdf[i], k_density_power) / std::max(sine, k_min_sine);
            view.pixels.push_back({i, {exposures.at(view.lights[i].wl, view.wv)}, view.weight * fraction});
            sum += fraction;
        }
        for (MatchedPixel& pixel : view.pixels) pixel.fraction /= sum;
        total += view.weight;
    }
    for (MatchedView& view : views)
        for (MatchedPixel& pixel : view.pixels) pixel.fraction /= total;
}

void add_extended_pixels(std::vector<MatchedView>& views) {
    const std::vector<Lighting> lights = extended_lights();
    double total = 0;
    for (const MatchedView& view : views) total += view.weight * double(lights.size());
    for (const Lighting& light : lights) {
        std::vector<std::pair<double, double>> values;
        const std::size_t azimuths = light.sources.empty() ? 1 : k_azimuths;
        for (MatchedView& view : views)
            for (std::size_t a = 0; a < azimuths; ++a) {
                // Each view has other azimuths, from 0 to π: the lamps lie in a plane with the viewer.
                const double azimuth =
                    k_pi * (double(a) + 0.5 + 0.4 * elementary::sin(40 * view.theta)) / double(azimuths);
                const Vec3d normal = spherical(view.theta, azimuth), toward{0, 0, 1};
                const Vec3d away = view.theta > 0 ? normalize(normal.z * normal - toward)
                                                  : Vec3d{elementary::cos(azimuth), elementary::sin(azimuth), 0};
                const Frame frame{away, cross(normal, away), normal};
                MatchedPixel pixel{0, {}, view.weight / (total * double(azimuths))};
                for (std::size_t i = 0; i < view.lights.size(); ++i)
                    pixel.weight.push_back(double(radiance(light, frame.from(view.lights[i].wl)).r) / view.pdf[i]);
                const Colour colour = colour_of(view, pixel);
                values.emplace_back(std::max({colour[0], colour[1], colour[2]}), view.weight);
                view.pixels.push_back(std::move(pixel));
            }
        const double level = weighted_quantile(values, k_exposed_quantile);
        for (MatchedView& view : views)
            for (std::size_t a = 0; a < azimuths; ++a)
                for (double& weight : view.pixels[view.pixels.size() - azimuths + a].weight)
                    weight *= k_exposed_value / std::max(level, 1e-30);
    }
}

}  // namespace

std::vector<MatchedView> matched_views(const Evaluate& f, std::size_t count, int threads) {
    std::vector<MatchedView> views(count);
    parallel_for(count, threads, [&](std::size_t i) {
        views[i] = matched_view(f, k_last_view * double(i) / double(count - 1), k_turn_of_views * double(i),
                                k_light_points + k_further_points * int(i % 7));
    });
    std::erase_if(views, [](const MatchedView& view) { return view.lights.empty(); });
    add_directional_pixels(views);
    add_extended_pixels(views);
    for (MatchedView& view : views)
        for (MatchedPixel& pixel : view.pixels) {
            pixel.colour = colour_of(view, pixel);
            for (std::size_t c = 0; c < 3; ++c)
                pixel.limit[c] = pixel.colour[c] < 1 ? std::numeric_limits<double>::max() : 1;
            pixel.itp = Itp<double>(shown(pixel.colour, pixel.limit)).value();
        }
    return views;
}

}  // namespace
