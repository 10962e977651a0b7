#include <map>

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

/// A source of nonzero size, with points that are uniform over it.
struct Disc {
    std::vector<Vec3d> points;
    Vec3d direction;
    double edge, density;  ///< cosine of its radius; points per solid angle
};
Disc disc(const Lighting::Source& source) {
    const double radius = source.radius * k_degree;
    const Frame frame = frame_about(source.direction, {0, 1, 0});
    Disc disc{
        {}, source.direction, elementary::cos(radius), k_source_points / (2 * k_pi * (1 - elementary::cos(radius)))};
    for (int i = 0; i < k_source_points; ++i)
        disc.points.push_back(frame.from(fibonacci_direction(i, k_source_points, radius)));
    return disc;
}

struct Discs {
    explicit Discs(const Lighting& lighting) {
        for (const Lighting::Source& source : lighting.sources)
            if (source.radius > 0) discs.push_back(disc(source));
        for (const Disc& disc : discs)
            for (const Vec3d& w : disc.points) points.push_back({w, density_at(w), radiance(lighting, w)});
    }
    /// The density of points of all discs [1/sr].
    double density_at(Vec3d w) const {
        double density = 0;
        for (const Disc& disc : discs) density += dot(w, disc.direction) >= disc.edge ? disc.density : 0;
        return density;
    }
    struct Point {
        Vec3d w;
        double density;
        Rgb light;
    };
    std::vector<Disc> discs;
    std::vector<Point> points;
};

/// A pair contributes weight × f to a pixel under a lighting.
struct Term {
    std::size_t lighting, pair;
    Rgb weight;
};
Rgb operator*(double factor, const Rgb& light) {
    return {float(factor * double(light.r)), float(factor * double(light.g)), float(factor * double(light.b))};
}

/// Shares of zenith, horizon and ground in the radiance of any sky from direction w: the colour of a sky in which these
/// are red, green and blue.
Vec3d sky_fractions(Vec3d w) {
    static const Lighting separate{{}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {}};
    const Rgb fractions = radiance(separate, w);
    return {double(fractions.r), double(fractions.g), double(fractions.b)};
}
/// A channel of the sky's radiance, from `sky_fractions`.
double sky(const Lighting& lighting, Vec3d fractions, int channel) {
    return dot(fractions, Vec3d{double(lighting.zenith[channel]), double(lighting.horizon[channel]),
                                double(lighting.ground[channel])});
}

/// A pixel's radiance as sums over pairs of directions.
struct Pixel {
    Vec3f wv;
    std::vector<Vec3f> wl;
    std::vector<Vec3d> fractions;  ///< terms of any sky at the first pairs: `sky_fractions` times cosθl dωl
    std::vector<Term> terms;       ///< the terms of the sources
};
/// The pixel with the frame's normal. `mirrored` are points of the mixture for a viewer with its θv at azimuth 0.
Pixel make_pixel(const Frame& frame, const Quadrature& mirrored, const MirrorMixture& mixture,
                 std::span<const Lighting> lightings, std::span<const Discs> discs) {
    const Vec3d v = frame.to({0, 0, 1});
    Pixel pixel{to_float(v), {}, {}, {}};
    // Points of all sets are weighted by their common density (balance heuristic). Few points of the mixture lie within
    // a source: all are weighted as if none did, and `terms` corrects those few.
    const auto count = double(mirrored.w.size());
    const double sin_v = elementary::hypot(v.x, v.y), cosine = sin_v > 0 ? v.x / sin_v : 1,
                 sine = sin_v > 0 ? v.y / sin_v : 0;
    for (std::size_t i = 0; i < mirrored.w.size(); ++i) {
        const Vec3d l = Kernel<double>::turned(to_double(mirrored.w[i]), cosine, sine), w = frame.from(l);
        const double density = count * mirrored.pdf[i], measure = l.z / density;
        const Vec3d fraction = sky_fractions(w);
        for (std::size_t k = 0; k < lightings.size(); ++k)
            if (const double disc_density = discs[k].density_at(w); disc_density > 0) {
                Rgb weight = l.z / (density + disc_density) * radiance(lightings[k], w);
                for (int c = 0; c < 3; ++c) weight[c] -= float(measure * sky(lightings[k], fraction, c));
                pixel.terms.push_back({k, i, weight});
            }
        pixel.wl.push_back(to_float(l));
        pixel.fractions.push_back(measure * fraction);
    }
    for (std::size_t k = 0; k < lightings.size(); ++k) {
        const auto add = [&](Vec3d l, const Rgb& weight) {
            pixel.terms.push_back({k, pixel.wl.size(), weight});
            pixel.wl.push_back(to_float(l));
        };
        for (const Lighting::Source& source : lightings[k].sources)
            if (const Vec3d l = frame.to(source.direction); source.radius == 0 && l.z > 0) add(l, l.z * source.power);
        for (const Discs::Point& point : discs[k].points)
            if (const Vec3d l = frame.to(point.w); l.z > 0)
                add(l, l.z / (count * mixture.pdf(l, v) + point.density) * point.light);
    }
    return pixel;
}

