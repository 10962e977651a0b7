#include <Eigen/SparseCholesky>

#include "base/errors.h"
#include "base/least_squares.h"
#include "base/levenberg_marquardt.h"
#include "base/parallel.h"
#include "brdf/directions.h"
#include "brdf/values.h"
#include "errors/itp.h"
#include "extras/blender/closure_terms.h"
#include "extras/blender/closures.h"
#include "extras/blender/matched_views.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

// ---- The loss ----

constexpr double k_min_alpha = 0.01, k_max_tilt = 1.5, k_beside_horizon = 0.01;  ///< [rad]
constexpr double k_min_weight = 1e-9;
constexpr const char* k_closure_stage = "fitting closures";

/// The unknowns at a knot: for each term the tilt ν of its normal, the logarithms of α along and across, and those of
/// its weights; then the logarithms of the colours of the diffuse ramp. Terms and these colours are parts of the sum.
struct Layout {
    std::size_t terms, ramp, knots;
    std::size_t parts() const { return terms + ramp; }
    std::size_t width() const { return 6 * terms + 3 * ramp; }
    std::size_t diffuse() const { return 6 * terms; }
    std::size_t weight(std::size_t part) const { return part < terms ? 6 * part + 3 : 3 * (terms + part); }
    double theta(std::size_t knot) const { return k_pi / 2 * double(knot) / double(knots - 1); }
};

/// The loss of a sum of closures: the mean over pixels of 2 k² (√(ΔE_ITP² / k² + 1) − 1), and squared second
/// differences between knots.
class ClosureProblem {
  public:
    /// `progress` receives each linearisation; `linearisations` is their largest number.
    ClosureProblem(const std::vector<MatchedView>& views, Layout layout, int threads, ProgressToken progress = {},
                   int linearisations = 1)
        : views_(views),
          layout_(layout),
          threads_(threads),
          progress_(std::move(progress)),
          linearisations_(linearisations) {}

    /// Sets k: the ΔE_ITP from which on the loss of a pixel grows linearly.
    void set_linear_from(double k) { linear_from_ = k; }

    double loss(const Eigen::VectorXd& x) {
        set(x);
        std::vector<double> losses(views_.size());
        parallel_for(views_.size(), threads_, [&](std::size_t v) { losses[v] = loss_of_view(views_[v]); });
        double sum = 0;
        for (const double each : losses) sum += each;
        for_differences([&](std::size_t i, std::size_t step, double weight) {
            sum += weight * elementary::square(second_difference(x, i, step));
        });
        return sum;
    }

    void linearise(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g) {
        progress_.report(k_closure_stage, double(linearised_++) / linearisations_);
        const auto n = x.size(), width = Eigen::Index(layout_.width());
        H = Eigen::MatrixXd::Zero(n, n);
        g = Eigen::VectorXd::Zero(n);
        std::vector<Eigen::MatrixXd> squares(views_.size());
        std::vector<Eigen::VectorXd> slopes(views_.size());
        parallel_for(views_.size(), threads_, [&](std::size_t v) { linearise_view(views_[v], squares[v], slopes[v]); });
        for (std::size_t v = 0; v < views_.size(); ++v) {
            const Eigen::Index first = Eigen::Index(KnotPosition(views_[v].theta, layout_.knots).knot) * width;
            H.block(first, first, 2 * width, 2 * width) += squares[v];
            g.segment(first, 2 * width) += slopes[v];
        }
        for_differences([&](std::size_t i, std::size_t step, double weight) {
            const std::array<Eigen::Index, 3> at{Eigen::Index(i - step), Eigen::Index(i), Eigen::Index(i + step)};
            const std::array<double, 3> factor{1, -2, 1};
            for (std::size_t a = 0; a < 3; ++a) {
                g[at[a]] += weight * factor[a] * second_difference(x, i, step);
                for (std::size_t b = 0; b < 3; ++b) H(at[a], at[b]) += weight * factor[a] * factor[b];
            }
        });
    }

    /// A x = b, where A is JᵀJ and a diagonal: unknowns of knots further apart than two have no common derivative.
    static Eigen::VectorXd solve(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
        const Eigen::SparseMatrix<double> band = A.sparseView();
        return Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>>(band)
            .solve(b);
    }

