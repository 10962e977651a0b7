#include <algorithm>
#include <cmath>
#include <map>

#include "parallel.h"
#include "reporter.h"
#include "srbf/directions.h"
#include "srbf/kernel.h"
#include "srbf/pictures.h"

namespace srbf {
namespace {

constexpr int k_mirror_points = 384, k_source_points = 32;

/// Squared distance from the sphere's centre, in units of (radius / size)²: an integer, on which θv depends alone.
int squared_distance(int size, int x, int y) {
    const int dx = 2 * x + 1 - size, dy = 2 * y + 1 - size;
    return dx * dx + dy * dy;
}

/// Points of the mixture for the viewer at azimuth 0.
struct MirrorPoints {
    Quadrature points;
    std::vector<double> density;  ///< points per solid angle
};

/// A source with extent: points that are uniform over it.
struct Disc {
    std::vector<Vec3d> points;
    Vec3d direction;
    double edge, density;  ///< cosine of its radius; points per solid angle inside
    double density_at(Vec3d w) const { return dot(w, direction) >= edge ? density : 0; }
};
Disc disc(const Lighting::Source& source) {
    const double radius = source.radius * k_degree;
    const Frame frame = frame_about(source.direction, {0, 1, 0});
    Disc disc{{}, source.direction, std::cos(radius), k_source_points / (2 * k_pi * (1 - std::cos(radius)))};
    for (int i = 0; i < k_source_points; ++i)
        disc.points.push_back(frame.from(fibonacci_direction(i, k_source_points, radius)));
    return disc;
}

/// What a pair contributes to a pixel: weight × f.
struct Term {
    std::size_t lighting, pair;
    int x;
    Rgb weight;
};

}  // namespace

bool shows_sphere(int size, int x, int y) { return squared_distance(size, x, y) < size * size; }

std::vector<std::vector<Image>> sphere_pictures(std::span<const Evaluate> brdfs, std::span<const Lighting> lightings,
                                                int size, int threads, const ProgressToken& progress) {
    const FlushSubnormals mode;
    const MirrorMixture mixture(k_pi / 2);
    const auto cos_view = [&](int squares) { return std::sqrt(1 - double(squares) / (double(size) * double(size))); };

    std::map<int, MirrorPoints> mirror_points;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
            if (shows_sphere(size, x, y)) mirror_points[squared_distance(size, x, y)];
    std::vector<std::pair<const int, MirrorPoints>*> each;
    for (auto& entry : mirror_points) each.push_back(&entry);
    parallel_for(each.size(), threads, [&](std::size_t i) {
        auto& [squares, of] = *each[i];
        const double z = cos_view(squares);
        const Vec3d v{std::sqrt(1 - z * z), 0, z};
        of.points = mixture.quadrature(v, k_mirror_points);
        for (const Vec3f& w : of.points.w)
            of.density.push_back(double(of.points.w.size()) * mixture.pdf(to_double(w), v));
    });

    std::vector<std::vector<Disc>> discs;
    std::vector<bool> is_lit_around;  // not by directions alone
    for (const Lighting& lighting : lightings) {
        discs.emplace_back();
        for (const Lighting::Source& source : lighting.sources)
            if (source.radius > 0) discs.back().push_back(disc(source));
        const Rgb none{};
        is_lit_around.push_back(!discs.back().empty() || lighting.horizon != none || lighting.zenith != none ||
                                lighting.ground != none);
    }

    std::vector<std::vector<Image>> images(lightings.size(), std::vector<Image>(brdfs.size(), Image(size, size)));
    Reporter reporter(progress, double(size));
    parallel_for(std::size_t(size), threads, [&](std::size_t row) {
        if (!reporter.advance("comparing pictures", 1)) return;
        const int y = int(row);
        std::vector<Vec3f> wl, wv;
        std::vector<Term> terms;
        for (int x = 0; x < size; ++x) {
            if (!shows_sphere(size, x, y)) continue;
            const int squares = squared_distance(size, x, y);
            const Vec3d normal{(2 * x + 1 - size) / double(size), (size - 2 * y - 1) / double(size), cos_view(squares)};
            const Frame frame = frame_about(normal, {0, 1, 0});
            const Vec3d v = frame.to({0, 0, 1});
            const auto add_pair = [&](Vec3d l) {
                wl.push_back(to_float(l)), wv.push_back(to_float(v));
                return wl.size() - 1;
            };
            const MirrorPoints& mirrored = mirror_points.at(squares);
            const std::size_t first = wl.size();
            const double across = std::hypot(v.x, v.y), cosine = across > 0 ? v.x / across : 1,
                         sine = across > 0 ? v.y / across : 0;
            for (const Vec3f& w : mirrored.points.w) add_pair(Kernel<double>::turned(to_double(w), cosine, sine));
            for (std::size_t k = 0; k < lightings.size(); ++k) {
                const Lighting& lighting = lightings[k];
                const auto add_term = [&](std::size_t pair, double z, double measure, const Rgb& light) {
                    const auto scale = float(z * measure);
                    if (light.r > 0 || light.g > 0 || light.b > 0)
                        terms.push_back({k, pair, x, {scale * light.r, scale * light.g, scale * light.b}});
                };
                for (const Lighting::Source& source : lighting.sources) {
                    const Vec3d l = frame.to(source.direction);
                    if (source.radius == 0 && l.z > 0) add_term(add_pair(l), l.z, 1, source.power);
                }
                // Points of all sets count by their common density.
                const auto add = [&](std::size_t pair, Vec3d w, double density) {
                    for (const Disc& of : discs[k]) density += of.density_at(w);
                    add_term(pair, double(wl[pair].z), 1 / density, radiance(lighting, w));
                };
                for (std::size_t i = 0; is_lit_around[k] && i < mirrored.density.size(); ++i)
                    add(first + i, frame.from(to_double(wl[first + i])), mirrored.density[i]);
                for (const Disc& of : discs[k])
                    for (const Vec3d& w : of.points) {
                        const Vec3d l = frame.to(w);
                        if (l.z > 0) add(add_pair(l), w, double(mirrored.density.size()) * mixture.pdf(l, v));
                    }
            }
        }
        std::vector<std::vector<Rgb>> f;
        std::vector<bool> measured(wl.size(), true);
        for (const Evaluate& brdf : brdfs) {
            f.emplace_back(wl.size());
            brdf(wl, wv, f.back());
            for (std::size_t i = 0; i < wl.size(); ++i) measured[i] = measured[i] && is_finite(f.back()[i]);
        }
        for (const Term& term : terms) {
            if (!measured[term.pair]) continue;
            for (std::size_t b = 0; b < brdfs.size(); ++b) {
                Rgb& pixel = images[term.lighting][b].at(term.x, y);
                for (int c = 0; c < 3; ++c) pixel[c] += term.weight[c] * std::max(f[b][term.pair][c], 0.f);
            }
        }
    });
    return images;
}

}  // namespace srbf
