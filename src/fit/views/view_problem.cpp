#include "fit/views/view_problem.h"

#include "fit/solve/least_squares.h"

namespace srbf {

ViewProblem::ViewProblem(int lobes, bool shaped) : EvaluatedLobes(lobes, shaped), beta_(lobes, 3) {}

double ViewProblem::loss(const Eigen::VectorXd& x) {
    evaluate(x);
    for (int c = 0; c < 3; ++c) beta_.col(c) = bounded_least_squares(gram(), with_data().col(c), limit().col(c));
    return loss_of(beta_);
}

// Let D hold the columns ∂G_j and G_j. The derivative of the residual of channel c is −β_jc ∂G_j. A coefficient
// strictly between its bounds adapts, so that only the component of D orthogonal to those lobes counts (Kaufman's
// approximation). A coefficient at a bound is constant.
void ViewProblem::linearise(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g) {
    const Eigen::Index J = count(), V = variables(), X = V * J;
    const Eigen::MatrixXd G = gram_of_derivatives(x);
    const auto DD = G.topLeftCorner(X, X), DE = G.block(0, X, X, J);

    H = Eigen::MatrixXd::Zero(X, X);
    g = Eigen::VectorXd::Zero(X);
    std::vector<Eigen::Index> free, last_free;
    Eigen::MatrixXd across;  // DD minus its component along the lobes whose coefficients are free
    for (Eigen::Index c = 0; c < 3; ++c) {
        free.clear();
        for (Eigen::Index j = 0; j < J; ++j)
            if (beta_(j, c) > 0 && beta_(j, c) < limit()(j, c)) free.push_back(j);
        if (across.size() == 0 || free != last_free) {
            across = DD;
            if (!free.empty()) eliminate(gram()(free, free), DE(Eigen::all, free), across);
            last_free = free;
        }
        Eigen::VectorXd beta(X);
        for (Eigen::Index i = 0; i < X; ++i) beta[i] = beta_(i / V, c);
        H += beta.asDiagonal() * across * beta.asDiagonal();
        g -= beta.cwiseProduct(G.block(0, X + J + c, X, 1));
    }
}

std::vector<double> ViewProblem::cost_of_dropping() const { return srbf::cost_of_dropping(gram(), beta_); }

}  // namespace srbf
