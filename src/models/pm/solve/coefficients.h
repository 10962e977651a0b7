// The linear variables of a fit: coefficients of lobes, which adapt to the other variables.
#pragma once
#include "base/least_squares.h"
#include "models/pm/solve/pixel_term.h"

namespace SRBF_NAMESPACE {

/// Coefficients β_jc of J lobes in C channels, 0 ≤ β_jc ≤ limit_jc, that minimise Σ_c |y_c − Σ_j β_jc E_j|² plus a
/// term of pixels. They are eliminated from the problem by variable projection.
struct Coefficients {
    Eigen::MatrixXd limit;  ///< J × C
    // Results of `fit`:
    Eigen::MatrixXd beta, gram;  ///< J × C; E·E
    double pixel_loss = 0;       ///< value of the pixel term

    /// Solves bounded least squares for each channel. With pixels it takes Gauss-Newton steps for all channels from
    /// the last β; the remaining gradient is eliminated together with the other variables. `products`: of all pairs
    /// of lobes and data, (J + C)².
    void fit(const Eigen::MatrixXd& products, const PixelTerm* pixels);

    /// The loss for other coefficients, with its derivatives by them. `pixel_term` receives the term of pixels.
    double loss_at(const Eigen::MatrixXd& other, const Eigen::MatrixXd& products, const PixelTerm* pixels,
                   double& pixel_term, CoefficientTerms& terms) const;

    /// The coefficients of channel c that are strictly between their bounds and hence adapt.
    std::vector<Eigen::Index> free(Eigen::Index c) const;

    /// Changes the Hessian and gradient of the pairs to those of the loss whose free coefficients adapt (Kaufman's
    /// approximation). `lobe_products(c)`: products of the derivatives of channel c with the lobes, variables × J.
    /// `residual_products(c)`: products of its residual with the lobes. `add_pixels(terms)` adds the derivatives of
    /// the pixel term.
    template <typename LobeProducts, typename ResidualProducts, typename AddPixels>
    void adapt(bool has_pixels, const LobeProducts& lobe_products, const ResidualProducts& residual_products,
               const AddPixels& add_pixels, Eigen::MatrixXd& H, Eigen::VectorXd& g) const {
        const Eigen::Index J = beta.rows();
        CoefficientTerms terms(g.size(), has_pixels ? beta.size() : 0);
        for (Eigen::Index c = 0; c < beta.cols(); ++c) {
            const Eigen::MatrixXd products = lobe_products(c);
            const std::vector<Eigen::Index> free_lobes = free(c);
            if (has_pixels) {  // the coefficients of all channels adapt together
                const auto channel = Eigen::seqN(c * J, J);
                terms.across(Eigen::all, channel) = products;
                terms.H(channel, channel) = gram;
                terms.g(channel) = -residual_products(c);
                for (const Eigen::Index j : free_lobes) terms.free.push_back(c * J + j);
            } else if (!free_lobes.empty()) {
                eliminate(gram(free_lobes, free_lobes), products(Eigen::all, free_lobes), H);
            }
        }
        if (!has_pixels) return;
        add_pixels(terms);
        terms.eliminate(H, g);
    }

  private:
    void fit_to_pixels(const Eigen::MatrixXd& products, const PixelTerm& pixels);
};

}  // namespace srbf
