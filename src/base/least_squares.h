// Bounded linear least squares, independent of BRDFs.
#pragma once
#include <Eigen/Dense>
#include <vector>

namespace srbf {

/// The x within 0 ≤ x ≤ upper that minimises ½ xᵀGx − gᵀx, with G symmetric and positive semidefinite: an active-set
/// method (Lawson & Hanson 1974, bounds as in Stark & Parker). A ridge of 1e-6 of G's diagonal makes the solution
/// unique if columns coincide; a zero column gets x = 0. `upper` may contain infinities. The search begins with x = 0.
Eigen::VectorXd bounded_least_squares(const Eigen::MatrixXd& G, const Eigen::VectorXd& g, const Eigen::VectorXd& upper);

/// Solves A x = b, with A symmetric and positive semidefinite.
Eigen::VectorXd solved(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

/// Subtracts A B⁻¹ Aᵀ from H, with B symmetric and positive definite but for a ridge of 1e-6 of its diagonal: what the
/// Hessian H is once other variables, of Hessian B, adapt to its own, with which A couples them. The second one also
/// subtracts A B⁻¹ b from the gradient g, where b is the gradient by the variables that adapt.
void eliminate(Eigen::MatrixXd B, const Eigen::MatrixXd& A, Eigen::MatrixXd& H);
void eliminate(Eigen::MatrixXd B, const Eigen::MatrixXd& A, Eigen::MatrixXd& H, const Eigen::VectorXd& b,
               Eigen::VectorXd& g);

/// G with a diagonal increased so that it can be factored even if columns coincide or are 0.
Eigen::MatrixXd ridged(Eigen::MatrixXd G);

/// The increase of the sum of squares if column j were dropped and the others' x adapted without bounds: x_j² over
/// (G⁻¹)_jj, summed over the right-hand sides; x has a column for each.
std::vector<double> cost_of_dropping(const Eigen::MatrixXd& G, const Eigen::MatrixXd& x);

}  // namespace srbf
