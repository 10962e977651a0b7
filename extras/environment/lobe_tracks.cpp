#include "extras/environment/lobe_tracks.h"

#include <cmath>
#include <numeric>
#include <utility>

#include "base/levenberg_marquardt.h"
#include "base/parallel.h"
#include "base/r_sequence.h"

namespace SRBF_NAMESPACE {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The weight of squared fractions, compared with squared relative errors of 0.02 to 0.2. Without it, lobes of
/// opposite signs that nearly cancel could fit the lights of one view, but neither other lights nor the views
/// between.
constexpr double k_ridge_of_lobes = 5e-2;
constexpr int k_lobe_starts = 12;
/// Sweeps over all views, each of which moves towards the mean of its neighbours. A third sweep changes pictures by
/// less than 0.01 ΔE_ITP.
constexpr int k_view_sweeps = 2;
/// The weights of squared distances from the neighbours: of p (as an angle of the axis) and r, and of fractions.
/// They compare with squared relative errors of 0.02 to 0.2, for views `k_usual_step` [rad] apart. Nodes are denser
/// at the horizon, where all lobes would change within one degree of the view, so that both weights are larger
/// there.
constexpr double k_smoothness = 3e-3, k_fraction_smoothness = 0.2, k_usual_step = 4 * k_pi / 180;
/// The inverse square of the angle between the views of a node and the next one, in units of `k_usual_step`; at
/// least 1.
double closeness(std::size_t node) {
    const auto angle = [](std::size_t node_index) { return elementary::acos(ExtendedLight::cosine(int(node_index))); };
    return std::clamp(elementary::square(k_usual_step / (angle(node) - angle(node + 1))), 1.0, 1e3);
}
/// Limits on |p|: it may exceed the mirror direction as off-specular peaks do. The limit is lower towards the
/// horizon, where an axis with |p| > 1 would move by many degrees when the view moves by one: |p| ≤ `k_max_beyond`
/// / sinθv or 1.
constexpr double k_max_axis = 1.3, k_max_beyond = 0.96;
/// The factors by which roughnesses that all views share are changed, for as long as errors become smaller.
constexpr std::array<double, 6> k_roughness_steps{1.4, 1.4, 1.2, 1.2, 1.1, 1.05};
constexpr LevenbergMarquardtOptions k_steps{.max_iterations = 30, .decrease_tolerance = 1e-4};

/// A least-squares problem in x = (p, r) of each lobe except the first: the squared errors of a view, plus
/// `k_ridge_of_lobes` times squared fractions, plus `smoothness` times the squared distances from `near`. The
/// weights are linear, and eliminated. The first lobe's weight is the remainder of the albedo.
class TrackProblem {
  public:
    TrackProblem(const LitView& view, const BlurredKernels& kernels, VectorXd near, double smoothness,
                 bool fixed = false)
        : view_(view),
          kernels_(kernels),
          fixed_(fixed),
          near_(std::move(near)),
          free_lobes_(int(near_.size()) / 2),
          smoothness_(repeat(near_, smoothness, smoothness)) {
        const double s = view_.wv.x;  // converts p to the angle of its axis
        for (Eigen::Index i = 0; i < near_.size(); i += 2)
            smoothness_[i] *= s * s / std::max(1 - near_[i] * near_[i] * s * s, 0.01);
    }

    double loss(const VectorXd& x) {
        const auto n = Eigen::Index(view_.lights.size());
        if (lobes_.empty()) {
            lobes_.resize(std::size_t(free_lobes_) + 1);
            for (MatrixXd* lobe_columns : {&lobe_radiance_, &by_axis_, &by_roughness_})
                lobe_columns->resize(n, free_lobes_ + 1);
        }
        set_lobe(0, 0, 1);
        for (int k = 1; k <= free_lobes_; ++k) set_lobe(k, x[2 * k - 2], x[2 * k - 1]);
        double sum = smoothness_.dot((x - near_).cwiseAbs2());
        for (int c = 0; c < 3; ++c) {
            solve(c, channels_[std::size_t(c)]);
            sum += channels_[std::size_t(c)].error.squaredNorm();
        }
        return sum;
    }
    void linearise(const VectorXd& x, MatrixXd& H, VectorXd& g) const {
        H = smoothness_.asDiagonal();
        g = smoothness_.cwiseProduct(x - near_);
        const auto n = Eigen::Index(view_.lights.size());
        for (std::size_t c = 0; c < 3; ++c) {
            const auto& [A, gram, weights, error] = channels_[c];
            MatrixXd J = MatrixXd::Zero(A.rows(), x.size());
            for (int k = 0; k < free_lobes_; ++k) {
                const auto weight = view_.weight.col(Eigen::Index(c));
                J.col(2 * k).head(n) = weights[k] * weight.cwiseProduct(by_axis_.col(k + 1));
                if (!fixed_) J.col(2 * k + 1).head(n) = weights[k] * weight.cwiseProduct(by_roughness_.col(k + 1));
            }
            J -= A * gram.ldlt().solve(A.transpose() * J);  // the weights adapt
            H += J.transpose() * J;
            g += J.transpose() * error;
        }
    }
    VectorXd lower(const VectorXd& x) const { return repeat(x, -axis_limit(), ExtendedLight::k_min_roughness); }
    VectorXd upper(const VectorXd& x) const { return repeat(x, axis_limit(), 1); }
    VectorXd longest_step(const VectorXd& x) const { return repeat(x, 0.2, 0.2); }