    Eigen::VectorXd lower(const Eigen::VectorXd& x) const {
        return bounds(x, -k_max_tilt, elementary::log(k_min_alpha), elementary::log(1e-12));
    }
    Eigen::VectorXd upper(const Eigen::VectorXd& x) const {
        Eigen::VectorXd upper = bounds(x, k_max_tilt, 0, elementary::log(100.0));
        for (std::size_t i = 0; i < layout_.knots; ++i)
            for (std::size_t k = 0; k < layout_.terms; ++k) {
                double& tilt = upper[Eigen::Index(i * layout_.width() + 6 * k)];
                tilt = std::min(tilt, k_pi / 2 - k_beside_horizon - layout_.theta(i));
            }
        return upper;
    }
    Eigen::VectorXd longest_step(const Eigen::VectorXd& x) const { return Eigen::VectorXd::Constant(x.size(), 0.7); }

    /// The tables of the unknowns.
    ClosureSum sum(const Eigen::VectorXd& x) {
        set(x);
        ClosureSum sum{layout_.terms, {}, {}, layout_.ramp};
        const auto colour = [](const double* c) { return Rgb{float(c[0]), float(c[1]), float(c[2])}; };
        for (std::size_t i = 0; i < layout_.knots; ++i) {
            const double* const row = &table_[i * layout_.width()];
            for (std::size_t k = 0; k < layout_.terms; ++k)
                sum.closures.push_back(
                    {float(row[6 * k]), float(row[6 * k + 1]), float(row[6 * k + 2]), colour(row + 6 * k + 3)});
            for (std::size_t j = 0; j < layout_.ramp; ++j)
                sum.diffuse.push_back(colour(row + layout_.diffuse() + 3 * j));
        }
        return sum;
    }

    /// Σ of each part over the pixels of a view, in rows; rows after these are derivatives of terms by their shapes.
    Eigen::MatrixXd pixel_sums(const MatchedView& view, bool with_derivatives) const {
        const std::vector<double> q = between(view.theta);
        const auto K = Eigen::Index(layout_.terms), parts = Eigen::Index(layout_.parts()),
                   n = Eigen::Index(view.lights.size());
        Eigen::MatrixXd values(parts + (with_derivatives ? 3 * K : 0), n);
        for (Eigen::Index i = 0; i < n; ++i)
            for (Eigen::Index j = 0; K + j < parts; ++j)
                values(K + j, i) =
                    ramp_fraction(std::size_t(j + 1), layout_.ramp, view.lights[std::size_t(i)].wl.z) / k_pi;
        for (Eigen::Index k = 0; k < K; ++k) {
            const ClosureTerm term({q[std::size_t(6 * k)], q[std::size_t(6 * k + 1)], q[std::size_t(6 * k + 2)]},
                                   view.wv);
            ClosureShape derivatives;
            for (Eigen::Index i = 0; i < n; ++i) {
                values(k, i) = term.value(view.lights[std::size_t(i)], with_derivatives ? &derivatives : nullptr);
                for (std::size_t p = 0; with_derivatives && p < 3; ++p)
                    values(parts + 3 * k + Eigen::Index(p), i) = derivatives[p];
            }
        }
        return summed_over_pixels(view, values);
    }
    static Eigen::MatrixXd summed_over_pixels(const MatchedView& view, const Eigen::MatrixXd& values) {
        Eigen::MatrixXd sums(values.rows(), Eigen::Index(view.pixels.size()));
        for (std::size_t p = 0; p < view.pixels.size(); ++p) {
            const MatchedPixel& pixel = view.pixels[p];
            auto sum = sums.col(Eigen::Index(p));
            sum = pixel.weight[0] * values.col(Eigen::Index(pixel.first));
            for (std::size_t i = 1; i < pixel.weight.size(); ++i)
                sum += pixel.weight[i] * values.col(Eigen::Index(pixel.first + i));
        }
        return sums;
    }

    void set(const Eigen::VectorXd& x) {
        const std::size_t width = layout_.width();
        table_.resize(std::size_t(x.size()));
        for (std::size_t i = 0; i < layout_.knots; ++i) {
            const double* const from = x.data() + i * width;
            double* const to = &table_[i * width];
            for (std::size_t k = 0; k < layout_.terms; ++k) {
                const double along = from[6 * k + 1], across = from[6 * k + 2],
                             ratio = elementary::exp(-std::abs(along - across) / 2);
                to[6 * k] = elementary::sin(from[6 * k]) / elementary::cos(from[6 * k]);
                to[6 * k + 1] = elementary::exp((along + across) / 4);
                to[6 * k + 2] = along < across ? 1 - ratio : ratio - 1;
                for (std::size_t c = 3; c < 6; ++c) to[6 * k + c] = elementary::exp(from[6 * k + c]);
            }
            for (std::size_t c = layout_.diffuse(); c < width; ++c) to[c] = elementary::exp(from[c]);
        }
    }

