#include "fit/view_problem.h"

#include <algorithm>
#include <cmath>

#include "least_squares.h"
#include "srbf/half.h"
#include "srbf/kernel.h"

namespace srbf {
namespace {

/// A lobe may lie between the rows: if less than a quarter of its peak is visible on them, it is bounded by the visible
/// part.
constexpr double k_unseen = 4;
constexpr double k_most_shift = 1;  // 45°; a larger shift needs a new start

/// Row-major lower triangles, as from add_gram, as a symmetric matrix.
Eigen::MatrixXd symmetric(const std::vector<double>& triangle, Eigen::Index n) {
    return Eigen::Map<const Eigen::MatrixXd>(triangle.data(), n, n).selfadjointView<Eigen::Upper>();
}

}  // namespace

ViewProblem::ViewProblem(int lobes) : lobes_(lobes), frame_(std::size_t(lobes)), offset_(std::size_t(lobes)) {
    beta_.resize(lobes, 3), limit_.resize(lobes, 3);
}

Eigen::VectorXd ViewProblem::start(const ViewRows& view, std::span<const ViewLobe> lobes) {
    view_ = &view;
    const std::size_t rows = blocks() * k_block, J = std::size_t(lobes_);
    exponent_.resize(rows * J), value_.resize(rows * J), derivative_.resize(rows * 3 * J), rest_.resize(rows * 3);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(3 * lobes_);
    for (int j = 0; j < lobes_; ++j) {
        const ViewLobe& lobe = lobes[std::size_t(j)];
        frame_[std::size_t(j)] = {lobe.centre,
                                  {Kernel<double>::from_frame(lobe.centre, 1.0, 0.0, 0.0),
                                   Kernel<double>::from_frame(lobe.centre, 0.0, 1.0, 0.0)}};
        x[3 * j + 2] = std::log(std::clamp(lobe.bandwidth, k_least_bandwidth, double(k_half_max)));
    }
    return x;
}

MovingLobe ViewProblem::moving(const Eigen::VectorXd& x, int j) const {
    const Frame& frame = frame_[std::size_t(j)];
    const Vec3d towards = frame.centre + x[3 * j] * frame.along[0] + x[3 * j + 1] * frame.along[1];
    const double length = std::sqrt(dot(towards, towards));
    const Vec3d centre = (1 / length) * towards;
    MovingLobe lobe{to_float(centre), {}, float(std::exp(x[3 * j + 2]))};
    for (int k = 0; k < 2; ++k)
        lobe.along[k] = to_float((1 / length) * (frame.along[k] - dot(frame.along[k], centre) * centre));
    return lobe;
}

std::vector<ViewLobe> ViewProblem::lobes(const Eigen::VectorXd& x) const {
    std::vector<ViewLobe> lobes;
    for (int j = 0; j < lobes_; ++j) {
        const Frame& frame = frame_[std::size_t(j)];
        lobes.push_back({normalize(frame.centre + x[3 * j] * frame.along[0] + x[3 * j + 1] * frame.along[1]),
                         std::exp(x[3 * j + 2])});
    }
    return lobes;
}

Eigen::VectorXd ViewProblem::lower(const Eigen::VectorXd& x) const {
    Eigen::VectorXd bound = Eigen::VectorXd::Constant(x.size(), -k_most_shift);
    for (int j = 0; j < lobes_; ++j) bound[3 * j + 2] = std::log(k_least_bandwidth);
    return bound;
}

Eigen::VectorXd ViewProblem::upper(const Eigen::VectorXd& x) const {
    Eigen::VectorXd bound = Eigen::VectorXd::Constant(x.size(), k_most_shift);
    for (int j = 0; j < lobes_; ++j) bound[3 * j + 2] = std::log(double(k_half_max));
    return bound;
}

Eigen::VectorXd ViewProblem::longest_step(const Eigen::VectorXd& x) const {
    Eigen::VectorXd longest = Eigen::VectorXd::Ones(x.size());
    for (int j = 0; j < lobes_; ++j)
        longest.segment(3 * j, 2).setConstant(std::min(0.5, 1.5 / std::sqrt(std::exp(x[3 * j + 2]))));
    return longest;
}

template <typename OfBlock> Eigen::MatrixXd ViewProblem::gram(std::size_t count, const OfBlock& of_block) {
    const std::size_t K = view_->lights.size();
    std::vector<double> products(count * count, 0.0), lit(K * count, 0.0);
    std::vector<const float*> columns(count), lights(K);
    for (std::size_t block = 0; block < blocks(); ++block) {
        of_block(block, columns);
        add_gram(columns, products.data());
        for (std::size_t k = 0; k < K; ++k) lights[k] = &view_->lights[k][block * k_block];
        if (K > 0) add_products(lights, columns, lit.data());
    }
    Eigen::MatrixXd G = symmetric(products, Eigen::Index(count));
    lit_ = Eigen::Map<const Eigen::MatrixXd>(lit.data(), Eigen::Index(count), Eigen::Index(K));
    if (K > 0) G += lit_ * lit_.transpose();
    return G;
}

double ViewProblem::loss(const Eigen::VectorXd& x) {
    const auto J = std::size_t(lobes_);
    for (int j = 0; j < lobes_; ++j) {
        const MovingLobe lobe = moving(x, j);
        float most = -std::numeric_limits<float>::max();
        for (std::size_t block = 0; block < blocks(); ++block)
            most = std::max(
                most, gaussian_exponents(view_->directions, block, lobe.centre, lobe.bandwidth,
                                         &view_->root_weight[block * k_block], part(exponent_, std::size_t(j), block)));
        offset_[std::size_t(j)] = double(most);
        // The maximum of the lobe over the hemisphere relative to its peak: the value at the horizon if the peak is
        // below it.
        const double z = double(lobe.centre.z), lambda = double(lobe.bandwidth);
        const double log_visible = z < 0 ? lambda * (std::sqrt(std::max(0.0, 1 - z * z)) - 1) : 0;
        const double seen = std::exp(double(most) - log_visible);  // the fraction of it that is visible on the rows
        for (int c = 0; c < 3; ++c) {
            const double of_hemisphere = view_->largest[std::size_t(c)] / std::max(z, view_->least_cosine) * seen *
                                         std::min(1.0, k_unseen * seen);
            const double of_halves = double(k_half_max) / view_->scale * std::exp(double(most));
            limit_(j, c) = std::min(of_hemisphere, of_halves);
        }
    }
    const Eigen::MatrixXd G = gram(J + 3, [&](std::size_t block, std::vector<const float*>& columns) {
        for (std::size_t j = 0; j < J; ++j) {
            exponentiate(part(exponent_, j, block), &view_->root_weight[block * k_block], float(offset_[j]),
                         part(value_, j, block));
            columns[j] = part(value_, j, block);
        }
        for (std::size_t c = 0; c < 3; ++c) columns[J + c] = &view_->y[c][block * k_block];
    });
    gram_ = G.topLeftCorner(lobes_, lobes_);
    for (int c = 0; c < 3; ++c)
        beta_.col(c) = bounded_least_squares(gram_, G.block(0, lobes_ + c, lobes_, 1), limit_.col(c));

    double sum = (lit_.bottomRows(3) - beta_.transpose() * lit_.topRows(lobes_)).squaredNorm();
    std::vector<float> beta(J);
    std::vector<const float*> columns(J);
    for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t j = 0; j < J; ++j) beta[j] = float(beta_(Eigen::Index(j), Eigen::Index(c)));
        for (std::size_t block = 0; block < blocks(); ++block) {
            for (std::size_t j = 0; j < J; ++j) columns[j] = part(value_, j, block);
            sum += residual(&view_->y[c][block * k_block], beta, columns, part(rest_, c, block));
        }
    }
    return sum;
}

