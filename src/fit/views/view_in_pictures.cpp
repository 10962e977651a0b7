#include "fit/views/view_in_pictures.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fit/solve/columns.h"
#include "fit/solve/pixel_term.h"
#include "srbf/elementary.h"

namespace srbf {

double ViewInPictures::share(const Eigen::VectorXd& x, double loss, double importance) {
    const double errors = this->loss(start(x, 1)) - loss;
    return errors > 0 ? importance * loss / errors : 0;
}

Eigen::VectorXd ViewInPictures::start(const Eigen::VectorXd& x, double share, bool only_coefficients) {
    only_coefficients_ = only_coefficients;
    share_ = share;
    slopes_.resize(blocks());
    const auto J = std::size_t(of_.lobes_);
    offset_ = of_.offset_;
    exponent_.resize(blocks() * J * k_block), value_.resize(blocks() * J * k_block);
    if (only_coefficients) see(x);
    Eigen::VectorXd all(of_lobes() + of_.beta_.size());
    all << x.head(of_lobes()), of_.beta_.reshaped<Eigen::RowMajor>();
    return all;
}

void ViewInPictures::see(const Eigen::VectorXd& lobes) {
    for (std::size_t j = 0; j < std::size_t(of_.lobes_); ++j) {
        const MovingLobe lobe = of_.moving(lobes, int(j));
        for (std::size_t block = 0; block < blocks(); ++block) {
            const float* const exposure = &seen().exposure[block * k_block];
            float* const exponent = part(exponent_, j, block);
            exponents(seen().directions, block, lobe, exposure, exponent);
            exponentiate(exponent, exposure, float(offset_[j]), part(value_, j, block));
        }
    }
}

double ViewInPictures::loss(const Eigen::VectorXd& x) {
    const Eigen::Index J = of_.lobes_;
    if (!only_coefficients_) {
        of_.place(x.head(of_lobes()));
        for (Eigen::Index j = 0; j < J; ++j) {
            const double change = offset_[std::size_t(j)] - of_.offset_[std::size_t(j)];
            if (change < -k_most_exponent) return std::numeric_limits<double>::infinity();
            of_.limit_.row(j) *= elementary::exp(std::min(change, 700.0));
        }
        of_.offset_ = offset_;
        of_.take_products();
        see(x.head(of_lobes()));
    }
    of_.beta_ = x.tail(3 * J).reshaped<Eigen::RowMajor>(J, 3).cwiseMin(of_.limit_);
    double sum = of_.loss_of_coefficients();
    Aligned<float> colours;
    std::vector<const float*> values;
    for (std::size_t block = 0; block < blocks(); ++block) {
        values.clear();
        for (std::size_t j = 0; j < std::size_t(J); ++j) values.push_back(part(value_, j, block));
        sum += share_ * seen().pixels.errors(block, combined(of_.beta_, values, colours), slopes_[block]);
    }
    return sum;
}

// Of the pairs, the derivative of the residual of channel c is −β_jc ∂G_j by a lobe and −G_j by its coefficient. The
// columns of the pixels are the derivatives of the three components of what is seen, and their differences.
void ViewInPictures::linearise(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g) {
    const Eigen::Index J = of_.lobes_, V = of_.per_lobe_, X = of_lobes(), all = X + 3 * J;
    H = Eigen::MatrixXd::Zero(all, all);
    g = Eigen::VectorXd::Zero(all);
    const Eigen::MatrixXd G = only_coefficients_ ? Eigen::MatrixXd() : of_.gram_of_derivatives(x.head(X));
    for (Eigen::Index c = 0; c < 3; ++c) {
        const auto of_channel = Eigen::seqN(X + c, J, 3);
        H(of_channel, of_channel) = of_.gram_;
        g(of_channel) = of_.gram_ * of_.beta_.col(c) - of_.with_data_.col(c);
        if (only_coefficients_) continue;
        const Eigen::VectorXd beta = of_.beta_.col(c)(Eigen::VectorXi::LinSpaced(X, 0, int(X) - 1) / int(V));
        H.topLeftCorner(X, X) += beta.asDiagonal() * G.topLeftCorner(X, X) * beta.asDiagonal();
        H(Eigen::seqN(0, X), of_channel) = beta.asDiagonal() * G.block(0, X, X, J);
        g.head(X) -= beta.cwiseProduct(G.block(0, X + J + c, X, 1));
    }
    Aligned<float> scratch(std::size_t(all + 1) * k_block);
    const auto column = [&](Eigen::Index i) { return &scratch[std::size_t(i) * k_block]; };
    float* const of_lobe = column(all);
    std::vector<const float*> columns;
    for (Eigen::Index i = 0; i < all; ++i) columns.push_back(column(i));
    Aligned<float> derivative(std::size_t(X) * k_block);
    std::vector<double> products(std::size_t((all + 1) * (all + 1)));
    for (std::size_t block = 0; block < blocks(); ++block) {
        for (Eigen::Index j = 0; V * j < X; ++j) {
            float* const by = &derivative[std::size_t(V * j) * k_block];
            derive(seen().directions, block, of_.moving(x, int(j)), part(value_, std::size_t(j), block),
                   part(exponent_, std::size_t(j), block), by, by + k_block, by + 2 * k_block,
                   V == 4 ? by + 3 * k_block : nullptr);
        }
        const PixelSlopes& slopes = slopes_[block];
        for (std::size_t component = 0; component < 3; ++component) {
            const std::array<const float*, 3> by_channel = slopes.by(component);
            for (Eigen::Index j = 0; j < J; ++j) {
                for (Eigen::Index c = 0; c < 3; ++c)
                    multiply(by_channel[c], part(value_, std::size_t(j), block), column(X + 3 * j + c));
                if (only_coefficients_) continue;
                std::vector<float> beta;
                for (Eigen::Index c = 0; c < 3; ++c) beta.push_back(float(of_.beta_(j, c)));
                combine(beta, by_channel, of_lobe);
                for (Eigen::Index k = V * j; k < V * (j + 1); ++k)
                    multiply(of_lobe, &derivative[std::size_t(k) * k_block], column(k));
            }
            columns.push_back(slopes.of(component));
            add_gram(columns, products.data());
            columns.pop_back();
        }
    }
    const Eigen::MatrixXd seen_products = share_ * Eigen::Map<const Eigen::MatrixXd>(products.data(), all + 1, all + 1);
    H.triangularView<Eigen::Upper>() += seen_products.topLeftCorner(all, all);
    g += seen_products.topRightCorner(all, 1);
    H = Eigen::MatrixXd(H.selfadjointView<Eigen::Upper>());
}

Eigen::VectorXd ViewInPictures::lower(const Eigen::VectorXd& x) const {
    Eigen::VectorXd bound = Eigen::VectorXd::Zero(x.size());
    if (!only_coefficients_) bound.head(of_lobes()) = of_.lower(x.head(of_lobes()));
    return bound;
}

Eigen::VectorXd ViewInPictures::upper(const Eigen::VectorXd& x) const {
    Eigen::VectorXd bound(x.size());
    if (!only_coefficients_) bound.head(of_lobes()) = of_.upper(x.head(of_lobes()));
    bound.tail(of_.limit_.size()) = of_.limit_.reshaped<Eigen::RowMajor>();
    return bound;
}

Eigen::VectorXd ViewInPictures::longest_step(const Eigen::VectorXd& x) const {
    Eigen::VectorXd longest = Eigen::VectorXd::Constant(x.size(), std::numeric_limits<double>::infinity());
    if (!only_coefficients_) longest.head(of_lobes()) = of_.longest_step(x.head(of_lobes()));
    return longest;
}

}  // namespace srbf