  private:
    /// Weights of squared second differences: of tilts, of log α, and of log weights.
    static constexpr std::array<double, 3> k_roughness_costs{200, 10, 2};
    static constexpr double k_knots_of_costs = 32;

    Eigen::VectorXd bounds(const Eigen::VectorXd& x, double tilt, double alpha, double weight) const {
        Eigen::VectorXd all = Eigen::VectorXd::Constant(x.size(), weight);
        for (std::size_t i = 0; i < layout_.knots; ++i)
            for (std::size_t k = 0; k < layout_.terms; ++k) {
                const auto first = Eigen::Index(i * layout_.width() + 6 * k);
                all[first] = tilt;
                all[first + 1] = all[first + 2] = alpha;
            }
        return all;
    }

    template <typename Visit> void for_differences(const Visit& visit) const {
        const double finer = (double(layout_.knots) - 1) / (k_knots_of_costs - 1),
                     scale = elementary::square(finer * finer);
        const auto add = [&](std::size_t column, double cost, std::size_t columns) {
            const double weight = scale * cost / (double(layout_.knots - 2) * double(columns));
            for (std::size_t i = 1; i + 1 < layout_.knots; ++i)
                visit(i * layout_.width() + column, layout_.width(), weight);
        };
        for (std::size_t k = 0; k < layout_.terms; ++k) {
            add(6 * k, k_roughness_costs[0], layout_.terms);
            for (std::size_t c = 1; c < 3; ++c) add(6 * k + c, k_roughness_costs[1], layout_.terms);
            for (std::size_t c = 3; c < 6; ++c) add(6 * k + c, k_roughness_costs[2], 3 * layout_.terms);
        }
        for (std::size_t c = layout_.diffuse(); c < layout_.width(); ++c)
            add(c, k_roughness_costs[2], 3 * layout_.ramp);
    }
    static double second_difference(const Eigen::VectorXd& x, std::size_t i, std::size_t step) {
        return x[Eigen::Index(i - step)] - 2 * x[Eigen::Index(i)] + x[Eigen::Index(i + step)];
    }

