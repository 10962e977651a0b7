// Lobes that several materials share, as one separable least-squares problem.
#pragma once
#include <Eigen/Dense>
#include <memory>
#include <span>
#include <vector>

#include "fit/solve/lobe_problem.h"

namespace srbf {

/// Σ_t L_t(x) / r_t over the problems of materials t, each with coefficients of its own. The variables are those of
/// `LobeProblem`. Materials are computed side by side on the threads of the caller's `on_threads`.
class SharedProblem {
  public:
    SharedProblem(std::span<const std::unique_ptr<Rows>> rows, const LobeShape& shape, double log_peak_limit);

    double loss(const Eigen::VectorXd& x);
    void linearise(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g);
    Eigen::VectorXd lower(const Eigen::VectorXd& x) const { return problems_[0]->lower(x); }
    Eigen::VectorXd upper(const Eigen::VectorXd& x) const { return problems_[0]->upper(x); }
    Eigen::VectorXd longest_step(const Eigen::VectorXd& x) const { return problems_[0]->longest_step(x); }

    /// Sets r_t by the losses of the last call of `loss`: √L_t, at least k_least_root of the largest.
    void weigh();
    /// The one of `candidates` that would lower the loss most if added; valid after `loss`.
    std::vector<double> best_addition(const std::vector<std::vector<double>>& candidates);

    const LobeProblem& problem(std::size_t t) const { return *problems_[t]; }

  private:
    std::vector<std::unique_ptr<LobeProblem>> problems_;
    std::vector<double> factor_, loss_;  ///< 1 / r_t; L_t
};

}  // namespace srbf
