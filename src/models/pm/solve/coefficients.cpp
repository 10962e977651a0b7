#include "models/pm/solve/coefficients.h"

#include <utility>

#include "base/least_squares.h"

namespace SRBF_NAMESPACE {
namespace {

/// Maximum number of steps with pixels. Steps end when the predicted decrease of the loss is below a fraction
/// `k_tolerance`, or when a step would have to be shortened below `k_min_fraction`.
constexpr int k_pixel_steps = 2;
constexpr double k_tolerance = 1e-6, k_min_fraction = 0.05;

bool are_equal_columns(const Eigen::MatrixXd& x) { return (x.colwise() - x.col(0)).isZero(0); }

}  // namespace

void Coefficients::fit(const Eigen::MatrixXd& products, const PixelTerm* pixels) {
    const Eigen::Index J = limit.rows(), C = limit.cols();
    gram = products.topLeftCorner(J, J);
    // With pixels, the coefficients of the last call are a better start than the coefficients for the pairs alone.
    if (!pixels || beta.rows() != J || beta.cols() != C) {
        beta.resize(J, C);
        for (Eigen::Index c = 0; c < C; ++c)
            beta.col(c) = bounded_least_squares(gram, products.block(0, J + c, J, 1), limit.col(c));
    }
    pixel_loss = 0;
    if (pixels) fit_to_pixels(products, *pixels);
}

void Coefficients::fit_to_pixels(const Eigen::MatrixXd& products, const PixelTerm& pixels) {
    const Eigen::Index J = limit.rows(), C = limit.cols();
    beta = beta.cwiseMin(limit).eval();
    CoefficientTerms terms(0, beta.size()), next_terms = terms;
    double loss = loss_at(beta, products, pixels, pixel_loss, terms);
    for (int step = 0; step < k_pixel_steps; ++step) {
        const Eigen::VectorXd current = beta.reshaped();
        Eigen::VectorXd direction =
            bounded_least_squares(terms.H, terms.H * current - terms.g, limit.reshaped()) - current;
        // The colours of pixels treat channels differently; channels of grey data have the mean of their steps.
        if (are_equal_columns(products.topRightCorner(J, C)))
            direction = direction.reshaped(J, C).rowwise().mean().replicate(1, C).reshaped().eval();
        const double predicted = -2 * direction.dot(terms.g) - direction.dot(terms.H * direction);
        if (!(predicted > k_tolerance * loss)) return;
        bool lowered = false;
        for (double fraction = 1; fraction > k_min_fraction && !lowered; fraction /= 2) {
            const Eigen::MatrixXd next = beta + fraction * direction.reshaped(J, C);
            double next_pixel_loss = 0;
            const double next_loss = loss_at(next, products, pixels, next_pixel_loss, next_terms);
            lowered = next_loss < loss;
            if (lowered) {
                beta = next;
                pixel_loss = next_pixel_loss;
                loss = next_loss;
                std::swap(terms, next_terms);
            }
        }
        if (!lowered) return;
    }
}

double Coefficients::loss_at(const Eigen::MatrixXd& other, const Eigen::MatrixXd& products, const PixelTerm& pixels,
                             double& pixel_term, CoefficientTerms& terms) const {
    const Eigen::Index J = other.rows(), C = other.cols();
    double sum = pixel_term = pixels.loss(other, terms);
    for (Eigen::Index c = 0; c < C; ++c) {
        const Eigen::VectorXd data_product = products.block(0, J + c, J, 1), product = gram * other.col(c);
        sum += other.col(c).dot(product - 2 * data_product) + products(J + c, J + c);
        terms.H.block(c * J, c * J, J, J) += gram;
        terms.g.segment(c * J, J) += product - data_product;
    }
    return sum;
}

std::vector<Eigen::Index> Coefficients::free(Eigen::Index c) const {
    std::vector<Eigen::Index> free;
    for (Eigen::Index j = 0; j < beta.rows(); ++j)
        if (beta(j, c) > 0 && beta(j, c) < limit(j, c)) free.push_back(j);
    return free;
}

}  // namespace
