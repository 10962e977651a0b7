// The linear variables of a fit: coefficients of lobes, to which the others adapt.
#pragma once
#include "base/least_squares.h"
#include "models/pm/solve/pixel_term.h"

namespace srbf {

/// Coefficients β_jc of J lobes in C channels, 0 ≤ β_jc ≤ limit_jc, that minimise Σ_c |y_c − Σ_j β_jc E_j|², and a term of
/// pixels: variable projection for what the lobes depend on.
struct Coefficients {
    Eigen::MatrixXd limit;  ///< J × C
    // Results of `fit`:
    Eigen::MatrixXd beta, gram;  ///< J × C; E·E
    double of_pixels = 0;        ///< the term of pixels

    /// Bounded least squares for each channel, or with pixels Gauss-Newton steps for all of them from the last β:
    /// what remains of the gradient is eliminated with the other variables.
    /// `products`: of the lobes and the data with each other, (J + C)².
    void fit(const Eigen::MatrixXd& products, const PixelTerm* pixels);

    /// The sum for other coefficients, with its derivatives by them; `its_pixels`: the part of the term of pixels.
    double loss_at(const Eigen::MatrixXd& other, const Eigen::MatrixXd& products, const PixelTerm* pixels,
                   double& its_pixels, CoefficientTerms& by_coefficients) const;

    /// The coefficients of channel c that are strictly between their bounds, and adapt.
    std::vector<Eigen::Index> free(Eigen::Index c) const;

    /// Changes Hessian and gradient of the pairs by variables to those of the sum to which the free coefficients adapt
    /// (Kaufman's approximation). `with_lobes(c)`: products of the derivatives of channel c with the lobes, variables × J;
    /// `rest(c)`: of its residual with the lobes; `add_pixels(terms)` adds the derivatives of the term of pixels.
    template <typename WithLobes, typename Rest, typename AddPixels>
    void adapt(bool to_pixels, const WithLobes& with_lobes, const Rest& rest, const AddPixels& add_pixels,
               Eigen::MatrixXd& H, Eigen::VectorXd& g) const {
        const Eigen::Index J = beta.rows();
        CoefficientTerms terms(g.size(), to_pixels ? beta.size() : 0);
        for (Eigen::Index c = 0; c < beta.cols(); ++c) {
            const Eigen::MatrixXd with = with_lobes(c);
            const std::vector<Eigen::Index> these = free(c);
            if (to_pixels) {  // the coefficients of all channels adapt together
                const auto of_channel = Eigen::seqN(c * J, J);
                terms.across(Eigen::all, of_channel) = with;
                terms.H(of_channel, of_channel) = gram;
                terms.g(of_channel) = -rest(c);
                for (const Eigen::Index j : these) terms.free.push_back(c * J + j);
            } else if (!these.empty()) {
                eliminate(gram(these, these), with(Eigen::all, these), H);
            }
        }
        if (!to_pixels) return;
        add_pixels(terms);
        terms.eliminate(H, g);
    }

  private:
    void fit_to_pixels(const Eigen::MatrixXd& products, const PixelTerm& pixels);
};

}  // namespace srbf
