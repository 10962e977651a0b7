// Products of the derivatives of reciprocal lobes, summed over rows.
#pragma once
#include <Eigen/Dense>
#include <span>
#include <vector>

#include "models/pm/solve/derivative_sums.h"

namespace SRBF_NAMESPACE {

/// The sums of `DerivativeSums` for lobes that are a sum over sides: the products of all columns with one another. The
/// columns are E_j and its derivatives by its weights, for each lobe; the columns of angles; and the residuals.
class DerivativeGram {
  public:
    /// As of `DerivativeSums`.
    DerivativeGram(LobeBasis& basis, const Eigen::VectorXd& x, const Eigen::MatrixXd& beta,
                   const Aligned<float>& residuals);

    double product(Eigen::Index j, Eigen::Index i, Eigen::Index k, Eigen::Index l) const {
        return G_(lobe(j, i), lobe(k, l));
    }
    double angles(Eigen::Index n, Eigen::Index m) const;
    double angle_and_weight(Eigen::Index n, Eigen::Index j, Eigen::Index i) const;
    double residual_and_angle(Eigen::Index n) const;
    double residual_and_weight(Eigen::Index j, Eigen::Index i) const;
    double angle_and_lobe(Eigen::Index n, Eigen::Index c, Eigen::Index k) const;
    double residual_and_lobe(Eigen::Index c, Eigen::Index j) const { return G_(residual(c), lobe(j, 0)); }
    Eigen::VectorXd residual_and_lobes(Eigen::Index c) const;

  private:
    // Indices of columns.
    Eigen::Index lobe(Eigen::Index j, Eigen::Index i) const { return j * (W_ + 1) + i; }
    Eigen::Index angle(Eigen::Index s, Eigen::Index n) const { return J_ * (W_ + 1) + s * N_ + n; }
    Eigen::Index residual(Eigen::Index c) const { return angle(S_, c); }
    Eigen::Index size() const { return residual(channels_); }

    /// Sets `all` to the columns of a block, which point into the basis, the residuals and `memory`.
    void fill_columns(std::size_t block, Aligned<float>& memory, std::vector<const float*>& all) const;
    /// Fills the columns of angle n.
    void fill_angle(std::size_t block, Eigen::Index n, Aligned<float>& memory) const;

    LobeBasis& basis_;
    const Eigen::VectorXd& x_;
    const Aligned<float>& residuals_;
    AngleColumns columns_;
    Eigen::Index J_, N_, W_, channels_, S_;  ///< as in `DerivativeSums`
    Eigen::MatrixXd G_;
};

}  // namespace srbf