    /// The parameters at an angle of the viewer.
    std::vector<double> between(double theta) const {
        const KnotPosition at(theta, layout_.knots);
        const double* const a = &table_[at.knot * layout_.width()];
        std::vector<double> q(layout_.width());
        for (std::size_t i = 0; i < q.size(); ++i) q[i] = a[i] + at.fraction * (a[i + q.size()] - a[i]);
        return q;
    }
    Colour colour_of_pixel(const std::vector<double>& q, const Eigen::MatrixXd& sums, std::size_t p) const {
        Colour colour{};
        for (std::size_t part = 0; part < layout_.parts(); ++part)
            for (std::size_t c = 0; c < 3; ++c)
                colour[c] += q[layout_.weight(part) + c] * sums(Eigen::Index(part), Eigen::Index(p));
        return colour;
    }
    /// √(ΔE_ITP² / k² + 1) by ΔE_ITP².
    double root_of(double square) const { return std::sqrt(square / elementary::square(linear_from_) + 1); }
    double loss_of_view(const MatchedView& view) const {
        const std::vector<double> q = between(view.theta);
        const Eigen::MatrixXd sums = pixel_sums(view, false);
        double loss = 0;
        for (std::size_t p = 0; p < view.pixels.size(); ++p) {
            const MatchedPixel& pixel = view.pixels[p];
            const Colour itp = Itp<double>(shown(colour_of_pixel(q, sums, p), pixel.limit)).value();
            double square = 0;
            for (std::size_t c = 0; c < 3; ++c) square += elementary::square(itp[c] - pixel.itp[c]);
            loss += pixel.fraction * 2 * square / (root_of(square) + 1);
        }
        return loss;
    }
    /// JᵀJ and Jᵀr of a view by the unknowns of its two knots.
    void linearise_view(const MatchedView& view, Eigen::MatrixXd& H, Eigen::VectorXd& g) const {
        const std::vector<double> q = between(view.theta);
        const Eigen::MatrixXd sums = pixel_sums(view, true);
        const auto K = Eigen::Index(layout_.terms), parts = Eigen::Index(layout_.parts()),
                   width = Eigen::Index(layout_.width());
        Eigen::MatrixXd J = Eigen::MatrixXd::Zero(width, 3 * Eigen::Index(view.pixels.size()));
        Eigen::VectorXd r(J.cols());
        for (std::size_t p = 0; p < view.pixels.size(); ++p) {
            const MatchedPixel& pixel = view.pixels[p];
            const auto column = Eigen::Index(p);
            const Colour colour = colour_of_pixel(q, sums, p);
            const Itp<double> itp(shown(colour, pixel.limit));
            const auto jacobian = itp.jacobian();
            double square = 0;
            for (std::size_t c = 0; c < 3; ++c) square += elementary::square(itp.value()[c] - pixel.itp[c]);
            const double root = std::sqrt(pixel.fraction / root_of(square));
            for (std::size_t i = 0; i < 3; ++i) {
                const Eigen::Index row = 3 * column + Eigen::Index(i);
                r[row] = root * (itp.value()[i] - pixel.itp[i]);
                for (std::size_t c = 0; c < 3; ++c) {
                    if (!(colour[c] < pixel.limit[c])) continue;
                    const double slope = root * jacobian[i][c];
                    for (Eigen::Index k = 0; k < K; ++k) {
                        const double weight = slope * q[std::size_t(6 * k) + 3 + c];
                        for (Eigen::Index s = 0; s < 3; ++s)
                            J(6 * k + s, row) += weight * sums(parts + 3 * k + s, column);
                    }
                    for (Eigen::Index part = 0; part < parts; ++part)
                        J(Eigen::Index(layout_.weight(std::size_t(part)) + c), row) += slope * sums(part, column);
                }
            }
        }
        const KnotPosition at(view.theta, layout_.knots);
        Eigen::MatrixXd chain(width, 2 * width);  // derivatives of a view's parameters by the unknowns of its knots
        chain << (1 - at.fraction) * slopes_at(at.knot), at.fraction * slopes_at(at.knot + 1);
        Eigen::MatrixXd square = Eigen::MatrixXd::Zero(width, width);
        square.selfadjointView<Eigen::Lower>().rankUpdate(J);
        square.triangularView<Eigen::StrictlyUpper>() = square.transpose();
        H = chain.transpose() * square * chain;
        g = chain.transpose() * (J * r);
    }
    /// Derivatives of the parameters at a knot by its unknowns.
    Eigen::MatrixXd slopes_at(std::size_t knot) const {
        const auto width = Eigen::Index(layout_.width());
        const Eigen::Map<const Eigen::VectorXd> row(&table_[knot * layout_.width()], width);
        Eigen::MatrixXd slopes = row.asDiagonal();
        for (Eigen::Index k = 0; k < Eigen::Index(layout_.terms); ++k) {
            const Eigen::Index i = 6 * k;
            slopes.block(i, i, 3, 3).setZero();
            slopes(i, i) = 1 + row[i] * row[i];
            slopes(i + 1, i + 1) = slopes(i + 1, i + 2) = row[i + 1] / 4;
            slopes(i + 2, i + 2) = (1 - std::abs(row[i + 2])) / 2;
            slopes(i + 2, i + 1) = -slopes(i + 2, i + 2);
        }
        return slopes;
    }

    const std::vector<MatchedView>& views_;
    Layout layout_;
    int threads_;
    ProgressToken progress_;
    int linearisations_, linearised_ = 0;
    double linear_from_ = 1;
    std::vector<double> table_;  ///< parameters at the knots, in the order of the unknowns
};

// ---- Starts ----

