#include "fit/views/view_problem.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "fit/solve/least_squares.h"
#include "srbf/elementary.h"
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

/// Where a lobe λ, τ with a centre at height z has its maximum over the hemisphere: the height, and the logarithm
/// there. The maximum lies in the plane of centre and normal, where λ sin(θ_centre − θ) = τ sin θ / cos² θ.
std::pair<double, double> highest(double z, double lambda, double tau) {
    const double centre = elementary::acos(std::clamp(z, -1.0, 1.0));
    double low = std::max(0.0, centre - k_pi / 2), high = std::min(centre, k_pi / 2);
    for (int step = 0; step < 40; ++step) {
        const double theta = (low + high) / 2;
        const double pull = lambda * elementary::sin(centre - theta) * elementary::cos(theta) * elementary::cos(theta);
        (pull > tau * elementary::sin(theta) ? low : high) = theta;
    }
    const double cosine = elementary::cos(low);
    return {cosine, lambda * (elementary::cos(centre - low) - 1) - tau * Kernel<double>::slant(cosine)};
}

}  // namespace

ViewProblem::ViewProblem(int lobes, bool shaped)
    : lobes_(lobes), per_lobe_(shaped ? 4 : 3), frame_(std::size_t(lobes)), offset_(std::size_t(lobes)) {
    beta_.resize(lobes, 3), limit_.resize(lobes, 3);
}

Eigen::VectorXd ViewProblem::start(const ViewRows& view, std::span<const ViewLobe> lobes) {
    view_ = &view;
    across_ = Kernel<float>::tangent_across(view.view);
    const std::size_t rows = blocks() * k_block, J = std::size_t(lobes_);
    exponent_.resize(rows * J), value_.resize(rows * J), derivative_.resize(rows * std::size_t(per_lobe_) * J),
        rest_.resize(rows * 3);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(per_lobe_ * lobes_);
    for (int j = 0; j < lobes_; ++j) {
        const ViewLobe& lobe = lobes[std::size_t(j)];
        frame_[std::size_t(j)] = {lobe.centre,
                                  {Kernel<double>::from_frame(lobe.centre, 1.0, 0.0, 0.0),
                                   Kernel<double>::from_frame(lobe.centre, 0.0, 1.0, 0.0)}};
        x[per_lobe_ * j + 2] = elementary::log(std::clamp(lobe.bandwidth, k_least_bandwidth, double(k_half_max)));
        if (per_lobe_ == 4) x[per_lobe_ * j + 3] = lobe.shape;
    }
    return x;
}

MovingLobe ViewProblem::moving(const Eigen::VectorXd& x, int j) const {
    const Frame& frame = frame_[std::size_t(j)];
    const double* const of = &x[per_lobe_ * j];
    const Vec3d towards = frame.centre + of[0] * frame.along[0] + of[1] * frame.along[1];
    const double length = std::sqrt(dot(towards, towards));
    const Vec3d centre = (1 / length) * towards;
    MovingLobe lobe{to_float(centre), {}, float(elementary::exp(of[2])), float(shape(x, j)), across_};
    for (int k = 0; k < 2; ++k)
        lobe.along[k] = to_float((1 / length) * (frame.along[k] - dot(frame.along[k], centre) * centre));
    return lobe;
}

std::vector<ViewLobe> ViewProblem::lobes(const Eigen::VectorXd& x) const {
    std::vector<ViewLobe> lobes;
    for (int j = 0; j < lobes_; ++j) {
        const Frame& frame = frame_[std::size_t(j)];
        const double* const of = &x[per_lobe_ * j];
        const double shape = this->shape(x, j);
        lobes.push_back({normalize(frame.centre + of[0] * frame.along[0] + of[1] * frame.along[1]),
                         elementary::exp(of[2]), shape == 0 ? -shape : shape});
    }
    return lobes;
}

double ViewProblem::least_shape(int j) const {
    const double cosine = dot(frame_[std::size_t(j)].centre, to_double(view_->view));
    return -k_most_narrowing * (1 - cosine) / std::max(1 + cosine, 0.01);
}

Eigen::VectorXd ViewProblem::lower(const Eigen::VectorXd& x) const {
    Eigen::VectorXd bound = Eigen::VectorXd::Constant(x.size(), -k_most_shift);
    for (int j = 0; j < lobes_; ++j) {
        bound[per_lobe_ * j + 2] = elementary::log(k_least_bandwidth);
        if (per_lobe_ == 4) bound[per_lobe_ * j + 3] = std::signbit(shape(x, j)) ? least_shape(j) : 0.0;
    }
    return bound;
}

Eigen::VectorXd ViewProblem::upper(const Eigen::VectorXd& x) const {
    Eigen::VectorXd bound = Eigen::VectorXd::Constant(x.size(), k_most_shift);
    for (int j = 0; j < lobes_; ++j) {
        bound[per_lobe_ * j + 2] = elementary::log(double(k_half_max));
        if (per_lobe_ == 4) bound[per_lobe_ * j + 3] = std::signbit(shape(x, j)) ? -0.0 : k_most_depth;
    }
    return bound;
}

