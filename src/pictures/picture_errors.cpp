#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "parallel.h"
#include "srbf/likeness.h"
#include "srbf/pictures.h"

namespace srbf {
namespace {

constexpr double k_white = 100;  ///< luminance of the display's white [cd/m²]
constexpr double k_exposed_value = 0.75, k_most_psnr = 100;
constexpr float k_surroundings = 0.16f;

/// The perceptual quantiser of ITU-R BT.2100, of a luminance [cd/m²].
double perceptual_quantiser(double luminance) {
    constexpr double m1 = 2610.0 / 16384, m2 = 128 * 2523.0 / 4096, c1 = 3424.0 / 4096, c2 = 32 * 2413.0 / 4096,
                     c3 = 32 * 2392.0 / 4096;
    const double y = std::pow(std::max(luminance, 0.0) / 10000, m1);
    return std::pow((c1 + c2 * y) / (1 + c3 * y), m2);
}

using Triplet = std::array<double, 3>;
Triplet times(const double (&m)[3][3], const Triplet& x) {
    Triplet y;
    for (std::size_t i = 0; i < 3; ++i) y[i] = m[i][0] * x[0] + m[i][1] * x[1] + m[i][2] * x[2];
    return y;
}

/// (I, C_T / 2, C_P) of a linear sRGB colour.
Triplet itp(const Rgb& colour) {
    constexpr double to_bt2020[3][3] = {{0.627403896, 0.329283038, 0.043313066},
                                        {0.069097289, 0.919540395, 0.011362316},
                                        {0.016391439, 0.088013308, 0.895595253}};
    constexpr double to_lms[3][3] = {{1688.0 / 4096, 2146.0 / 4096, 262.0 / 4096},
                                     {683.0 / 4096, 2951.0 / 4096, 462.0 / 4096},
                                     {99.0 / 4096, 309.0 / 4096, 3688.0 / 4096}};
    constexpr double to_itp[3][3] = {{0.5, 0.5, 0},
                                     {6610.0 / 8192, -13613.0 / 8192, 7003.0 / 8192},
                                     {17933.0 / 4096, -17390.0 / 4096, -543.0 / 4096}};
    Triplet lms = times(to_lms, times(to_bt2020, {double(colour.r), double(colour.g), double(colour.b)}));
    for (double& x : lms) x = perceptual_quantiser(k_white * x);
    return times(to_itp, lms);
}

double srgb_encoded(double x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055; }

Image displayed(const Image& radiance, float exposure) {
    Image shown = radiance;
    for (int y = 0; y < shown.height; ++y)
        for (int x = 0; x < shown.width; ++x) {
            Rgb& pixel = shown.at(x, y);
            const bool sphere = shows_sphere(shown.width, x, y);
            for (int c = 0; c < 3; ++c) pixel[c] = sphere ? std::clamp(exposure * pixel[c], 0.f, 1.f) : k_surroundings;
        }
    return shown;
}

}  // namespace

double delta_e_itp(const Rgb& a, const Rgb& b) {
    const Triplet x = itp(a), y = itp(b);
    return 720 * std::hypot(x[0] - y[0], x[1] - y[1], x[2] - y[2]);
}

PictureErrors picture_errors(const Image& reference, const Image& other) {
    assert(reference.width == other.width && reference.height == other.height && reference.width == reference.height);
    const float exposure = exposure_to(reference, k_exposed_value);
    const Image a = displayed(reference, exposure), b = displayed(other, exposure);
    const std::vector<double> flip = flip_map(a, b);
    const auto square = [](double x) { return x * x; };
    PictureErrors errors;
    double pixels = 0, encoded = 0, squares = 0, whole = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        if (!shows_sphere(a.width, int(i) % a.width, int(i) / a.width)) continue;
        ++pixels;
        errors.delta_e += delta_e_itp(a.pixels[i], b.pixels[i]);
        errors.flip += flip[i];
        for (int c = 0; c < 3; ++c) {
            encoded += square(srgb_encoded(double(a.pixels[i][c])) - srgb_encoded(double(b.pixels[i][c])));
            squares += square(double(reference.pixels[i][c]) - double(other.pixels[i][c]));
            whole += square(double(reference.pixels[i][c]));
        }
    }
    errors.delta_e /= pixels, errors.flip /= pixels;
    errors.psnr = std::min(-10 * std::log10(encoded / (3 * pixels)), k_most_psnr);
    errors.rms = squares > 0 ? std::sqrt(squares / whole) : 0;
    return errors;
}

std::vector<Appearance> compare_pictures(const Evaluate& reference, std::span<const Evaluate> others, int threads,
                                         const ProgressToken& progress, int size) {
    std::vector<Evaluate> brdfs{reference};
    brdfs.insert(brdfs.end(), others.begin(), others.end());
    const auto images = sphere_pictures(brdfs, standard_lightings(), size, threads, progress);
    std::vector<Appearance> all(others.size());
    for (Appearance& of : all) of.lighting.resize(images.size());
    parallel_for(images.size() * others.size(), threads, [&](std::size_t i) {
        const std::size_t lighting = i / others.size(), other = i % others.size();
        all[other].lighting[lighting] = picture_errors(images[lighting].front(), images[lighting][other + 1]);
    });
    for (Appearance& of : all) {
        const auto n = double(of.lighting.size());
        for (const PictureErrors& errors : of.lighting) {
            of.mean.delta_e += errors.delta_e / n, of.mean.flip += errors.flip / n;
            of.mean.psnr += errors.psnr / n, of.mean.rms += errors.rms / n;
            of.worst_delta_e = std::max(of.worst_delta_e, errors.delta_e);
        }
    }
    return all;
}

}  // namespace srbf
