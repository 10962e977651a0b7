// Chi-square tests of samplers of directions.
#pragma once
#include <algorithm>
#include <functional>
#include <numeric>
#include <span>
#include <vector>

#include "srbf/vec.h"

namespace srbf {

/// Q(a, x) = Γ(a, x) / Γ(a), the regularised upper incomplete gamma function, a > 0, x ≥ 0: by the series of P for x <
/// a + 1, otherwise by the continued fraction (Lentz).
inline double upper_gamma_ratio(double a, double x) {
    if (x <= 0) return 1;
    const double prefactor = std::exp(a * std::log(x) - x - std::lgamma(a));
    if (x < a + 1) {
        double term = 1 / a, sum = term;
        for (double k = a + 1; term > 1e-16 * sum; ++k) sum += term *= x / k;
        return 1 - prefactor * sum;
    }
    constexpr double tiny = 1e-300;
    double b = x + 1 - a, c = 1 / tiny, d = 1 / b, fraction = d;
    for (int i = 1; i < 10000; ++i) {
        const double an = -i * (i - a);
        b += 2;
        d = 1 / (std::abs(an * d + b) < tiny ? tiny : an * d + b);
        c = std::abs(b + an / c) < tiny ? tiny : b + an / c;
        fraction *= c * d;
        if (std::abs(c * d - 1) < 1e-15) break;
    }
    return prefactor * fraction;
}

/// Pearson's p-value: the probability that random counts differ from these expectations by more than the observed ones.
/// Bins with an expectation below five are pooled. Returns 0 if anything is NaN or the sums do not agree.
inline double chi2_p_value(std::span<const double> observed, std::span<const double> expected) {
    double chi2 = 0, few_observed = 0, few_expected = 0, total_observed = 0, total_expected = 0;
    int bins = 0;
    const auto add = [&](double o, double e) {
        chi2 += (o - e) * (o - e) / e;
        ++bins;
    };
    for (std::size_t i = 0; i < observed.size(); ++i) {
        total_observed += observed[i];
        total_expected += expected[i];
        if (expected[i] >= 5)
            add(observed[i], expected[i]);
        else {
            few_observed += observed[i];
            few_expected += expected[i];
        }
    }
    if (few_expected > 0 || few_observed > 0) add(few_observed, std::max(few_expected, 1.0));
    if (!(std::abs(total_observed - total_expected) <= 0.5 * std::sqrt(total_observed)) || bins < 2) return 0;
    return upper_gamma_ratio(0.5 * (bins - 1), 0.5 * chi2);
}

inline double sum_of(std::span<const double> numbers) { return std::accumulate(numbers.begin(), numbers.end(), 0.0); }

/// Sums of numbers, and what follows of them.
struct Moments {
    double count = 0, sum = 0, squares = 0, largest = 0;

    void add(double x) {
        ++count;
        sum += x;
        squares += x * x;
        largest = std::max(largest, x);
    }
    double mean() const { return sum / count; }
    double variance() const { return squares / count - mean() * mean(); }
    double relative_variance() const { return squares * count / (sum * sum) - 1; }
    double deviation_of_mean() const { return std::sqrt(std::max(0.0, variance()) / count); }
};

/// The p-value of counts whose expectations are proportional to `mass`.
inline double chi2_p_value_of_shape(std::span<const double> observed, std::vector<double> mass) {
    const double count_per_mass = sum_of(observed) / sum_of(mass);
    for (double& m : mass) m *= count_per_mass;
    return chi2_p_value(observed, mass);
}

/// The significance of each of `tests` tests, such that all together have `significance` (Šidák).
inline double sidak(double significance, int tests) { return -std::expm1(std::log1p(-significance) / tests); }

/// Bins of directions about an axis: rings between values of 1 − cos θ, cut into sectors.
struct PolarBins {
    Vec3d axis;
    std::vector<double> edge;  ///< of 1 − cos θ, from 0 to 2
    int sectors = 8;

    std::size_t size() const { return (edge.size() - 1) * std::size_t(sectors); }
    Vec3d x() const {
        const Vec3d other = std::abs(axis.x) < 0.7 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
        return normalize(cross(other, axis));
    }
    Vec3d y() const { return cross(axis, x()); }
    std::size_t index(Vec3d w) const {
        const double t = 0.5 * dot(w - axis, w - axis), turns = std::atan2(dot(w, y()), dot(w, x())) / (2 * k_pi);
        const auto ring = std::upper_bound(edge.begin() + 1, edge.end() - 1, t) - edge.begin() - 1;
        const int sector = std::min(int((turns < 0 ? turns + 1 : turns) * sectors), sectors - 1);
        return std::size_t(ring) * std::size_t(sectors) + std::size_t(sector);
    }
    /// The integral of `pdf` over each bin, by midpoints.
    std::vector<double> integrals(const std::function<double(Vec3d)>& pdf, int steps = 32) const {
        std::vector<double> mass(size());
        const Vec3d ex = x(), ey = y();
        for (std::size_t bin = 0; bin < mass.size(); ++bin) {
            const std::size_t ring = bin / std::size_t(sectors), sector = bin % std::size_t(sectors);
            const double dt = (edge[ring + 1] - edge[ring]) / steps, dphi = 2 * k_pi / (sectors * steps);
            for (int i = 0; i < steps; ++i) {
                const double t = edge[ring] + (i + 0.5) * dt, r = std::sqrt(t * (2 - t));
                for (int k = 0; k < steps; ++k) {
                    const double phi = (double(sector) * steps + k + 0.5) * dphi;
                    const Vec3d w = r * std::cos(phi) * ex + r * std::sin(phi) * ey + (1 - t) * axis;
                    mass[bin] += pdf(w) * dt * dphi;
                }
            }
        }
        return mass;
    }
};

/// The p-value of `count` samples of `sample()` against `pdf`.
template <typename Sample>
double sampler_p_value(const PolarBins& bins, const std::function<double(Vec3d)>& pdf, int count, Sample sample) {
    std::vector<double> expected = bins.integrals(pdf), observed(bins.size());
    for (double& mass : expected) mass *= count;
    for (int i = 0; i < count; ++i) {
        const Vec3d w = sample();
        // An invalid direction falls into no bin, so the sums do not agree.
        if (std::abs(dot(w, w) - 1) <= 1e-5) observed[bins.index(w)] += 1;
    }
    return chi2_p_value(observed, expected);
}

/// Rings over the sphere about the normal.
inline PolarBins sphere_bins() {
    return {{0, 0, 1}, {0, 0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 1.4, 1.6, 1.8, 1.9, 2}};
}

/// Rings of half vectors about the normal, narrow where lobes are.
inline PolarBins half_vector_bins() {
    PolarBins bins{{0, 0, 1}, {0}};
    for (double t = 2e-6; t < 0.02; t *= 4) bins.edge.push_back(t);
    for (const double t : {0.02, 0.06, 0.12, 0.2, 0.3, 0.45, 0.6, 0.8, 1.0, 2.0}) bins.edge.push_back(t);
    return bins;
}

}  // namespace srbf
