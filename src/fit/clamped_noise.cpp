#include "fit/clamped_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

/// Neighbours along an azimuth whose mean and variance are compared.
constexpr std::size_t k_neighbours = 30;
/// Less noise than that of so many deviations above 0 is hardly clamped: no more is searched for.
constexpr double k_unclamped = 6;
constexpr double k_least_clamped = 0.01;
/// Variance of x_i − (x_{i−1} + x_{i+1}) / 2 of independent x.
constexpr double k_second_difference_variance = 1.5;

double normal_density(double t) { return elementary::exp(-t * t / 2) / std::sqrt(2 * k_pi); }
/// Φ(−t) of the normal distribution with its density at t, within 7.5e-8 (Abramowitz & Stegun 1964, 26.2.17).
double normal_tail(double t, double density) {
    if (t < 0) return 1 - normal_tail(-t, density);
    constexpr double b[] = {1.330274429, -1.821255978, 1.781477937, -0.356563782, 0.319381530};
    const double k = 1 / (1 + 0.2316419 * t);
    double sum = 0;
    for (const double x : b) sum = (sum + x) * k;
    return density * sum;
}

/// The mean and the mean square of max(0, t + n) of a normal n of variance 1.
struct ClampedMoments {
    double mean, square;
};
ClampedMoments clamped_moments(double t) {
    const double density = normal_density(t), above = normal_tail(-t, density);
    return {density + t * above, (1 + t * t) * above + t * density};
}

/// The t at which a decreasing function reaches a value, or an end of [−3, k_unclamped].
template <typename Function> double argument_of(const Function& decreasing, double value) {
    double low = -3, high = k_unclamped;
    for (int i = 0; i < 40; ++i) {
        const double middle = (low + high) / 2;
        (decreasing(middle) > value ? low : high) = middle;
    }
    return (low + high) / 2;
}

/// σ of samples with this mean and variance.
double deviation_of(double mean, double variance) {
    const auto relative_variance = [](double x) {
        const ClampedMoments moments = clamped_moments(x);
        return moments.square / elementary::square(moments.mean) - 1;
    };
    const double t = argument_of(relative_variance, variance / (mean * mean));
    return t > 0.99 * k_unclamped ? std::sqrt(variance) : mean / clamped_moments(t).mean;
}

/// Samples in rows along which the azimuth rises.
struct SampleRows {
    std::span<const Rgb> cells;
    std::size_t length = 0;
};
SampleRows sample_rows(const Measured& measured) {
    if (const auto* merl = std::get_if<MerlTable>(&measured.table)) return {merl->cells, merl->size[2]};
    if (const auto* mbsdf = std::get_if<MbsdfTable>(&measured.table)) return {mbsdf->cells, mbsdf->azimuths};
    return {};
}

struct Neighbours {
    double mean, variance;
};
/// The windows of one channel, and how many of its samples are negative, and 0 beside others above 0.
struct SampleChannel {
    std::vector<Neighbours> windows;
    std::size_t negative = 0, cut = 0, samples = 0;
};
void add_window(SampleChannel& to, std::span<const Rgb> window, int c) {
    const auto x = [&](std::size_t i) { return double(window[i][c]); };
    double sum = 0, squares = 0;
    for (std::size_t i = 0; i < window.size(); ++i) {
        if (std::isnan(x(i))) return;
        sum += x(i);
    }
    for (std::size_t i = 1; i + 1 < window.size(); ++i) {
        squares += elementary::square(x(i) - (x(i - 1) + x(i + 1)) / 2);
        to.negative += x(i) < 0, ++to.samples;
        to.cut += x(i) == 0 && std::max(x(i - 1), x(i + 1)) > 0;
    }
    if (!(sum > 0 && squares > 0)) return;
    to.windows.push_back(
        {sum / double(window.size()), squares / (k_second_difference_variance * double(window.size() - 2))});
}

double deviation_of_all(SampleChannel& channel) {
    auto& [windows, negative, cut, samples] = channel;
    if (windows.empty() || negative > 0 || double(cut) < k_least_clamped * double(samples)) return 0;
    std::ranges::sort(windows, {}, &Neighbours::mean);
    windows.resize((windows.size() + 1) / 2);
    std::vector<double> deviations;
    for (const Neighbours& window : channel.windows) deviations.push_back(deviation_of(window.mean, window.variance));
    const auto middle = deviations.begin() + std::ptrdiff_t(deviations.size() / 2);
    std::ranges::nth_element(deviations, middle);
    return *middle;
}

}  // namespace

Rgb clamped_deviation(const Measured& measured) {
    const auto [cells, length] = sample_rows(measured);
    Rgb deviation{};
    for (int c = 0; c < 3; ++c) {
        SampleChannel channel;
        for (std::size_t row = 0; row + length <= cells.size() && length >= k_neighbours; row += length)
            for (std::size_t i = 0; i + k_neighbours <= length; i += k_neighbours)
                add_window(channel, cells.subspan(row + i, k_neighbours), c);
        deviation[c] = float(deviation_of_all(channel));
    }
    return deviation;
}

float clamped_excess(float m, float deviation) {
    if (!(deviation > 0)) return 0;
    const double t = double(m) / double(deviation), density = normal_density(t);
    return float(double(deviation) * (density - t * normal_tail(t, density)));
}

float unclamped(float mean, float deviation) {
    if (!(deviation > 0)) return mean;
    const double of_mean = double(mean) / double(deviation);
    if (of_mean >= k_unclamped) return mean;
    const double t = argument_of([](double x) { return -clamped_moments(x).mean; }, -of_mean);
    return float(std::max(t, 0.0) * double(deviation));
}

}  // namespace srbf
