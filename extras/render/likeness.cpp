#include "extras/render/likeness.h"

#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#include "brdf/colour.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

Plane luma(const Image8& image) {
    Plane plane(image.width, image.height);
    for (std::size_t i = 0; i < plane.pixels.size(); ++i) {
        const Rgb8& p = image.pixels[i];
        plane.pixels[i] = (0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2]) / 255;
    }
    return plane;
}

Image linear(const Image8& shown) {
    Image image(shown.width, shown.height);
    for (std::size_t i = 0; i < shown.pixels.size(); ++i)
        for (int c = 0; c < 3; ++c) image.pixels[i][c] = float(srgb_decoded(shown.pixels[i][std::size_t(c)] / 255.0));
    return image;
}

double mean(const std::vector<double>& numbers) {
    return std::accumulate(numbers.begin(), numbers.end(), 0.0) / double(numbers.size());
}

}  // namespace

std::vector<double> ssim_map(const Image8& reference, const Image8& other) {
    assert(reference.width == other.width && reference.height == other.height);
    const Plane a = luma(reference), b = luma(other);
    const Filter window = gaussian_filter(5, 1.5);
    const auto mean_of = [&](const Plane& plane) { return correlate(plane, window, window); };
    const auto mean_of_product = [&](Plane x, const Plane& y) {
        for (std::size_t i = 0; i < x.pixels.size(); ++i) x.pixels[i] *= y.pixels[i];
        return mean_of(x);
    };
    const Plane ma = mean_of(a), mb = mean_of(b), aa = mean_of_product(a, a), bb = mean_of_product(b, b),
                ab = mean_of_product(a, b);
    constexpr double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
    std::vector<double> map;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        const double ua = ma.pixels[i], ub = mb.pixels[i], va = aa.pixels[i] - ua * ua, vb = bb.pixels[i] - ub * ub,
                     cov = ab.pixels[i] - ua * ub;
        map.push_back((2 * ua * ub + c1) * (2 * cov + c2) / ((ua * ua + ub * ub + c1) * (va + vb + c2)));
    }
    return map;
}

std::vector<double> flip_map(const Image8& reference, const Image8& other, double pixels_per_degree) {
    return flip_map(linear(reference), linear(other), pixels_per_degree);
}

Likeness likeness(const Image8& reference, const Image8& other) {
    assert(reference.pixels.size() == other.pixels.size() && !reference.pixels.empty());
    double squares = 0;
    for (std::size_t i = 0; i < reference.pixels.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const double error = (reference.pixels[i][c] - other.pixels[i][c]) / 255.0;
            squares += error * error;
        }
    squares /= 3 * double(reference.pixels.size());
    return {squares > 0 ? -10 * elementary::log10(squares) : std::numeric_limits<double>::infinity(),
            mean(ssim_map(reference, other)), mean(flip_map(reference, other))};
}

Image8 in_false_colours(const std::vector<double>& map, int width, int height) {
    assert(map.size() == std::size_t(width) * std::size_t(height));
    // Colours of matplotlib's "magma" at uniform steps of lightness.
    constexpr std::array<std::array<double, 3>, 6> stops{{{0.0, 0.0, 0.016},
                                                          {0.232, 0.060, 0.438},
                                                          {0.550, 0.161, 0.506},
                                                          {0.869, 0.288, 0.409},
                                                          {0.995, 0.624, 0.428},
                                                          {0.987, 0.991, 0.750}}};
    Image8 image(width, height);
    for (std::size_t i = 0; i < map.size(); ++i) {
        const double position = 5 * std::clamp(map[i], 0.0, 1.0);
        const auto below = std::min(std::size_t(position), std::size_t(4));
        for (std::size_t c = 0; c < 3; ++c) {
            const double x = std::lerp(stops[below][c], stops[below + 1][c], position - double(below));
            image.pixels[i][c] = std::uint8_t(255 * x + 0.5);
        }
    }
    return image;
}

}  // namespace