/// A term to start from: the tilt of its normal over θv [degrees], and α.
struct StartingTerm {
    enum class Tilt { constant, retro, half } tilt;
    double degrees, alpha;
    bool narrows;  ///< α along is α cos θv: a highlight that is round about the mirror direction
    double tilt_at(double theta) const {
        if (tilt == Tilt::retro) return -theta;
        if (tilt == Tilt::half) return -theta / 2;
        return std::min(degrees * k_degree, 86 * k_degree - theta);
    }
    double along(double theta) const {
        return narrows ? alpha * elementary::cos(std::min(theta, 80 * k_degree)) : alpha;
    }
    ClosureShape at(double theta) const {
        const double a = along(theta), tilt_here = tilt_at(theta);
        return {elementary::sin(tilt_here) / elementary::cos(tilt_here), std::sqrt(std::sqrt(a * alpha)),
                1 - std::sqrt(a / alpha)};
    }
};
std::vector<StartingTerm> starting_terms() {
    std::vector<StartingTerm> all;
    using Tilt = StartingTerm::Tilt;
    for (const double alpha : {0.03, 0.06, 0.12, 0.2, 0.35, 0.6, 0.95})
        for (const bool narrows : {false, true}) {
            for (const double degrees : {-40, -25, -12, -5, 0, 5, 12, 25})
                all.push_back({Tilt::constant, degrees, alpha, narrows});
            for (const Tilt tilt : {Tilt::retro, Tilt::half}) all.push_back({tilt, 0, alpha, narrows});
        }
    return all;
}

/// Weights of one view that match its pixels best: rows are parts, columns channels.
struct ViewWeights {
    Eigen::MatrixXd weights;
    double loss = 0;
};
/// Rows of `sums` are parts, columns pixels. The loss is a quadratic approximation of a difference of sixth roots.
ViewWeights best_weights(const MatchedView& view, const Eigen::MatrixXd& sums) {
    constexpr double k_dark = 0.0075, k_power = -5.0 / 3;
    ViewWeights best{Eigen::MatrixXd(sums.rows(), 3), 0};
    for (std::size_t c = 0; c < 3; ++c) {
        Eigen::VectorXd weight(sums.cols()), colour(sums.cols());
        for (std::size_t p = 0; p < view.pixels.size(); ++p) {
            const MatchedPixel& pixel = view.pixels[p];
            colour[Eigen::Index(p)] = pixel.colour[c];
            weight[Eigen::Index(p)] = pixel.fraction * elementary::pow(pixel.colour[c] + k_dark, k_power);
        }
        const Eigen::MatrixXd weighed = sums * weight.asDiagonal(), G = weighed * sums.transpose();
        const Eigen::VectorXd g = weighed * colour;
        const Eigen::VectorXd x =
            bounded_least_squares(G, g, Eigen::VectorXd::Constant(g.size(), std::numeric_limits<double>::infinity()));
        best.weights.col(Eigen::Index(c)) = x;
        best.loss += weight.dot(colour.cwiseAbs2()) - 2 * x.dot(g) + x.dot(G * x);
    }
    return best;
}

/// Values at increasing angles, linear between them.
double interpolated(std::span<const MatchedView> views, double theta, const auto& value_of) {
    std::size_t i = 1;
    while (i + 1 < views.size() && views[i].theta < theta) ++i;
    if (views.size() == 1) return value_of(0);
    const double fraction = std::clamp((theta - views[i - 1].theta) / (views[i].theta - views[i - 1].theta), 0.0, 1.0);
    return (1 - fraction) * value_of(i - 1) + fraction * value_of(i);
}

/// The unknowns with a further term, and the weights of the views: of the parts before, then of the term.
Eigen::VectorXd extended(const std::vector<MatchedView>& views, Layout before, const Eigen::VectorXd& x,
                         const StartingTerm& start, const std::vector<Eigen::MatrixXd>& weights) {
    const Layout after{before.terms + 1, before.ramp, before.knots};
    Eigen::VectorXd longer(Eigen::Index(after.knots * after.width()));
    const auto weight_at = [&](double theta, Eigen::Index row, std::size_t c) {
        return interpolated(views, theta, [&](std::size_t v) { return weights[v](row, Eigen::Index(c)); });
    };
    Eigen::VectorXd largest = Eigen::VectorXd::Zero(Eigen::Index(after.parts()));
    for (const Eigen::MatrixXd& view_weights : weights) largest = largest.cwiseMax(view_weights.rowwise().maxCoeff());
    constexpr double k_min_fraction = 0.02;  // weights stay above this fraction, so that they can grow again
    for (std::size_t i = 0; i < after.knots; ++i) {
        const double theta = after.theta(i);
        double* const to = longer.data() + i * after.width();
        const double* const from = x.data() + i * before.width();
        std::copy(from, from + 6 * before.terms, to);
        to[6 * before.terms] = start.tilt_at(theta);
        to[6 * before.terms + 1] = elementary::log(std::max(start.along(theta), k_min_alpha));
        to[6 * before.terms + 2] = elementary::log(start.alpha);
        for (std::size_t part = 0; part < after.parts(); ++part) {
            const auto row = Eigen::Index(part < before.terms    ? part
                                          : part == before.terms ? before.parts()
                                                                 : part - 1);
            for (std::size_t c = 0; c < 3; ++c)
                to[after.weight(part) + c] =
                    elementary::log(std::max(weight_at(theta, row, c), k_min_fraction * largest[row] + k_min_weight));
        }
    }
    return longer;
}

