// Products of derivatives, summed over rows.
#pragma once
#include <Eigen/Dense>
#include <span>
#include <vector>

#include "models/pm/solve/lobe_basis.h"

namespace srbf {

/// Sums over rows of the products of derivatives and residuals of which Hessian and gradient consist: over pairs sums of
/// products, over integrals products of sums.
///
/// (E_j s_i) · (E_k s_l) = (E_j E_k) · (s_i s_l) with s_0 = 1: the products of a pair of lobes with a pair of factors are
/// computed once, whichever lobe goes with which factor. Of the products with the derivatives by angles and with the
/// residuals r_c only sums over channels are needed: (E_j U_nj) · s_i and (E_j R_j) · s_i with
/// A_nc = Σ_j β_jc E_j p_jn·∂ψ_n/∂angle, U_nj = Σ_c β_jc A_nc and R_j = Σ_c β_jc r_c. A_nc are sums of fewer columns where
/// there are more channels than lobes: A = in_channel × (S of these), with in_channel × of_lobe = βᵀ.
class DerivativeSums {
  public:
    /// The sums for the lobes that `basis` has evaluated at x. `beta`: their coefficients, J × channels; `rest`: the residuals,
    /// blocks × channels × k_block. (E_j · E_k are not among the sums.)
    DerivativeSums(LobeBasis& basis, const Eigen::VectorXd& x, const Eigen::MatrixXd& beta, const Aligned<float>& rest);

    /// (E_j s_i) · (E_k s_l), where factor 0 is 1, but not both.
    double product(Eigen::Index j, Eigen::Index i, Eigen::Index k, Eigen::Index l) const {
        return products_[std::size_t(pair_index(j, k) * (count_of_pairs(W_ + 1) - 1) + pair_index(i, l) - 1)] +
               of_integrals_(j * (W_ + 1) + i, k * (W_ + 1) + l);
    }
    /// The Hessian's parts of angles n, m; of angle n and weight i of lobe j; and minus half of the gradient's.
    double angles(Eigen::Index n, Eigen::Index m) const;
    double angle_and_weight(Eigen::Index n, Eigen::Index j, Eigen::Index i) const {
        return unit_ * unit_ * with_lobe_(j * (N_ + 1) + n, i);
    }
    double rest_and_angle(Eigen::Index n) const;
    double rest_and_weight(Eigen::Index j, Eigen::Index i) const { return unit_ * with_lobe_(j * (N_ + 1) + N_, i); }
    /// A_nc · E_k, and r_c · E_j.
    double angle_and_lobe(Eigen::Index n, Eigen::Index c, Eigen::Index k) const;
    double rest_and_lobe(Eigen::Index c, Eigen::Index j) const { return of_rest_(c, j); }
    Eigen::VectorXd rest_and_lobes(Eigen::Index c) const { return of_rest_.block(c, 0, 1, J_).transpose(); }

  private:
    /// Unordered pairs of 0..n−1, each with itself too: (0,0), (1,0), (1,1), (2,0), …
    static constexpr Eigen::Index count_of_pairs(Eigen::Index n) { return n * (n + 1) / 2; }
    static constexpr Eigen::Index pair_index(Eigen::Index a, Eigen::Index b) {
        return a < b ? pair_index(b, a) : count_of_pairs(a) + b;
    }
    using Weights = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    /// Columns of a block that are computed from others, in memory that a thread keeps.
    class Scratch;

    float* rest(std::size_t block, Eigen::Index c) const {
        return const_cast<float*>(&rest_[(block * std::size_t(channels_) + std::size_t(c)) * k_block]);
    }
    // The sums of a block of pairs, one after the other in `to`: of products of pairs of lobes with pairs of factors; of
    // columns of angles and residuals with lobes and columns of angles; of the columns of each lobe with factors.
    void add_block(std::size_t block, std::span<double> to);
    void add_products_of_lobes(std::size_t block, Scratch& scratch, double* to);
    std::vector<const float*> columns_of_angles(std::size_t block, Scratch& scratch);
    void add_products_with_rests(std::size_t block, std::span<const float* const> angles, double* to);
    void add_products_with_factors(std::size_t block, std::span<const float* const> angles, Scratch& scratch,
                                   double* to);
    /// The sums of E_j s_i, of the columns of angles and of the residuals over the blocks of an integral.
    std::vector<double> sums_of_integral(std::size_t begin, std::size_t end);
    /// Adds the products of these.
    void add_integrals(std::span<const std::vector<double>> sums);

    LobeBasis& basis_;
    const Eigen::VectorXd& x_;
    const Aligned<float>& rest_;
    Eigen::Index J_, N_, C_, W_, channels_, S_;  ///< as in LobeShape; S: columns of angles for each angle
    double unit_;                                ///< of the coefficients in what follows
    Eigen::MatrixXd beta_, in_channel_, of_lobe_, across_channels_, lobes_to_angles_;
    Weights of_angles_, for_angles_, for_rests_;

    std::vector<double> products_;        ///< (E_j E_k) · (s_i s_l), over pairs
    Eigen::MatrixXd of_integrals_;        ///< of the sums of E_j s_i
    Eigen::MatrixXd of_angle_, of_rest_;  ///< with lobes and columns of angles
    Eigen::MatrixXd with_lobe_;           ///< of E_j U_nj and E_j R_j, J × (N + 1), with the factors of weights
};

}  // namespace srbf
