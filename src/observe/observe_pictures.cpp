#include "observe/observations.h"

#include "base/parallel.h"
#include "brdf/directions.h"
#include "brdf/values.h"
#include "errors/sphere.h"
#include "observe/pair_weights.h"
#include "observe/pairs.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

/// Number of views, and of points for the extended lights of each. Eight times or half as many of either make no
/// larger difference than another seed does.
constexpr std::size_t k_views = 100;
constexpr int k_points = 112;
/// Angles between viewer and directional lights [degrees], unevenly spread over the whole range.
constexpr double k_light_phases[] = {3, 11, 24, 38, 52, 70, 88, 105, 122, 140, 156};

Rgb grey(double x) { return {float(x), float(x), float(x)}; }

/// The lights of the pictures, all of them white: bright and dark surroundings with lamps of several sizes, and
/// directional lights of irradiance π.
struct PictureLights {
    std::vector<Lighting> extended;
    std::vector<Vec3d> directions;
    std::size_t count() const { return extended.size() + directions.size(); }
};
PictureLights make_lights() {
    const auto towards = [](double x, double y, double z) { return normalize(Vec3d{x, y, z}); };
    PictureLights lights;
    lights.extended = {
        {"hall", grey(1), grey(0.8), grey(0.3), {}},
        {"box", grey(0.08), grey(0.06), grey(0.05), {{towards(0.6, 0.6, 0.5), 25, grey(8)}}},
        {"street", grey(0.3), grey(0.5), grey(0.1), {{towards(-0.6, 0.3, 0.6), 8, grey(30)}}},
        {"stage",
         grey(0.05),
         grey(0.05),
         grey(0.05),
         {{towards(-0.7, 0.5, -0.4), 15, grey(20)}, {towards(0.3, 0.6, 0.8), 12, grey(5)}}},
    };
    constexpr double k_first_azimuth = 4 * k_golden_angle;  // arbitrary
    for (const double phase : k_light_phases)
        lights.directions.push_back(
            spherical(phase * k_degree, k_first_azimuth + k_golden_angle * double(lights.directions.size())));
    return lights;
}

/// The frame of point i of the sphere's disc, relative to the viewer's, rotated about the normal by the point's angle.
Frame frame_of(std::size_t i, double theta_max) {
    const double r = std::sqrt((double(i) + 0.5) / double(k_views)) * elementary::sin(theta_max),
                 azimuth = k_golden_angle * double(i);
    const Vec3d normal{r * elementary::cos(azimuth), r * elementary::sin(azimuth), std::sqrt(1 - r * r)};
    const Frame frame = frame_about(normal);
    const Vec3d x = elementary::cos(azimuth) * frame.x + elementary::sin(azimuth) * frame.y;
    return {x, cross(normal, x), normal};
}

/// A view without values, whose pixels are not exposed yet.
ObservedView view_of(const Frame& frame, const PictureLights& lights, const MirrorMixture& mixture) {
    const Vec3d wv = frame.to({0, 0, 1});
    const Quadrature points = mixture.quadrature(wv, k_points);
    ObservedView view{to_float(wv), points.w, {}, {}};
    for (std::size_t k = 0; k < lights.directions.size(); ++k) {
        const Vec3d l = frame.to(lights.directions[k]);
        if (!mixture.contains(l)) continue;
        view.pixels.push_back({lights.extended.size() + k, view.wl.size(), {float(l.z * k_pi)}});
        view.wl.push_back(to_float(l));
    }
    for (std::size_t k = 0; k < lights.extended.size(); ++k) {
        ObservedPixel pixel{k, 0, {}};
        for (std::size_t p = 0; p < points.w.size(); ++p) {
            const Vec3d l = to_double(points.w[p]);
            pixel.weight.push_back(float(points.weight[p] * l.z) * radiance(lights.extended[k], frame.from(l)).r);
        }
        view.pixels.push_back(std::move(pixel));
    }
    return view;
}

/// Samples f for a view. Pairs that were not measured get value and weight 0.
void sample_values(ObservedView& view, const Evaluate& f) {
    view.f = values_towards(f, view.wl, view.wv);
    for (ObservedPixel& pixel : view.pixels)
        for (std::size_t p = 0; p < pixel.weight.size(); ++p)
            if (!is_finite(view.f[pixel.first + p])) pixel.weight[p] = 0;
    for (Rgb& value : view.f) value = is_finite(value) ? non_negative(value) : Rgb{};
}

}  // namespace

std::vector<ObservedView> observe_views(const Evaluate& f, double theta_max, int threads) {
    const PictureLights lights = make_lights();
    const MirrorMixture mixture(theta_max);
    std::vector<ObservedView> views(k_views);
    std::vector<Image> pictures(lights.count(), Image(int(k_views), 1));
    parallel_for(k_views, threads, [&](std::size_t i) {
        ObservedView& view = views[i];
        view = view_of(frame_of(i, theta_max), lights, mixture);
        sample_values(view, f);
        for (const ObservedPixel& pixel : view.pixels)
            for (std::size_t p = 0; p < pixel.weight.size(); ++p)
                for (int c = 0; c < 3; ++c)
                    pictures[pixel.lighting].at(int(i), 0)[c] += pixel.weight[p] * view.f[pixel.first + p][c];
    });
    std::vector<float> exposure;
    for (const Image& picture : pictures) exposure.push_back(exposure_to(picture, k_exposed_value));
    for (ObservedView& view : views)
        for (ObservedPixel& pixel : view.pixels)
            for (float& weight : pixel.weight) weight *= exposure[pixel.lighting];
    return views;
}

}  // namespace