/// The unknowns with a further term. It is the term with which the views are matched best, if all weights are optimal.
Eigen::VectorXd with_term(const std::vector<MatchedView>& views, Layout before, const Eigen::VectorXd& x, int threads) {
    ClosureProblem problem(views, before, threads);
    problem.set(x);
    const auto parts = Eigen::Index(before.parts());
    std::vector<Eigen::MatrixXd> sums(views.size());
    parallel_for(views.size(), threads, [&](std::size_t v) {
        sums[v].resize(parts + 1, Eigen::Index(views[v].pixels.size()));
        sums[v].topRows(parts) = problem.pixel_sums(views[v], false);
    });
    const auto solve = [&](std::size_t v, const StartingTerm& start) {
        const MatchedView& view = views[v];
        Eigen::MatrixXd values(1, Eigen::Index(view.lights.size()));
        const ClosureTerm term(start.at(view.theta), view.wv);
        for (std::size_t i = 0; i < view.lights.size(); ++i) values(0, Eigen::Index(i)) = term.value(view.lights[i]);
        Eigen::MatrixXd all = sums[v];
        all.row(parts) = ClosureProblem::summed_over_pixels(view, values);
        return best_weights(view, all);
    };
    const std::vector<StartingTerm> starts = starting_terms();
    std::vector<double> losses(starts.size());
    parallel_for(starts.size(), threads, [&](std::size_t s) {
        for (std::size_t v = 0; v < views.size(); v += 2) losses[s] += solve(v, starts[s]).loss;
    });
    const StartingTerm& best = starts[std::size_t(std::ranges::min_element(losses) - losses.begin())];
    std::vector<Eigen::MatrixXd> weights(views.size());
    parallel_for(views.size(), threads, [&](std::size_t v) { weights[v] = solve(v, best).weights; });
    return extended(views, before, x, best, weights);
}

// ---- Albedo ----

constexpr int k_albedo_points_of_closures = 1024;

/// Scales the weights of knots by factors s ≤ 1, near to 1, so that no albedo is above 1, at the knots and between
/// them. At an angle between knots i and i + 1 the albedo is a s_i + b s_{i+1}: while it is above 1, (s_i, s_{i+1})
/// moves to the nearest point at which it is 1.
void limit_albedos(ClosureSum& sum, int threads) {
    constexpr std::size_t k_between = 4;
    constexpr double k_last_angle = 89.8 * k_degree, k_within = 1e-3;
    constexpr int k_max_sweeps = 1000;
    const std::size_t count = (sum.knots() - 1) * k_between;
    std::array<ClosureSum, 2> parts{sum, sum};  // the knots with even indices, and those with odd ones
    for (std::size_t knot = 0; knot < sum.knots(); ++knot) {
        ClosureSum& other = parts[1 - knot % 2];
        for (std::size_t j = 0; j < sum.ramp; ++j) other.diffuse[knot * sum.ramp + j] = {};
        for (std::size_t k = 0; k < sum.terms; ++k) other.closures[knot * sum.terms + k].weight = {};
    }
    const auto theta = [&](std::size_t i) { return k_last_angle * double(i) / double(count - 1); };
    std::vector<std::array<Rgb, 2>> albedos(count);
    const MirrorMixture mixture(k_pi / 2);
    parallel_for(count, threads, [&](std::size_t i) {
        const Vec3d wv = spherical(theta(i), 0.0);
        const Quadrature points = mixture.quadrature(wv, k_albedo_points_of_closures);
        for (std::size_t part = 0; part < 2; ++part) {
            const std::vector<Rgb> f = values_towards(evaluator(parts[part]), points.w, to_float(wv));
            for (std::size_t p = 0; p < f.size(); ++p)
                for (int c = 0; c < 3; ++c)
                    albedos[i][part][c] += float(points.weight[p] * double(points.w[p].z)) * f[p][c];
        }
    });
    for (int c = 0; c < 3; ++c) {
        std::vector<double> scale(sum.knots(), 1);
        bool exceeded = true;
        for (int sweep = 0; exceeded && sweep < k_max_sweeps; ++sweep) {
            exceeded = false;
            for (std::size_t i = count; i-- > 0;) {  // the last ones exceed 1 by most
                const std::size_t knot = KnotPosition(theta(i), sum.knots()).knot;
                const double a = double(albedos[i][knot % 2][c]), b = double(albedos[i][1 - knot % 2][c]),
                             excess = a * scale[knot] + b * scale[knot + 1] - 1;
                if (!(excess > k_within)) continue;
                exceeded = true;
                const double step = excess / (a * a + b * b);
                scale[knot] = std::max(scale[knot] - step * a, 0.0);
                scale[knot + 1] = std::max(scale[knot + 1] - step * b, 0.0);
            }
        }
        for (std::size_t knot = 0; knot < sum.knots(); ++knot) {
            for (std::size_t j = 0; j < sum.ramp; ++j) sum.diffuse[knot * sum.ramp + j][c] *= float(scale[knot]);
            for (std::size_t k = 0; k < sum.terms; ++k)
                sum.closures[knot * sum.terms + k].weight[c] *= float(scale[knot]);
        }
    }
}

}  // namespace