Eigen::VectorXd ViewProblem::longest_step(const Eigen::VectorXd& x) const {
    Eigen::VectorXd longest = Eigen::VectorXd::Ones(x.size());
    for (int j = 0; j < lobes_; ++j) {
        auto of = longest.segment(per_lobe_ * j, per_lobe_);
        of.head(2).setConstant(std::min(0.5, 1.5 / std::sqrt(elementary::exp(x[per_lobe_ * j + 2]))));
        if (per_lobe_ == 4) of[3] = 0.5 + 0.5 * std::abs(shape(x, j));
    }
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

void ViewProblem::place(const Eigen::VectorXd& x) {
    for (int j = 0; j < lobes_; ++j) {
        const MovingLobe lobe = moving(x, j);
        float most = -std::numeric_limits<float>::max();
        for (std::size_t block = 0; block < blocks(); ++block)
            most = std::max(most, exponents(view_->directions, block, lobe, &view_->root_weight[block * k_block],
                                            part(exponent_, std::size_t(j), block)));
        offset_[std::size_t(j)] = double(most);
        // The maximum of the lobe over the hemisphere relative to that of its Gaussian: the value at the horizon if the
        // centre is below it.
        const double centre_z = double(lobe.centre.z), lambda = double(lobe.bandwidth);
        double z = centre_z, log_visible = z < 0 ? lambda * (std::sqrt(std::max(0.0, 1 - z * z)) - 1) : 0;
        if (lobe.shape > 0) std::tie(z, log_visible) = highest(centre_z, lambda, double(lobe.shape));
        const double seen =
            elementary::exp(double(most) - log_visible);  // the fraction of it that is visible on the rows
        for (int c = 0; c < 3; ++c) {
            const double of_hemisphere = view_->largest[std::size_t(c)] / std::max(z, view_->least_cosine) * seen *
                                         std::min(1.0, k_unseen * seen);
            const double of_halves = double(k_half_max) / view_->scale * elementary::exp(double(most));
            limit_(j, c) = std::min(of_hemisphere, of_halves);
        }
    }
}

void ViewProblem::take_products() {
    const auto J = std::size_t(lobes_);
    const Eigen::MatrixXd G = gram(J + 3, [&](std::size_t block, std::vector<const float*>& columns) {
        for (std::size_t j = 0; j < J; ++j) {
            exponentiate(part(exponent_, j, block), &view_->root_weight[block * k_block], float(offset_[j]),
                         part(value_, j, block));
            columns[j] = part(value_, j, block);
        }
        for (std::size_t c = 0; c < 3; ++c) columns[J + c] = &view_->y[c][block * k_block];
    });
    gram_ = G.topLeftCorner(lobes_, lobes_);
    with_data_ = G.topRightCorner(lobes_, 3);
}

double ViewProblem::loss(const Eigen::VectorXd& x) {
    place(x);
    take_products();
    for (int c = 0; c < 3; ++c) beta_.col(c) = bounded_least_squares(gram_, with_data_.col(c), limit_.col(c));
    return loss_of_coefficients();
}

double ViewProblem::loss_of_coefficients() {
    const auto J = std::size_t(lobes_);
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

Eigen::MatrixXd ViewProblem::gram_of_derivatives(const Eigen::VectorXd& x) {
    const Eigen::Index J = lobes_, derivatives = per_lobe_ * J, total = derivatives + J + 3;
    return gram(std::size_t(total), [&](std::size_t block, std::vector<const float*>& columns) {
        for (std::size_t j = 0; j < std::size_t(J); ++j) {
            const std::size_t V = std::size_t(per_lobe_);
            std::array<float*, 4> by{};
            for (std::size_t k = 0; k < V; ++k) columns[V * j + k] = by[k] = part(derivative_, V * j + k, block);
            const float* e = columns[std::size_t(derivatives) + j] = part(value_, j, block);
            derive(view_->directions, block, moving(x, int(j)), e, part(exponent_, j, block), by[0], by[1], by[2],
                   by[3]);
        }
        for (std::size_t c = 0; c < 3; ++c) columns[std::size_t(total) - 3 + c] = part(rest_, c, block);
    });
}

// Let D hold the columns ∂G_j and G_j. The derivative of the residual of channel c is −β_jc ∂G_j. A coefficient
// strictly between its bounds adapts, so that only the component of D orthogonal to those lobes counts (Kaufman's
// approximation). A coefficient at a bound is constant.
void ViewProblem::linearise(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g) {
    const Eigen::Index J = lobes_, derivatives = per_lobe_ * J;
    const Eigen::MatrixXd G = gram_of_derivatives(x);
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
        for (Eigen::Index i = 0; i < derivatives; ++i) beta[i] = beta_(i / per_lobe_, c);
        H += beta.asDiagonal() * across * beta.asDiagonal();
        g -= beta.cwiseProduct(G.block(0, derivatives + J + c, derivatives, 1));
    }
}

double ViewProblem::coefficient(int j, int c) const {
    const double at_peak = elementary::exp(std::min(-offset_[std::size_t(j)], 700.0));
    return std::min(beta_(j, c) * at_peak * view_->scale, double(k_half_max));
}

std::vector<double> ViewProblem::cost_of_dropping() const { return srbf::cost_of_dropping(gram_, beta_); }

}  // namespace srbf
