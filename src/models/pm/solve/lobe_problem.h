// Lobes as a separable least-squares problem, for Levenberg-Marquardt and for the search.
#pragma once
#include "models/pm/solve/coefficients.h"
#include "models/pm/solve/derivative_gram.h"

namespace SRBF_NAMESPACE {

/// Σ w |f − Σ_j β_j E_j|² over C channels and the rows of pairs, plus the squares of the sums of integrals, plus
/// the term of pixels if the rows have views. The variables are x = (angles, parameters); the `Coefficients` β are
/// eliminated.
class LobeProblem {
  public:
    /// `parallel`: loops over rows use several threads; the result does not depend on it.
    LobeProblem(const PackedObservations& rows, const LobeShape& shape, bool parallel);

    double loss(const Eigen::VectorXd& x);
    void linearise(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g);
    Eigen::VectorXd lower(const Eigen::VectorXd& x) const { return bounds(x.size(), &Interval::min); }
    Eigen::VectorXd upper(const Eigen::VectorXd& x) const { return bounds(x.size(), &Interval::max); }
    /// Step bounds: half a parameter plus 2, and half a radian, so that a lobe without effect at present does not
    /// diverge.
    Eigen::VectorXd longest_step(const Eigen::VectorXd& x) const;

    // Results of the last call of `loss`:
    double delta_e() { return pixels_.term().delta_e(beta()); }         ///< mean ΔE_ITP of the views' pixels
    const Eigen::MatrixXd& beta() const { return coefficients_.beta; }  ///< J × C, in multiples of `scale`
    const Eigen::MatrixXd& gram() const { return coefficients_.gram; }  ///< E·E
    /// With pixels, `loss` takes a few steps from the last coefficients. This sets the coefficients to start from.
    void continue_from(const Eigen::MatrixXd& beta) { coefficients_.beta = beta; }
    double scale() const { return rows_.scale; }
    const std::vector<double>& offset() const { return basis_.offset(); }  ///< o_j
    /// The log of the coefficient of lobe j with peak 1 if β_j is 1, for the lobes of that call.
    double log_unit(const Lobes& lobes, int j) const;

    /// Approximate decrease of the loss if each candidate were added; −1 for a candidate that is 0 at all pairs.
    /// Valid after `loss`.
    Eigen::VectorXd gains(const std::vector<std::vector<double>>& candidates);
    /// The candidate whose addition would lower the loss most. Valid after `loss`.
    std::vector<double> best_addition(const std::vector<std::vector<double>>& candidates);

  private:
    Eigen::VectorXd bounds(Eigen::Index size, double Interval::*bound) const;
    Eigen::Index channels() const { return Eigen::Index(rows_.y.size()); }
    float* residual_column(std::size_t block, Eigen::Index c) {
        return &residuals_[(block * std::size_t(channels()) + std::size_t(c)) * k_block];
    }
    /// Products of all pairs of lobes and data, (J + C)².
    Eigen::MatrixXd products_with_data();
    /// Bounds the coefficients of lobes with peak 1.
    void limit_coefficients(const Eigen::VectorXd& x);
    /// Computes the residuals and returns the loss.
    double loss_with_residuals();
    /// Fills the derivatives with respect to the variables for constant coefficients.
    void fill_derivatives(const DerivativeGram& sums, Eigen::MatrixXd& H, Eigen::VectorXd& g) const;
    /// Products of the derivatives of channel c with the lobes, variables × J.
    Eigen::MatrixXd derivatives_with_lobes(const DerivativeGram& sums, Eigen::Index c) const;
    /// Products of candidate lobes with the lobes and the residuals of pairs, (J + C) × candidates. `squares`
    /// receives the candidates' squared norms.
    Eigen::MatrixXd products_with_candidates(std::span<const std::vector<double>> candidates, Eigen::VectorXd& squares);

    const PackedObservations& rows_;
    LobeShape shape_;
    LobeBasis basis_;
    PixelMoments pixels_;
    Aligned<float> residuals_;  ///< residuals: blocks × C × k_block
    Coefficients coefficients_;
};

}  // namespace
