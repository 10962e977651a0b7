// Pixels of displayed pictures as a term of a fit.
#pragma once
#include <Eigen/Dense>
#include <vector>

#include "fit/model/lobe_basis.h"

namespace srbf {

/// Second-order terms of a sum in the coefficients, in the order of β's columns.
struct Coefficients {
    Coefficients(Eigen::Index variables, Eigen::Index count)
        : H(Eigen::MatrixXd::Zero(count, count)),
          across(Eigen::MatrixXd::Zero(variables, count)),
          g(Eigen::VectorXd::Zero(count)) {}
    Eigen::MatrixXd H, across;       ///< Hessian, and with the variables
    Eigen::VectorXd g;               ///< half the gradient
    std::vector<Eigen::Index> free;  ///< strictly between their bounds
    /// Changes the variables' Hessian and gradient to those of a sum to which these coefficients adapt.
    void eliminate(Eigen::MatrixXd& of_x, Eigen::VectorXd& by_x) const;
};

/// importance × the mean over pixels of ρ(ΔE_ITP), see `Pixels`. A pixel is a sum over rows of its view, Σ light f, which
/// is Σ_j β_jc of the moments Σ light E_j. The term is not quadratic in the coefficients and couples the channels.
class PixelTerm {
  public:
    /// `basis` must outlive it. Without views there is nothing to evaluate.
    explicit PixelTerm(LobeBasis& basis) : basis_(basis) {}

    /// Sets the moments of all pixels, Σ light E_j; `with_derivatives` also Σ light E_j times each factor.
    void evaluate(bool with_derivatives);
    /// The mean ΔE_ITP of the pixels for coefficients β.
    double delta_e(const Eigen::MatrixXd& beta);
    /// The term for coefficients β, and its derivatives by them.
    double loss(const Eigen::MatrixXd& beta, Coefficients& by_coefficients);
    /// Adds the term's derivatives by x and by the coefficients; `limit`: the coefficients' upper bounds.
    void add_derivatives(const Eigen::VectorXd& x, const Eigen::MatrixXd& beta, const Eigen::VectorXd& limit,
                         Eigen::MatrixXd& H, Eigen::VectorXd& g, Coefficients& by_coefficients);

  private:
    const Pixels& pixels() const { return basis_.rows().pixels; }
    Eigen::Index columns_of_lobe() const { return 1 + basis_.factors(); }
    /// Column j: of lobe j; J + j × factors + i: of lobe j with factor i.
    float* moment(std::size_t block, Eigen::Index column) {
        return &moment_[(block * std::size_t(basis_.count() * columns_of_lobe()) + std::size_t(column)) * k_block];
    }
    void evaluate_view(std::size_t view, bool with_derivatives);
    /// Of a block of pixels; valid until the thread's next call.
    Pixels::Colours colours(const Eigen::MatrixXd& beta, std::size_t block);
    /// The columns of a component's derivatives by x and by the coefficients.
    void set_columns(const Eigen::VectorXd& x, const Eigen::MatrixXd& beta, const Eigen::VectorXd& limit,
                     std::size_t block, const std::array<const float*, 3>& by_channel, float* columns);

    LobeBasis& basis_;
    Aligned<float> moment_;  ///< blocks of pixels × columns × k_block
};

/// Colours of a block of pixels, Σ_j β_jc values[j], in `columns`.
Pixels::Colours combined(const Eigen::MatrixXd& beta, std::span<const float* const> values, Aligned<float>& columns,
                         std::size_t count = k_block);

}  // namespace srbf
