#include "fit/view_in_pictures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace srbf {

Eigen::VectorXd ViewInPictures::start(const Eigen::VectorXd& x, double loss, double importance,
                                      bool only_coefficients) {
    only_coefficients_ = only_coefficients;
    slope_.resize(blocks() * k_block);
    const auto J = std::size_t(of_.lobes_);
    offset_ = of_.offset_;
    exponent_.resize(blocks() * J * k_block), value_.resize(blocks() * J * k_block);
    Eigen::VectorXd all(x.size() + of_.beta_.size());
    all << x, of_.beta_.reshaped<Eigen::RowMajor>();
    share_ = 1 / double(seen().count);
    const double of_pixels = this->loss(all) - loss;
    share_ *= of_pixels > 0 ? importance * loss / of_pixels : 0;
    return all;
}

Pixels::Triplet ViewInPictures::colour(std::size_t p) const {
    const std::size_t J = std::size_t(of_.lobes_);
    Pixels::Triplet colour{};
    for (std::size_t j = 0; j < J; ++j) {
        const auto e = double(value_[(p / k_block * J + j) * k_block + p % k_block]);
        for (std::size_t c = 0; c < 3; ++c) colour[c] += of_.beta_(Eigen::Index(j), Eigen::Index(c)) * e;
    }
    return colour;
}

double ViewInPictures::loss(const Eigen::VectorXd& x) {
    const Eigen::Index J = of_.lobes_;
    of_.place(x.head(variables()));
    for (Eigen::Index j = 0; j < J; ++j) {
        const double change = offset_[std::size_t(j)] - of_.offset_[std::size_t(j)];
        if (change < -k_most_exponent) return std::numeric_limits<double>::infinity();
        of_.limit_.row(j) *= std::exp(std::min(change, 700.0));
    }
    of_.offset_ = offset_;
    of_.beta_ = x.tail(3 * J).reshaped<Eigen::RowMajor>(J, 3).cwiseMin(of_.limit_);
    of_.gram_of_values();
    double sum = of_.loss_of_coefficients();
    for (std::size_t block = 0; block < blocks(); ++block)
        for (std::size_t j = 0; j < std::size_t(J); ++j) {
            const MovingLobe lobe = of_.moving(x, int(j));
            const float* const exposure = &seen().exposure[block * k_block];
            float* const exponent = part(exponent_, j, block);
            exponents(seen().directions, block, lobe, exposure, exponent);
            exponentiate(exponent, exposure, float(offset_[j]), part(value_, j, block));
        }
    for (std::size_t p = 0; p < seen().count; ++p) sum += share_ * seen().pixels.error(p, colour(p), &slope_[p]);
    return sum;
}

// Of the pairs, the derivative of the residual of channel c is −β_jc ∂G_j by a lobe and −G_j by its coefficient. The
// columns of the pixels are the derivatives of the three components of what is seen, and their differences.
void ViewInPictures::linearise(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g) {
    const Eigen::Index J = of_.lobes_, V = of_.per_lobe_, X = V * J, all = X + 3 * J;
    const Eigen::MatrixXd G = of_.gram_of_derivatives(x);
    H = Eigen::MatrixXd::Zero(all, all);
    g = Eigen::VectorXd::Zero(all);
    for (Eigen::Index c = 0; c < 3; ++c) {
        const Eigen::VectorXd beta = of_.beta_.col(c)(Eigen::VectorXi::LinSpaced(X, 0, int(X) - 1) / int(V));
        const auto of_channel = Eigen::seqN(X + c, J, 3);
        H.topLeftCorner(X, X) += beta.asDiagonal() * G.topLeftCorner(X, X) * beta.asDiagonal();
        H(Eigen::seqN(0, X), of_channel) = beta.asDiagonal() * G.block(0, X, X, J);
        H(of_channel, of_channel) = G.block(X, X, J, J);
        g.head(X) -= beta.cwiseProduct(G.block(0, X + J + c, X, 1));
        g(of_channel) = -G.block(X, X + J + c, J, 1);
    }
    Aligned<float> scratch(std::size_t(all + 5) * k_block);
    const auto column = [&](Eigen::Index i) { return &scratch[std::size_t(i) * k_block]; };
    float* const by_channel[] = {column(all + 1), column(all + 2), column(all + 3)};
    float* const of_lobe = column(all + 4);
    const std::vector<const float*> channels(std::begin(by_channel), std::end(by_channel));
    std::vector<const float*> columns;
    for (Eigen::Index i = 0; i <= all; ++i) columns.push_back(column(i));
    Aligned<float> derivative(std::size_t(X) * k_block);
    std::vector<double> products(columns.size() * columns.size());
    for (std::size_t block = 0; block < blocks(); ++block) {
        for (Eigen::Index j = 0; j < J; ++j) {
            float* const by = &derivative[std::size_t(V * j) * k_block];
            derive(seen().directions, block, of_.moving(x, int(j)), part(value_, std::size_t(j), block),
                   part(exponent_, std::size_t(j), block), by, by + k_block, by + 2 * k_block,
                   V == 4 ? by + 3 * k_block : nullptr);
        }
        const std::span<const Pixels::Slope> slopes(&slope_[block * k_block], k_block);
        for (std::size_t component = 0; component < 3; ++component) {
            for (std::size_t p = 0; p < k_block; ++p) {
                for (std::size_t c = 0; c < 3; ++c) by_channel[c][p] = float(slopes[p].jacobian[component][c]);
                column(all)[p] = float(slopes[p].r[component]);
            }
            for (Eigen::Index j = 0; j < J; ++j) {
                std::vector<float> beta;
                for (Eigen::Index c = 0; c < 3; ++c) beta.push_back(float(of_.beta_(j, c)));
                combine(beta, channels, of_lobe);
                for (Eigen::Index k = V * j; k < V * (j + 1); ++k)
                    multiply(of_lobe, &derivative[std::size_t(k) * k_block], column(k));
                for (Eigen::Index c = 0; c < 3; ++c)
                    multiply(by_channel[c], part(value_, std::size_t(j), block), column(X + 3 * j + c));
            }
            add_gram(columns, products.data());
        }
    }
    const Eigen::MatrixXd seen_products = share_ * Eigen::Map<const Eigen::MatrixXd>(products.data(), all + 1, all + 1);
    H.triangularView<Eigen::Upper>() += seen_products.topLeftCorner(all, all);
    g += seen_products.topRightCorner(all, 1);
    H = Eigen::MatrixXd(H.selfadjointView<Eigen::Upper>());
}

Eigen::VectorXd ViewInPictures::lower(const Eigen::VectorXd& x) const {
    Eigen::VectorXd bound = Eigen::VectorXd::Zero(x.size());
    const Eigen::VectorXd lobes = x.head(variables());
    bound.head(variables()) = only_coefficients_ ? lobes : of_.lower(lobes);
    return bound;
}

Eigen::VectorXd ViewInPictures::upper(const Eigen::VectorXd& x) const {
    Eigen::VectorXd bound(x.size());
    const Eigen::VectorXd lobes = x.head(variables());
    bound << (only_coefficients_ ? lobes : of_.upper(lobes)), of_.limit_.reshaped<Eigen::RowMajor>();
    return bound;
}

Eigen::VectorXd ViewInPictures::longest_step(const Eigen::VectorXd& x) const {
    Eigen::VectorXd longest = Eigen::VectorXd::Constant(x.size(), std::numeric_limits<double>::infinity());
    longest.head(variables()) = of_.longest_step(x.head(variables()));
    return longest;
}

}  // namespace srbf
