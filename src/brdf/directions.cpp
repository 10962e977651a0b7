#include "brdf/directions.h"

#include <cassert>

#include "srbf/elementary.h"
#include "srbf/kernel.h"
#include "srbf/models/su.h"

namespace SRBF_NAMESPACE {

Vec3d fibonacci_direction(int i, int n, double theta_max) {
    static const double golden_angle = k_pi * (3 - std::sqrt(5.0));
    const double cos_max = elementary::cos(theta_max);
    const double z = (i + 0.5) / n * (1 - cos_max) + cos_max;
    const double r = std::sqrt(std::max(0.0, 1 - z * z)), phi = i * golden_angle;
    return {r * elementary::cos(phi), r * elementary::sin(phi), z};
}

std::vector<Vec3f> fibonacci_directions(int n, double theta_max) {
    std::vector<Vec3f> directions;
    directions.reserve(std::size_t(n));
    for (int i = 0; i < n; ++i) directions.push_back(to_float(fibonacci_direction(i, n, theta_max)));
    return directions;
}

// Searches outwards from the z of w, until the difference in z alone exceeds the distances of all found directions.
void find_nearest(std::span<const Vec3f> directions, Vec3f w, std::span<std::uint16_t> nearest) {
    assert(directions.size() >= nearest.size() && directions.size() <= 65536);
    struct Found {
        float squared_distance;
        std::size_t index;
        auto operator<=>(const Found&) const = default;
    };
    constexpr std::size_t k_max = 16;
    assert(nearest.size() <= k_max && !nearest.empty());
    std::array<Found, k_max> found;
    std::size_t count = 0;
    const auto ends_search = [&](std::size_t i) {
        const float dz = directions[i].z - w.z;
        return count == nearest.size() && dz * dz > found[count - 1].squared_distance;
    };
    const auto insert = [&](std::size_t i) {
        const Vec3f difference = directions[i] - w;
        const Found next{dot(difference, difference), i};
        if (count == nearest.size() && !(next < found[count - 1])) return;
        std::size_t k = count < nearest.size() ? count++ : count - 1;
        for (; k > 0 && next < found[k - 1]; --k) found[k] = found[k - 1];
        found[k] = next;
    };
    const auto middle =
        std::size_t(std::partition_point(directions.begin(), directions.end(), [&](Vec3f d) { return d.z < w.z; }) -
                    directions.begin());
    for (std::size_t i = middle; i < directions.size() && !ends_search(i); ++i) insert(i);
    for (std::size_t i = middle; i-- > 0 && !ends_search(i);) insert(i);
    for (std::size_t k = 0; k < nearest.size(); ++k) nearest[k] = std::uint16_t(found[k].index);
}

namespace {

/// A face of the cube: the axes of s and t, and the normal.
struct CubeFace {
    Vec3f s, t, normal;
};
constexpr std::array<CubeFace, 6> k_faces{{{{0, 0, -1}, {0, -1, 0}, {1, 0, 0}},
                                           {{0, 0, 1}, {0, -1, 0}, {-1, 0, 0}},
                                           {{1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
                                           {{1, 0, 0}, {0, 0, -1}, {0, -1, 0}},
                                           {{1, 0, 0}, {0, -1, 0}, {0, 0, 1}},
                                           {{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}}}};

/// The nodes and weights of Gauss-Legendre rules of six nodes on the intervals between these numbers.
std::vector<std::array<double, 2>> gauss_legendre(std::vector<double> ends) {
    constexpr double k_rule[][2] = {{0.2386191860831969, 0.4679139345726910},
                                    {0.6612093864662645, 0.3607615730481386},
                                    {0.9324695142031521, 0.1713244923791704}};
    std::ranges::sort(ends);
    std::vector<std::array<double, 2>> nodes;
    for (std::size_t i = 1; i < ends.size(); ++i)
        for (const auto& [x, weight] : k_rule)
            for (const double node : {-x, x}) {
                const double half = (ends[i] - ends[i - 1]) / 2;
                nodes.push_back({ends[i - 1] + half * (1 + node), half * weight});
            }
    return nodes;
}

}  // namespace

std::size_t texels(DirectionMap map, int size) {
    return (map == DirectionMap::cube ? 6 : 1) * std::size_t(size) * std::size_t(size);
}

Vec3f texel_direction(DirectionMap map, int size, std::size_t texel) {
    const auto side = std::size_t(size);
    const auto centre = [&](std::size_t i) { return (2 * float(i) + 1) / float(size) - 1; };
    const float s = centre(texel % side), t = centre(texel / side % side);
    if (map == DirectionMap::parabolic) return (1 / (1 + s * s + t * t)) * Vec3f(2 * s, 2 * t, 1 - s * s - t * t);
    const CubeFace& face = k_faces[texel / (side * side)];
    return normalize(face.normal + s * face.s + t * face.t);
}

std::size_t texel_of(DirectionMap map, int size, Vec3f w) {
    const auto side = std::size_t(size);
    const auto index = [&](float x) {  // the column or row of a coordinate in [−1, 1]
        return std::size_t(std::clamp(int((0.5f * x + 0.5f) * float(size)), 0, size - 1));
    };
    if (map == DirectionMap::parabolic) {
        const float scale = 1 / std::max(1 + w.z, 1e-6f);
        return index(std::clamp(scale * w.y, -1.f, 1.f)) * side + index(std::clamp(scale * w.x, -1.f, 1.f));
    }
    const auto face = std::max_element(k_faces.begin(), k_faces.end(), [&](const CubeFace& a, const CubeFace& b) {
        return dot(a.normal, w) < dot(b.normal, w);
    });
    const float scale = 1 / dot(face->normal, w);
    const auto number = std::size_t(face - k_faces.begin());
    return (number * side + index(scale * dot(face->t, w))) * side + index(scale * dot(face->s, w));
}

MirrorMixture::MirrorMixture(double theta_max)
    : cos_max_(elementary::cos(theta_max)),
      retro_scale_(k_retro / Kernel<double>::gaussian_integral(k_retro_bandwidth)) {
    for (std::size_t k = 0; k < mirror_scale_.size(); ++k)
        mirror_scale_[k] = k_mirror / Kernel<double>::gaussian_integral(k_mirror_bandwidths[k]);
}

Vec3d MirrorMixture::sample_cap(double u1, double u2) const {
    const double z = 1 - u1 * (1 - cos_max_), r = std::sqrt(std::max(0.0, 1 - z * z));
    return {r * elementary::cos(2 * k_pi * u2), r * elementary::sin(2 * k_pi * u2), z};
}

Vec3d MirrorMixture::sample_part(int part, Vec3d wv, double u1, double u2) const {
    if (part == 0) return sample_cap(u1, u2);
    if (part == k_parts - 1) return Kernel<double>::sample_vmf(wv, k_retro_bandwidth, u1, u2);
    return Kernel<double>::sample_vmf(mirror(wv), k_mirror_bandwidths[std::size_t(part - 1)], u1, u2);
}

Vec3d MirrorMixture::sample(Vec3d wv, double u0, double u1, double u2) const {
    int part = 0;
    for (; part < k_parts - 1 && u0 >= chance(part); ++part) u0 -= chance(part);
    return sample_part(part, wv, u1, u2);
}

double MirrorMixture::pdf(Vec3d wl, Vec3d wv) const {
    double density = contains(wl) ? k_uniform * cap_pdf() : 0;
    const auto lobe = [](Vec3d w, Vec3d centre, double bandwidth, double scale) {
        const double exponent = Kernel<double>::gaussian_exponent(w, centre, bandwidth);
        // smaller values are negligible compared to the uniform component
        return exponent < -80 ? 0 : scale * elementary::exp(exponent);
    };
    for (std::size_t k = 0; k < mirror_scale_.size(); ++k)
        density += lobe(wl, mirror(wv), k_mirror_bandwidths[k], mirror_scale_[k]);
    return density + lobe(wl, wv, k_retro_bandwidth, retro_scale_);
}

Quadrature MirrorMixture::quadrature_of_part(int part, Vec3d wv, int count) const {
    const double golden = (std::sqrt(5.0) - 1) / 2;
    Quadrature points;
    const int part_count = int(chance(part) * count);
    for (int i = 0; i < part_count; ++i) {
        const double turns = i * golden;
        const Vec3d wl = sample_part(part, wv, (i + 0.5) / part_count, turns - std::floor(turns));
        if (!contains(wl)) continue;
        points.w.push_back(to_float(wl));
        points.pdf.push_back(pdf(wl, wv));
        points.weight.push_back(chance(part) / part_count / points.pdf.back());
    }
    return points;
}

Quadrature MirrorMixture::quadrature(Vec3d wv, int count) const {
    Quadrature points;
    for (int part = 0; part < k_parts; ++part) {
        const Quadrature added = quadrature_of_part(part, wv, count);
        points.w.insert(points.w.end(), added.w.begin(), added.w.end());
        points.weight.insert(points.weight.end(), added.weight.begin(), added.weight.end());
        points.pdf.insert(points.pdf.end(), added.pdf.begin(), added.pdf.end());
    }
    return points;
}

Quadrature with_cosines(Quadrature points) {
    for (std::size_t i = 0; i < points.w.size(); ++i) points.weight[i] *= double(points.w[i].z);
    return points;
}

Quadrature albedo_quadrature(Vec3d wv, double theta_max, int count) {
    constexpr double k_grazing = 0.3, k_growth = 5, k_first_of_cosine = 1e-2, k_first_at_horizon = 1e-3,
                     k_first_azimuth = 1e-4;
    if (wv.z >= k_grazing) return with_cosines(MirrorMixture(theta_max).quadrature(wv, count));
    Quadrature points;
    const double min = elementary::cos(theta_max), sine = std::sqrt(1 - wv.z * wv.z);
    std::vector<double> cosine{min, 1}, azimuth{0, k_pi / 2};
    for (double s = 1; s < 1 / k_first_azimuth; s *= k_growth) {
        for (const double z :
             {wv.z - k_first_of_cosine * s * wv.z, wv.z + k_first_of_cosine * s * wv.z, k_first_at_horizon * s, wv.z})
            if (z > min && z < 1 && (z != wv.z || s == 1)) cosine.push_back(z);
        azimuth.push_back(k_first_azimuth * s);
    }
    const auto azimuths = gauss_legendre(azimuth);
    for (const auto& [z, z_weight] : gauss_legendre(cosine))
        for (const auto& [phi, phi_weight] : azimuths)
            for (const double along : {-elementary::cos(phi), elementary::cos(phi)})
                for (const double across : {-elementary::sin(phi), elementary::sin(phi)}) {
                    const double r = std::sqrt(1 - z * z) / sine;
                    points.w.push_back(
                        to_float({r * (along * wv.x - across * wv.y), r * (along * wv.y + across * wv.x), z}));
                    points.weight.push_back(z * z_weight * phi_weight);
                }
    return points;
}

std::array<double, 3> weighted_sum(std::span<const Rgb> f, std::span<const double> weight) {
    std::array<double, 3> sum{};
    for (std::size_t i = 0; i < f.size(); ++i)
        for (int c = 0; c < 3; ++c)
            if (std::isfinite(f[i][c])) sum[std::size_t(c)] += weight[i] * double(f[i][c]);
    return sum;
}

bool is_in_plane(Vec3f wl, Vec3f wv) {
    constexpr float k_max = 0.01f;
    const float sin_l = elementary::hypot(wl.x, wl.y), cross = wl.x * wv.y - wl.y * wv.x;
    return std::abs(cross) <= k_max * sin_l || sin_l <= k_max;
}

}  // namespace
