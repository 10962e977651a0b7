#include "base/step_bounds.h"

#include <algorithm>
#include <numeric>

#include "base/least_squares.h"

namespace SRBF_NAMESPACE {

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

}  // namespace srbf
