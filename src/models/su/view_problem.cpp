#include "models/su/view_problem.h"

#include <limits>

#include "base/half.h"
#include "base/least_squares.h"
#include "srbf/elementary.h"
#include "srbf/kernel.h"

namespace SRBF_NAMESPACE {
namespace {

/// A lobe may peak between the rows. If its peak exceeds its largest value on them by more than this factor, its bound
/// is lowered accordingly.
constexpr double k_max_peak_ratio = 4;
/// Bound on the shift of a centre along a tangent, which corresponds to 45°.
constexpr double k_max_shift = 1;
/// Bounds on the step of a centre, in radians and in widths 1/√λ.
constexpr double k_longest_shift = 0.5, k_widths = 1.5;
/// Exponents up to this have a finite exponential in double.
constexpr double k_max_double_exponent = 700;

}  // namespace

ViewProblem::ViewProblem(int lobes) : lobes_(lobes), frame_(std::size_t(lobes)), log_scale_(std::size_t(lobes)) {}

Eigen::VectorXd ViewProblem::start(const ViewRows& view, std::span<const ViewLobe> lobes) {
    view_ = &view;
    const std::size_t column = blocks() * k_block, lobe_columns = column * std::size_t(lobes_);
    exponent_.resize(lobe_columns);
    value_.resize(lobe_columns);
    derivative_.resize(lobe_columns * k_variables);
    residual_.resize(column * 3);
    coefficients_ = {Eigen::MatrixXd(lobes_, 3), {}, {}};
    Eigen::VectorXd x = Eigen::VectorXd::Zero(k_variables * lobes_);
    for (int j = 0; j < lobes_; ++j) {
        const ViewLobe& lobe = lobes[std::size_t(j)];
        frame_[std::size_t(j)] = {lobe.centre,
                                  {Kernel<double>::from_frame(lobe.centre, 1.0, 0.0, 0.0),
                                   Kernel<double>::from_frame(lobe.centre, 0.0, 1.0, 0.0)}};
        x[k_variables * j + 2] = elementary::log(std::clamp(lobe.bandwidth, k_min_bandwidth, double(k_half_max)));
    }
    return x;
}

MovingLobe ViewProblem::moving_lobe(const Eigen::VectorXd& x, int j) const {
    const Frame& frame = frame_[std::size_t(j)];
    const double* const variables = &x[k_variables * j];
    const Vec3d shifted = frame.centre + variables[0] * frame.along[0] + variables[1] * frame.along[1];
    const double length = std::sqrt(dot(shifted, shifted));
    const Vec3d centre = (1 / length) * shifted;
    MovingLobe lobe{to_float(centre), {}, float(elementary::exp(variables[2]))};
    for (int k = 0; k < 2; ++k)
        lobe.along[k] = to_float((1 / length) * (frame.along[k] - dot(frame.along[k], centre) * centre));
    return lobe;
}

std::vector<ViewLobe> ViewProblem::lobes(const Eigen::VectorXd& x) const {
    std::vector<ViewLobe> lobes;
    for (int j = 0; j < lobes_; ++j) {
        const Frame& frame = frame_[std::size_t(j)];
        const double* const variables = &x[k_variables * j];
        lobes.push_back({normalize(frame.centre + variables[0] * frame.along[0] + variables[1] * frame.along[1]),
                         elementary::exp(variables[2])});
    }
    return lobes;
}

Eigen::VectorXd ViewProblem::for_each_lobe(double shift, double log_bandwidth) const {
    return Eigen::Vector3d(shift, shift, log_bandwidth).replicate(lobes_, 1);
}
Eigen::VectorXd ViewProblem::lower(const Eigen::VectorXd&) const {
    return for_each_lobe(-k_max_shift, elementary::log(k_min_bandwidth));
}
Eigen::VectorXd ViewProblem::upper(const Eigen::VectorXd&) const {
    return for_each_lobe(k_max_shift, elementary::log(double(k_half_max)));
}
Eigen::VectorXd ViewProblem::longest_step(const Eigen::VectorXd& x) const {
    Eigen::VectorXd longest = Eigen::VectorXd::Ones(k_variables * lobes_);
    for (int j = 0; j < lobes_; ++j)
        longest.segment(k_variables * j, 2)
            .setConstant(std::min(k_longest_shift, k_widths / std::sqrt(elementary::exp(x[k_variables * j + 2]))));
    return longest;
}

template <typename AddColumns> Eigen::MatrixXd ViewProblem::gram(std::size_t count, const AddColumns& add_columns) {
    const std::size_t K = view_->lights.size();
    std::vector<double> products(count * count, 0.0), lit(K * count, 0.0);
    std::vector<const float*> columns, lights(K);
    for (std::size_t block = 0; block < blocks(); ++block) {
        columns.clear();
        add_columns(block, columns);
        add_gram(columns, products.data());
        for (std::size_t k = 0; k < K; ++k) lights[k] = &view_->lights[k][block * k_block];
        if (K > 0) add_products(lights, columns, lit.data());
    }
    // The row-major lower triangle is a column-major upper one.
    const Eigen::Map<const Eigen::MatrixXd> triangle(products.data(), Eigen::Index(count), Eigen::Index(count));
    Eigen::MatrixXd G = triangle.selfadjointView<Eigen::Upper>();
    lit_ = Eigen::Map<const Eigen::MatrixXd>(lit.data(), Eigen::Index(count), Eigen::Index(K));
    if (K > 0) G += lit_ * lit_.transpose();
    return G;
}

double ViewProblem::loss(const Eigen::VectorXd& x) {
    for (int j = 0; j < lobes_; ++j) {
        const MovingLobe lobe = moving_lobe(x, j);
        float max = -std::numeric_limits<float>::max();
        for (std::size_t block = 0; block < blocks(); ++block)
            max = std::max(max, exponents(view_->directions, block, lobe, &view_->root_weight[block * k_block],
                                          exponent(block, j)));
        log_scale_[std::size_t(j)] = double(max);
        coefficients_.limit.row(j) = coefficient_limits(lobe, double(max));
        for (std::size_t block = 0; block < blocks(); ++block)
            exponentiate(exponent(block, j), &view_->root_weight[block * k_block], max, value(block, j));
    }
    const Eigen::MatrixXd G = gram(std::size_t(lobes_ + 3), [&](std::size_t block, std::vector<const float*>& columns) {
        for (int j = 0; j < lobes_; ++j) columns.push_back(value(block, j));
        for (const auto& y : view_->y) columns.push_back(&y[block * k_block]);
    });
    coefficients_.fit(G, nullptr);
    return loss_with_residuals();
}

Eigen::RowVector3d ViewProblem::coefficient_limits(const MovingLobe& lobe, double max) const {
    // The maximum of the lobe over the hemisphere; it is at the horizon if the centre is below.
    const double z = double(lobe.centre.z), lambda = double(lobe.bandwidth);
    const double log_peak = z < 0 ? lambda * (std::sqrt(std::max(0.0, 1 - z * z)) - 1) : 0;
    const double fraction = elementary::exp(max - log_peak);  // the largest value on the rows, relative to that maximum
    Eigen::RowVector3d limit;
    for (int c = 0; c < 3; ++c) {
        const double peak_limit = view_->largest[std::size_t(c)] / std::max(z, view_->min_cosine) * fraction *
                                  std::min(1.0, k_max_peak_ratio * fraction);
        const double half_limit = double(k_half_max) / view_->scale * elementary::exp(max);
        limit[c] = std::min(peak_limit, half_limit);
    }
    return limit;
}

double ViewProblem::loss_with_residuals() {
    const Eigen::MatrixXd& beta = coefficients_.beta;
    double sum = (lit_.bottomRows(3) - beta.transpose() * lit_.topRows(lobes_)).squaredNorm();
    std::vector<const float*> columns(static_cast<std::size_t>(lobes_));
    for (Eigen::Index c = 0; c < 3; ++c) {
        const Eigen::VectorXf factors = beta.col(c).cast<float>();
        for (std::size_t block = 0; block < blocks(); ++block) {
            for (int j = 0; j < lobes_; ++j) columns[std::size_t(j)] = value(block, j);
            sum += residual(&view_->y[std::size_t(c)][block * k_block], {factors.data(), columns.size()}, columns,
                            residual_of(block, c));
        }
    }
    return sum;
}

// The derivative of the residual of channel c is −β_jc ∂G_j.
void ViewProblem::linearise(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g) {
    const Eigen::Index J = lobes_, X = k_variables * J;
    for (int j = 0; j < lobes_; ++j) {
        const MovingLobe lobe = moving_lobe(x, j);
        const Eigen::Index i = k_variables * j;
        for (std::size_t block = 0; block < blocks(); ++block)
            derive(view_->directions, block, lobe, value(block, j), exponent(block, j), derivative(block, i),
                   derivative(block, i + 1), derivative(block, i + 2));
    }
    const Eigen::MatrixXd G = gram(std::size_t(X + J + 3), [&](std::size_t block, std::vector<const float*>& columns) {
        for (Eigen::Index i = 0; i < X; ++i) columns.push_back(derivative(block, i));
        for (Eigen::Index j = 0; j < J; ++j) columns.push_back(value(block, j));
        for (Eigen::Index c = 0; c < 3; ++c) columns.push_back(residual_of(block, c));
    });
    Eigen::MatrixXd beta(X, 3);  // the coefficients of each variable's lobe
    for (Eigen::Index i = 0; i < X; ++i) beta.row(i) = coefficients_.beta.row(i / k_variables);
    H = G.topLeftCorner(X, X).cwiseProduct(beta * beta.transpose());
    g = -G.block(0, X + J, X, 3).cwiseProduct(beta).rowwise().sum();
    for (Eigen::Index c = 0; c < 3; ++c) {
        const std::vector<Eigen::Index> free = coefficients_.free(c);
        const Eigen::MatrixXd with_lobes = beta.col(c).asDiagonal() * G.block(0, X, X, J);
        if (!free.empty()) eliminate(coefficients_.gram(free, free), with_lobes(Eigen::all, free), H);
    }
}

std::vector<double> ViewProblem::cost_of_dropping() const {
    return srbf::cost_of_dropping(coefficients_.gram, coefficients_.beta);
}

std::vector<std::array<double, 3>> ViewProblem::coefficients() const {
    std::vector<std::array<double, 3>> all(log_scale_.size());
    for (std::size_t j = 0; j < all.size(); ++j) {
        const double at_peak = elementary::exp(std::min(-log_scale_[j], k_max_double_exponent));
        for (std::size_t c = 0; c < 3; ++c)
            all[j][c] = std::min(coefficients_.beta(Eigen::Index(j), Eigen::Index(c)) * at_peak * view_->scale,
                                 double(k_half_max));
    }
    return all;
}

}  // namespace
