#include "extras/render/sphere_picture.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "brdf/frame.h"
#include "src/base/parallel.h"

namespace SRBF_NAMESPACE {

namespace {

/// Calls visit(n) with the sphere's normal at each sample point of pixel (x, y) that lies on it.
template <typename Visit> void for_each_normal(int x, int y, const SphereOptions& options, const Visit& visit) {
    const double half = options.size / 2.0, radius = SphereOptions::k_radius * half;
    for (int j = 0; j < options.samples; ++j)
        for (int i = 0; i < options.samples; ++i) {
            const double u = (x + (i + 0.5) / options.samples - half) / radius;
            const double v = (half - y - (j + 0.5) / options.samples) / radius;
            if (const double squared_z = 1 - u * u - v * v; squared_z > 0) visit(Vec3d{u, v, std::sqrt(squared_z)});
        }
}

/// The lit points of a row, as arrays for one evaluation.
struct LitPoints {
    std::vector<Vec3f> wl, wv;
    std::vector<Rgb> f;
    std::vector<Rgb> irradiance;  ///< max(0, n·l) E divided by the number of the pixel's points on the sphere
    std::vector<int> column;
};

/// Adds row y of the sphere to `image`, which must be 0 there.
void render_row(const Evaluate& f, const SphereOptions& options, int y, Image& image) {
    LitPoints points;
    for (int x = 0; x < options.size; ++x) {
        int hits = 0;
        for_each_normal(x, y, options, [&](Vec3d) { ++hits; });
        for_each_normal(x, y, options, [&](Vec3d n) {
            const Frame surface = surface_frame(n);
            const auto local = [&](Vec3d w) { return to_float(surface.to(w)); };
            for (const DirectionalLight& light : k_three_lights) {
                const double cosine = dot(n, light.towards);
                if (cosine <= 0) continue;
                const Rgb e = light.irradiance;
                const float scale = float(cosine / hits);
                points.wl.push_back(local(light.towards));
                points.wv.push_back(local({0, 0, 1}));
                points.irradiance.push_back({scale * e.r, scale * e.g, scale * e.b});
                points.column.push_back(x);
            }
        });
    }
    points.f.resize(points.wl.size());
    if (!points.f.empty()) f(points.wl, points.wv, points.f);
    for (std::size_t i = 0; i < points.f.size(); ++i)
        for (int c = 0; c < 3; ++c) image.at(points.column[i], y)[c] += points.f[i][c] * points.irradiance[i][c];
}

}  // namespace

Image render_sphere(const Evaluate& f, const SphereOptions& options) {
    assert(f && options.size >= 1 && options.samples >= 1 && options.threads >= 0);
    Image image(options.size, options.size);
    parallel_for(std::size_t(options.size), options.threads,
                 [&](std::size_t y) { render_row(f, options, int(y), image); });
    return image;
}

std::vector<float> sphere_coverage(const SphereOptions& options) {
    std::vector<float> coverage;
    for (int y = 0; y < options.size; ++y)
        for (int x = 0; x < options.size; ++x) {
            int hits = 0;
            for_each_normal(x, y, options, [&](Vec3d) { ++hits; });
            coverage.push_back(float(hits) / float(options.samples * options.samples));
        }
    return coverage;
}

}  // namespace srbf
