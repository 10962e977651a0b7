#include "fit/noise.h"

#include <limits>

#include "base/errors.h"
#include "base/floating_point.h"
#include "brdf/directions.h"
#include "models/pm/search/fit_pm.h"
#include "observe/observations.h"
#include "observe/pairs.h"
#include "srbf/elementary.h"
#include "srbf/model.h"

namespace SRBF_NAMESPACE {
namespace {

/// The step between values whose noise is independent: more than the distance of most tables' nodes.
constexpr double k_noise_step = 3 * k_degree;
/// The largest polar angle of light and viewer, also after the light is rotated.
constexpr double k_noise_theta = 80 * k_degree;
constexpr std::size_t k_noise_pairs = 8192;
/// A normal distribution has this median of |x| in standard deviations, and this variance of x0 − (x1 + x2) / 2.
constexpr double k_median_of_normal = 0.6745, k_variance_of_difference = 1.5;
/// Noise of a tenth of dark values changes a fit less than another seed does; noise of all of them doubles its error.
constexpr double k_noisy = 0.3;
/// Clean tables have almost no isolated negative values.
constexpr double k_negative = 0.01;
/// A value within this number of deviations of the fitted one differs by noise.
constexpr float k_noise_limit = 3;
/// Before the first fit, values below this many standard deviations are weighted alike.
constexpr float k_floor_deviations = 5;
constexpr int k_rounds = 3;
/// The options of the short fits, by pairs alone.
constexpr int k_noise_starts = 4, k_noise_perturbations = 20;

double median(std::vector<double> x) {
    const auto middle = x.begin() + std::ptrdiff_t(x.size() / 2);
    std::ranges::nth_element(x, middle);
    return *middle;
}

/// The standard deviation of values, each with a mean, from the median of the values with the darker half of the means.
double dark_deviation(std::vector<std::pair<double, double>> means) {
    if (means.empty()) return 0;
    std::ranges::sort(means);
    means.resize((means.size() + 1) / 2);
    std::vector<double> values;
    for (const auto& [mean, value] : means) values.push_back(std::abs(value));
    return median(std::move(values)) / k_median_of_normal;
}

/// The direction rotated by an angle towards the tangent of that azimuth.
Vec3f turned(Vec3f w, double azimuth, double angle) {
    const Vec3d z = to_double(w);
    const Frame frame = frame_about(z);
    const Vec3d across = elementary::cos(azimuth) * frame.x + elementary::sin(azimuth) * frame.y;
    return to_float(elementary::cos(angle) * z + elementary::sin(angle) * across);
}

/// f at triples of pairs: one pair, and two with its light rotated to either side.
std::vector<Rgb> at_triples(const Evaluate& f) {
    const MirrorMixture cap(k_noise_theta);
    std::mt19937_64 random(0);
    RSequence<6> points = random_sequence(random);
    std::vector<Vec3f> wl, wv;
    while (wl.size() < 3 * k_noise_pairs) {
        const auto pair = pair_within(cap, points.next());
        if (!pair) continue;
        const double azimuth = k_golden_angle * double(wl.size());
        const Vec3f one = turned(pair->wl, azimuth, k_noise_step), other = turned(pair->wl, azimuth, -k_noise_step);
        if (!cap.contains(to_double(one)) || !cap.contains(to_double(other))) continue;
        wl.insert(wl.end(), {pair->wl, one, other});
        wv.insert(wv.end(), 3, pair->wv);
    }
    std::vector<Rgb> values(wl.size());
    f(wl, wv, values);
    return values;
}

/// Values of at least √(f² + (k_floor_deviations σ)²), by which weights hardly depend on the noise of dark values.
Evaluate above_noise(const Evaluate& f, const Rgb& deviation) {
    return [f, deviation](std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> values) {
        f(wl, wv, values);
        for (Rgb& value : values)
            for (int c = 0; c < 3; ++c) {
                const float min = k_floor_deviations * deviation[c];
                value[c] = std::sqrt(value[c] * value[c] + min * min);
            }
    };
}

/// The fractions λ of `smoothed`.
Rgb fraction_of_noise(const Evaluate& f, const Evaluate& fitted, const Rgb& deviation) {
    const std::vector<Rgb> values = at_triples(f), means = at_triples(fitted);
    Rgb lambda;
    for (int c = 0; c < 3; ++c) {
        std::vector<std::pair<double, double>> differences;
        for (std::size_t i = 0; i < values.size(); ++i)
            if (std::isfinite(values[i][c]))
                differences.emplace_back(double(means[i][c]), double(values[i][c]) - double(means[i][c]));
        const double ratio = double(deviation[c]) / dark_deviation(std::move(differences));
        lambda[c] = float(ratio < 1 ? ratio * ratio : 1);
    }
    return lambda;
}

/// The result of `smoothed`, by this f̂.
Evaluate smoothed_towards(const Evaluate& fitted, const Evaluate& f, const Rgb& deviation) {
    const Rgb lambda = fraction_of_noise(f, fitted, deviation);
    return [f, fitted, deviation, lambda](std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> values) {
        std::vector<Rgb> means(values.size());
        f(wl, wv, values);
        fitted(wl, wv, means);
        for (std::size_t i = 0; i < values.size(); ++i)
            for (int c = 0; c < 3; ++c) {
                const float max = k_noise_limit * deviation[c];
                values[i][c] -= lambda[c] * std::clamp(values[i][c] - means[i][c], -max, max);  // NaN remains
            }
    };
}

}  // namespace

Noise noise_of(const Evaluate& f) {
    const std::vector<Rgb> values = at_triples(f);
    Noise noise;
    for (int c = 0; c < 3; ++c) {
        std::vector<std::pair<double, double>> means;  // (mean, second difference), which noise makes independent
        std::size_t negative = 0;
        for (std::size_t i = 0; i < values.size(); i += 3) {
            const double x = double(values[i][c]), beside = double(values[i + 1][c]) + double(values[i + 2][c]);
            if (!std::isfinite(x + beside)) continue;
            means.emplace_back((x + beside) / 3, x - beside / 2);
            negative += x < 0 && x + beside > 0;
        }
        if (means.empty()) continue;
        noise.negative = std::max(noise.negative, double(negative) / double(means.size()));
        std::ranges::sort(means);
        noise.level[c] = float(means[means.size() / 4].first);
        noise.deviation[c] = float(dark_deviation(std::move(means)) / std::sqrt(k_variance_of_difference));
    }
    return noise;
}

bool is_noisy(const Noise& noise) { return fraction_of(noise) > k_noisy || noise.negative > k_negative; }

double largest_fraction(const Noise& noise) {
    constexpr double k_infinite = std::numeric_limits<double>::infinity();
    double largest = 0;
    for (int c = 0; c < 3; ++c) {
        const double deviation = double(noise.deviation[c]), level = double(noise.level[c]);
        if (deviation > 0) largest = std::max(largest, level > 0 ? deviation / level : k_infinite);
    }
    return largest;
}

Result<Evaluate> smoothed(const Evaluate& f, const Noise& noise, bool axial, int threads,
                          const ProgressToken& progress) {
    PmFitOptions options;
    options.axial = axial;
    options.starts = k_noise_starts;
    options.perturbations = k_noise_perturbations;
    options.threads = threads;
    Evaluate smooth = above_noise(f, noise.deviation);
    for (int round = 0; round < k_rounds; ++round) {
        const ProgressToken part = progress.subrange(double(round) / k_rounds, (round + 1.0) / k_rounds);
        const auto observed = observe(f, {.threads = threads, .smoothed = smooth}, part.subrange(0, 0.3));
        if (!observed) return observed.error();
        auto fitted = fit_pm(first_pairs(*observed, observed->fitted_count()), options, part.subrange(0.3, 1));
        if (!fitted) return fitted.error();
        smooth = smoothed_towards(evaluator(std::move(fitted->model)), f, noise.deviation);
    }
    return smooth;
}

Result<Evaluate> smoothed_to_noise(const Measured& measured, int threads, const ProgressToken& progress) {
    const StandardArithmetic mode;
    const auto refused = [](const char* expected, std::string found) {
        return argument_error("smoothing", "measurement", expected, std::move(found));
    };
    if (std::holds_alternative<ScatteredSamples>(measured.table)) return refused("a table", "scattered samples");
    if (std::holds_alternative<BsdfTable>(measured.table))
        return refused("a table of reflection", "reflection and transmission");
    const Evaluate f = signed_evaluator(measured);
    const Noise noise = noise_of(f);
    if (!is_noisy(noise))
        return refused("a noisy table", fmt::format("noise of {:.0f} % of dark values", 100 * fraction_of(noise)));
    return smoothed(f, noise, true, threads, progress);
}

}  // namespace
