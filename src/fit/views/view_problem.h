// The lobes of one sampled view as a separable least-squares problem.
#pragma once
#include "fit/views/evaluated_lobes.h"

namespace srbf {

/// The loss of `EvaluatedLobes`, with β eliminated by bounded least squares per channel.
class ViewProblem : public EvaluatedLobes {
  public:
    explicit ViewProblem(int lobes, bool shaped = false);

    double loss(const Eigen::VectorXd& x);
    void linearise(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g);

    // Results of the last call of `loss`:
    const Eigen::MatrixXd& beta() const { return beta_; }  ///< J × 3
    /// First-order estimate of the increase of the loss if lobe j is dropped and the others' β adapt.
    std::vector<double> cost_of_dropping() const;

  private:
    Eigen::MatrixXd beta_;
};

}  // namespace srbf
