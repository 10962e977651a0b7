#include "errors/image_errors.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <numeric>

#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

Plane combine(const Plane& a, const Plane& b, const auto& operation) {
    Plane result(a.width, a.height);
    for (std::size_t i = 0; i < result.pixels.size(); ++i) result.pixels[i] = operation(a.pixels[i], b.pixels[i]);
    return result;
}

Filter sample_filter(int radius, const std::function<double(double)>& weight) {
    Filter filter;
    for (int i = -radius; i <= radius; ++i) filter.push_back(weight(i));
    return filter;
}
void add_scaled(double* sum, const double* x, double factor, int count) {
    for (int i = 0; i < count; ++i) sum[i] += factor * x[i];
}
double sum(const std::vector<double>& numbers) { return std::accumulate(numbers.begin(), numbers.end(), 0.0); }

}  // namespace

Filter gaussian_filter(int radius, double sigma) {
    Filter filter = sample_filter(radius, [&](double x) { return elementary::exp(-x * x / (2 * sigma * sigma)); });
    const double whole = sum(filter);
    for (double& w : filter) w /= whole;
    return filter;
}

Plane correlate(const Plane& plane, const Filter& horizontal, const Filter& vertical) {
    const int width = plane.width, height = plane.height;
    const auto row = [width](auto& image, int y) { return image.pixels.data() + std::size_t(y) * std::size_t(width); };
    Plane filtered_rows(width, height), result(width, height);
    const auto radius = horizontal.size() / 2;
    for (int y = 0; y < height; ++y) {
        const double* const source = row(plane, y);
        std::vector<double> padded(radius, source[0]);
        padded.insert(padded.end(), source, source + width);
        padded.insert(padded.end(), radius, source[width - 1]);
        for (std::size_t i = 0; i < horizontal.size(); ++i)
            add_scaled(row(filtered_rows, y), &padded[i], horizontal[i], width);
    }
    for (int y = 0; y < height; ++y)
        for (std::size_t i = 0; i < vertical.size(); ++i) {
            const int v = std::clamp(y + int(i) - int(vertical.size() / 2), 0, height - 1);
            add_scaled(row(result, y), row(filtered_rows, v), vertical[i], width);
        }
    return result;
}

namespace {

using Triplet = std::array<double, 3>;

// The constants up to `flip_map` come from the reference implementation of ꟻLIP (see `flip_map`).

/// Linear sRGB as CIE XYZ, each divided by its value for white.
Triplet to_relative_xyz(const Triplet& rgb) {
    constexpr double m[3][3] = {
        {0.412391, 0.357584, 0.180481}, {0.212639, 0.715169, 0.072192}, {0.019331, 0.119195, 0.950532}};
    Triplet xyz;
    for (std::size_t i = 0; i < 3; ++i)
        xyz[i] = (m[i][0] * rgb[0] + m[i][1] * rgb[1] + m[i][2] * rgb[2]) / (m[i][0] + m[i][1] + m[i][2]);
    return xyz;
}
Triplet to_linear_rgb(const Triplet& relative) {
    const double x = 0.950456 * relative[0], y = relative[1], z = 1.089058 * relative[2];
    return {3.240970 * x - 1.537383 * y - 0.498611 * z, -0.969244 * x + 1.875968 * y + 0.041555 * z,
            0.055630 * x - 0.203977 * y + 1.056972 * z};
}

/// CIELAB with chroma scaled by L/100 (Hunt effect).
Triplet hunt_lab(const Triplet& rgb) {
    Triplet t = to_relative_xyz(rgb);
    for (double& v : t) v = v > 216.0 / 24389 ? elementary::cbrt(v) : v * 841 / 108 + 4.0 / 29;
    const double l = 116 * t[1] - 16;
    return {l, 0.01 * l * 500 * (t[0] - t[1]), 0.01 * l * 200 * (t[1] - t[2])};
}
/// HyAB distance to the power 0.7.
double colour_distance(const Triplet& a, const Triplet& b) {
    return elementary::pow(std::abs(a[0] - b[0]) + elementary::hypot(a[1] - b[1], a[2] - b[2]), 0.7);
}
/// Maps `colour_distance` to [0, 1]: values up to 0.4 of the largest distance, green to blue, use 0.95 of the range.
double scale_distance(double distance) {
    static const double largest = colour_distance(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1}));
    const double knee = 0.4 * largest;
    return distance < knee ? 0.95 * distance / knee : 0.95 + 0.05 * (distance - knee) / (largest - knee);
}