    /// The squared errors at x of the last call of `loss`, as a function of a channel's fractions s: sᵀ H s − 2 gᵀ
    /// s plus a constant.
    struct Quadratic {
        MatrixXd H;
        VectorXd g;
    };
    Quadratic by_fractions(int c) const {
        const Channel& channel = channels_[std::size_t(c)];
        const double albedo = std::max(double(view_.albedo[c]), 1e-6);
        return {albedo * albedo * channel.gram, albedo * (channel.gram * channel.weights)};
    }

  private:
    /// A w − b. Its squares are errors under the lights and, in the last rows, the ridge.
    struct Channel {
        MatrixXd A, gram;  ///< AᵀA
        VectorXd weights, error;
    };
    void solve(int c, Channel& channel) const {
        const auto n = Eigen::Index(view_.lights.size());
        const double albedo = double(view_.albedo[c]);
        const VectorXd first = view_.weight.col(c).cwiseProduct(lobe_radiance_.col(0));
        channel.A.setZero(n + free_lobes_, free_lobes_);
        channel.A.topRows(n) = view_.weight.col(c).asDiagonal() * lobe_radiance_.rightCols(free_lobes_);
        channel.A.topRows(n).colwise() -= first;
        for (int k = 0; k < free_lobes_; ++k)
            channel.A(n + k, k) = std::sqrt(k_ridge_of_lobes) / std::max(albedo, 1e-6);
        VectorXd b = VectorXd::Zero(n + free_lobes_);
        b.head(n) = view_.radiance.col(c) - albedo * first;
        channel.gram = channel.A.transpose() * channel.A;
        channel.weights = channel.gram.ldlt().solve(channel.A.transpose() * b);
        channel.error = channel.A * channel.weights - b;
    }
    void set_lobe(int k, double p, double r) {
        if (std::exchange(lobes_[std::size_t(k)], std::pair(p, r)) == std::pair(p, r)) return;
        const double s = view_.wv.x, c = std::sqrt(std::max(1 - p * p * s * s, 1e-12));
        const Vec3d axis{-p * s, 0, c},
            by_p{-s, 0, -p * s * s / std::max(c, 0.05)};  // its slope at the horizon is infinite
        for (Eigen::Index i = 0; i < lobe_radiance_.rows(); ++i) {
            const KernelLight& light = view_.lights[std::size_t(i)];
            const auto kernel = kernels_.at(light.size, r, dot(axis, light.centre));
            lobe_radiance_(i, k) = kernel.value;
            by_axis_(i, k) = kernel.by_cosine * dot(by_p, light.centre);
            by_roughness_(i, k) = kernel.by_roughness;
        }
    }
    double axis_limit() const {
        const double sine = std::max(view_.wv.x, 1e-3);
        // keeps the axis above the horizon
        return std::min({k_max_axis, std::max(k_max_beyond / sine, 1.0), 0.999 / sine});
    }
    static VectorXd repeat(const VectorXd& x, double axis, double roughness) {
        VectorXd values(x.size());
        for (Eigen::Index i = 0; i < x.size(); ++i) values[i] = i % 2 == 0 ? axis : roughness;
        return values;
    }

    const LitView& view_;
    const BlurredKernels& kernels_;
    bool fixed_;  ///< roughnesses are those of `near`
    VectorXd near_;
    int free_lobes_;
    VectorXd smoothness_;
    std::vector<std::pair<double, double>> lobes_;     ///< p and r of the columns of the next three; r > 0 of those set
    MatrixXd lobe_radiance_, by_axis_, by_roughness_;  ///< lights × lobes, for weight 1
    std::array<Channel, 3> channels_;
};

}  // namespace

