#include "fit/data/observe_pictures.h"

#include <cmath>

#include "fit/data/observations.h"
#include "fit/objective/objective.h"
#include "parallel.h"
#include "srbf/directions.h"
#include "srbf/elementary.h"
#include "srbf/pictures.h"

namespace srbf {
namespace {

constexpr std::size_t k_views = 100;
constexpr int k_points = 112;  ///< towards extended lights, of each view
/// Angles between viewer and single lights as seen from the sphere [degrees].
constexpr double k_light_phases[] = {3, 11, 24, 38, 52, 70, 88, 105, 122, 140, 156};

Rgb grey(double x) { return {float(x), float(x), float(x)}; }

std::vector<Lighting> lights() {
    const auto towards = [](double x, double y, double z) { return normalize(Vec3d{x, y, z}); };
    std::vector<Lighting> all{
        {"hall", grey(1), grey(0.8), grey(0.3), {}},
        {"box", grey(0.08), grey(0.06), grey(0.05), {{towards(0.6, 0.6, 0.5), 25, grey(8)}}},
        {"street", grey(0.3), grey(0.5), grey(0.1), {{towards(-0.6, 0.3, 0.6), 8, grey(30)}}},
        {"stage",
         grey(0.05),
         grey(0.05),
         grey(0.05),
         {{towards(-0.7, 0.5, -0.4), 15, grey(20)}, {towards(0.3, 0.6, 0.8), 12, grey(5)}}},
    };
    for (const double phase : k_light_phases)
        all.push_back({"single", {}, {}, {}, {{spherical(phase * k_degree, 2.4 * double(all.size())), 0, grey(k_pi)}}});
    return all;
}

bool is_single(const Lighting& lighting) { return lighting.sources.size() == 1 && lighting.sources[0].radius == 0; }

/// A frame about `normal`, turned about it by some angle.
Frame frame_of(Vec3d normal, double turn) {
    const Frame frame = frame_about(normal, std::abs(normal.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0});
    const Vec3d x = elementary::cos(turn) * frame.x + elementary::sin(turn) * frame.y;
    return {x, cross(normal, x), normal};
}

}  // namespace

std::vector<SeenView> observe_views(const Evaluate& f, double theta_max, int threads) {
    const std::vector<Lighting> all = lights();
    const MirrorMixture mixture(theta_max);
    std::vector<SeenView> views(k_views);
    std::vector<Image> seen(all.size(), Image(int(k_views), 1));
    parallel_for(k_views, threads, [&](std::size_t i) {
        SeenView& view = views[i];
        const double r = std::sqrt((double(i) + 0.5) / double(k_views)) * elementary::sin(theta_max),
                     phi = 2.4 * double(i);
        const Frame frame = frame_of({r * elementary::cos(phi), r * elementary::sin(phi), std::sqrt(1 - r * r)}, phi);
        const Vec3d wv = frame.to({0, 0, 1});
        view.wv = to_float(wv);
        const Quadrature points = mixture.quadrature(wv, k_points);
        view.wl = points.w;
        for (const Lighting& lighting : all)
            if (is_single(lighting))
                if (const Vec3d l = frame.to(lighting.sources[0].direction); mixture.contains(l)) {
                    view.pixels.push_back({std::size_t(&lighting - all.data()), view.wl.size(), {float(l.z * k_pi)}});
                    view.wl.push_back(to_float(l));
                }
        for (std::size_t k = 0; k < all.size(); ++k) {
            if (is_single(all[k])) continue;
            SeenPixel pixel{k, 0, {}};
            for (std::size_t p = 0; p < points.w.size(); ++p) {
                const Vec3d l = to_double(points.w[p]);
                pixel.weight.push_back(float(points.weight[p] * l.z) * radiance(all[k], frame.from(l)).r);
            }
            view.pixels.push_back(std::move(pixel));
        }
        view.f.resize(view.wl.size());
        f(view.wl, std::vector<Vec3f>(view.wl.size(), view.wv), view.f);
        for (SeenPixel& pixel : view.pixels)
            for (std::size_t p = 0; p < pixel.weight.size(); ++p)
                if (!is_finite(view.f[pixel.first + p])) pixel.weight[p] = 0;
        for (Rgb& value : view.f) {
            if (!is_finite(value)) value = {};
            clamp_negative(value);
        }
        for (const SeenPixel& pixel : view.pixels)
            for (std::size_t p = 0; p < pixel.weight.size(); ++p)
                for (int c = 0; c < 3; ++c)
                    seen[pixel.lighting].at(int(i), 0)[c] += pixel.weight[p] * view.f[pixel.first + p][c];
    });
    std::vector<float> exposure;
    for (const Image& image : seen) exposure.push_back(exposure_to(image, k_exposed_value));
    for (SeenView& view : views)
        for (SeenPixel& pixel : view.pixels)
            for (float& weight : pixel.weight) weight *= exposure[pixel.lighting];
    return views;
}

}  // namespace srbf
