// Products of the derivatives of lobes, summed over rows.
#pragma once
#include "models/pm/solve/lobe_basis.h"

namespace SRBF_NAMESPACE {

/// The coefficients β of lobes, in multiples of `unit`, and the columns from which the derivatives by an angle are
/// combined: one for each channel, or one for each lobe if there are fewer lobes than channels.
struct AngleColumns {
    explicit AngleColumns(const Eigen::MatrixXd& coefficients);  ///< J × channels
    double unit;                      ///< the largest coefficient, so that floats can hold products of two of them
    Eigen::MatrixXd beta;             ///< J × channels
    Eigen::MatrixXd channels, lobes;  ///< channels × lobes = βᵀ; S rows of `lobes`
};

/// Sums over rows that make up the Hessian and the gradient: for pairs sums of the products of derivatives and
/// residuals, for integrals products of their sums. The columns that are multiplied with one another are E_j and its
/// derivatives E_j s_i by its parameters, for each lobe; those of angles; and the residuals r_c. The derivative by
/// angle n is −A_nc in channel c, A_nc = Σ_j β_jc E_j p_jn·∂ψ_n/∂angle, a combination of S columns: see `AngleColumns`.
class DerivativeGram {
  public:
    /// Computes the sums for the lobes that `basis` has evaluated at x. `beta` holds their coefficients, J ×
    /// channels, and `residuals` blocks × channels × k_block numbers.
    DerivativeGram(LobeBasis& basis, const Eigen::VectorXd& x, const Eigen::MatrixXd& beta,
                   const Aligned<float>& residuals);

    /// (E_j s_i) · (E_k s_l), where s_0 is 1.
    double product(Eigen::Index j, Eigen::Index i, Eigen::Index k, Eigen::Index l) const {
        return G_(lobe(j, i), lobe(k, l));
    }
    /// Entries of the Hessian for angles n and m, and for angle n and parameter i of lobe j; and minus half of the
    /// gradient's.
    double angles(Eigen::Index n, Eigen::Index m) const;
    double angle_and_parameter(Eigen::Index n, Eigen::Index j, Eigen::Index i) const;
    double residual_and_angle(Eigen::Index n) const;
    double residual_and_parameter(Eigen::Index j, Eigen::Index i) const;
    /// A_nc · E_k, and r_c · E_j.
    double angle_and_lobe(Eigen::Index n, Eigen::Index c, Eigen::Index k) const;
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
    Eigen::Index J_, N_, W_, channels_, S_;  ///< the sizes of LobeShape; S: number of columns for each angle
    Eigen::MatrixXd G_;
};

}  // namespace
