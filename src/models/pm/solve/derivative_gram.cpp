#include "models/pm/solve/derivative_gram.h"

#include <algorithm>

#include "models/pm/solve/simd_columns.h"

namespace SRBF_NAMESPACE {

AngleColumns::AngleColumns(const Eigen::MatrixXd& coefficients) {
    const double largest = coefficients.size() > 0 ? coefficients.maxCoeff() : 0;
    unit = largest > 0 ? largest : 1;
    beta = coefficients / unit;
    channels = beta.transpose(), lobes = channels;
    const Eigen::Index columns = std::min(beta.rows(), beta.cols());
    (beta.cols() < beta.rows() ? channels : lobes).setIdentity(columns, columns);
}

DerivativeGram::DerivativeGram(LobeBasis& basis, const Eigen::VectorXd& x, const Eigen::MatrixXd& beta,
                               const Aligned<float>& residuals)
    : basis_(basis),
      x_(x),
      residuals_(residuals),
      columns_(beta),
      J_(basis.count()),
      N_(basis.shape().variates),
      W_(basis.shape().width()),
      channels_(beta.cols()),
      S_(columns_.lobes.rows()) {
    G_ = products_of_columns(basis.rows(), std::size_t(size()), basis.parallel(),
                             [&](std::size_t block, std::vector<const float*>& columns) {
                                 thread_local Aligned<float> memory;
                                 fill_columns(block, memory, columns);
                             });
}

double DerivativeGram::angles(Eigen::Index n, Eigen::Index m) const {
    double sum = 0;
    for (Eigen::Index s = 0; s < S_; ++s)
        for (Eigen::Index t = 0; t < S_; ++t)
            sum += columns_.channels.col(s).dot(columns_.channels.col(t)) * G_(angle(s, n), angle(t, m));
    return columns_.unit * columns_.unit * sum;
}

double DerivativeGram::angle_and_parameter(Eigen::Index n, Eigen::Index j, Eigen::Index i) const {
    double sum = 0;
    for (Eigen::Index s = 0; s < S_; ++s)
        sum += columns_.beta.row(j).dot(columns_.channels.col(s)) * G_(angle(s, n), lobe(j, 1 + i));
    return columns_.unit * columns_.unit * sum;
}

double DerivativeGram::residual_and_angle(Eigen::Index n) const {
    double sum = 0;
    for (Eigen::Index c = 0; c < channels_; ++c)
        for (Eigen::Index s = 0; s < S_; ++s) sum += columns_.channels(c, s) * G_(residual(c), angle(s, n));
    return columns_.unit * sum;
}

double DerivativeGram::residual_and_parameter(Eigen::Index j, Eigen::Index i) const {
    double sum = 0;
    for (Eigen::Index c = 0; c < channels_; ++c) sum += columns_.beta(j, c) * G_(residual(c), lobe(j, 1 + i));
    return columns_.unit * sum;
}

double DerivativeGram::angle_and_lobe(Eigen::Index n, Eigen::Index c, Eigen::Index k) const {
    double sum = 0;
    for (Eigen::Index s = 0; s < S_; ++s) sum += columns_.channels(c, s) * G_(angle(s, n), lobe(k, 0));
    return columns_.unit * sum;
}

Eigen::VectorXd DerivativeGram::residual_and_lobes(Eigen::Index c) const {
    return Eigen::VectorXd::NullaryExpr(J_, [&](Eigen::Index j) { return G_(residual(c), lobe(j, 0)); });
}

void DerivativeGram::fill_columns(std::size_t block, Aligned<float>& memory, std::vector<const float*>& all) const {
    const std::size_t count = basis_.rows().rows_in(block);
    memory.resize(std::max(memory.size(), std::size_t(size() + 1) * k_block));  // one more, which is temporary
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = &memory[i * k_block];
    for (Eigen::Index j = 0; j < J_; ++j) {
        all[std::size_t(lobe(j, 0))] = basis_.lobe(block, int(j));
        for (int i = 0; i < int(W_); ++i) {
            float* const column = &memory[std::size_t(lobe(j, 1 + i)) * k_block];
            if (basis_.shape().orders() == 1)
                multiply(basis_.lobe(block, int(j)), basis_.factor(block, i), column, count);
            else
                add_two_products(basis_.summand(block, int(j), 0), basis_.factor(block, i, 0),
                                 basis_.summand(block, int(j), 1), basis_.factor(block, i, 1), column, count);
        }
    }
    for (Eigen::Index n = 0; n < N_; ++n) fill_angle(block, n, memory);
    for (Eigen::Index c = 0; c < channels_; ++c)
        all[std::size_t(residual(c))] = &residuals_[(block * std::size_t(channels_) + std::size_t(c)) * k_block];
}

void DerivativeGram::fill_angle(std::size_t block, Eigen::Index n, Aligned<float>& memory) const {
    const std::size_t count = basis_.rows().rows_in(block);
    float* const product = &memory[std::size_t(size()) * k_block];
    const int D = basis_.shape().components();
    std::vector<float> factors(static_cast<std::size_t>(J_));
    std::vector<const float*> parts(factors.size());
    for (Eigen::Index s = 0; s < S_; ++s) {
        float* const column = &memory[std::size_t(angle(s, n)) * k_block];
        std::fill_n(column, count, 0.f);
        for (int order = 0; order < basis_.shape().orders(); ++order)
            for (Eigen::Index k = n * D; k < (n + 1) * D; ++k) {
                for (Eigen::Index j = 0; j < J_; ++j) {
                    factors[std::size_t(j)] = float(columns_.lobes(s, j) * x_[N_ + j * W_ + k]);
                    parts[std::size_t(j)] = basis_.summand(block, int(j), order);
                }
                combine_and_multiply(factors, parts, basis_.by_angle(block, int(k), order), product, count);
                add(column, product, column, count);
            }
    }
}

}  // namespace
