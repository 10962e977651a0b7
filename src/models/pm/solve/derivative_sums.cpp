#include "models/pm/solve/derivative_sums.h"

#include <algorithm>
#include <array>
#include <utility>

#include "models/pm/solve/columns.h"

namespace srbf {
namespace {

/// Pairs of lobes at a time, whose products stay in the cache.
constexpr Eigen::Index k_at_once = 48;

}  // namespace

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
                               const Aligned<float>& rest)
    : basis_(basis), x_(x), rest_(rest) {
    const LobeShape& shape = basis.shape();
    J_ = basis.count(), N_ = shape.variates, C_ = shape.components(), W_ = shape.width();
    channels_ = beta.cols(), S_ = std::min(channels_, J_);
    // Coefficients in a unit of their own: floats hold products of two of them, whatever the unit of the data.
    const double largest = beta.size() > 0 ? beta.maxCoeff() : 0;
    unit_ = largest > 0 ? largest : 1;
    beta_ = beta / unit_;
    in_channel_ = beta_.transpose(), of_lobe_ = in_channel_;
    (channels_ < J_ ? in_channel_ : of_lobe_).setIdentity(S_, S_);
    across_channels_ = in_channel_.transpose() * in_channel_;
    lobes_to_angles_ = of_lobe_.transpose() * across_channels_;  // U of A: J × S
    // Row s W + k: the weights of lobes in A of sum s by weight k; row j: those of A and of the residuals for lobe j.
    of_angles_.resize(S_ * W_, J_);
    for (Eigen::Index s = 0; s < S_; ++s)
        for (Eigen::Index k = 0; k < W_; ++k)
            for (Eigen::Index j = 0; j < J_; ++j)
                of_angles_(s * W_ + k, j) = float(of_lobe_(s, j) * x[N_ + j * W_ + k]);
    for_angles_ = lobes_to_angles_.cast<float>(), for_rests_ = beta_.cast<float>();

    const Rows& rows = basis.rows();
    const Eigen::Index others = S_ * N_ + channels_, columns = J_ + S_ * N_,
                       of_factors = count_of_pairs(J_) * (count_of_pairs(W_ + 1) - 1), of_others = others * columns,
                       of_rows = J_ * (N_ + 1) * W_;
    std::vector<std::vector<double>> parts(rows.chunks());
    rows.for_chunks(parts.size(), basis.parallel(), [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        if (rows.is_of_integral(begin)) {
            parts[chunk] = sums_of_integral(begin, end);
            return;
        }
        parts[chunk].assign(std::size_t(of_factors + of_others + of_rows), 0.0);
        for (std::size_t block = begin; block < end; ++block) add_block(block, parts[chunk]);
    });
    Eigen::VectorXd whole = Eigen::VectorXd::Zero(of_factors + of_others + of_rows);
    for (std::size_t chunk = 0; chunk < rows.chunks_of_pairs(); ++chunk)
        whole += Eigen::Map<const Eigen::VectorXd>(parts[chunk].data(), whole.size());
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    products_.assign(whole.begin(), whole.begin() + of_factors);
    const Eigen::Map<const RowMajor> with_others(&whole[of_factors], others, columns),
        with_lobe(&whole[of_factors + of_others], J_ * (N_ + 1), W_);
    of_angle_ = with_others.topRows(S_ * N_), of_rest_ = with_others.bottomRows(channels_);
    with_lobe_ = with_lobe;
    add_integrals(std::span(parts).subspan(rows.chunks_of_pairs()));
}

double DerivativeSums::angles(Eigen::Index n, Eigen::Index m) const {
    double sum = 0;
    for (Eigen::Index s = 0; s < S_; ++s)
        for (Eigen::Index t = 0; t < S_; ++t)
            sum += unit_ * unit_ * across_channels_(s, t) * of_angle_(s * N_ + n, J_ + t * N_ + m);
    return sum;
}

double DerivativeSums::rest_and_angle(Eigen::Index n) const {
    double sum = 0;
    for (Eigen::Index c = 0; c < channels_; ++c)
        for (Eigen::Index s = 0; s < S_; ++s) sum += unit_ * in_channel_(c, s) * of_rest_(c, J_ + s * N_ + n);
    return sum;
}

