#include "srbf/directions.h"

#include "srbf/kernel.h"

namespace srbf {

Vec3d fibonacci_direction(int i, int n, double theta_max) {
    static const double golden_angle = k_pi * (3 - std::sqrt(5.0));
    const double cos_max = std::cos(theta_max);
    const double z = (i + 0.5) / n * (1 - cos_max) + cos_max;
    const double r = std::sqrt(std::max(0.0, 1 - z * z)), phi = i * golden_angle;
    return {r * std::cos(phi), r * std::sin(phi), z};
}

std::vector<Vec3f> fibonacci_directions(int n, double theta_max) {
    std::vector<Vec3f> directions;
    directions.reserve(std::size_t(n));
    for (int i = 0; i < n; ++i) directions.push_back(to_float(fibonacci_direction(i, n, theta_max)));
    return directions;
}

Vec3d MirrorMixture::sample_cap(double u1, double u2) const {
    const double z = 1 - u1 * (1 - cos_max_), r = std::sqrt(std::max(0.0, 1 - z * z));
    return {r * std::cos(2 * k_pi * u2), r * std::sin(2 * k_pi * u2), z};
}

Vec3d MirrorMixture::sample_part(int part, Vec3d wv, double u1, double u2) const {
    if (part == 0) return sample_cap(u1, u2);
    if (part == k_parts - 1) return Kernel<double>::sample_vmf(wv, k_retro_bandwidth, u1, u2);
    return Kernel<double>::sample_vmf(mirror(wv), k_mirror_bandwidths[std::size_t(part - 1)], u1, u2);
}

Vec3d MirrorMixture::sample(Vec3d wv, double u0, double u1, double u2) const {
    int part = 0;
    for (; part < k_parts - 1 && u0 >= share(part); ++part) u0 -= share(part);
    return sample_part(part, wv, u1, u2);
}

double MirrorMixture::pdf(Vec3d wl, Vec3d wv) const {
    double density = contains(wl) ? k_even * cap_pdf() : 0;
    for (const double bandwidth : k_mirror_bandwidths)
        density += k_mirror * Kernel<double>::vmf_pdf(wl, mirror(wv), bandwidth);
    return density + k_retro * Kernel<double>::vmf_pdf(wl, wv, k_retro_bandwidth);
}

Quadrature MirrorMixture::quadrature(Vec3d wv, int count) const {
    const double golden = (std::sqrt(5.0) - 1) / 2;
    Quadrature points;
    for (int part = 0; part < k_parts; ++part) {
        const int of_part = int(share(part) * count);
        for (int i = 0; i < of_part; ++i) {
            const Vec3d wl = sample_part(part, wv, (i + 0.5) / of_part, std::fmod(i * golden, 1.0));
            if (!contains(wl)) continue;
            points.w.push_back(to_float(wl));
            points.weight.push_back(share(part) / of_part / pdf(wl, wv));
        }
    }
    return points;
}

}  // namespace srbf
