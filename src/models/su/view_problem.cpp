#include "models/su/view_problem.h"

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
/// Bisections: an interval of π/2 becomes 2e-5, and the logarithm at a maximum is exact to the square of that.
constexpr int k_bisections = 16;
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

void LobeColumns::take(const DirectionRows& directions, const Aligned<float>& weight, int lobes, int variables) {
    directions_ = &directions, weight_ = &weight, lobes_ = lobes, variables_ = variables;
    const std::size_t rows = directions.blocks * k_block * std::size_t(lobes);
    exponent_.resize(rows), value_.resize(rows), derivative_.resize(rows * std::size_t(variables));
}

double LobeColumns::take_exponents(int j, const MovingLobe& lobe) {
    float most = -std::numeric_limits<float>::max();
    for (std::size_t block = 0; block < directions_->blocks; ++block)
        most = std::max(
            most, exponents(*directions_, block, lobe, &(*weight_)[block * k_block], &exponent_[at(block, j, lobes_)]));
    return double(most);
}

void LobeColumns::exponentiate(int j, double offset) {
    for (std::size_t block = 0; block < directions_->blocks; ++block)
        srbf::exponentiate(&exponent_[at(block, j, lobes_)], &(*weight_)[block * k_block], float(offset),
                           &value_[at(block, j, lobes_)]);
}

void LobeColumns::derive(int j, const MovingLobe& lobe) {
    for (std::size_t block = 0; block < directions_->blocks; ++block) {
        std::array<float*, 4> by{};
        for (int k = 0; k < variables_; ++k)
            by[std::size_t(k)] = &derivative_[at(block, variables_ * j + k, lobes_ * variables_)];
        srbf::derive(*directions_, block, lobe, value(block, j), &exponent_[at(block, j, lobes_)], by[0], by[1], by[2],
                     by[3]);
    }
}

ViewProblem::ViewProblem(int lobes, bool shaped)
    : lobes_(lobes), variables_(shaped ? 4 : 3), frame_(std::size_t(lobes)), offset_(std::size_t(lobes)) {}