double DerivativeSums::angle_and_lobe(Eigen::Index n, Eigen::Index c, Eigen::Index k) const {
    double sum = 0;
    for (Eigen::Index s = 0; s < S_; ++s) sum += unit_ * in_channel_(c, s) * of_angle_(s * N_ + n, k);
    return sum;
}

void DerivativeSums::add_block(std::size_t block, std::span<double> to) {
    const Eigen::Index factor_pairs = count_of_pairs(W_ + 1) - 1;
    Scratch scratch(factor_pairs + k_at_once + 1 + S_ * N_ + J_ * (N_ + 1));
    double* at = to.data();
    add_products_of_lobes(block, scratch, at);
    at += count_of_pairs(J_) * factor_pairs;
    const std::vector<const float*> angles = columns_of_angles(block, scratch);
    add_products_with_rests(block, angles, at);
    at += (S_ * N_ + channels_) * (J_ + S_ * N_);
    add_products_with_factors(block, angles, scratch, at);
}

void DerivativeSums::add_products_of_lobes(std::size_t block, Scratch& scratch, double* to) {
    const std::size_t count = basis_.rows().rows_in(block);
    std::vector<const float*> factors, of_lobes;
    for (int i = 0; i < W_; ++i) {
        factors.push_back(basis_.factor(block, i));
        for (int l = 0; l <= i; ++l) {
            float* const product = scratch.next();
            multiply(basis_.factor(block, i), basis_.factor(block, l), product, count);
            factors.push_back(product);
        }
    }
    std::array<float*, k_at_once> products;
    for (float*& product : products) product = scratch.next();
    const auto add_these = [&] {
        add_products(of_lobes, factors, to, count);
        to += of_lobes.size() * factors.size();
        of_lobes.clear();
    };
    for (int j = 0; j < J_; ++j)
        for (int k = 0; k <= j; ++k) {
            float* const product = products[of_lobes.size()];
            multiply(basis_.lobe(block, j), basis_.lobe(block, k), product, count);
            of_lobes.push_back(product);
            if (Eigen::Index(of_lobes.size()) == k_at_once) add_these();
        }
    add_these();
}

std::vector<const float*> DerivativeSums::columns_of_angles(std::size_t block, Scratch& scratch) {
    const std::size_t count = basis_.rows().rows_in(block);
    const auto row_of = [](const Weights& all, Eigen::Index row) {
        return std::span<const float>(&all(row, 0), std::size_t(all.cols()));
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
                combine(row_of(of_angles_, s * W_ + k), lobes, basis_.by_angle(block, int(k)),
                        is_first ? angle : column, count);
                if (!is_first) combine(std::array{1.f, 1.f}, std::array<const float*, 2>{angle, column}, angle, count);
            }
        }
    return angles;
}

void DerivativeSums::add_products_with_rests(std::size_t block, std::span<const float* const> angles, double* to) {
    std::vector<const float*> rows(angles.begin(), angles.end()), columns;
    for (Eigen::Index c = 0; c < channels_; ++c) rows.push_back(rest(block, c));
    for (int j = 0; j < J_; ++j) columns.push_back(basis_.lobe(block, j));
    columns.insert(columns.end(), angles.begin(), angles.end());
    add_products(rows, columns, to, basis_.rows().rows_in(block));
}

void DerivativeSums::add_products_with_factors(std::size_t block, std::span<const float* const> angles,
                                               Scratch& scratch, double* to) {
    const std::size_t count = basis_.rows().rows_in(block);
    std::vector<const float*> with, rows, residuals, factors;
    for (Eigen::Index c = 0; c < channels_; ++c) residuals.push_back(rest(block, c));
    for (int i = 0; i < W_; ++i) factors.push_back(basis_.factor(block, i));
    for (Eigen::Index j = 0; j < J_; ++j) {
        const auto add_row = [&](const Weights& weights, std::span<const float* const> of) {
            float* const row = scratch.next();
            combine({&weights(j, 0), of.size()}, of, basis_.lobe(block, int(j)), row, count);
            rows.push_back(row);
        };
        for (Eigen::Index n = 0; n < N_; ++n) {
            with.clear();
            for (Eigen::Index s = 0; s < S_; ++s) with.push_back(angles[std::size_t(s * N_ + n)]);
            add_row(for_angles_, with);
        }
        add_row(for_rests_, residuals);
    }
    add_products(rows, factors, to, count);
}

