// Pixels of displayed pictures as a term of the loss.
#pragma once
#include <functional>

#include "models/pm/solve/lobe_basis.h"

namespace SRBF_NAMESPACE {

/// A sum to second order in the coefficients, in the order of β's columns.
struct CoefficientTerms {
    CoefficientTerms(Eigen::Index variables, Eigen::Index count)
        : H(Eigen::MatrixXd::Zero(count, count)),
          across(Eigen::MatrixXd::Zero(variables, count)),
          g(Eigen::VectorXd::Zero(count)) {}
    Eigen::MatrixXd H, across;       ///< the Hessian; the mixed derivatives by variables and coefficients
    Eigen::VectorXd g;               ///< half the gradient
    std::vector<Eigen::Index> free;  ///< indices of coefficients strictly between their bounds
    /// Changes the variables' Hessian and gradient to the derivatives of a sum to which the free coefficients adapt.
    void eliminate(Eigen::MatrixXd& H_x, Eigen::VectorXd& g_x) const;
};

/// Σ over pixels of cost_per_pixel × ρ(ΔE_ITP), see `Pixels`, where the colours are Σ_j β_jc (lobe j). The term is
/// not quadratic in the coefficients and couples the channels.
struct PixelTerm {
    using ByChannel = std::array<const float*, 3>;
    /// Adds the contribution of lobe j to the derivatives of one component, which are the columns of the variables.
    /// `lobe_derivative` is the derivative of the component by the value of the lobe.
    using AddByLobe =
        std::function<void(std::size_t block, Eigen::Index j, const float* lobe_derivative, float* columns)>;

    const Pixels& pixels;
    double cost_per_pixel = 0;
    bool parallel = false;
    std::function<const float*(std::size_t block, Eigen::Index j)> lobe;  ///< values of lobe j in a block of pixels

    /// The mean ΔE_ITP of the pixels for coefficients β.
    double delta_e(const Eigen::MatrixXd& beta) const;
    /// The term for coefficients β, and its derivatives by them.
    double loss(const Eigen::MatrixXd& beta, CoefficientTerms& by_coefficients) const;
    /// Adds the term's derivatives by the variables, from the columns that `add_by_lobe` fills, and by the
    /// coefficients.
    void add_derivatives(const Eigen::MatrixXd& beta, const AddByLobe& add_by_lobe, Eigen::MatrixXd& H,
                         Eigen::VectorXd& g, CoefficientTerms& by_coefficients) const;

  private:
    /// The colours of a block of pixels; valid until the thread's next call.
    Pixels::Colours colours(const Eigen::MatrixXd& beta, std::size_t block) const;
    /// cost_per_pixel × all products of the derivatives of the three components of ΔE_ITP, by `variables` variables
    /// and by the coefficients, and of the components' differences. `term` receives the term for coefficients β.
    Eigen::MatrixXd products(const Eigen::MatrixXd& beta, Eigen::Index variables, const AddByLobe& add_by_lobe,
                             double& term) const;
};

/// Returns the colours Σ_j β_jc values[j] of a block of pixels. The result points into `columns`.
Pixels::Colours combine_colours(const Eigen::MatrixXd& beta, std::span<const float* const> values,
                                Aligned<float>& columns, std::size_t count = k_block);

/// Multivariate lobes in pixels. A pixel is a sum over the rows of its view, Σ light f. Lobe j contributes the
/// moment Σ light E_j.
class PixelMoments {
  public:
    /// `basis` must outlive this object. Without views there is nothing to evaluate.
    explicit PixelMoments(LobeBasis& basis) : basis_(basis) {}

    /// Computes the moments of all pixels; `with_derivatives` adds Σ light E_j times each factor.
    void evaluate(bool with_derivatives);
    /// The term of these pixels, which is the importance times the mean over pixels.
    PixelTerm term();
    /// The derivatives of the lobes at x.
    PixelTerm::AddByLobe derivatives(const Eigen::VectorXd& x);

  private:
    const Pixels& pixels() const { return basis_.rows().pixels; }
    Eigen::Index columns_of_lobe() const { return 1 + basis_.factors(); }
    /// Column j: moment of lobe j. Column J + j × factors + i: moment of lobe j times factor i.
    float* moment(std::size_t block, Eigen::Index column) {
        return &moment_[(block * std::size_t(basis_.count() * columns_of_lobe()) + std::size_t(column)) * k_block];
    }
    void evaluate_view(std::size_t view, int order, bool with_derivatives);

    LobeBasis& basis_;
    Aligned<float> moment_;  ///< blocks of pixels × columns × k_block
};

}  // namespace
