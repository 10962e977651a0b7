#include <optional>

#include "base/parallel.h"
#include "base/reporter.h"
#include "brdf/directions.h"
#include "brdf/values.h"
#include "errors/sphere.h"
#include "srbf/elementary.h"
#include "srbf/kernel.h"

namespace SRBF_NAMESPACE {
namespace {

constexpr int k_source_points = 32;
constexpr int k_max_shared = 256;  ///< the largest picture whose pixels of equal θv share points; a point set has 8 KB

/// Squared distance of a pixel from the sphere's centre, in units of (radius / size)². θv is a function of this
/// integer.
int squared_distance(int size, int x, int y) {
    const int dx = 2 * x + 1 - size, dy = 2 * y + 1 - size;
    return dx * dx + dy * dy;
}

/// A source that has a size. The points on it have a uniform density.
struct Disc {
    Vec3d direction;
    double radius, edge, density;  ///< [rad], its cosine, points per solid angle [1/sr]
};
struct DiscPoint {
    Vec3d w;
    double density;  ///< of the points of all discs [1/sr]
    Rgb light;
};
/// A lighting with its discs and the points on them.
struct LightPoints {
    const Lighting& lighting;
    std::vector<Disc> discs;
    std::vector<DiscPoint> points;
};

/// The density of points of all discs [1/sr].
double density_at(std::span<const Disc> discs, Vec3d w) {
    double density = 0;
    for (const Disc& disc : discs) density += dot(w, disc.direction) >= disc.edge ? disc.density : 0;
    return density;
}

LightPoints light_points(const Lighting& lighting) {
    LightPoints light{lighting, {}, {}};
    for (const Lighting::Source& source : lighting.sources) {
        if (source.radius == 0) continue;
        const double radius = source.radius * k_degree, edge = elementary::cos(radius);
        light.discs.push_back({source.direction, radius, edge, k_source_points / (2 * k_pi * (1 - edge))});
    }
    for (const Disc& disc : light.discs) {
        const Frame frame = frame_about(disc.direction, {0, 1, 0});
        for (int i = 0; i < k_source_points; ++i) {
            const Vec3d w = frame.from(fibonacci_direction(i, k_source_points, disc.radius));
            light.points.push_back({w, density_at(light.discs, w), radiance(lighting, w)});
        }
    }
    return light;
}

Rgb operator*(double factor, const Rgb& light) {
    return {float(factor * double(light.r)), float(factor * double(light.g)), float(factor * double(light.b))};
}

/// A channel of the sky's radiance, from `sky_fractions`.
double sky(const Lighting& lighting, Vec3d fractions, int channel) {
    return dot(fractions, Vec3d{double(lighting.zenith[channel]), double(lighting.horizon[channel]),
                                double(lighting.ground[channel])});
}

/// A direction to the light contributes weight × f to a pixel under a lighting.
struct Term {
    std::size_t lighting, direction;
    Rgb weight;
};
/// A pixel's radiance as sums over directions to the light: the points of the mixture, then points of the sources.
struct Pixel {
    std::vector<Vec3d> fractions;   ///< of each point of the mixture: `sky_fractions` times cosθl dωl
    std::vector<Vec3f> to_sources;  ///< the directions after these points
    std::vector<Term> terms;        ///< the terms of the sources
};
/// The pixel whose frame has the viewer at azimuth 0; `mirrored` are points of the mixture for its viewer.
Pixel make_pixel(const Frame& frame, const Quadrature& mirrored, const MirrorMixture& mixture,
                 std::span<const LightPoints> lights) {
    const Vec3d v = frame.to({0, 0, 1}), up = frame.to({0, 1, 0});
    const auto count = double(mirrored.w.size());
    Pixel pixel;
    pixel.fractions.reserve(mirrored.w.size());
    // Points of all sets are weighted by their common density (balance heuristic). Few points of the mixture lie within
    // a source: all are weighted as if none did, and `terms` corrects those few.
    for (std::size_t i = 0; i < mirrored.w.size(); ++i) {
        const Vec3d l = to_double(mirrored.w[i]);
        pixel.fractions.push_back(l.z / (count * mirrored.pdf[i]) * sky_fractions(dot(l, up)));
    }
    for (std::size_t k = 0; k < lights.size(); ++k) {
        const Lighting& lighting = lights[k].lighting;
        std::vector<Disc> discs = lights[k].discs;
        for (Disc& disc : discs) disc.direction = frame.to(disc.direction);
        for (std::size_t i = 0; i < mirrored.w.size(); ++i) {
            const Vec3d l = to_double(mirrored.w[i]);
            const double disc_density = density_at(discs, l);
            if (disc_density == 0) continue;
            Rgb weight = l.z / (count * mirrored.pdf[i] + disc_density) * radiance(lighting, frame.from(l));
            for (int c = 0; c < 3; ++c) weight[c] -= float(sky(lighting, pixel.fractions[i], c));
            pixel.terms.push_back({k, i, weight});
        }
        const auto add = [&](Vec3d l, const Rgb& weight) {
            pixel.terms.push_back({k, mirrored.w.size() + pixel.to_sources.size(), weight});
            pixel.to_sources.push_back(to_float(l));
        };
        for (const Lighting::Source& source : lighting.sources)
            if (const Vec3d l = frame.to(source.direction); source.radius == 0 && l.z > 0) add(l, l.z * source.power);
        for (const DiscPoint& point : lights[k].points)
            if (const Vec3d l = frame.to(point.w); l.z > 0)
                add(l, l.z / (count * mixture.pdf(l, v) + point.density) * point.light);
    }
    return pixel;
}

/// The pixel's radiance under each lighting. `mirrored` and `sources` have f at the points of the mixture and at those
/// of the sources.
std::vector<Rgb> radiances(const Pixel& pixel, std::span<const Rgb> mirrored, std::span<const Rgb> sources,
                           std::span<const LightPoints> lights) {
    std::array<Vec3d, 3> sums{};  // the fractions of the sky in each channel
    for (std::size_t i = 0; i < mirrored.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) sums[c] = sums[c] + double(mirrored[i][int(c)]) * pixel.fractions[i];
    std::vector<Rgb> all(lights.size());
    for (std::size_t k = 0; k < lights.size(); ++k)
        for (int c = 0; c < 3; ++c) all[k][c] = float(sky(lights[k].lighting, sums[std::size_t(c)], c));
    for (const auto& [k, i, weight] : pixel.terms) {
        const Rgb& f = i < mirrored.size() ? mirrored[i] : sources[i - mirrored.size()];
        for (int c = 0; c < 3; ++c) all[k][c] += weight[c] * f[c];
    }
    return all;
}

/// f of each BRDF at wl, 0 where one of them was not measured. The viewer has this azimuth, given by cosine and sine,
/// and wl are the directions for azimuth 0.
std::vector<std::vector<Rgb>> values(std::span<const Evaluate> brdfs, std::vector<Vec3f> wl, Vec3d view, double cosine,
                                     double sine) {
    for (Vec3f& l : wl) l = to_float(Kernel<double>::turned(to_double(l), cosine, sine));
    const std::vector<Vec3f> wv(wl.size(), to_float(Kernel<double>::turned(view, cosine, sine)));
    std::vector<std::vector<Rgb>> f(brdfs.size(), std::vector<Rgb>(wl.size()));
    std::vector<char> is_measured(wl.size(), true);
    for (std::size_t b = 0; b < brdfs.size(); ++b) {
        brdfs[b](wl, wv, f[b]);
        for (std::size_t i = 0; i < wl.size(); ++i) is_measured[i] = is_measured[i] && is_finite(f[b][i]);
    }
    for (std::vector<Rgb>& values : f)
        for (std::size_t i = 0; i < wl.size(); ++i)
            for (int c = 0; c < 3; ++c) values[i][c] = is_measured[i] ? std::max(values[i][c], 0.f) : 0;
    return f;
}

}  // namespace

bool shows_sphere(int size, int x, int y) { return squared_distance(size, x, y) < size * size; }

std::vector<std::vector<Image>> sphere_pictures(std::span<const Evaluate> brdfs, std::span<const Lighting> lightings,
                                                int size, int threads, const ProgressToken& progress, int mirror_points,
                                                bool is_isotropic) {
    const StandardArithmetic mode;
    const MirrorMixture mixture(k_pi / 2);
    const auto viewer = [&](int squares) {
        const double sine_squared = double(squares) / (double(size) * double(size));
        return Vec3d{std::sqrt(sine_squared), 0, std::sqrt(1 - sine_squared)};
    };
    struct ViewPoints {
        Quadrature points;                // of the mixture
        std::vector<std::vector<Rgb>> f;  // the values there, if they do not depend on the viewer's azimuth
    };
    const auto view_points = [&](int squares) {
        ViewPoints view{mixture.quadrature(viewer(squares), mirror_points), {}};
        if (is_isotropic) view.f = values(brdfs, view.points.w, viewer(squares), 1, 0);
        return view;
    };
    std::vector<std::optional<ViewPoints>> shared;  // by squared distance; about eight pixels share points
    if (size <= k_max_shared) shared.resize(std::size_t(size) * std::size_t(size));
    for (int y = 0; y < size && !shared.empty(); ++y)
        for (int x = 0; x < size; ++x)
            if (shows_sphere(size, x, y)) shared[std::size_t(squared_distance(size, x, y))].emplace();
    parallel_for(shared.size(), threads, [&](std::size_t squares) {
        if (shared[squares] && !progress.cancelled()) shared[squares] = view_points(int(squares));
    });

    std::vector<LightPoints> lights;
    for (const Lighting& lighting : lightings) lights.push_back(light_points(lighting));
    std::vector<std::vector<Image>> images(lightings.size(), std::vector<Image>(brdfs.size(), Image(size, size)));
    if (progress.cancelled()) return images;
    Reporter reporter(progress, double(size));
    parallel_for(std::size_t(size), threads, [&](std::size_t row) {
        if (!reporter.advance("comparing pictures", 1)) return;
        const int y = int(row);
        for (int x = 0; x < size; ++x) {
            if (!shows_sphere(size, x, y) || progress.cancelled()) continue;
            const int squares = squared_distance(size, x, y);
            const Vec3d view = viewer(squares),
                        normal{(2 * x + 1 - size) / double(size), (size - 2 * y - 1) / double(size), view.z};
            const Frame frame = frame_about(normal, {0, 1, 0});
            const Vec3d v = frame.to({0, 0, 1});
            const double sine_v = elementary::hypot(v.x, v.y), cosine = sine_v > 0 ? v.x / sine_v : 1,
                         sine = sine_v > 0 ? v.y / sine_v : 0;
            const Frame turned{cosine * frame.x + sine * frame.y, cosine * frame.y - sine * frame.x, normal};
            const ViewPoints own = shared.empty() ? view_points(squares) : ViewPoints();
            const ViewPoints& points = shared.empty() ? own : *shared[std::size_t(squares)];
            const Pixel pixel = make_pixel(turned, points.points, mixture, lights);
            const auto f = [&](const std::vector<Vec3f>& wl) {
                return is_isotropic ? values(brdfs, wl, view, 1, 0) : values(brdfs, wl, view, cosine, sine);
            };
            const auto mirrored = is_isotropic ? points.f : f(points.points.w), sources = f(pixel.to_sources);
            for (std::size_t b = 0; b < brdfs.size(); ++b) {
                const std::vector<Rgb> radiance = radiances(pixel, mirrored[b], sources[b], lights);
                for (std::size_t k = 0; k < lights.size(); ++k) images[k][b].at(x, y) = radiance[k];
            }
        }
    });
    return images;
}

}  // namespace
