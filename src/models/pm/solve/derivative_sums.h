// Products of derivatives, summed over rows.
#pragma once
#include <Eigen/Dense>
#include <span>
#include <vector>

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
/// residuals, for integrals products of their sums.
///
/// (E_j s_i) · (E_k s_l) = (E_j E_k) · (s_i s_l), s_0 = 1: the products of two lobes with two factors are computed
/// once, whichever lobe belongs to which factor. Products with the derivatives by angles and with the residuals r_c
/// are needed only as sums over channels: (E_j U_nj) · s_i and (E_j R_j) · s_i with A_nc = Σ_j β_jc E_j
/// p_jn·∂ψ_n/∂angle, U_nj = Σ_c β_jc A_nc and R_j = Σ_c β_jc r_c. If there are more channels than lobes, the A_nc
/// are combinations of S < C columns: A = channels × columns, see `AngleColumns`.
///
/// The form reciprocal, whose derivatives do not factor so, uses `DerivativeGram`.
class DerivativeSums {
  public:
    /// Computes the sums for the lobes that `basis` has evaluated at x. `beta` holds their coefficients, J ×
    /// channels, and `residuals` blocks × channels × k_block numbers. The products E_j · E_k are not among the
    /// sums.
    DerivativeSums(LobeBasis& basis, const Eigen::VectorXd& x, const Eigen::MatrixXd& beta,
                   const Aligned<float>& residuals);

    /// (E_j s_i) · (E_k s_l). Factor 0 is 1; i and l must not both be 0.
    double product(Eigen::Index j, Eigen::Index i, Eigen::Index k, Eigen::Index l) const {
        return products_[std::size_t(pair_index(j, k) * (count_of_pairs(W_ + 1) - 1) + pair_index(i, l) - 1)] +
               integral_products_(j * (W_ + 1) + i, k * (W_ + 1) + l);
    }
    /// Entries of the Hessian for angles n and m, and for angle n and weight i of lobe j; and minus half of the
    /// gradient's.
    double angles(Eigen::Index n, Eigen::Index m) const;
    double angle_and_weight(Eigen::Index n, Eigen::Index j, Eigen::Index i) const {
        return columns_.unit * columns_.unit * factor_sums_(j * (N_ + 1) + n, i);
    }
    double residual_and_angle(Eigen::Index n) const;
    double residual_and_weight(Eigen::Index j, Eigen::Index i) const {
        return columns_.unit * factor_sums_(j * (N_ + 1) + N_, i);
    }
    /// A_nc · E_k, and r_c · E_j.
    double angle_and_lobe(Eigen::Index n, Eigen::Index c, Eigen::Index k) const;
    double residual_and_lobe(Eigen::Index c, Eigen::Index j) const { return residual_sums_(c, j); }
    Eigen::VectorXd residual_and_lobes(Eigen::Index c) const { return residual_sums_.block(c, 0, 1, J_).transpose(); }

  private:
    /// Unordered pairs of 0..n−1, including equal ones: (0,0), (1,0), (1,1), (2,0), …
    static constexpr Eigen::Index count_of_pairs(Eigen::Index n) { return n * (n + 1) / 2; }
    static constexpr Eigen::Index pair_index(Eigen::Index a, Eigen::Index b) {
        return a < b ? pair_index(b, a) : count_of_pairs(a) + b;
    }
    using Weights = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    /// Temporary columns of a block, in memory that each thread keeps.
    class Scratch;

    float* residual_column(std::size_t block, Eigen::Index c) const {
        return const_cast<float*>(&residuals_[(block * std::size_t(channels_) + std::size_t(c)) * k_block]);
    }
    /// Adds the sums of a block of pairs to `sums`, in this order: products of pairs of lobes with pairs of
    /// factors; of the columns of angles and residuals with lobes and columns of angles; of the columns of each
    /// lobe with factors.
    void add_block(std::size_t block, std::span<double> sums);
    void add_products_of_lobes(std::size_t block, Scratch& scratch, double* sums);
    std::vector<const float*> columns_of_angles(std::size_t block, Scratch& scratch);
    void add_products_with_residuals(std::size_t block, std::span<const float* const> angles, double* sums);
    void add_products_with_factors(std::size_t block, std::span<const float* const> angles, Scratch& scratch,
                                   double* sums);
    /// The sums of E_j s_i, of the columns of angles and of the residuals over the blocks of one integral.
    std::vector<double> sums_of_integral(std::size_t begin, std::size_t end);
    /// Adds the products of the sums of each integral.
    void add_integrals(std::span<const std::vector<double>> sums);

    LobeBasis& basis_;
    const Eigen::VectorXd& x_;
    const Aligned<float>& residuals_;
    Eigen::Index J_, N_, C_, W_, channels_, S_;  ///< as in LobeShape; S: number of columns for each angle
    AngleColumns columns_;
    Eigen::MatrixXd across_channels_, lobes_to_angles_;
    Weights lobes_in_angles_, angles_in_lobes_, residuals_in_lobes_;

    std::vector<double> products_;                ///< (E_j E_k) · (s_i s_l), over pairs
    Eigen::MatrixXd integral_products_;           ///< products of the sums of E_j s_i
    Eigen::MatrixXd angle_sums_, residual_sums_;  ///< products with lobes and columns of angles
    Eigen::MatrixXd factor_sums_;  ///< products of E_j U_nj and E_j R_j with the factors of weights, J (N + 1) × W
};

}  // namespace srbf
