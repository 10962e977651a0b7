#include "models/pm/solve/lobe_problem.h"

#include <algorithm>
#include <limits>

#include "base/least_squares.h"
#include "models/pm/solve/simd_columns.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

/// Upper bound on the log of the coefficient of a lobe with peak 1. The peak may lie where no pair of directions maps
/// to. But the exponents of opposing lobes of ever larger bandwidths lose precision in float.
constexpr double k_log_peak_limit = 300;

}  // namespace

LobeProblem::LobeProblem(const PackedObservations& rows, const LobeShape& shape, bool parallel)
    : rows_(rows),
      shape_(shape),
      basis_(rows, shape, parallel),
      pixels_(basis_),
      residuals_(rows.total_blocks() * rows.y.size() * k_block) {}

Eigen::VectorXd LobeProblem::bounds(Eigen::Index size, double Interval::*bound) const {
    const Interval angles{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    Eigen::VectorXd b(size);
    b.head(shape_.variates).setConstant(angles.*bound);
    for (Eigen::Index i = shape_.variates; i < size; ++i)
        b[i] = parameter_range(int(i - shape_.variates) % shape_.width(), shape_).*bound;
    return b;
}

Eigen::VectorXd LobeProblem::longest_step(const Eigen::VectorXd& x) const {
    Eigen::VectorXd longest = 0.5 * x.cwiseAbs().array() + 2;
    longest.head(shape_.variates).setConstant(0.5);
    return longest;
}

double LobeProblem::loss(const Eigen::VectorXd& x) {
    basis_.evaluate(x);
    limit_coefficients(x);
    const bool has_pixels = rows_.views > 0;
    if (has_pixels) pixels_.evaluate(false);
    const PixelTerm pixels = pixels_.term();
    coefficients_.fit(products_with_data(), has_pixels ? &pixels : nullptr);
    return loss_with_residuals();
}

Eigen::MatrixXd LobeProblem::products_with_data() {
    const auto J = std::size_t(basis_.count());
    return products_of_columns(rows_, J + rows_.y.size(), basis_.parallel(),
                               [&](std::size_t block, std::vector<const float*>& columns) {
                                   for (std::size_t j = 0; j < J; ++j) columns[j] = basis_.lobe(block, int(j));
                                   for (std::size_t c = 0; c < rows_.y.size(); ++c)
                                       columns[J + c] = &rows_.y[c][block * k_block];
                               });
}

void LobeProblem::limit_coefficients(const Eigen::VectorXd& x) {
    constexpr double k_largest_exponent = 700;  // exp of it is finite
    const Lobes lobes = unpack(x, shape_);
    Eigen::VectorXd limit(basis_.count());
    for (int j = 0; j < limit.size(); ++j)
        limit[j] = elementary::exp(std::min(k_log_peak_limit - log_unit(lobes, j), k_largest_exponent));
    coefficients_.limit = limit.replicate(1, channels());
}

double LobeProblem::log_unit(const Lobes& lobes, int j) const {
    return elementary::log(scale()) + log_peak_factor(lobes.parameters_of(j), shape_, offset()[std::size_t(j)]);
}

double LobeProblem::loss_with_residuals() {
    const auto J = std::size_t(basis_.count()), C = std::size_t(channels());
    std::vector<double> sums(rows_.chunks(), 0.0);
    rows_.for_chunks(sums.size(), basis_.parallel(), [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        std::vector<float> channel_beta(J);
        std::vector<const float*> columns(J);
        std::vector<double> integral(C, 0.0);
        for (std::size_t block = begin; block < end; ++block) {
            for (std::size_t j = 0; j < J; ++j) columns[j] = basis_.lobe(block, int(j));
            for (std::size_t c = 0; c < C; ++c) {
                for (std::size_t j = 0; j < J; ++j) channel_beta[j] = float(beta()(Eigen::Index(j), Eigen::Index(c)));
                float* const difference = residual_column(block, Eigen::Index(c));
                const double squares =
                    residual(&rows_.y[c][block * k_block], channel_beta, columns, difference, rows_.rows_in(block));
                if (rows_.is_integral(block))
                    integral[c] += sum(difference);
                else
                    sums[chunk] += squares;
            }
        }
        for (const double difference : integral) sums[chunk] += difference * difference;
    });
    double total = coefficients_.pixel_loss;
    for (const double part : sums) total += part;
    return total;
}

// The derivative of the residual of channel c is −β_jc E_j s_i with respect to parameter i of lobe j, where s_i is the
// factor of the parameter, and −A_nc with respect to angle n, A_nc = Σ_j β_jc E_j p_jn·∂ψ_n/∂angle. A coefficient
// strictly between its bounds adapts, so that only the component of the derivatives orthogonal to the free lobes counts
// (Kaufman's approximation). The others are constants, although their upper bound depends on the lobe.
void LobeProblem::linearise(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g) {
    const DerivativeGram sums(basis_, x, beta(), residuals_);
    H = Eigen::MatrixXd::Zero(x.size(), x.size());
    g = Eigen::VectorXd::Zero(x.size());
    fill_derivatives(sums, H, g);
    const bool has_pixels = rows_.views > 0;
    CoefficientTerms terms(x.size(), has_pixels ? beta().size() : 0);
    for (Eigen::Index c = 0; c < channels(); ++c) {
        const Eigen::MatrixXd with_lobes = derivatives_with_lobes(sums, c);
        const std::vector<Eigen::Index> free = coefficients_.free(c);
        if (has_pixels) {  // the coefficients of all channels adapt together
            const auto channel = Eigen::seqN(c * gram().rows(), gram().rows());
            terms.across(Eigen::all, channel) = with_lobes;
            terms.H(channel, channel) = gram();
            terms.g(channel) = -sums.residual_and_lobes(c);
            for (const Eigen::Index j : free) terms.free.push_back(c * gram().rows() + j);
        } else if (!free.empty()) {
            eliminate(gram()(free, free), with_lobes(Eigen::all, free), H);
        }
    }
    if (!has_pixels) return;
    pixels_.evaluate(true);
    pixels_.term().add_derivatives(beta(), pixels_.derivatives(x), H, g, terms);
    terms.eliminate(H, g);
}

void LobeProblem::fill_derivatives(const DerivativeGram& sums, Eigen::MatrixXd& H, Eigen::VectorXd& g) const {
    const Eigen::Index J = basis_.count(), N = shape_.variates, W = shape_.width();
    const auto parameter = [&](Eigen::Index j, Eigen::Index i) { return N + j * W + i; };
    const Eigen::MatrixXd beta_products = beta() * beta().transpose();
    for (Eigen::Index k = 0; k < J; ++k)
        for (Eigen::Index l = 0; l < W; ++l)
            for (Eigen::Index j = 0; j < J; ++j)
                for (Eigen::Index i = 0; i < W; ++i)
                    H(parameter(j, i), parameter(k, l)) = beta_products(j, k) * sums.product(j, 1 + i, k, 1 + l);
    for (Eigen::Index j = 0; j < J; ++j)
        for (Eigen::Index i = 0; i < W; ++i) {
            for (Eigen::Index n = 0; n < N; ++n)
                H(n, parameter(j, i)) = H(parameter(j, i), n) = sums.angle_and_parameter(n, j, i);
            g[parameter(j, i)] = -sums.residual_and_parameter(j, i);
        }
    for (Eigen::Index n = 0; n < N; ++n) {
        for (Eigen::Index m = 0; m < N; ++m) H(n, m) = sums.angles(n, m);
        g[n] = -sums.residual_and_angle(n);
    }
}

Eigen::MatrixXd LobeProblem::derivatives_with_lobes(const DerivativeGram& sums, Eigen::Index c) const {
    const Eigen::Index J = basis_.count(), N = shape_.variates, W = shape_.width();
    Eigen::MatrixXd with_lobes(N + J * W, J);
    for (Eigen::Index k = 0; k < J; ++k) {
        for (Eigen::Index n = 0; n < N; ++n) with_lobes(n, k) = sums.angle_and_lobe(n, c, k);
        for (Eigen::Index j = 0; j < J; ++j)
            for (Eigen::Index i = 0; i < W; ++i)
                with_lobes(N + j * W + i, k) = beta()(j, c) * sums.product(j, 1 + i, k, 0);
    }
    return with_lobes;
}

// For each channel the loss falls by (e·r)² / |e|². Here e is the candidate minus its component along the present
// lobes, whose coefficients adapt, and r is the residual. The coefficient must not be negative.
Eigen::VectorXd LobeProblem::gains(const std::vector<std::vector<double>>& candidates) {
    constexpr std::size_t k_group = 16;  // the values of this many candidates on all blocks fit in the cache
    constexpr double k_min_square = 1e-60, k_min_orthogonal = 1e-4;  // less of |e|² is float noise
    const Eigen::LDLT<Eigen::MatrixXd> factor(with_ridge(gram()));
    Eigen::VectorXd gains = Eigen::VectorXd::Constant(Eigen::Index(candidates.size()), -1);
    for (std::size_t first = 0; first < candidates.size(); first += k_group) {
        const auto group = std::span(candidates).subspan(first, std::min(k_group, candidates.size() - first));
        Eigen::VectorXd squares(group.size());
        const Eigen::MatrixXd products = products_with_candidates(group, squares);
        for (Eigen::Index k = 0; k < squares.size(); ++k) {
            if (!(squares[k] > k_min_square)) continue;
            const auto with_lobes = products.col(k).head(basis_.count());
            double orthogonal = squares[k];
            if (basis_.count() > 0) orthogonal -= with_lobes.dot(factor.solve(with_lobes));
            orthogonal = std::max(orthogonal, k_min_orthogonal * squares[k]);
            gains[Eigen::Index(first) + k] = products.col(k).tail(channels()).cwiseMax(0.0).squaredNorm() / orthogonal;
        }
    }
    return gains;
}

std::vector<double> LobeProblem::best_addition(const std::vector<std::vector<double>>& candidates) {
    Eigen::Index best = 0;
    if (candidates.empty() || gains(candidates).maxCoeff(&best) < 0) return {};
    return candidates[std::size_t(best)];
}

Eigen::MatrixXd LobeProblem::products_with_candidates(std::span<const std::vector<double>> candidates,
                                                      Eigen::VectorXd& squares) {
    const std::size_t blocks = rows_.blocks;
    thread_local Aligned<float> values, other_order;
    values.resize(std::max(values.size(), candidates.size() * blocks * k_block));
    other_order.resize(std::max(other_order.size(), std::size_t(shape_.orders() - 1) * blocks * k_block));
    const auto candidate = [&](std::size_t k, std::size_t block) { return &values[(k * blocks + block) * k_block]; };
    std::vector<const float*> factors, rows, columns;
    for (std::size_t k = 0; k < candidates.size(); ++k) {
        const std::vector<float> parameter(candidates[k].begin(), candidates[k].end());
        const auto part = [&](std::size_t block, int order) {
            return order == 0 ? candidate(k, block) : &other_order[block * k_block];
        };
        float offset = -std::numeric_limits<float>::infinity();
        for (std::size_t block = 0; block < blocks; ++block)
            for (int order = 0; order < shape_.orders(); ++order) {
                factors.clear();
                for (int n = 0; n < shape_.width(); ++n) factors.push_back(basis_.factor(block, n, order));
                offset = std::max(offset, exponent(parameter, factors, &rows_.root_weight[block * k_block],
                                                   part(block, order), rows_.rows_in(block)));
            }
        double sum = 0;
        for (std::size_t block = 0; block < blocks; ++block) {
            for (int order = 0; order < shape_.orders(); ++order)
                exponentiate(part(block, order), &rows_.root_weight[block * k_block], offset, part(block, order),
                             rows_.rows_in(block));
            if (shape_.orders() == 2) add(part(block, 0), part(block, 1), part(block, 0), rows_.rows_in(block));
            sum += sum_of_squares(candidate(k, block), rows_.rows_in(block));
        }
        squares[Eigen::Index(k)] = sum;
    }
    // A row-major matrix, read as columns of candidates.
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(basis_.count() + channels(), Eigen::Index(candidates.size()));
    for (std::size_t block = 0; block < blocks; ++block) {
        rows.clear(), columns.clear();
        for (std::size_t k = 0; k < candidates.size(); ++k) rows.push_back(candidate(k, block));
        for (int j = 0; j < basis_.count(); ++j) columns.push_back(basis_.lobe(block, j));
        for (Eigen::Index c = 0; c < channels(); ++c) columns.push_back(residual_column(block, c));
        add_products(rows, columns, products.data(), rows_.rows_in(block));
    }
    return products;
}

}  // namespace
