#include "fit/views/evaluated_lobes.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "srbf/elementary.h"
#include "srbf/half.h"
#include "srbf/kernel.h"

namespace srbf {
namespace {

/// A lobe may lie between the rows: if less than a quarter of its peak is visible on them, it is bounded by the visible
/// part.
constexpr double k_hidden = 4;
/// Of a centre along a tangent, by which it turns 45°. A larger shift needs a new start.
constexpr double k_most_shift = 1;
/// Bounds of a step: of a centre at most this [rad], and at most so many widths 1/√λ.
constexpr double k_longest_shift = 0.5, k_widths = 1.5;
/// Bounds of a step of the shape: this, and as much of its present value.
constexpr double k_longest_shape = 0.5;
/// 1 + ξ·wv counts as no less where it divides: centres close to −wv are below the horizon.
constexpr double k_least_denominator = 0.01;
/// Bisections: an interval of π/2 becomes 1e-12.
constexpr int k_bisections = 40;
/// Exponents up to this have a finite exponential in double.
constexpr double k_most_double_exponent = 700;

/// Where a lobe λ, τ with a centre at height z has its maximum over the hemisphere: the height, and the logarithm
/// there. The maximum lies in the plane of centre and normal, where λ sin(θ_centre − θ) = τ sin θ / cos² θ.
std::pair<double, double> highest(double z, double lambda, double tau) {
    const double centre = elementary::acos(std::clamp(z, -1.0, 1.0));
    double low = std::max(0.0, centre - k_pi / 2), high = std::min(centre, k_pi / 2);
    for (int step = 0; step < k_bisections; ++step) {
        const double theta = (low + high) / 2;
        const double pull = lambda * elementary::sin(centre - theta) * elementary::cos(theta) * elementary::cos(theta);
        (pull > tau * elementary::sin(theta) ? low : high) = theta;
    }
    const double cosine = elementary::cos(low);
    return {cosine, lambda * (elementary::cos(centre - low) - 1) - tau * Kernel<double>::slant(cosine)};
}

}  // namespace

Eigen::MatrixXd symmetric(const std::vector<double>& triangle, Eigen::Index n) {
    return Eigen::Map<const Eigen::MatrixXd>(triangle.data(), n, n).selfadjointView<Eigen::Upper>();
}

EvaluatedLobes::EvaluatedLobes(int lobes, bool shaped)
    : lobes_(lobes), variables_(shaped ? 4 : 3), frame_(std::size_t(lobes)), offset_(std::size_t(lobes)) {
    limit_.resize(lobes, 3);
}

Eigen::VectorXd EvaluatedLobes::start(const ViewRows& view, std::span<const ViewLobe> lobes) {
    view_ = &view;
    across_ = Kernel<float>::tangent_across(view.view);
    const std::size_t rows = blocks() * k_block, J = std::size_t(lobes_);
    exponent_.resize(rows * J), value_.resize(rows * J), derivative_.resize(rows * std::size_t(variables_) * J),
        residual_.resize(rows * 3);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(variables_ * lobes_);
    for (int j = 0; j < lobes_; ++j) {
        const ViewLobe& lobe = lobes[std::size_t(j)];
        frame_[std::size_t(j)] = {lobe.centre,
                                  {Kernel<double>::from_frame(lobe.centre, 1.0, 0.0, 0.0),
                                   Kernel<double>::from_frame(lobe.centre, 0.0, 1.0, 0.0)}};
        x[variables_ * j + 2] = elementary::log(std::clamp(lobe.bandwidth, k_least_bandwidth, double(k_half_max)));
        if (shaped()) x[variables_ * j + 3] = lobe.shape;
    }
    return x;
}

MovingLobe EvaluatedLobes::moving(const Eigen::VectorXd& x, int j) const {
    const Frame& frame = frame_[std::size_t(j)];
    const double* const of = &x[variables_ * j];
    const Vec3d towards = frame.centre + of[0] * frame.along[0] + of[1] * frame.along[1];
    const double length = std::sqrt(dot(towards, towards));
    const Vec3d centre = (1 / length) * towards;
    MovingLobe lobe{to_float(centre), {}, float(elementary::exp(of[2])), float(shape(x, j)), across_};
    for (int k = 0; k < 2; ++k)
        lobe.along[k] = to_float((1 / length) * (frame.along[k] - dot(frame.along[k], centre) * centre));
    return lobe;
}

std::vector<ViewLobe> EvaluatedLobes::lobes(const Eigen::VectorXd& x) const {
    std::vector<ViewLobe> lobes;
    for (int j = 0; j < lobes_; ++j) {
        const Frame& frame = frame_[std::size_t(j)];
        const double* const of = &x[variables_ * j];
        const double shape = this->shape(x, j);
        lobes.push_back({normalize(frame.centre + of[0] * frame.along[0] + of[1] * frame.along[1]),
                         elementary::exp(of[2]), shape == 0 ? -shape : shape});
    }
    return lobes;
}

double EvaluatedLobes::least_shape(int j) const {
    const double cosine = dot(frame_[std::size_t(j)].centre, to_double(view_->view));
    return -k_most_narrowing * (1 - cosine) / std::max(1 + cosine, k_least_denominator);
}

Eigen::VectorXd EvaluatedLobes::lower(const Eigen::VectorXd& x) const {
    Eigen::VectorXd bound = Eigen::VectorXd::Constant(variables_ * lobes_, -k_most_shift);
    for (int j = 0; j < lobes_; ++j) {
        bound[variables_ * j + 2] = elementary::log(k_least_bandwidth);
        if (shaped()) bound[variables_ * j + 3] = std::signbit(shape(x, j)) ? least_shape(j) : 0.0;
    }
    return bound;
}

Eigen::VectorXd EvaluatedLobes::upper(const Eigen::VectorXd& x) const {
    Eigen::VectorXd bound = Eigen::VectorXd::Constant(variables_ * lobes_, k_most_shift);
    for (int j = 0; j < lobes_; ++j) {
        bound[variables_ * j + 2] = elementary::log(double(k_half_max));
        if (shaped()) bound[variables_ * j + 3] = std::signbit(shape(x, j)) ? -0.0 : k_most_depth;
    }
    return bound;
}

Eigen::VectorXd EvaluatedLobes::longest_step(const Eigen::VectorXd& x) const {
    Eigen::VectorXd longest = Eigen::VectorXd::Ones(variables_ * lobes_);
    for (int j = 0; j < lobes_; ++j) {
        auto of = longest.segment(variables_ * j, variables_);
        of.head(2).setConstant(std::min(k_longest_shift, k_widths / std::sqrt(elementary::exp(x[variables_ * j + 2]))));
        if (shaped()) of[3] = k_longest_shape + k_longest_shape * std::abs(shape(x, j));
    }
    return longest;
}

template <typename OfBlock> Eigen::MatrixXd EvaluatedLobes::gram(std::size_t count, const OfBlock& of_block) {
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

void EvaluatedLobes::evaluate(const Eigen::VectorXd& x) {
    take_exponents(x);
    take_products();
}

bool EvaluatedLobes::evaluate(const Eigen::VectorXd& x, const std::vector<double>& offset) {
    take_exponents(x);
    for (int j = 0; j < lobes_; ++j) {
        const double change = offset[std::size_t(j)] - offset_[std::size_t(j)];
        if (change < -k_most_exponent) return false;
        limit_.row(j) *= elementary::exp(std::min(change, k_most_double_exponent));
    }
    offset_ = offset;
    take_products();
    return true;
}

void EvaluatedLobes::take_exponents(const Eigen::VectorXd& x) {
    for (int j = 0; j < lobes_; ++j) {
        const MovingLobe lobe = moving(x, j);
        float most = -std::numeric_limits<float>::max();
        for (std::size_t block = 0; block < blocks(); ++block)
            most = std::max(most, exponents(view_->directions, block, lobe, &view_->root_weight[block * k_block],
                                            part(exponent_, std::size_t(j), block)));
        offset_[std::size_t(j)] = double(most);
        limit_.row(j) = limit_of(lobe, double(most));
    }
}

Eigen::RowVector3d EvaluatedLobes::limit_of(const MovingLobe& lobe, double most) const {
    // The maximum of the lobe over the hemisphere relative to that of its Gaussian: the value at the horizon if the
    // centre is below it.
    const double centre_z = double(lobe.centre.z), lambda = double(lobe.bandwidth);
    double z = centre_z, log_visible = z < 0 ? lambda * (std::sqrt(std::max(0.0, 1 - z * z)) - 1) : 0;
    if (lobe.shape > 0) std::tie(z, log_visible) = highest(centre_z, lambda, double(lobe.shape));
    const double visible = elementary::exp(most - log_visible);  // the fraction of it that is on the rows
    Eigen::RowVector3d limit;
    for (int c = 0; c < 3; ++c) {
        const double of_hemisphere = view_->largest[std::size_t(c)] / std::max(z, view_->least_cosine) * visible *
                                     std::min(1.0, k_hidden * visible);
        const double of_halves = double(k_half_max) / view_->scale * elementary::exp(most);
        limit[c] = std::min(of_hemisphere, of_halves);
    }
    return limit;
}

void EvaluatedLobes::take_products() {
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

double EvaluatedLobes::loss_of(const Eigen::MatrixXd& all_beta) {
    const auto J = std::size_t(lobes_);
    double sum = (lit_.bottomRows(3) - all_beta.transpose() * lit_.topRows(lobes_)).squaredNorm();
    std::vector<float> beta(J);
    std::vector<const float*> columns(J);
    for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t j = 0; j < J; ++j) beta[j] = float(all_beta(Eigen::Index(j), Eigen::Index(c)));
        for (std::size_t block = 0; block < blocks(); ++block) {
            for (std::size_t j = 0; j < J; ++j) columns[j] = part(value_, j, block);
            sum += residual(&view_->y[c][block * k_block], beta, columns, part(residual_, c, block));
        }
    }
    return sum;
}

Eigen::MatrixXd EvaluatedLobes::gram_of_derivatives(const Eigen::VectorXd& x) {
    const std::size_t J = std::size_t(lobes_), V = std::size_t(variables_), derivatives = V * J;
    return gram(derivatives + J + 3, [&](std::size_t block, std::vector<const float*>& columns) {
        for (std::size_t j = 0; j < J; ++j) {
            std::array<float*, 4> by{};
            for (std::size_t k = 0; k < V; ++k) columns[V * j + k] = by[k] = part(derivative_, V * j + k, block);
            const float* e = columns[derivatives + j] = part(value_, j, block);
            derive(view_->directions, block, moving(x, int(j)), e, part(exponent_, j, block), by[0], by[1], by[2],
                   by[3]);
        }
        for (std::size_t c = 0; c < 3; ++c) columns[derivatives + J + c] = part(residual_, c, block);
    });
}

std::vector<std::array<double, 3>> EvaluatedLobes::coefficients(const Eigen::MatrixXd& beta) const {
    std::vector<std::array<double, 3>> all(offset_.size());
    for (std::size_t j = 0; j < all.size(); ++j) {
        const double at_peak = elementary::exp(std::min(-offset_[j], k_most_double_exponent));
        for (std::size_t c = 0; c < 3; ++c)
            all[j][c] = std::min(beta(Eigen::Index(j), Eigen::Index(c)) * at_peak * view_->scale, double(k_half_max));
    }
    return all;
}

}  // namespace srbf
