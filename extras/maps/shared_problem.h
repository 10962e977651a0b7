// Lobes that several materials share, as one separable least-squares problem.
#pragma once
#include <Eigen/Dense>
#include <memory>
#include <span>
#include <vector>

#include "models/pm/solve/lobe_problem.h"

namespace SRBF_NAMESPACE {

/// Σ_t L_t(x) / r_t over the problems of materials t, each with its own coefficients. The variables x are the variables
/// of `LobeProblem`. Materials are computed in parallel on the threads of the caller's `on_threads`.
class SharedProblem {
  public:
    /// The materials must outlive this object.
    SharedProblem(std::span<const std::unique_ptr<PackedObservations>> materials, const LobeShape& shape);

    double loss(const Eigen::VectorXd& x);
    void linearise(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g);
    /// The bounds of `LobeProblem`, narrowed to the longest step: a lobe that would move further stops there.
    /// If the whole step were shortened instead, most lobes would hardly move.
    Eigen::VectorXd lower(const Eigen::VectorXd& x) const;
    Eigen::VectorXd upper(const Eigen::VectorXd& x) const;
    Eigen::VectorXd longest_step(const Eigen::VectorXd& x) const;

    /// Sets r_t from the losses of the last call of `loss`: √L_t, at least k_min_root of the largest.
    void weigh();
    /// The candidate whose addition would lower the loss most. Valid after `loss`.
    std::vector<double> best_addition(const std::vector<std::vector<double>>& candidates);

  private:
    std::vector<std::unique_ptr<LobeProblem>> problems_;
    std::vector<double> factor_, loss_;  ///< 1 / r_t; L_t
};

}  // namespace
