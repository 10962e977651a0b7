#include "fit/views/view_with_pixels.h"

#include <limits>

#include "fit/solve/pixel_term.h"

namespace srbf {

ViewWithPixels::ViewWithPixels(ViewProblem& pairs, const Eigen::VectorXd& x, double share, bool only_coefficients)
    : lobes_(pairs),
      only_coefficients_(only_coefficients),
      of_lobes_(only_coefficients ? 0 : x.size()),
      share_(share),
      beta_(pairs.beta()),
      offset_(pairs.offset()),
      slopes_(blocks()) {
    exponent_.resize(blocks() * std::size_t(lobes_.count()) * k_block), value_.resize(exponent_.size());
    if (only_coefficients) evaluate_in_pixels(x);
}

Eigen::VectorXd ViewWithPixels::start(const Eigen::VectorXd& x) const {
    Eigen::VectorXd all(of_lobes_ + beta_.size());
    all << x.head(of_lobes_), beta_.reshaped<Eigen::RowMajor>();
    return all;
}

void ViewWithPixels::evaluate_in_pixels(const Eigen::VectorXd& x) {
    for (std::size_t j = 0; j < std::size_t(lobes_.count()); ++j) {
        const MovingLobe lobe = lobes_.moving(x, int(j));
        for (std::size_t block = 0; block < blocks(); ++block) {
            const float* const exposure = &pixels().exposure[block * k_block];
            float* const exponent = part(exponent_, j, block);
            exponents(pixels().directions, block, lobe, exposure, exponent);
            exponentiate(exponent, exposure, float(offset_[j]), part(value_, j, block));
        }
    }
}

double ViewWithPixels::loss(const Eigen::VectorXd& x) {
    const Eigen::Index J = lobes_.count();
    if (!only_coefficients_) {
        if (!lobes_.evaluate(x, offset_)) return std::numeric_limits<double>::infinity();
        evaluate_in_pixels(x);
    }
    beta_ = x.tail(3 * J).reshaped<Eigen::RowMajor>(J, 3).cwiseMin(lobes_.limit());
    double sum = lobes_.loss_of(beta_);
    Aligned<float> colours;
    std::vector<const float*> values;
    for (std::size_t block = 0; block < blocks(); ++block) {
        values.clear();
        for (std::size_t j = 0; j < std::size_t(J); ++j) values.push_back(part(value_, j, block));
        sum += share_ * pixels().reference.errors(block, combined(beta_, values, colours), slopes_[block]);
    }
    return sum;
}

void ViewWithPixels::linearise(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g) {
    H = Eigen::MatrixXd::Zero(x.size(), x.size());
    g = Eigen::VectorXd::Zero(x.size());
    add_pairs(x, H, g);
    add_pixels(x, H, g);
    H = Eigen::MatrixXd(H.selfadjointView<Eigen::Upper>());
}

// The derivative of the residual of channel c is −β_jc ∂G_j by a lobe and −G_j by its coefficient.
void ViewWithPixels::add_pairs(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g) {
    const Eigen::Index J = lobes_.count(), V = lobes_.variables(), X = of_lobes_;
    const Eigen::MatrixXd G = only_coefficients_ ? Eigen::MatrixXd() : lobes_.gram_of_derivatives(x);
    for (Eigen::Index c = 0; c < 3; ++c) {
        const auto of_channel = Eigen::seqN(X + c, J, 3);
        H(of_channel, of_channel) = lobes_.gram();
        g(of_channel) = lobes_.gram() * beta_.col(c) - lobes_.with_data().col(c);
        if (only_coefficients_) continue;
        const Eigen::VectorXd beta = beta_.col(c)(Eigen::VectorXi::LinSpaced(X, 0, int(X) - 1) / int(V));
        H.topLeftCorner(X, X) += beta.asDiagonal() * G.topLeftCorner(X, X) * beta.asDiagonal();
        H(Eigen::seqN(0, X), of_channel) = beta.asDiagonal() * G.block(0, X, X, J);
        g.head(X) -= beta.cwiseProduct(G.block(0, X + J + c, X, 1));
    }
}

// The columns, of which `add_gram` makes the products, are the derivatives of the three components of a pixel's colour
// in I, T, P by the variables, and the components' differences.
void ViewWithPixels::add_pixels(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g) {
    const Eigen::Index J = lobes_.count(), V = lobes_.variables(), X = of_lobes_, all = x.size();
    Aligned<float> scratch(std::size_t(all + 1) * k_block), derivative(std::size_t(X) * k_block);
    const auto column = [&](Eigen::Index i) { return &scratch[std::size_t(i) * k_block]; };
    float* const of_lobe = column(all);
    std::vector<const float*> columns;
    for (Eigen::Index i = 0; i < all; ++i) columns.push_back(column(i));
    std::vector<double> products(std::size_t((all + 1) * (all + 1)));
    for (std::size_t block = 0; block < blocks(); ++block) {
        for (Eigen::Index j = 0; V * j < X; ++j) {
            float* const by = &derivative[std::size_t(V * j) * k_block];
            derive(pixels().directions, block, lobes_.moving(x, int(j)), part(value_, std::size_t(j), block),
                   part(exponent_, std::size_t(j), block), by, by + k_block, by + 2 * k_block,
                   V == 4 ? by + 3 * k_block : nullptr);
        }
        const PixelSlopes& slopes = slopes_[block];
        for (std::size_t component = 0; component < 3; ++component) {
            const std::array<const float*, 3> by_channel = slopes.by(component);
            for (Eigen::Index j = 0; j < J; ++j) {
                for (Eigen::Index c = 0; c < 3; ++c)
                    multiply(by_channel[std::size_t(c)], part(value_, std::size_t(j), block), column(X + 3 * j + c));
                if (only_coefficients_) continue;
                const Eigen::VectorXf beta = beta_.row(j).cast<float>();
                combine({beta.data(), 3}, by_channel, of_lobe);
                for (Eigen::Index k = V * j; k < V * (j + 1); ++k)
                    multiply(of_lobe, &derivative[std::size_t(k) * k_block], column(k));
            }
            columns.push_back(slopes.of(component));
            add_gram(columns, products.data());
            columns.pop_back();
        }
    }
    const Eigen::MatrixXd G = share_ * Eigen::Map<const Eigen::MatrixXd>(products.data(), all + 1, all + 1);
    H.triangularView<Eigen::Upper>() += G.topLeftCorner(all, all);
    g += G.topRightCorner(all, 1);
}

Eigen::VectorXd ViewWithPixels::lower(const Eigen::VectorXd& x) const {
    Eigen::VectorXd bound = Eigen::VectorXd::Zero(x.size());
    if (!only_coefficients_) bound.head(of_lobes_) = lobes_.lower(x);
    return bound;
}

Eigen::VectorXd ViewWithPixels::upper(const Eigen::VectorXd& x) const {
    Eigen::VectorXd bound(x.size());
    if (!only_coefficients_) bound.head(of_lobes_) = lobes_.upper(x);
    bound.tail(beta_.size()) = lobes_.limit().reshaped<Eigen::RowMajor>();
    return bound;
}

Eigen::VectorXd ViewWithPixels::longest_step(const Eigen::VectorXd& x) const {
    Eigen::VectorXd longest = Eigen::VectorXd::Constant(x.size(), std::numeric_limits<double>::infinity());
    if (!only_coefficients_) longest.head(of_lobes_) = lobes_.longest_step(x);
    return longest;
}

}  // namespace srbf
