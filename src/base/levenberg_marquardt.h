// Levenberg-Marquardt for separable least squares.
#pragma once
#include <concepts>
#include <limits>

#include "base/least_squares.h"

namespace SRBF_NAMESPACE {

/// A sum of squares whose linear variables have been eliminated: a function of x only.
template <typename P>
concept SeparableProblem = requires(P& problem, const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g) {
    // the loss at x, with the optimal linear variables
    { problem.loss(x) } -> std::convertible_to<double>;
    // JᵀJ and Jᵀr at the x of the last call of `loss`
    {problem.linearise(x, H, g)};
    // bounds on x after a step, which may depend on x before it
    { problem.lower(x) } -> std::convertible_to<Eigen::VectorXd>;
    { problem.upper(x) } -> std::convertible_to<Eigen::VectorXd>;
    // the longest step of each variable; a longer step is scaled
    { problem.longest_step(x) } -> std::convertible_to<Eigen::VectorXd>;
};

enum class Stop {
    decrease,    ///< predicted decrease ≤ `decrease_tolerance` × loss
    step,        ///< no step with damping up to 1e10 lowers the loss
    iterations,  ///< `max_iterations` linearisations were used
    target,      ///< the remaining steps would not reach `target` even if each lowered the loss as much as the last one
};

struct LevenbergMarquardtOptions {
    int max_iterations = 40;           ///< linearisations
    double decrease_tolerance = 1e-7;  ///< relative
    double damping = 1e-3;             ///< initial ν, times the diagonal of JᵀJ
    /// If true, the other variables adapt when a step is clamped at bounds (`adapt_to_bounds`).
    bool adapts_to_bounds = false;
    /// The loss to reach. From the second step on the optimiser stops if the remaining steps would not reach it even if
    /// each lowered the loss as much as the last one. Usually later steps lower it less.
    double target = std::numeric_limits<double>::infinity();
};

struct LevenbergMarquardtSummary {
    double loss = 0;  ///< the loss at the returned x
    int iterations = 0;
    Stop stop = Stop::iterations;
};

/// The step that solves `damped` δ = −g, within bounds and at most as long as `longest` for each variable.
template <typename P>
Eigen::VectorXd damped_step(const P& problem, const Eigen::MatrixXd& damped, const Eigen::VectorXd& g,
                            const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, const Eigen::VectorXd& longest,
                            bool adapts_to_bounds) {
    Eigen::VectorXd step;
    if constexpr (requires { problem.solve(damped, g); })  // a solver that uses the zeros in its JᵀJ
        step = -problem.solve(damped, g);
    else
        step = -solve_symmetric(damped, g);
    if (adapts_to_bounds) adapt_to_bounds(step, damped, g, lower, upper);
    return step * std::min(1.0, 1 / step.cwiseAbs().cwiseQuotient(longest).maxCoeff());
}

/// Minimises problem.loss from x, with steps (JᵀJ + ν diag JᵀJ) δ = −Jᵀr, each within the bounds at its start. ν adapts
/// to the ratio of actual to predicted decrease (Nielsen 1999). The last call of problem.loss is at the returned x.
template <SeparableProblem P>
LevenbergMarquardtSummary levenberg_marquardt(P& problem, Eigen::VectorXd& x,
                                              const LevenbergMarquardtOptions& options) {
    constexpr double k_max_damping = 1e10;
    LevenbergMarquardtSummary summary;
    Eigen::MatrixXd H;
    Eigen::VectorXd g;
    double nu = options.damping, growth = 2;
    summary.loss = problem.loss(x);
    double decrease = 0;  // the decrease of the loss by the last step
    bool at_x = true;     // the last call of problem.loss was at x
    while (summary.iterations < options.max_iterations) {
        problem.linearise(x, H, g);
        ++summary.iterations;
        const Eigen::VectorXd lower = problem.lower(x), upper = problem.upper(x);
        const double floor = 1e-12 * std::max(H.diagonal().maxCoeff(), 1e-300);
        fix_at_bounds(x, lower, upper, H, g);
        const Eigen::VectorXd scale = H.diagonal().cwiseMax(floor);
        bool lowered = false;
        while (nu < k_max_damping && !lowered) {
            Eigen::MatrixXd damped = H;
            damped.diagonal() += nu * scale;
            const Eigen::VectorXd step = damped_step(problem, damped, g, lower - x, upper - x, problem.longest_step(x),
                                                     options.adapts_to_bounds);
            const double predicted = -2 * step.dot(g) - step.dot(H * step);
            if (options.adapts_to_bounds && predicted < 0) {  // clamping costs more than the other variables gain
                nu *= growth, growth *= 2;
                continue;
            }
            if (!(predicted > options.decrease_tolerance * summary.loss)) {
                summary.stop = Stop::decrease;
                break;
            }
            const Eigen::VectorXd next = (x + step).cwiseMax(lower).cwiseMin(upper);
            const double loss = problem.loss(next);
            lowered = at_x = loss < summary.loss;
            if (!lowered) {
                nu *= growth, growth *= 2;
                continue;
            }
            const double gain = 2 * (summary.loss - loss) / predicted - 1;
            nu *= std::max(1.0 / 3, 1 - gain * gain * gain);
            growth = 2;
            x = next;
            decrease = summary.loss - loss;
            summary.loss = loss;
        }
        if (lowered) {
            const int left = options.max_iterations - summary.iterations;
            if (summary.iterations == 1 || summary.loss - left * decrease <= options.target) continue;
            summary.stop = Stop::target;
        } else if (nu >= k_max_damping) {
            summary.stop = Stop::step;
        }
        break;
    }
    if (!at_x) summary.loss = problem.loss(x);
    return summary;
}

}  // namespace