Result<ClosureSum> fit_closures(const Evaluate& f, const ClosureFitOptions& options, const ProgressToken& progress) {
    const StandardArithmetic mode;
    if (const auto valid = require_range("fit", "terms", options.terms, 1, k_max_closures); !valid)
        return valid.error();
    if (const auto valid = require_range("fit", "ramp", options.ramp, 1, k_ramp_of_osl); !valid) return valid.error();
    if (const auto valid = require_range("fit", "knots", options.knots, 4, 256); !valid) return valid.error();
    Layout layout{0, std::size_t(options.ramp), std::size_t(options.knots)};
    const std::vector<MatchedView> views = matched_views(f, 2 * layout.knots - 1, options.threads);
    if (std::ranges::none_of(views, [](const MatchedView& view) {
            return std::ranges::any_of(view.radiance, [](const Rgb& c) { return largest_of(c) > 0; });
        }))
        return no_data_error("fit", "values", "some above 0");
    constexpr double k_tolerance = 1e-6;
    // Steps converge slowly where the loss is linear, so the first ones are of a loss that is quadratic for longer.
    const auto steps_of = [&](int k) {
        return (k + 1 < options.terms ? 30 : 80) / (options.ramp > 1 ? 2 : 1);  // a ramp makes them slower
    };
    // The fractions of the time at which the fit of each term begins: a step takes longer with more terms.
    std::vector<double> times{0};
    for (int k = 0; k < options.terms; ++k) times.push_back(times.back() + (k + 1) * steps_of(k));
    Eigen::VectorXd x = Eigen::VectorXd::Zero(Eigen::Index(layout.knots * layout.width()));
    double min = std::numeric_limits<double>::infinity();
    ClosureSum best;
    for (int k = 0; k < options.terms; ++k) {
        const auto index = std::size_t(k);
        const ProgressToken stage = progress.subrange(times[index] / times.back(), times[index + 1] / times.back());
        if (!stage.report(k_closure_stage, 0)) return cancelled_error("fit");
        x = with_term(views, layout, x, options.threads);
        ++layout.terms;
        const int steps = steps_of(k);
        ClosureProblem problem(views, layout, options.threads, stage, steps / 2 + steps);
        problem.set_linear_from(3);
        levenberg_marquardt(problem, x, {.max_iterations = steps / 2, .decrease_tolerance = k_tolerance});
        problem.set_linear_from(1);
        const double loss =
            levenberg_marquardt(problem, x, {.max_iterations = steps, .decrease_tolerance = k_tolerance}).loss;
        if (loss < min) {  // a further term can raise the loss
            min = loss;
            best = problem.sum(x);
        }
    }
    limit_albedos(best, options.threads);
    return best;
}

}  // namespace
