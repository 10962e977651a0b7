// Pixels of displayed pictures as a term of a fit.
#pragma once
#include <Eigen/Dense>
#include <functional>
#include <vector>

#include "models/pm/solve/lobe_basis.h"

namespace srbf {

/// Second-order terms of a sum in the coefficients, in the order of β's columns.
struct CoefficientTerms {
    CoefficientTerms(Eigen::Index variables, Eigen::Index count)
        : H(Eigen::MatrixXd::Zero(count, count)),
          across(Eigen::MatrixXd::Zero(variables, count)),
          g(Eigen::VectorXd::Zero(count)) {}
    Eigen::MatrixXd H, across;       ///< Hessian, and with the variables
    Eigen::VectorXd g;               ///< half the gradient
    std::vector<Eigen::Index> free;  ///< strictly between their bounds
    /// Changes the variables' Hessian and gradient to those of a sum to which these coefficients adapt.
    void eliminate(Eigen::MatrixXd& of_x, Eigen::VectorXd& by_x) const;
};

/// Σ over pixels of share × ρ(ΔE_ITP), see `Pixels`, of the colours Σ_j β_jc (lobe j). The term is not quadratic in the
/// coefficients and couples the channels.
struct PixelTerm {
    using ByChannel = std::array<const float*, 3>;
    /// Sets or adds to columns what a component's derivatives by the variables owe to lobe j: `of_lobe` is the component's
    /// derivative by the value of the lobe, `by_channel` by each channel.
    using SetByLobe = std::function<void(std::size_t block, Eigen::Index j, const float* of_lobe,
                                         const ByChannel& by_channel, float* columns)>;

    const Pixels& pixels;
    double share = 0;  ///< what a pixel costs
    bool parallel = false;
    std::function<const float*(std::size_t block, Eigen::Index j)> lobe;  ///< in a block of pixels

    /// The mean ΔE_ITP of the pixels for coefficients β.
    double delta_e(const Eigen::MatrixXd& beta) const;
    /// The term for coefficients β, and its derivatives by them.
    double loss(const Eigen::MatrixXd& beta, CoefficientTerms& by_coefficients) const;
    /// Adds the term's derivatives by the variables, of the columns that `set_by_lobe` makes, and by the coefficients.
    void add_derivatives(const Eigen::MatrixXd& beta, const SetByLobe& set_by_lobe, Eigen::MatrixXd& H,
                         Eigen::VectorXd& g, CoefficientTerms& by_coefficients) const;

  private:
    /// The colours of a block of pixels; valid until the thread's next call.
    Pixels::Colours colours(const Eigen::MatrixXd& beta, std::size_t block) const;
    /// share × the products with each other of the derivatives of the three components of ΔE_ITP by so many variables and
    /// by the coefficients, and of the components' differences. Sets the term for coefficients β.
    Eigen::MatrixXd products(const Eigen::MatrixXd& beta, Eigen::Index variables, const SetByLobe& set_by_lobe,
                             double& term) const;
};

/// Colours of a block of pixels, Σ_j β_jc values[j], in `columns`.
Pixels::Colours combined(const Eigen::MatrixXd& beta, std::span<const float* const> values, Aligned<float>& columns,
                         std::size_t count = k_block);

/// Multivariate lobes in pixels. A pixel is a sum over rows of its view, Σ light f, to which lobe j contributes the moment
/// Σ light E_j.
class PixelMoments {
  public:
    /// `basis` must outlive it. Without views there is nothing to evaluate.
    explicit PixelMoments(LobeBasis& basis) : basis_(basis) {}

    /// Sets the moments of all pixels; `with_derivatives` also Σ light E_j times each factor.
    void evaluate(bool with_derivatives);
    /// importance × the mean over pixels.
    PixelTerm term();
    /// The derivatives of the lobes at x; `limit`: the coefficients' upper bounds, which those at their bounds follow.
    PixelTerm::SetByLobe derivatives(const Eigen::VectorXd& x, const Eigen::MatrixXd& beta,
                                     const Eigen::MatrixXd& limit);

  private:
    const Pixels& pixels() const { return basis_.rows().pixels; }
    Eigen::Index columns_of_lobe() const { return 1 + basis_.factors(); }
    /// Column j: of lobe j; J + j × factors + i: of lobe j with factor i.
    float* moment(std::size_t block, Eigen::Index column) {
        return &moment_[(block * std::size_t(basis_.count() * columns_of_lobe()) + std::size_t(column)) * k_block];
    }
    void evaluate_view(std::size_t view, bool with_derivatives);

    LobeBasis& basis_;
    Aligned<float> moment_;  ///< blocks of pixels × columns × k_block
};

}  // namespace srbf
