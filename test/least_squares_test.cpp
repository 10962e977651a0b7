// Bounded linear least squares, checked by optimality conditions, which suffice for a convex problem.
// Levenberg-Marquardt on problems with known solutions.
#include "base/least_squares.h"
#include "base/levenberg_marquardt.h"

#include "properties.h"

namespace srbf::least_squares_test {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct LinearProblem {
    MatrixXd G;
    VectorXd g, upper;
};

double draw(std::mt19937_64& random) { return 2 * uniform(random) - 1; }

/// A problem AᵀA, Aᵀy. Norms of the columns differ by orders of magnitude. Degenerate problems have equal and zero
/// columns.
LinearProblem random_problem(std::mt19937_64& random, Index n, bool degenerate, bool bounded) {
    MatrixXd A = MatrixXd::NullaryExpr(n + 4, n, [&] { return draw(random) + 0.4; });
    const VectorXd y = VectorXd::NullaryExpr(n + 4, [&] { return draw(random) + 0.2; });
    for (Index i = 0; i < n; ++i) A.col(i) *= std::pow(10, 3 * draw(random));
    if (degenerate && n > 1) {
        A.col(n - 1) = 0.5 * A.col(0);
        if (n > 3) A.col(2).setZero();
    }
    LinearProblem problem{A.transpose() * A, A.transpose() * y, VectorXd::Constant(n, INFINITY)};
    for (Index i = 0; i < n && bounded; ++i) {
        const double length = A.col(i).norm(), kind = uniform(random);
        if (kind < 0.1)
            problem.upper[i] = 0;
        else if (kind < 0.7 && length > 0)
            problem.upper[i] = 0.5 * uniform(random) * y.norm() / length;
    }
    return problem;
}

/// The documented regularization, and the matrix that includes it.
constexpr double k_regularization = 1e-6;
MatrixXd regularized(const MatrixXd& G) { return G + MatrixXd(k_regularization * G.diagonal().asDiagonal()); }

/// Returns how far x violates the optimality conditions with columns scaled to unit length, relative to the largest gᵢ.
/// Infinite if x is outside the bounds.
double violation(const LinearProblem& p, const VectorXd& x) {
    const VectorXd descent = p.g - regularized(p.G) * x;
    double worst = 0, scale = 1e-300;
    for (Index i = 0; i < x.size(); ++i) {
        const double length = std::sqrt(p.G(i, i));
        if (!(x[i] >= 0 && x[i] <= p.upper[i])) return INFINITY;
        if (length == 0) {
            if (x[i] != 0) return INFINITY;
            continue;
        }
        const double rate = descent[i] / length;
        scale = std::max(scale, std::abs(p.g[i]) / length);
        double violation_i = std::abs(rate);
        if (x[i] == 0) violation_i = std::max(rate, 0.0);
        if (x[i] == p.upper[i]) violation_i = std::max(-rate, 0.0);
        if (p.upper[i] == 0) violation_i = 0;
        worst = std::isfinite(violation_i) ? std::max(worst, violation_i) : INFINITY;
    }
    return worst / scale;
}

TEST(BoundedLeastSquares, SatisfiesTheOptimalityConditions) {
    std::mt19937_64 random(1);
    for (const Index n : {1, 2, 3, 5, 8, 20, 64})
        for (int trial = 0; trial < 60; ++trial) {
            const LinearProblem p = random_problem(random, n, trial % 3 == 0, trial % 2 == 0);
            EXPECT_LE(violation(p, bounded_least_squares(p.G, p.g, p.upper)), 1e-9) << n << ' ' << trial;
        }
}

TEST(BoundedLeastSquares, HandlesNearlyEqualColumns) {
    // Exponentials with close rates: G is numerically singular.
    std::mt19937_64 random(3);
    const VectorXd t = VectorXd::LinSpaced(200, 0, 1), rate = VectorXd::LinSpaced(24, 0.5, 12);
    const MatrixXd A = (-t * rate.transpose()).array().exp();
    for (int trial = 0; trial < 40; ++trial) {
        const VectorXd y =
            (2 - 3 * t.array()) * t.array() + VectorXd::NullaryExpr(200, [&] { return 0.1 * draw(random); }).array();
        const double high = trial % 2 ? INFINITY : 0.05;
        const LinearProblem p{A.transpose() * A, A.transpose() * y, VectorXd::Constant(24, high)};
        EXPECT_LE(violation(p, bounded_least_squares(p.G, p.g, p.upper)), 1e-9) << trial;
    }
}

TEST(BoundedLeastSquares, OneVariableIsTheClampedQuotient) {
    const auto solve = [](double G, double g, double upper) {
        return bounded_least_squares(MatrixXd::Constant(1, 1, G), VectorXd::Constant(1, g),
                                     VectorXd::Constant(1, upper))[0];
    };
    EXPECT_WITHIN_RELATIVE(solve(4, 6, INFINITY), 1.5, 2 * k_regularization);
    EXPECT_WITHIN_RELATIVE(solve(4e-40, 6e-40, INFINITY), 1.5, 2 * k_regularization);
    EXPECT_WITHIN_RELATIVE(solve(4e40, 6e40, INFINITY), 1.5, 2 * k_regularization);
    EXPECT_EQ(solve(4, 6, 1), 1);
    EXPECT_EQ(solve(4, 6, 0), 0);
    EXPECT_EQ(solve(4, -6, INFINITY), 0);
    EXPECT_EQ(solve(4, 0, INFINITY), 0);
    EXPECT_EQ(solve(0, 0, INFINITY), 0);
    EXPECT_EQ(solve(0, 0, 1), 0);
    EXPECT_EQ(bounded_least_squares(MatrixXd(0, 0), VectorXd(0), VectorXd(0)).size(), 0);
}

/// The X that minimises |A X − B|. A single function, since it takes seconds to compile.
MatrixXd solved_by_qr(const MatrixXd& A, const MatrixXd& B) { return A.colPivHouseholderQr().solve(B); }

/// y(t) = Σ_k c_k exp(−x_k t), where the c_k are eliminated by orthogonal projection.
struct Exponentials {
    VectorXd t, y;
    VectorXd lower_bound, upper_bound;
    VectorXd last_x, coefficient, residual;
    MatrixXd A;
    int calls = 0;