// Let D hold the columns ∂G_j and G_j. The derivative of the residual of channel c is −β_jc ∂G_j. A coefficient
// strictly between its bounds adapts, so that only the component of D orthogonal to those lobes counts (Kaufman's
// approximation). A coefficient at a bound is constant.
void ViewProblem::linearise(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g) {
    const Eigen::Index J = lobes_, derivatives = 3 * J, total = 4 * J + 3;
    const Eigen::MatrixXd G = gram(std::size_t(total), [&](std::size_t block, std::vector<const float*>& columns) {
        for (std::size_t j = 0; j < std::size_t(J); ++j) {
            float* by[3];
            for (std::size_t k = 0; k < 3; ++k) columns[3 * j + k] = by[k] = part(derivative_, 3 * j + k, block);
            const float* e = columns[std::size_t(derivatives) + j] = part(value_, j, block);
            derive(view_->directions, block, moving(x, int(j)), e, part(exponent_, j, block), by[0], by[1], by[2]);
        }
        for (std::size_t c = 0; c < 3; ++c) columns[std::size_t(4 * J) + c] = part(rest_, c, block);
    });
    const auto DD = G.topLeftCorner(derivatives, derivatives), DE = G.block(0, derivatives, derivatives, J);

    H = Eigen::MatrixXd::Zero(derivatives, derivatives);
    g = Eigen::VectorXd::Zero(derivatives);
    std::vector<Eigen::Index> passive, last_passive;
    Eigen::MatrixXd across;  // DD minus its component along the passive lobes
    for (Eigen::Index c = 0; c < 3; ++c) {
        passive.clear();
        for (Eigen::Index j = 0; j < J; ++j)
            if (beta_(j, c) > 0 && beta_(j, c) < limit_(j, c)) passive.push_back(j);
        if (across.size() == 0 || passive != last_passive) {
            across = DD;
            if (!passive.empty()) {
                Eigen::MatrixXd EE = gram_(passive, passive);
                EE.diagonal() *= 1 + 1e-6;
                const Eigen::MatrixXd along = DE(Eigen::all, passive);
                across -= along * EE.ldlt().solve(along.transpose());
            }
            last_passive = passive;
        }
        Eigen::VectorXd beta(derivatives);
        for (Eigen::Index i = 0; i < derivatives; ++i) beta[i] = beta_(i / 3, c);
        H += beta.asDiagonal() * across * beta.asDiagonal();
        g -= beta.cwiseProduct(G.block(0, 4 * J + c, derivatives, 1));
    }
}

double ViewProblem::coefficient(int j, int c) const {
    const double at_peak = std::exp(std::min(-offset_[std::size_t(j)], 700.0));
    return std::min(beta_(j, c) * at_peak * view_->scale, double(k_half_max));
}

std::vector<double> ViewProblem::cost_of_dropping() const { return srbf::cost_of_dropping(gram_, beta_); }

}  // namespace srbf