// The columns are products of lobes and the factors of weights or angles.
std::vector<double> DerivativeSums::sums_of_integral(std::size_t begin, std::size_t end) {
    const Eigen::Index D = basis_.shape().directional(), F = W_ + D;
    std::vector<double> products(std::size_t(J_ * (1 + F))), all(std::size_t(J_ * (W_ + 1) + S_ * N_ + channels_));
    const Aligned<float> one(k_block, 1.f);
    std::vector<const float*> lobes, factors;
    double *const of_angles = &all[std::size_t(J_ * (W_ + 1))], *const of_rest = of_angles + S_ * N_;
    for (std::size_t block = begin; block < end; ++block) {
        lobes.clear();
        factors.assign(1, one.data());
        for (int j = 0; j < J_; ++j) lobes.push_back(basis_.lobe(block, j));
        for (int i = 0; i < F; ++i) factors.push_back(basis_.factor(block, i));
        add_products(lobes, factors, products.data());
        for (Eigen::Index c = 0; c < channels_; ++c) of_rest[c] += sum(rest(block, c));
    }
    for (Eigen::Index j = 0; j < J_; ++j) {
        const double* const of_this = &products[std::size_t(j * (1 + F))];
        std::copy_n(of_this, W_ + 1, &all[std::size_t(j * (W_ + 1))]);
        for (Eigen::Index s = 0; s < S_; ++s)
            for (Eigen::Index k = 0; k < D; ++k)
                of_angles[s * N_ + k / C_] += of_lobe_(s, j) * x_[N_ + j * W_ + k] * of_this[1 + W_ + k];
    }
    return all;
}

void DerivativeSums::add_integrals(std::span<const std::vector<double>> sums) {
    const auto integrals = Eigen::Index(sums.size()), weighted = J_ * (W_ + 1);
    Eigen::MatrixXd all(weighted + S_ * N_ + channels_, integrals);
    for (Eigen::Index k = 0; k < integrals; ++k)
        all.col(k) = Eigen::Map<const Eigen::VectorXd>(sums[std::size_t(k)].data(), all.rows());
    of_integrals_ = Eigen::MatrixXd::Zero(weighted, weighted);
    if (integrals > 0) of_integrals_.selfadjointView<Eigen::Upper>().rankUpdate(all.topRows(weighted));
    of_integrals_ = Eigen::MatrixXd(of_integrals_.selfadjointView<Eigen::Upper>());
    for (Eigen::Index k = 0; k < integrals; ++k) {
        const auto of_weights = all.col(k).head(weighted), angles = all.col(k).segment(weighted, S_ * N_),
                   residuals = all.col(k).tail(channels_);
        Eigen::VectorXd columns(J_ + S_ * N_);
        for (Eigen::Index j = 0; j < J_; ++j) columns[j] = of_weights[j * (W_ + 1)];
        columns.tail(S_ * N_) = angles;
        of_angle_ += angles * columns.transpose();
        of_rest_ += residuals * columns.transpose();
        for (Eigen::Index j = 0; j < J_; ++j) {
            const auto factors = of_weights.segment(j * (W_ + 1) + 1, W_);
            for (Eigen::Index n = 0; n < N_; ++n)
                for (Eigen::Index s = 0; s < S_; ++s)
                    with_lobe_.row(j * (N_ + 1) + n) +=
                        lobes_to_angles_(j, s) * angles[s * N_ + n] * factors.transpose();
            with_lobe_.row(j * (N_ + 1) + N_) += beta_.row(j).dot(residuals.transpose()) * factors.transpose();
        }
    }
}

}  // namespace srbf
