#pragma once
#include <Eigen/Dense>

namespace SRBF_NAMESPACE {

/// Clamps the components of the step δ = −A⁻¹g that exceed bounds, and solves for the others again.
void adapt_to_bounds(Eigen::VectorXd& step, const Eigen::MatrixXd& A, const Eigen::VectorXd& g,
                     const Eigen::VectorXd& lower, const Eigen::VectorXd& upper);

/// Fixes variables at a bound if the negative gradient leads beyond it: their rows, columns and gradients become 0.
void fix_at_bounds(const Eigen::VectorXd& x, const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                   Eigen::MatrixXd& H, Eigen::VectorXd& g);

}  // namespace srbf
