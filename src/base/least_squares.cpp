#include "base/least_squares.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace SRBF_NAMESPACE {

// Inner products of float columns are accurate to about 1e-7 of the product of the norms; a ridge of 1e-6 exceeds that.
constexpr double k_ridge = 1e-6;

namespace {

/// The active set of `bounded_least_squares`: each variable is free or fixed at a bound.
struct ActiveSet {
    enum Status { at_zero, free, at_upper };
    const Eigen::MatrixXd& G;
    const Eigen::VectorXd &g, &upper;
    std::vector<Status> status = std::vector<Status>(std::size_t(g.size()), at_zero);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(g.size());

    /// Moves the free variables to their optimum; those that reach a bound on the way stay there.
    void improve() {
        for (Eigen::Index steps = 0; steps <= g.size() && step(); ++steps) {
        }
    }

    /// Frees the variable whose release decreases the sum fastest. Returns false if no rate exceeds the tolerance.
    bool release(double tolerance) {
        const Eigen::VectorXd descent = g - G * x;
        Eigen::Index best = -1;
        double best_rate = tolerance;
        for (Eigen::Index i = 0; i < g.size(); ++i) {
            const Status now = status[std::size_t(i)];
            const double rate = now == at_zero ? descent[i] : now == at_upper ? -descent[i] : 0;
            if (rate > best_rate && G(i, i) > k_ridge && upper[i] > 0) best = i, best_rate = rate;
        }
        if (best >= 0) status[std::size_t(best)] = free;
        return best >= 0;
    }

    /// Moves the free variables towards their optimum, up to the first bound on the way, and fixes that variable there.
    /// Returns false if there is none.
    bool step() {
        std::vector<Eigen::Index> passive;
        for (Eigen::Index i = 0; i < g.size(); ++i)
            if (status[std::size_t(i)] == free) passive.push_back(i);
        if (passive.empty()) return false;
        Eigen::VectorXd fixed = x;
        for (const Eigen::Index i : passive) fixed[i] = 0;
        const Eigen::VectorXd target = G(passive, passive).ldlt().solve(Eigen::VectorXd((g - G * fixed)(passive)));
        double fraction = 1;
        Eigen::Index crossed = -1;
        Status bound = at_zero;
        for (std::size_t k = 0; k < passive.size(); ++k) {
            const Eigen::Index i = passive[k];
            const double goal = target[Eigen::Index(k)];
            const double limit = goal < 0 ? 0.0 : upper[i];
            if (goal >= 0 && goal <= upper[i]) continue;
            const double t = goal == x[i] ? 0 : (limit - x[i]) / (goal - x[i]);
            if (t < fraction) {
                fraction = std::max(t, 0.0);
                crossed = i;
                bound = goal < 0 ? at_zero : at_upper;
            }
        }
        for (std::size_t k = 0; k < passive.size(); ++k)
            x[passive[k]] += fraction * (target[Eigen::Index(k)] - x[passive[k]]);
        if (crossed < 0) return false;
        status[std::size_t(crossed)] = bound;
        x[crossed] = bound == at_zero ? 0 : upper[crossed];
        return true;
    }
};

/// H ← H − A B⁻¹ Aᵀ; returns the factors B = PᵀLDLᵀP, with which A B⁻¹ Aᵀ = (√D⁻¹ L⁻¹ P Aᵀ)ᵀ (√D⁻¹ L⁻¹ P Aᵀ).
Eigen::LDLT<Eigen::MatrixXd> subtract_eliminated(Eigen::MatrixXd& B, const Eigen::MatrixXd& A, Eigen::MatrixXd& H) {
    B.diagonal() *= 1 + k_ridge;
    Eigen::LDLT<Eigen::MatrixXd> factor(B);
    Eigen::MatrixXd half = factor.transpositionsP() * A.transpose();
    factor.matrixL().solveInPlace(half);
    for (Eigen::Index i = 0; i < half.rows(); ++i) {
        const double d = factor.vectorD()[i];
        half.row(i) *= d > 1e-300 ? 1 / std::sqrt(d) : 0;
    }
    Eigen::MatrixXd product = Eigen::MatrixXd::Zero(H.rows(), H.cols());
    product.selfadjointView<Eigen::Lower>().rankUpdate(half.transpose());
    H -= Eigen::MatrixXd(product.selfadjointView<Eigen::Lower>());
    return factor;
}

}  // namespace

