// Linear least squares with bounds, and small dense linear algebra for it.
#pragma once
#include <Eigen/Dense>
#include <vector>

namespace SRBF_NAMESPACE {

/// The x within 0 ≤ x ≤ upper that minimises ½ xᵀGx − gᵀx, with G symmetric and positive semidefinite. An active-set
/// method from x = 0 (Lawson & Hanson 1974, with bounds as in Stark & Parker 1995). A ridge of 1e-6 of G's diagonal
/// makes the solution unique if columns coincide; a zero column gets x = 0. `upper` may contain infinities. If the
/// solution of a `similar` problem is known, fewer steps are taken.
Eigen::VectorXd bounded_least_squares(const Eigen::MatrixXd& G, const Eigen::VectorXd& g, const Eigen::VectorXd& upper,
                                      const Eigen::VectorXd& similar = {});

/// Solves A x = b, with A symmetric and positive semidefinite.
Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

/// Eliminates variables with Hessian B and gradient b from a quadratic problem (Schur complement): H ← H − A B⁻¹ Aᵀ and
/// g ← g − A B⁻¹ b, where A couples them to the other variables. A ridge of 1e-6 of its diagonal is added to B, which
/// is symmetric and positive semidefinite.
void eliminate(Eigen::MatrixXd B, const Eigen::MatrixXd& A, Eigen::MatrixXd& H);
void eliminate(Eigen::MatrixXd B, const Eigen::MatrixXd& A, Eigen::MatrixXd& H, const Eigen::VectorXd& b,
               Eigen::VectorXd& g);

/// G with a diagonal increased so that it can be factored even if columns coincide or are 0.
Eigen::MatrixXd with_ridge(Eigen::MatrixXd G);

/// For each column j, the increase of the sum of squares if it is dropped and the other x adapt without bounds:
/// x_j² / (G⁻¹)_jj, summed over the right-hand sides. x has a column for each of these.
std::vector<double> cost_of_dropping(const Eigen::MatrixXd& G, const Eigen::MatrixXd& x);

/// Clamps the components of the step δ = −A⁻¹g that exceed bounds, and solves for the others again.
void adapt_to_bounds(Eigen::VectorXd& step, const Eigen::MatrixXd& A, const Eigen::VectorXd& g,
                     const Eigen::VectorXd& lower, const Eigen::VectorXd& upper);

/// Fixes variables at a bound if the negative gradient leads beyond it: their rows, columns and gradients become 0.
void fix_at_bounds(const Eigen::VectorXd& x, const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                   Eigen::MatrixXd& H, Eigen::VectorXd& g);

}  // namespace