LobeTracks::LobeTracks(const std::vector<LitView>& views, const BlurredKernels& kernels, int lobes, bool fixed,
                       int threads)
    : views_(views), kernels_(kernels), fixed_(fixed), threads_(threads), x_(views.size()) {
    // One view at 45 degrees is fitted from several starts; from there on, each view begins with its
    // neighbour's lobes.
    std::size_t first = 0;
    while (views[first].wv.z < 0.7) ++first;
    x_[first] = best_of_starts(views[first], lobes);
    for (std::size_t v = first + 1; v < views.size(); ++v) x_[v] = refine(v, x_[v - 1], x_[v - 1]);
    for (std::size_t v = first; v-- > 0;) x_[v] = refine(v, x_[v + 1], x_[v + 1]);
    for (int i = 0; i < k_view_sweeps; ++i) {
        if (fixed) search_roughnesses();
        sweep();
    }
}
void LobeTracks::sweep() {
    for (const std::size_t parity : {0u, 1u})
        parallel_for(views_.size() / 2, threads_, [&](std::size_t i) {
            const std::size_t v = 2 * i + parity, last = views_.size() - 1;
            const VectorXd &below = x_[v == 0 ? 1 : v - 1], &above = x_[v == last ? last - 1 : v + 1];
            x_[v] = refine(v, x_[v], 0.5 * (below + above));
        });
}
void LobeTracks::search_roughnesses() {
    std::vector<TrackProblem> problems;
    for (std::size_t v = 0; v < views_.size(); ++v) problems.emplace_back(views_[v], kernels_, x_[v], 0);
    const auto loss = [&] {  // without smoothness
        std::vector<double> losses(views_.size());
        parallel_for(views_.size(), threads_, [&](std::size_t v) { losses[v] = problems[v].loss(x_[v]); });
        return std::accumulate(losses.begin(), losses.end(), 0.0);
    };
    double min = loss();
    for (const double step : k_roughness_steps)
        for (Eigen::Index i = 1; i < x_[0].size(); i += 2)
            for (const double factor : {step, 1 / step}) {
                const double before = x_[0][i],
                             r = std::clamp(factor * before, double(ExtendedLight::k_min_roughness), 1.0);
                for (VectorXd& x : x_) x[i] = r;
                const double found = loss();
                min = std::min(min, found);
                for (VectorXd& x : x_) x[i] = found > min ? before : r;
            }
}
VectorXd LobeTracks::best_of_starts(const LitView& view, int lobes) const {
    std::vector<std::pair<double, VectorXd>> starts(k_lobe_starts);
    parallel_for(starts.size(), threads_, [&](std::size_t i) {
        RSequence<1> numbers({double(i) / k_lobe_starts});
        VectorXd x(2 * (lobes - 1));
        for (int k = 0; k < lobes - 1; ++k) {  // near the mirror direction, with roughnesses in ascending order
            x[2 * k] = 0.9;
            x[2 * k + 1] = 0.08 + 0.9 * (k + numbers.next()[0]) / (lobes - 1);
        }
        TrackProblem problem(view, kernels_, x, 0);
        const double loss = levenberg_marquardt(problem, x, k_steps).loss;
        starts[i] = {loss, std::move(x)};
    });
    return std::ranges::min(starts, {}, [](const auto& start) { return start.first; }).second;
}
VectorXd LobeTracks::refine(std::size_t v, VectorXd x, const VectorXd& near) const {
    TrackProblem problem(views_[v], kernels_, near, k_smoothness * closeness(std::min(v, views_.size() - 2)), fixed_);
    x = x.cwiseMax(problem.lower(x)).cwiseMin(problem.upper(x));
    levenberg_marquardt(problem, x, k_steps);
    return x;
}

MatrixXd fractions_of(const std::vector<LitView>& views, const BlurredKernels& kernels, const LobeTracks& tracks) {
    const Eigen::Index others = tracks[0].size() / 2, n = others * Eigen::Index(views.size());
    std::array<MatrixXd, 3> H;
    MatrixXd g = MatrixXd::Zero(n, 3), fractions(n, 3);
    H.fill(MatrixXd::Zero(n, n));
    for (std::size_t v = 0; v < views.size(); ++v) {
        TrackProblem problem(views[v], kernels, tracks[v], 0);
        problem.loss(tracks[v]);
        const Eigen::Index first = others * Eigen::Index(v);
        for (int c = 0; c < 3; ++c) {
            const auto quadratic = problem.by_fractions(c);
            MatrixXd& channel_H = H[std::size_t(c)];
            channel_H.block(first, first, others, others) += quadratic.H;
            g.col(c).segment(first, others) += quadratic.g;
            if (v + 1 == views.size()) continue;
            const double smoothness = k_fraction_smoothness * elementary::square(closeness(v));
            for (Eigen::Index i = first; i < first + others; ++i) {
                channel_H(i, i) += smoothness;
                channel_H(i + others, i + others) += smoothness;
                channel_H(i, i + others) -= smoothness;
                channel_H(i + others, i) -= smoothness;
            }
        }
    }
    for (int c = 0; c < 3; ++c) fractions.col(c) = H[std::size_t(c)].ldlt().solve(g.col(c));
    return fractions;
}

}  // namespace