/// The colours of an image as Y, Cx, Cz.
std::array<Plane, 3> opponent_colours(const Image& image) {
    const Plane blank(image.width, image.height);
    std::array<Plane, 3> planes{blank, blank, blank};
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        const Rgb& colour = image.pixels[i];
        const Triplet t = to_relative_xyz({double(colour.r), double(colour.g), double(colour.b)});
        planes[0].pixels[i] = 116 * t[1] - 16;
        planes[1].pixels[i] = 500 * (t[0] - t[1]);
        planes[2].pixels[i] = 200 * (t[1] - t[2]);
    }
    return planes;
}

/// Filters each channel by the contrast sensitivity of the eye, Σ a √(π/b) e^{−π²x²/b} with x in degrees, and converts
/// to the colours that `colour_distance` compares.
std::vector<Triplet> perceived_colours(const std::array<Plane, 3>& planes, double pixels_per_degree) {
    struct Gaussian {
        double a, b;
    };
    static const std::vector<Gaussian> sensitivity[3] = {{{1, 0.0047}}, {{1, 0.0053}}, {{34.1, 0.04}, {13.5, 0.025}}};
    const int radius = int(std::ceil(3 * std::sqrt(0.04 / (2 * k_pi * k_pi)) * pixels_per_degree));
    std::vector<Plane> resolved;
    for (std::size_t c = 0; c < 3; ++c) {
        Plane total(planes[c].width, planes[c].height);
        double total_weight = 0;
        for (const auto& [a, b] : sensitivity[c]) {
            const Filter filter = sample_filter(radius, [b = b, pixels_per_degree](double x) {
                return elementary::exp(-k_pi * k_pi * x * x / (pixels_per_degree * pixels_per_degree * b));
            });
            const double weight = a * std::sqrt(k_pi / b);
            total = combine(total, correlate(planes[c], filter, filter),
                            [&](double s, double x) { return s + weight * x; });
            total_weight += weight * sum(filter) * sum(filter);
        }
        for (double& x : total.pixels) x /= total_weight;
        resolved.push_back(std::move(total));
    }
    std::vector<Triplet> colours;
    for (std::size_t i = 0; i < planes[0].pixels.size(); ++i) {
        const double y = (resolved[0].pixels[i] + 16) / 116;
        Triplet rgb = to_linear_rgb({y + resolved[1].pixels[i] / 500, y, y - resolved[2].pixels[i] / 200});
        for (double& v : rgb) v = std::clamp(v, 0.0, 1.0);
        colours.push_back(hunt_lab(rgb));
    }
    return colours;
}

/// Magnitudes of edges or points: `derivative` is the filter along one axis, relative to a Gaussian, with positive and
/// negative weights normalised to 1 each. The filter along the other axis is a Gaussian.
Plane feature_map(const Plane& luma, double sigma, const std::function<double(double)>& derivative) {
    const int radius = int(std::ceil(3 * sigma));
    const Filter gaussian = gaussian_filter(radius, sigma);
    Filter edge =
        sample_filter(radius, [&](double x) { return derivative(x) * elementary::exp(-x * x / (2 * sigma * sigma)); });
    double positive = 0, negative = 0;
    for (const double w : edge) (w > 0 ? positive : negative) += std::abs(w);
    for (double& w : edge) w /= w > 0 ? positive : negative;
    return combine(correlate(luma, edge, gaussian), correlate(luma, gaussian, edge),
                   [](double dx, double dy) { return elementary::hypot(dx, dy); });
}

struct Features {
    Plane edges, points;
};
Features detect_features(Plane y, double pixels_per_degree) {
    for (double& v : y.pixels) v = (v + 16) / 116;
    const double sigma = 0.5 * 0.082 * pixels_per_degree;
    return {feature_map(y, sigma, [](double x) { return -x; }),
            feature_map(y, sigma, [&](double x) { return x * x / (sigma * sigma) - 1; })};
}

}  // namespace

std::vector<double> flip_map(const Image& reference, const Image& other, double pixels_per_degree) {
    assert(reference.width == other.width && reference.height == other.height);
    const auto a = opponent_colours(reference), b = opponent_colours(other);
    const auto colours_a = perceived_colours(a, pixels_per_degree), colours_b = perceived_colours(b, pixels_per_degree);
    const Features fa = detect_features(a[0], pixels_per_degree), fb = detect_features(b[0], pixels_per_degree);
    std::vector<double> map;
    for (std::size_t i = 0; i < colours_a.size(); ++i) {
        const double colour = scale_distance(colour_distance(colours_a[i], colours_b[i]));
        const double difference = std::max(std::abs(fa.edges.pixels[i] - fb.edges.pixels[i]),
                                           std::abs(fa.points.pixels[i] - fb.points.pixels[i]));
        const double feature = std::sqrt(std::min(difference / std::sqrt(2.0), 1.0));
        map.push_back(elementary::pow(colour, 1 - feature));
    }
    return map;
}

}  // namespace