Eigen::VectorXd ViewProblem::start(const ViewRows& view, std::span<const ViewLobe> lobes, double share) {
    view_ = &view, share_ = share;
    across_ = Kernel<float>::tangent_across(view.view);
    on_rows_.take(view.directions, view.root_weight, lobes_, variables_);
    on_pixels_.take(view.pixels.directions, view.pixels.exposure, lobes_, variables_);
    rest_.resize(blocks() * k_block * 3);
    coefficients_ = {true, Eigen::MatrixXd(lobes_, 3), {}, {}};
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

MovingLobe ViewProblem::moving(const Eigen::VectorXd& x, int j) const {
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

std::vector<ViewLobe> ViewProblem::lobes(const Eigen::VectorXd& x) const {
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

double ViewProblem::least_shape(int j) const {
    const double cosine = dot(frame_[std::size_t(j)].centre, to_double(view_->view));
    return -k_most_narrowing * (1 - cosine) / std::max(1 + cosine, k_least_denominator);
}

Eigen::VectorXd ViewProblem::lower(const Eigen::VectorXd& x) const {
    Eigen::VectorXd bound = Eigen::VectorXd::Constant(variables_ * lobes_, -k_most_shift);
    for (int j = 0; j < lobes_; ++j) {
        bound[variables_ * j + 2] = elementary::log(k_least_bandwidth);
        if (shaped()) bound[variables_ * j + 3] = std::signbit(shape(x, j)) ? least_shape(j) : 0.0;
    }
    return bound;
}

Eigen::VectorXd ViewProblem::upper(const Eigen::VectorXd& x) const {
    Eigen::VectorXd bound = Eigen::VectorXd::Constant(variables_ * lobes_, k_most_shift);
    for (int j = 0; j < lobes_; ++j) {
        bound[variables_ * j + 2] = elementary::log(double(k_half_max));
        if (shaped()) bound[variables_ * j + 3] = std::signbit(shape(x, j)) ? -0.0 : k_most_depth;
    }
    return bound;
}

Eigen::VectorXd ViewProblem::longest_step(const Eigen::VectorXd& x) const {
    Eigen::VectorXd longest = Eigen::VectorXd::Ones(variables_ * lobes_);
    for (int j = 0; j < lobes_; ++j) {
        auto of = longest.segment(variables_ * j, variables_);
        of.head(2).setConstant(std::min(k_longest_shift, k_widths / std::sqrt(elementary::exp(x[variables_ * j + 2]))));
        if (shaped()) of[3] = k_longest_shape + k_longest_shape * std::abs(shape(x, j));
    }
    return longest;
}

template <typename OfBlock> Eigen::MatrixXd ViewProblem::gram(std::size_t count, const OfBlock& of_block) {
    const std::size_t K = view_->lights.size();
    std::vector<double> products(count * count, 0.0), lit(K * count, 0.0);
    std::vector<const float*> columns, lights(K);
    for (std::size_t block = 0; block < blocks(); ++block) {
        columns.clear();
        of_block(block, columns);
        add_gram(columns, products.data());
        for (std::size_t k = 0; k < K; ++k) lights[k] = &view_->lights[k][block * k_block];
        if (K > 0) add_products(lights, columns, lit.data());
    }
    // Row-major lower triangles are column-major upper ones.
    const Eigen::Map<const Eigen::MatrixXd> triangle(products.data(), Eigen::Index(count), Eigen::Index(count));
    Eigen::MatrixXd G = triangle.selfadjointView<Eigen::Upper>();
    lit_ = Eigen::Map<const Eigen::MatrixXd>(lit.data(), Eigen::Index(count), Eigen::Index(K));
    if (K > 0) G += lit_ * lit_.transpose();
    return G;
}

double ViewProblem::loss(const Eigen::VectorXd& x) {
    for (int j = 0; j < lobes_; ++j) {
        const MovingLobe lobe = moving(x, j);
        const double most = offset_[std::size_t(j)] = on_rows_.take_exponents(j, lobe);
        coefficients_.limit.row(j) = limit_of(lobe, most);
        on_rows_.exponentiate(j, most);
    }
    if (share_ > 0) evaluate_in_pixels(x);
    const Eigen::MatrixXd G = gram(std::size_t(lobes_ + 3), [&](std::size_t block, std::vector<const float*>& columns) {
        for (int j = 0; j < lobes_; ++j) columns.push_back(on_rows_.value(block, j));
        for (const auto& y : view_->y) columns.push_back(&y[block * k_block]);
    });
    const PixelTerm pixels = pixel_term(share_);
    coefficients_.fit(G, share_ > 0 ? &pixels : nullptr);
    return loss_with_residuals();
}

void ViewProblem::evaluate_in_pixels(const Eigen::VectorXd& x) {
    for (int j = 0; j < lobes_; ++j) {
        on_pixels_.take_exponents(j, moving(x, j));
        on_pixels_.exponentiate(j, offset_[std::size_t(j)]);
    }
}

PixelTerm ViewProblem::pixel_term(double share) const {
    return {view_->pixels.reference, share, false,
            [this](std::size_t block, Eigen::Index j) { return on_pixels_.value(block, j); }};
}

double ViewProblem::pixel_errors(const Eigen::VectorXd& x) {
    evaluate_in_pixels(x);
    CoefficientTerms unused(0, 0);
    return pixel_term(1).loss(coefficients_.beta, unused);
}

Eigen::RowVector3d ViewProblem::limit_of(const MovingLobe& lobe, double most) const {
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

double ViewProblem::loss_with_residuals() {
    const Eigen::MatrixXd& beta = coefficients_.beta;
    double sum = coefficients_.of_pixels + (lit_.bottomRows(3) - beta.transpose() * lit_.topRows(lobes_)).squaredNorm();
    std::vector<const float*> columns(static_cast<std::size_t>(lobes_));
    for (Eigen::Index c = 0; c < 3; ++c) {
        const Eigen::VectorXf of_channel = beta.col(c).cast<float>();
        for (std::size_t block = 0; block < blocks(); ++block) {
            for (int j = 0; j < lobes_; ++j) columns[std::size_t(j)] = on_rows_.value(block, j);
            sum += residual(&view_->y[std::size_t(c)][block * k_block], {of_channel.data(), columns.size()}, columns,
                            rest(block, c));
        }
    }
    return sum;
}

// The derivative of the residual of channel c is −β_jc ∂G_j.
void ViewProblem::linearise(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g) {
    const Eigen::Index J = lobes_, V = variables_, X = V * J;
    for (int j = 0; j < lobes_; ++j) on_rows_.derive(j, moving(x, j));
    const Eigen::MatrixXd G = gram(std::size_t(X + J + 3), [&](std::size_t block, std::vector<const float*>& columns) {
        for (Eigen::Index i = 0; i < X; ++i) columns.push_back(on_rows_.derivative(block, i));
        for (Eigen::Index j = 0; j < J; ++j) columns.push_back(on_rows_.value(block, j));
        for (Eigen::Index c = 0; c < 3; ++c) columns.push_back(rest(block, c));
    });
    Eigen::MatrixXd beta(X, 3);  // of the lobe of each variable
    for (Eigen::Index i = 0; i < X; ++i) beta.row(i) = coefficients_.beta.row(i / V);
    H = G.topLeftCorner(X, X).cwiseProduct(beta * beta.transpose());
    g = -G.block(0, X + J, X, 3).cwiseProduct(beta).rowwise().sum();
    const auto with_lobes = [&](Eigen::Index c) -> Eigen::MatrixXd {
        return beta.col(c).asDiagonal() * G.block(0, X, X, J);
    };
    const auto rest_with_lobes = [&](Eigen::Index c) -> Eigen::VectorXd { return G.block(X, X + J + c, J, 1); };
    const auto add_pixels = [&](CoefficientTerms& terms) {
        for (int j = 0; j < lobes_; ++j) on_pixels_.derive(j, moving(x, j));
        const auto set_by_lobe = [&](std::size_t block, Eigen::Index j, const float* of_lobe,
                                     const PixelTerm::ByChannel&, float* columns) {
            for (Eigen::Index i = V * j; i < V * (j + 1); ++i)
                multiply(of_lobe, on_pixels_.derivative(block, i), columns + std::size_t(i) * k_block);
        };
        pixel_term(share_).add_derivatives(coefficients_.beta, set_by_lobe, H, g, terms);
    };
    coefficients_.adapt(share_ > 0, with_lobes, rest_with_lobes, add_pixels, H, g);
}

std::vector<double> ViewProblem::cost_of_dropping() const {
    return srbf::cost_of_dropping(coefficients_.gram, coefficients_.beta);
}

std::vector<std::array<double, 3>> ViewProblem::coefficients() const {
    std::vector<std::array<double, 3>> all(offset_.size());
    for (std::size_t j = 0; j < all.size(); ++j) {
        const double at_peak = elementary::exp(std::min(-offset_[j], k_most_double_exponent));
        for (std::size_t c = 0; c < 3; ++c)
            all[j][c] = std::min(coefficients_.beta(Eigen::Index(j), Eigen::Index(c)) * at_peak * view_->scale,
                                 double(k_half_max));
    }
    return all;
}

}  // namespace srbf
