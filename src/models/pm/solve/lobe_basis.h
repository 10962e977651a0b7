// Lobes on the rows of a fit: their values and the factors of their derivatives.
#pragma once
#include "models/pm/solve/lobes.h"
#include "models/pm/solve/packed_observations.h"

namespace SRBF_NAMESPACE {

/// The values √w E_j of lobes on all rows, and the factors of their derivatives: E_j s_i with respect to parameter i
/// of lobe j, and Σ_j E_j p_jn·∂ψ_n/∂angle with respect to angle n. Each is a sum over the orders of the shape.
class LobeBasis {
  public:
    /// `parallel`: loops over rows use several threads; the result does not depend on it.
    LobeBasis(const PackedObservations& rows, const LobeShape& shape, bool parallel);

    void evaluate(const Eigen::VectorXd& x);

    // Results of the last call of `evaluate`, for a block of rows:
    int count() const { return count_; }  ///< J
    float* lobe(std::size_t block, int j) { return column(lobe_, block, count_, j); }
    /// The summand of a lobe that one order contributes.
    float* summand(std::size_t block, int j, int order) {
        return shape_.orders() == 1 ? lobe(block, j) : column(summand_, block, 2 * count_, order * count_ + j);
    }
    /// s_i of parameter i.
    float* factor(std::size_t block, int i, int order = 0) {
        return column(factor_, block, shape_.orders() * factors(), order * factors() + i);
    }
    /// ∂(ψ−ẑ)/∂angle, in the order of the parameters of variates.
    float* by_angle(std::size_t block, int k, int order = 0) { return factor(block, shape_.width() + k, order); }
    /// Factors of parameters and angles: W + N D.
    int factors() const { return shape_.width() + shape_.directional(); }
    const std::vector<double>& offset() const { return offset_; }  ///< o_j

    const PackedObservations& rows() const { return rows_; }
    const LobeShape& shape() const { return shape_; }
    bool parallel() const { return parallel_; }

  private:
    static float* column(Aligned<float>& values, std::size_t block, int columns, int k) {
        return &values[(block * std::size_t(columns) + std::size_t(k)) * k_block];
    }
    /// The factors of the variates, for angles x.
    void evaluate_factors(const Eigen::VectorXd& x, std::size_t block);
    /// Replaces the exponents of lobe j by its values.
    void exponentiate_lobe(std::size_t block, int j);

    const PackedObservations& rows_;
    LobeShape shape_;
    bool parallel_;
    int count_ = 0;
    Aligned<float> lobe_, summand_, factor_;  ///< blocks × (J, 2 J or none, orders × (W + N D)) × k_block
    std::vector<double> offset_;
};

}  // namespace
