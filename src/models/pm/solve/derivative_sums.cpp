#include "models/pm/solve/derivative_sums.h"

#include <algorithm>
#include <array>
#include <utility>

#include "models/pm/solve/columns.h"

namespace SRBF_NAMESPACE {
namespace {

/// Number of pairs of lobes processed together, so that their products stay in the cache.
constexpr Eigen::Index k_pairs_together = 48;

}  // namespace

AngleColumns::AngleColumns(const Eigen::MatrixXd& coefficients) {
    const double largest = coefficients.size() > 0 ? coefficients.maxCoeff() : 0;
    unit = largest > 0 ? largest : 1;
    beta = coefficients / unit;
    channels = beta.transpose(), lobes = channels;
    const Eigen::Index columns = std::min(beta.rows(), beta.cols());
    (beta.cols() < beta.rows() ? channels : lobes).setIdentity(columns, columns);
}

class DerivativeSums::Scratch {
  public:
    explicit Scratch(Eigen::Index columns) {
        thread_local Aligned<float> memory;  // a few hundred kilobytes, allocated once per thread
        memory.resize(std::max(memory.size(), std::size_t(columns) * k_block));
        free_ = memory.data();
    }
    float* next() { return std::exchange(free_, free_ + k_block); }

  private:
    float* free_;
};

DerivativeSums::DerivativeSums(LobeBasis& basis, const Eigen::VectorXd& x, const Eigen::MatrixXd& beta,
                               const Aligned<float>& residuals)
    : basis_(basis), x_(x), residuals_(residuals), columns_(beta) {
    const LobeShape& shape = basis.shape();
    J_ = basis.count(), N_ = shape.variates, C_ = shape.components(), W_ = shape.width();
    channels_ = beta.cols(), S_ = columns_.lobes.rows();
    across_channels_ = columns_.channels.transpose() * columns_.channels;
    lobes_to_angles_ = columns_.lobes.transpose() * across_channels_;  // U of A: J × S
    // Row s W + k: contribution of weight k to column s of A, for each lobe. Row j: combinations of A and of the
    // residuals for lobe j.
    lobes_in_angles_.resize(S_ * W_, J_);
    for (Eigen::Index s = 0; s < S_; ++s)
        for (Eigen::Index k = 0; k < W_; ++k)
            for (Eigen::Index j = 0; j < J_; ++j)
                lobes_in_angles_(s * W_ + k, j) = float(columns_.lobes(s, j) * x[N_ + j * W_ + k]);
    angles_in_lobes_ = lobes_to_angles_.cast<float>(), residuals_in_lobes_ = columns_.beta.cast<float>();

    const Rows& rows = basis.rows();
    const Eigen::Index others = S_ * N_ + channels_, columns = J_ + S_ * N_,
                       factor_count = count_of_pairs(J_) * (count_of_pairs(W_ + 1) - 1), other_count = others * columns,
                       row_count = J_ * (N_ + 1) * W_;
    std::vector<std::vector<double>> parts(rows.chunks());
    rows.for_chunks(parts.size(), basis.parallel(), [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        if (rows.is_integral(begin)) {
            parts[chunk] = sums_of_integral(begin, end);
            return;
        }
        parts[chunk].assign(std::size_t(factor_count + other_count + row_count), 0.0);
        for (std::size_t block = begin; block < end; ++block) add_block(block, parts[chunk]);
    });
    Eigen::VectorXd total = Eigen::VectorXd::Zero(factor_count + other_count + row_count);
    for (std::size_t chunk = 0; chunk < rows.chunks_of_pairs(); ++chunk)
        total += Eigen::Map<const Eigen::VectorXd>(parts[chunk].data(), total.size());
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    products_.assign(total.begin(), total.begin() + factor_count);
    const Eigen::Map<const RowMajor> with_others(&total[factor_count], others, columns),
        factor_sums(&total[factor_count + other_count], J_ * (N_ + 1), W_);
    angle_sums_ = with_others.topRows(S_ * N_), residual_sums_ = with_others.bottomRows(channels_);
    factor_sums_ = factor_sums;
    add_integrals(std::span(parts).subspan(rows.chunks_of_pairs()));
}

double DerivativeSums::angles(Eigen::Index n, Eigen::Index m) const {
    double sum = 0;
    for (Eigen::Index s = 0; s < S_; ++s)
        for (Eigen::Index t = 0; t < S_; ++t)
            sum += columns_.unit * columns_.unit * across_channels_(s, t) * angle_sums_(s * N_ + n, J_ + t * N_ + m);
    return sum;
}

double DerivativeSums::residual_and_angle(Eigen::Index n) const {
    double sum = 0;
    for (Eigen::Index c = 0; c < channels_; ++c)
        for (Eigen::Index s = 0; s < S_; ++s)
            sum += columns_.unit * columns_.channels(c, s) * residual_sums_(c, J_ + s * N_ + n);
    return sum;
}

double DerivativeSums::angle_and_lobe(Eigen::Index n, Eigen::Index c, Eigen::Index k) const {
    double sum = 0;
    for (Eigen::Index s = 0; s < S_; ++s) sum += columns_.unit * columns_.channels(c, s) * angle_sums_(s * N_ + n, k);
    return sum;
}

void DerivativeSums::add_block(std::size_t block, std::span<double> sums) {
    const Eigen::Index factor_pairs = count_of_pairs(W_ + 1) - 1;
    Scratch scratch(factor_pairs + k_pairs_together + 1 + S_ * N_ + J_ * (N_ + 1));
    double* next = sums.data();
    add_products_of_lobes(block, scratch, next);
    next += count_of_pairs(J_) * factor_pairs;
    const std::vector<const float*> angles = columns_of_angles(block, scratch);
    add_products_with_residuals(block, angles, next);
    next += (S_ * N_ + channels_) * (J_ + S_ * N_);
    add_products_with_factors(block, angles, scratch, next);
}

void DerivativeSums::add_products_of_lobes(std::size_t block, Scratch& scratch, double* sums) {
    const std::size_t count = basis_.rows().rows_in(block);
    std::vector<const float*> factors, lobe_products;
    for (int i = 0; i < W_; ++i) {
        factors.push_back(basis_.factor(block, i));
        for (int l = 0; l <= i; ++l) {
            float* const product = scratch.next();
            multiply(basis_.factor(block, i), basis_.factor(block, l), product, count);
            factors.push_back(product);
        }
    }
    std::array<float*, k_pairs_together> products;
    for (float*& product : products) product = scratch.next();
    const auto add_group = [&] {
        add_products(lobe_products, factors, sums, count);
        sums += lobe_products.size() * factors.size();
        lobe_products.clear();
    };
    for (int j = 0; j < J_; ++j)
        for (int k = 0; k <= j; ++k) {
            float* const product = products[lobe_products.size()];
            multiply(basis_.lobe(block, j), basis_.lobe(block, k), product, count);
            lobe_products.push_back(product);
            if (Eigen::Index(lobe_products.size()) == k_pairs_together) add_group();
        }
    add_group();
}

std::vector<const float*> DerivativeSums::columns_of_angles(std::size_t block, Scratch& scratch) {
    const std::size_t count = basis_.rows().rows_in(block);
    const auto row_of = [](const Weights& matrix, Eigen::Index row) {
        return std::span<const float>(&matrix(row, 0), std::size_t(matrix.cols()));
    };
    std::vector<const float*> lobes, angles;
    for (int j = 0; j < J_; ++j) lobes.push_back(basis_.lobe(block, j));
    float* const column = scratch.next();
    for (Eigen::Index s = 0; s < S_; ++s)
        for (Eigen::Index n = 0; n < N_; ++n) {
            float* const angle = scratch.next();
            angles.push_back(angle);
            for (Eigen::Index k = n * C_; k < (n + 1) * C_; ++k) {
                const bool is_first = k == n * C_;
                combine(row_of(lobes_in_angles_, s * W_ + k), lobes, basis_.by_angle(block, int(k)),
                        is_first ? angle : column, count);
                if (!is_first) combine(std::array{1.f, 1.f}, std::array<const float*, 2>{angle, column}, angle, count);
            }
        }
    return angles;
}

void DerivativeSums::add_products_with_residuals(std::size_t block, std::span<const float* const> angles,
                                                 double* sums) {
    std::vector<const float*> rows(angles.begin(), angles.end()), columns;
    for (Eigen::Index c = 0; c < channels_; ++c) rows.push_back(residual_column(block, c));
    for (int j = 0; j < J_; ++j) columns.push_back(basis_.lobe(block, j));
    columns.insert(columns.end(), angles.begin(), angles.end());
    add_products(rows, columns, sums, basis_.rows().rows_in(block));
}

void DerivativeSums::add_products_with_factors(std::size_t block, std::span<const float* const> angles,
                                               Scratch& scratch, double* sums) {
    const std::size_t count = basis_.rows().rows_in(block);
    std::vector<const float*> angle_columns, rows, residuals, factors;
    for (Eigen::Index c = 0; c < channels_; ++c) residuals.push_back(residual_column(block, c));
    for (int i = 0; i < W_; ++i) factors.push_back(basis_.factor(block, i));
    for (Eigen::Index j = 0; j < J_; ++j) {
        const auto add_row = [&](const Weights& weights, std::span<const float* const> columns) {
            float* const row = scratch.next();
            combine({&weights(j, 0), columns.size()}, columns, basis_.lobe(block, int(j)), row, count);
            rows.push_back(row);
        };
        for (Eigen::Index n = 0; n < N_; ++n) {
            angle_columns.clear();
            for (Eigen::Index s = 0; s < S_; ++s) angle_columns.push_back(angles[std::size_t(s * N_ + n)]);
            add_row(angles_in_lobes_, angle_columns);
        }
        add_row(residuals_in_lobes_, residuals);
    }
    add_products(rows, factors, sums, count);
}

// The columns are products of lobes and the factors of weights or angles.
std::vector<double> DerivativeSums::sums_of_integral(std::size_t begin, std::size_t end) {
    const Eigen::Index D = basis_.shape().directional(), F = W_ + D;
    std::vector<double> products(std::size_t(J_ * (1 + F))), sums(std::size_t(J_ * (W_ + 1) + S_ * N_ + channels_));
    const Aligned<float> one(k_block, 1.f);
    std::vector<const float*> lobes, factors;
    double *const angle_sums = &sums[std::size_t(J_ * (W_ + 1))], *const residual_sums = angle_sums + S_ * N_;
    for (std::size_t block = begin; block < end; ++block) {
        lobes.clear();
        factors.assign(1, one.data());
        for (int j = 0; j < J_; ++j) lobes.push_back(basis_.lobe(block, j));
        for (int i = 0; i < F; ++i) factors.push_back(basis_.factor(block, i));
        add_products(lobes, factors, products.data());
        for (Eigen::Index c = 0; c < channels_; ++c) residual_sums[c] += sum(residual_column(block, c));
    }
    for (Eigen::Index j = 0; j < J_; ++j) {
        const double* const lobe_products = &products[std::size_t(j * (1 + F))];
        std::copy_n(lobe_products, W_ + 1, &sums[std::size_t(j * (W_ + 1))]);
        for (Eigen::Index s = 0; s < S_; ++s)
            for (Eigen::Index k = 0; k < D; ++k)
                angle_sums[s * N_ + k / C_] += columns_.lobes(s, j) * x_[N_ + j * W_ + k] * lobe_products[1 + W_ + k];
    }
    return sums;
}

void DerivativeSums::add_integrals(std::span<const std::vector<double>> sums) {
    const auto integrals = Eigen::Index(sums.size()), weighted = J_ * (W_ + 1);
    Eigen::MatrixXd integral_sums(weighted + S_ * N_ + channels_, integrals);
    for (Eigen::Index k = 0; k < integrals; ++k)
        integral_sums.col(k) = Eigen::Map<const Eigen::VectorXd>(sums[std::size_t(k)].data(), integral_sums.rows());
    integral_products_ = Eigen::MatrixXd::Zero(weighted, weighted);
    if (integrals > 0) integral_products_.selfadjointView<Eigen::Upper>().rankUpdate(integral_sums.topRows(weighted));
    integral_products_ = Eigen::MatrixXd(integral_products_.selfadjointView<Eigen::Upper>());
    for (Eigen::Index k = 0; k < integrals; ++k) {
        const auto weight_sums = integral_sums.col(k).head(weighted),
                   angles = integral_sums.col(k).segment(weighted, S_ * N_),
                   residuals = integral_sums.col(k).tail(channels_);
        Eigen::VectorXd columns(J_ + S_ * N_);
        for (Eigen::Index j = 0; j < J_; ++j) columns[j] = weight_sums[j * (W_ + 1)];
        columns.tail(S_ * N_) = angles;
        angle_sums_ += angles * columns.transpose();
        residual_sums_ += residuals * columns.transpose();
        for (Eigen::Index j = 0; j < J_; ++j) {
            const auto factors = weight_sums.segment(j * (W_ + 1) + 1, W_);
            for (Eigen::Index n = 0; n < N_; ++n)
                for (Eigen::Index s = 0; s < S_; ++s)
                    factor_sums_.row(j * (N_ + 1) + n) +=
                        lobes_to_angles_(j, s) * angles[s * N_ + n] * factors.transpose();
            factor_sums_.row(j * (N_ + 1) + N_) +=
                columns_.beta.row(j).dot(residuals.transpose()) * factors.transpose();
        }
    }
}

}  // namespace srbf
