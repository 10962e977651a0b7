#include "models/pm/solve/coefficients.h"

#include <utility>

namespace srbf {
namespace {

/// Steps with pixels, at most. One is the last if it is predicted to lower the loss by less than a share, or would have to
/// be shortened to less than another.
constexpr int k_pixel_steps = 2;
constexpr double k_tolerance = 1e-6, k_least_share = 0.05;

}  // namespace

void Coefficients::fit(const Eigen::MatrixXd& products, const PixelTerm* pixels) {
    const Eigen::Index J = limit.rows(), C = limit.cols();
    gram = products.topLeftCorner(J, J);
    // With pixels the coefficients of the last call are a better start than those of the pairs alone.
    if (!pixels || beta.rows() != J || beta.cols() != C) {
        beta.resize(J, C);
        for (Eigen::Index c = 0; c < C; ++c)
            beta.col(c) = bounded_least_squares(gram, products.block(0, J + c, J, 1), limit.col(c));
    }
    of_pixels = 0;
    if (pixels) fit_to_pixels(products, *pixels);
}

void Coefficients::fit_to_pixels(const Eigen::MatrixXd& products, const PixelTerm& pixels) {
    const Eigen::Index J = limit.rows(), C = limit.cols();
    beta = beta.cwiseMin(limit).eval();
    CoefficientTerms at(0, beta.size()), further = at;
    double loss = loss_at(beta, products, &pixels, of_pixels, at);
    for (int step = 0; step < k_pixel_steps; ++step) {
        const Eigen::VectorXd now = beta.reshaped();
        const Eigen::VectorXd towards = bounded_least_squares(at.H, at.H * now - at.g, limit.reshaped()) - now;
        const double predicted = -2 * towards.dot(at.g) - towards.dot(at.H * towards);
        if (!(predicted > k_tolerance * loss)) return;
        bool lowered = false;
        for (double share = 1; share > k_least_share && !lowered; share /= 2) {
            const Eigen::MatrixXd next = beta + share * towards.reshaped(J, C);
            double next_of_pixels = 0;
            const double whole = loss_at(next, products, &pixels, next_of_pixels, further);
            lowered = whole < loss;
            if (lowered) beta = next, of_pixels = next_of_pixels, loss = whole, std::swap(at, further);
        }
        if (!lowered) return;
    }
}

double Coefficients::loss_at(const Eigen::MatrixXd& other, const Eigen::MatrixXd& products, const PixelTerm* pixels,
                             double& its_pixels, CoefficientTerms& by_coefficients) const {
    const Eigen::Index J = other.rows(), C = other.cols();
    by_coefficients = CoefficientTerms(0, other.size());
    double sum = its_pixels = pixels ? pixels->loss(other, by_coefficients) : 0;
    for (Eigen::Index c = 0; c < C; ++c) {
        const Eigen::VectorXd of_data = products.block(0, J + c, J, 1), product = gram * other.col(c);
        sum += other.col(c).dot(product - 2 * of_data) + products(J + c, J + c);
        by_coefficients.H.block(c * J, c * J, J, J) += gram;
        by_coefficients.g.segment(c * J, J) += product - of_data;
    }
    return sum;
}

std::vector<Eigen::Index> Coefficients::free(Eigen::Index c) const {
    std::vector<Eigen::Index> free;
    for (Eigen::Index j = 0; j < beta.rows(); ++j)
        if (beta(j, c) > 0 && beta(j, c) < limit(j, c)) free.push_back(j);
    return free;
}

}  // namespace srbf
