// The linear variables of a fit: coefficients of lobes, which adapt to the other variables.
#pragma once
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

    /// The coefficients of channel c that are strictly between their bounds and hence adapt.
    std::vector<Eigen::Index> free(Eigen::Index c) const;

  private:
    void fit_to_pixels(const Eigen::MatrixXd& products, const PixelTerm& pixels);
    /// The loss for other coefficients, with its derivatives by them. `pixel_term` receives the term of pixels.
    double loss_at(const Eigen::MatrixXd& other, const Eigen::MatrixXd& products, const PixelTerm& pixels,
                   double& pixel_term, CoefficientTerms& terms) const;
};

}  // namespace