    double loss(const VectorXd& x) {
        ++calls;
        last_x = x;
        A = (-t * x.transpose()).array().exp();
        coefficient = solved_by_qr(A, y);
        residual = A * coefficient - y;
        return residual.squaredNorm();
    }
    void linearise(const VectorXd& x, MatrixXd& H, VectorXd& g) {
        EXPECT_EQ(x, last_x) << "linearise was called for another x than the last loss";
        MatrixXd J = ((-t).asDiagonal() * A) * coefficient.asDiagonal();
        J -= A * solved_by_qr(A, J);
        H = J.transpose() * J;
        g = J.transpose() * residual;
    }
    VectorXd lower(const VectorXd&) const { return lower_bound; }
    VectorXd upper(const VectorXd&) const { return upper_bound; }
    VectorXd longest_step(const VectorXd& x) const { return VectorXd::Constant(x.size(), 1e3); }
};

Exponentials two_exponentials(double noise = 0) {
    Exponentials problem;
    problem.t = VectorXd::LinSpaced(50, 0, 4);
    problem.y = 2 * (-0.5 * problem.t).array().exp() + 3 * (-3 * problem.t).array().exp();
    for (Index i = 0; i < problem.t.size(); ++i) problem.y[i] += noise * std::sin(double(7 * i * i));
    problem.lower_bound = VectorXd::Constant(2, 0.0);
    problem.upper_bound = VectorXd::Constant(2, INFINITY);
    return problem;
}
const LevenbergMarquardtOptions k_precise{.max_iterations = 200, .decrease_tolerance = 1e-14};

// Variables that are not at a bound minimise the problem, given the variables that are.
TEST(AdaptToBounds, SolvesAgainForFreeVariables) {
    std::mt19937_64 random(7);
    int at_bounds = 0;
    for (int round = 0; round < 200; ++round) {
        const Index n = 1 + round % 8;
        const LinearProblem problem = random_problem(random, n, false, false);
        const VectorXd lower = VectorXd::NullaryExpr(n, [&] { return -uniform(random); }),
                       upper = VectorXd::NullaryExpr(n, [&] { return uniform(random); });
        VectorXd step = -solve_symmetric(problem.G, problem.g);
        adapt_to_bounds(step, problem.G, problem.g, lower, upper);
        const VectorXd gradient = problem.G * step + problem.g;
        for (Index i = 0; i < n; ++i) {
            EXPECT_GE(step[i], lower[i]);
            EXPECT_LE(step[i], upper[i]);
            const bool at_bound = step[i] == lower[i] || step[i] == upper[i];
            at_bounds += at_bound;
            if (!at_bound) {
                EXPECT_LE(std::abs(gradient[i]), 1e-5 * (std::abs(problem.g[i]) + problem.G.row(i).norm())) << i;
            }
        }
    }
    EXPECT_GT(at_bounds, 100);
}

TEST(LevenbergMarquardt, RecoversSyntheticRates) {
    Exponentials problem = two_exponentials();
    VectorXd x(2);
    x << 1.0, 2.0;
    const double before = problem.loss(x);
    const auto summary = levenberg_marquardt(problem, x, k_precise);
    EXPECT_WITHIN_RELATIVE(x.minCoeff(), 0.5, 1e-9) << x;
    EXPECT_WITHIN_RELATIVE(x.maxCoeff(), 3, 1e-9) << x;
    EXPECT_WITHIN_RELATIVE(problem.coefficient.minCoeff(), 2, 1e-8);
    EXPECT_WITHIN_RELATIVE(problem.coefficient.maxCoeff(), 3, 1e-8);
    EXPECT_LT(summary.loss, 1e-18 * before);
    EXPECT_LT(summary.iterations, 50);
    EXPECT_EQ(problem.last_x, x);
}

TEST(LevenbergMarquardt, StopsWhereTheGradientVanishes) {
    Exponentials problem = two_exponentials(0.01);
    VectorXd x(2);
    x << 1.0, 2.0;
    MatrixXd H;
    VectorXd g;
    const auto by_difference = [&](const VectorXd& point, Index i) {
        const VectorXd step = 1e-5 * VectorXd::Unit(2, i);
        return (problem.loss(point + step) - problem.loss(point - step)) / 4e-5;  // derivative of loss / 2
    };
    const VectorXd difference{{by_difference(x, 0), by_difference(x, 1)}};
    problem.loss(x);
    problem.linearise(x, H, g);
    EXPECT_LE((g - difference).norm(), 1e-6 * g.norm());

    const auto summary = levenberg_marquardt(problem, x, k_precise);
    EXPECT_EQ(summary.stop, Stop::decrease);
    EXPECT_EQ(problem.last_x, x);
    EXPECT_EQ(summary.loss, problem.loss(x));
    VectorXd final_gradient;
    problem.linearise(x, H, final_gradient);
    EXPECT_LE(final_gradient.norm(), 1e-6 * g.norm());
}

TEST(LevenbergMarquardt, KeepsTheBounds) {
    // The optimal exponents, 0.5 and 3, are outside one or both bounds.
    for (const auto& [low, high] : {std::pair(0.0, 2.0), {0.8, INFINITY}, {0.8, 2.0}, {1.0, 1.0}}) {
        Exponentials problem = two_exponentials();
        problem.lower_bound.setConstant(low);
        problem.upper_bound.setConstant(high);
        VectorXd x{{1.0, low == 1 ? 1.0 : 1.9}};
        const auto summary = levenberg_marquardt(problem, x, k_precise);
        EXPECT_GE(x.minCoeff(), low);
        EXPECT_LE(x.maxCoeff(), high);
        if (low > 0) {
            EXPECT_EQ(x.minCoeff(), low);
        }
        if (std::isfinite(high)) {
            EXPECT_EQ(x.maxCoeff(), high);
        }
        EXPECT_EQ(problem.last_x, x);
        EXPECT_EQ(problem.loss(x), summary.loss);
        if (low == high) continue;
        // The gradient is zero for a variable that is not at a bound.
        MatrixXd H;
        VectorXd g;
        problem.linearise(x, H, g);
        for (Index i = 0; i < 2; ++i)
            EXPECT_TRUE(x[i] == low ? g[i] > 0 : x[i] == high ? g[i] < 0 : near(g[i], 0, 1e-6)) << x[i] << ' ' << g[i];
    }
}

TEST(LevenbergMarquardt, ReportsWhyItStopped) {
    VectorXd x{{1.0, 2.0}};
    Exponentials problem = two_exponentials(0.01);
    const auto first_run = levenberg_marquardt(problem, x, {.max_iterations = 2});
    EXPECT_EQ(first_run.stop, Stop::iterations);
    EXPECT_EQ(first_run.iterations, 2);
    EXPECT_EQ(problem.last_x, x);
    const auto second_run = levenberg_marquardt(problem, x, k_precise);
    EXPECT_EQ(second_run.stop, Stop::decrease);
    EXPECT_LT(second_run.loss, first_run.loss);
    const VectorXd end = x;
    EXPECT_EQ(levenberg_marquardt(problem, x, {.max_iterations = 0}).loss, second_run.loss);
    EXPECT_EQ(x, end);
}

TEST(LevenbergMarquardt, StopsIfItsTargetIsUnreachable) {
    const VectorXd start{{1.0, 2.0}};
    const LevenbergMarquardtOptions base_options{.max_iterations = 12, .decrease_tolerance = 1e-14};
    const auto from_start = [&](LevenbergMarquardtOptions options, double target, VectorXd& x) {
        Exponentials problem = two_exponentials(0.01);
        options.target = target;
        x = start;
        return levenberg_marquardt(problem, x, options);
    };
    VectorXd full_x, x;
    const auto full_run = from_start(base_options, INFINITY, full_x);
    // A target that is reached has no effect. If noise makes the target unreachable, the run stops once steps reduce
    // the loss by less than the remaining difference.
    const auto reached = from_start(base_options, 1.01 * full_run.loss, x);
    EXPECT_EQ(reached.loss, full_run.loss);
    EXPECT_EQ(x, full_x);
    const auto missed = from_start(base_options, 0.5 * full_run.loss, x);
    EXPECT_EQ(missed.stop, Stop::target);
    EXPECT_GE(missed.iterations, 2);
    EXPECT_LT(missed.iterations, full_run.iterations);
    EXPECT_GE(missed.loss, full_run.loss);
}

/// Predicts a decrease of the loss that does not occur, or gives NaN.
struct Misleading : Exponentials {
    bool nan = false;
    VectorXd start;
    double loss(const VectorXd& x) {
        Exponentials::loss(x);
        return nan && x != start ? NAN : 1 + (x - start).norm();
    }
};

TEST(LevenbergMarquardt, NeverTakesAStepThatDoesNotReduceTheLoss) {
    for (const bool nan : {false, true}) {
        Misleading problem{two_exponentials(), nan, VectorXd{{1.0, 2.0}}};
        VectorXd x = problem.start;
        const auto summary = levenberg_marquardt(problem, x, {.decrease_tolerance = 0});
        EXPECT_EQ(summary.stop, Stop::step);
        EXPECT_EQ(x, problem.start);
        EXPECT_EQ(problem.last_x, problem.start);
        EXPECT_EQ(summary.loss, 1);
        EXPECT_GT(problem.calls, 5);
    }
}

}  // namespace
}  // namespace srbf::least_squares_test