Eigen::VectorXd bounded_least_squares(const Eigen::MatrixXd& G_in, const Eigen::VectorXd& g_in,
                                      const Eigen::VectorXd& upper_in, const Eigen::VectorXd& similar) {
    // Scales columns to unit length, so that tolerances are relative.
    const Eigen::Index n = g_in.size();
    if (n == 0) return {};
    Eigen::VectorXd length = G_in.diagonal().cwiseMax(0.0).cwiseSqrt();
    const Eigen::VectorXd reciprocal = (length.array() > 1e-150).select(length.array().max(1e-150).inverse(), 0.0);
    Eigen::MatrixXd G = reciprocal.asDiagonal() * G_in * reciprocal.asDiagonal();
    G.diagonal().array() += k_ridge;
    const Eigen::VectorXd g = reciprocal.cwiseProduct(g_in), upper = upper_in.cwiseProduct(length);
    const double tolerance = 1e-12 * g.cwiseAbs().maxCoeff();

    ActiveSet set{G, g, upper};
    for (Eigen::Index i = 0; i < similar.size(); ++i)
        if (similar[i] > 0 && G(i, i) > k_ridge && upper[i] > 0) set.status[std::size_t(i)] = ActiveSet::free;
    if (similar.size() > 0) set.improve();
    for (int round = 0; round < 6 * int(n) + 6 && set.release(tolerance); ++round) set.improve();
    // A variable at its bound takes it exactly; scaling back would lose a digit.
    Eigen::VectorXd x(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const ActiveSet::Status status = set.status[std::size_t(i)];
        x[i] = status == ActiveSet::at_zero    ? 0
               : status == ActiveSet::at_upper ? upper_in[i]
                                               : std::clamp(reciprocal[i] * set.x[i], 0.0, upper_in[i]);
    }
    return x;
}

Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) { return A.ldlt().solve(b); }

void eliminate(Eigen::MatrixXd B, const Eigen::MatrixXd& A, Eigen::MatrixXd& H) { subtract_eliminated(B, A, H); }

void eliminate(Eigen::MatrixXd B, const Eigen::MatrixXd& A, Eigen::MatrixXd& H, const Eigen::VectorXd& b,
               Eigen::VectorXd& g) {
    g -= A * subtract_eliminated(B, A, H).solve(b);
}

Eigen::MatrixXd with_ridge(Eigen::MatrixXd G) {
    G.diagonal().array() *= 1 + 1e-7;
    G.diagonal().array() += 1e-300;
    return G;
}

std::vector<double> cost_of_dropping(const Eigen::MatrixXd& G, const Eigen::MatrixXd& x) {
    const Eigen::MatrixXd inverse = with_ridge(G).ldlt().solve(Eigen::MatrixXd::Identity(G.rows(), G.cols()));
    std::vector<double> cost;
    for (Eigen::Index j = 0; j < G.rows(); ++j)
        cost.push_back(x.row(j).squaredNorm() / std::max(inverse(j, j), 1e-300));
    return cost;
}

void adapt_to_bounds(Eigen::VectorXd& step, const Eigen::MatrixXd& A, const Eigen::VectorXd& g,
                     const Eigen::VectorXd& lower, const Eigen::VectorXd& upper) {
    std::vector<Eigen::Index> free(std::size_t(step.size())), fixed;
    std::iota(free.begin(), free.end(), 0);
    for (;;) {
        const auto exceeds = [&](Eigen::Index i) { return step[i] < lower[i] || step[i] > upper[i]; };
        const auto first = std::stable_partition(free.begin(), free.end(), std::not_fn(exceeds));
        if (first == free.end()) return;
        fixed.insert(fixed.end(), first, free.end());
        free.erase(first, free.end());
        for (const Eigen::Index i : fixed) step[i] = std::clamp(step[i], lower[i], upper[i]);
        if (free.empty()) return;
        step(free) = -solve_symmetric(A(free, free), g(free) + A(free, fixed) * step(fixed));
    }
}

void fix_at_bounds(const Eigen::VectorXd& x, const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                   Eigen::MatrixXd& H, Eigen::VectorXd& g) {
    for (Eigen::Index i = 0; i < x.size(); ++i) {
        if (!(x[i] <= lower[i] && g[i] > 0) && !(x[i] >= upper[i] && g[i] < 0)) continue;
        H.row(i).setZero();
        H.col(i).setZero();
        g[i] = 0;
    }
}

}  // namespace