std::vector<Rgb> radiances(const Pixel& pixel, std::span<const Rgb> f, std::span<const Lighting> lightings) {
    std::array<Vec3d, 3> sums{};  // the fractions of the sky in each channel
    for (std::size_t i = 0; i < pixel.fractions.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) sums[c] = sums[c] + double(f[i][int(c)]) * pixel.fractions[i];
    std::vector<Rgb> all(lightings.size());
    for (std::size_t k = 0; k < lightings.size(); ++k)
        for (int c = 0; c < 3; ++c) all[k][c] = float(sky(lightings[k], sums[std::size_t(c)], c));
    for (const Term& term : pixel.terms)
        for (int c = 0; c < 3; ++c) all[term.lighting][c] += term.weight[c] * f[term.pair][c];
    return all;
}

/// f of each BRDF at the pairs of a pixel, 0 where one of them was not measured. `f`: the values at the first pairs, if
/// they are known.
std::vector<std::vector<Rgb>> pixel_values(std::span<const Evaluate> brdfs, const Pixel& pixel,
                                           std::vector<std::vector<Rgb>> f) {
    const std::vector<Vec3f> wv(pixel.wl.size(), pixel.wv);
    f.resize(brdfs.size());
    std::vector<char> measured(wv.size(), true);
    for (std::size_t b = 0; b < brdfs.size(); ++b) {
        const std::size_t known = f[b].size();
        f[b].resize(wv.size());
        brdfs[b](std::span(pixel.wl).subspan(known), std::span(wv).subspan(known), std::span(f[b]).subspan(known));
        for (std::size_t i = 0; i < wv.size(); ++i) measured[i] = measured[i] && is_finite(f[b][i]);
    }
    for (std::vector<Rgb>& values : f)
        for (std::size_t i = 0; i < wv.size(); ++i)
            for (int c = 0; c < 3; ++c) values[i][c] = measured[i] ? std::max(values[i][c], 0.f) : 0;
    return f;
}

}  // namespace

bool shows_sphere(int size, int x, int y) { return squared_distance(size, x, y) < size * size; }

std::vector<std::vector<Image>> sphere_pictures(std::span<const Evaluate> brdfs, std::span<const Lighting> lightings,
                                                int size, int threads, const ProgressToken& progress, int mirror_points,
                                                bool is_isotropic) {
    const StandardArithmetic mode;
    const MirrorMixture mixture(k_pi / 2);
    const auto cos_view = [&](int squares) { return std::sqrt(1 - double(squares) / (double(size) * double(size))); };

    const auto viewer = [&](int squares) {
        const double z = cos_view(squares);
        return Vec3d{std::sqrt(1 - z * z), 0, z};
    };
    const auto points_of = [&](int squares) { return mixture.quadrature(viewer(squares), mirror_points); };
    struct Shared {
        Quadrature points;
        std::vector<std::vector<Rgb>> f;  // the values of isotropic BRDFs
    };
    std::map<int, Shared> mirrored;  // keys are squared distances; about eight pixels share points
    std::vector<std::pair<const int, Shared>*> each;
    if (size <= k_max_shared)
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x)
                if (shows_sphere(size, x, y)) mirrored[squared_distance(size, x, y)];
    for (auto& entry : mirrored) each.push_back(&entry);
    parallel_for(each.size(), threads, [&](std::size_t i) {
        if (progress.cancelled()) return;
        auto& [squares, shared] = *each[i];
        shared.points = points_of(squares);
        if (!is_isotropic) return;
        for (const Evaluate& brdf : brdfs)
            shared.f.push_back(values_towards(brdf, shared.points.w, to_float(viewer(squares))));
    });

    const std::vector<Discs> discs(lightings.begin(), lightings.end());
    std::vector<std::vector<Image>> images(lightings.size(), std::vector<Image>(brdfs.size(), Image(size, size)));
    if (progress.cancelled()) return images;
    Reporter reporter(progress, double(size));
    parallel_for(std::size_t(size), threads, [&](std::size_t row) {
        if (!reporter.advance("comparing pictures", 1)) return;
        const int y = int(row);
        for (int x = 0; x < size; ++x) {
            if (!shows_sphere(size, x, y) || progress.cancelled()) continue;
            const int squares = squared_distance(size, x, y);
            const Vec3d normal{(2 * x + 1 - size) / double(size), (size - 2 * y - 1) / double(size), cos_view(squares)};
            const auto shared = mirrored.find(squares);
            const Pixel pixel = make_pixel(frame_about(normal, {0, 1, 0}),
                                           shared != mirrored.end() ? shared->second.points : points_of(squares),
                                           mixture, lightings, discs);
            const auto f = pixel_values(brdfs, pixel,
                                        shared != mirrored.end() ? shared->second.f : std::vector<std::vector<Rgb>>());
            for (std::size_t b = 0; b < brdfs.size(); ++b) {
                const std::vector<Rgb> radiance = radiances(pixel, f[b], lightings);
                for (std::size_t k = 0; k < lightings.size(); ++k) images[k][b].at(x, y) = radiance[k];
            }
        }
    });
    return images;
}

}  // namespace
