#include "extras/maps/block_pivoting.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/least_squares.h"

namespace SRBF_NAMESPACE {
namespace {

constexpr double k_pivoting_ridge = 1e-6;  ///< that of `bounded_least_squares`
/// Least pivot: rounding errors of a matrix of floats must not make it indefinite.
constexpr double k_least_pivot = 1e-7;
constexpr double k_tolerance = 1e-12;
constexpr int k_patience = 3;

}  // namespace

void BlockPivoting::set_matrix(std::span<const double> G, std::span<const bool> is_free) {
    const std::size_t n = is_free.size();
    n_ = n, is_factored_ = false;
    G_.resize(n * n), reciprocal_.resize(n), g_.resize(n), upper_.resize(n), x_.resize(n), factor_.resize(n * n),
        right_.resize(n);
    status_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        const double length = std::sqrt(std::max(G[i * n + i], 0.0));
        reciprocal_[i] = length > 1e-150 ? 1 / length : 0;
        status_[i] = is_free[i] && reciprocal_[i] > 0 ? free : at_zero;
    }
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j)
            G_[i * n + j] = reciprocal_[i] * G[i * n + j] * reciprocal_[j] + (i == j ? k_pivoting_ridge : 0);
}

void BlockPivoting::minimise(std::span<const double> g, std::span<const double> upper, std::span<double> x) {
    double largest = 0;
    for (std::size_t i = 0; i < n_; ++i) {
        g_[i] = reciprocal_[i] * g[i], largest = std::max(largest, std::abs(g_[i]));
        upper_[i] = reciprocal_[i] > 0 ? upper[i] / reciprocal_[i] : 0;
        if (status_[i] == at_upper && !std::isfinite(upper_[i])) status_[i] = free;
    }
    std::size_t least = n_ + 1;
    int patience = k_patience;
    for (std::size_t step = 0; step < 50 + 10 * n_; ++step) {
        solve_free();
        const std::size_t count = count_violations(k_tolerance * largest);
        if (count == 0) return take(upper, x);
        if (count < least) {
            least = count, patience = k_patience;
        } else if (--patience < 0) {
            change(violations_.back());
            continue;
        }
        for (const std::size_t i : violations_) change(i);
    }
    // Rounding errors let the violations recur: almost never.
    using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;
    const auto vector = [&](const std::vector<double>& of) { return VectorXd::Map(of.data(), Index(n_)); };
    const VectorXd slow =
        bounded_least_squares(MatrixXd::Map(G_.data(), Index(n_), Index(n_)), vector(g_), vector(upper_));
    for (std::size_t i = 0; i < n_; ++i) {
        x_[i] = slow[Index(i)];
        status_[i] = x_[i] <= 0 ? at_zero : x_[i] >= upper_[i] ? at_upper : free;
    }
    take(upper, x);
}

void BlockPivoting::take(std::span<const double> upper, std::span<double> x) const {
    for (std::size_t i = 0; i < n_; ++i)
        x[i] = status_[i] == at_zero    ? 0
               : status_[i] == at_upper ? upper[i]
                                        : std::clamp(reciprocal_[i] * x_[i], 0.0, upper[i]);
}

/// Solves for the free x.
void BlockPivoting::solve_free() {
    std::swap(free_, factored_), free_.clear();
    bool has_upper = false;
    for (std::size_t i = 0; i < n_; ++i) {
        x_[i] = status_[i] == at_upper ? upper_[i] : 0;
        has_upper |= status_[i] == at_upper;
        if (status_[i] == free) free_.push_back(i);
    }
    if (!is_factored_ || free_ != factored_) factor_free();
    const std::size_t m = free_.size();
    for (std::size_t k = 0; k < m; ++k) {
        right_[k] = g_[free_[k]];
        for (std::size_t i = 0; has_upper && i < n_; ++i) right_[k] -= G_[free_[k] * n_ + i] * x_[i];
    }
    for (std::size_t k = 0; k < m; ++k) {
        const double* const of = factor_.data() + k * m;
        const double y = right_[k] * of[k];
        for (std::size_t i = k + 1; i < m; ++i) right_[i] -= of[i] * y;
    }
    for (std::size_t k = m; k-- > 0;) {
        const double* const of = factor_.data() + k * m;
        double sum = right_[k];
        for (std::size_t i = k + 1; i < m; ++i) sum -= of[i] * right_[i];
        x_[free_[k]] = right_[k] = sum * of[k];
    }
}

/// G = L D Lᵀ of the free x, by columns: column k of the factor has D_k L_ik, i > k, and at its head 1 / D_k. The inner
/// loop runs over independent numbers.
void BlockPivoting::factor_free() {
    const std::size_t m = free_.size();
    for (std::size_t k = 0; k < m; ++k)
        for (std::size_t i = k; i < m; ++i) factor_[k * m + i] = G_[free_[k] * n_ + free_[i]];
    for (std::size_t k = 0; k < m; ++k) {
        double* const __restrict of = factor_.data() + k * m;
        const double pivot = of[k] = 1 / std::max(of[k], k_least_pivot);
        for (std::size_t j = k + 1; j < m; ++j) {
            double* const __restrict other = factor_.data() + j * m;
            const double factor = of[j] * pivot;
            for (std::size_t i = j; i < m; ++i) other[i] -= factor * of[i];
        }
    }
    is_factored_ = true;
}

std::size_t BlockPivoting::count_violations(double tolerance) {
    violations_.clear();
    for (std::size_t i = 0; i < n_; ++i) {
        if (reciprocal_[i] == 0) continue;
        double descent = 0;  // the negative gradient, 0 for free x
        if (status_[i] != free) {
            descent = g_[i];
            for (std::size_t j = 0; j < n_; ++j) descent -= G_[i * n_ + j] * x_[j];
        }
        const bool violates = status_[i] == free      ? x_[i] < 0 || x_[i] > upper_[i]
                              : status_[i] == at_zero ? descent > tolerance && upper_[i] > 0
                                                      : -descent > tolerance;
        if (violates) violations_.push_back(i);
    }
    return violations_.size();
}

void BlockPivoting::change(std::size_t i) { status_[i] = status_[i] != free ? free : x_[i] < 0 ? at_zero : at_upper; }

}  // namespace srbf
