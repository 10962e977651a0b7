// Bounds of the variables of Levenberg-Marquardt.
#pragma once
#include <Eigen/Dense>

namespace srbf {

/// Makes the step δ = −A⁻¹g end at bounds that it exceeds, and solves for its other components again.
void adapt_to_bounds(Eigen::VectorXd& step, const Eigen::MatrixXd& A, const Eigen::VectorXd& g,
                     const Eigen::VectorXd& lower, const Eigen::VectorXd& upper);

/// Variables at a bound are fixed if the gradient pushes them outwards: their rows, columns and gradients become 0.
void fix_at_bounds(const Eigen::VectorXd& x, const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                   Eigen::MatrixXd& H, Eigen::VectorXd& g);

}  // namespace srbf
