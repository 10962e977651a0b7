#include "extras/maps/active_lobes.h"

#include <algorithm>
#include <limits>

#include "base/least_squares.h"
#include "srbf/elementary.h"

namespace srbf {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

/// One lobe in this number of the surplus is dropped before the coefficients adapt.
constexpr std::size_t k_surplus_per_drop = 4;
/// The least share of a lobe's square that is not a combination of others: smaller shares are noise.
constexpr double k_least_across = 1e-4;

/// The minimum of bᵀHb − 2yᵀb over b ≥ 0 that is 0 for all lobes but some. The coefficients of channel c follow those of
/// channel c − 1.
class ActiveLobes {
  public:
    explicit ActiveLobes(LobeProblem& problem) : lobes_(problem.beta().rows()), channels_(problem.beta().cols()) {
        const CoefficientTerms at = problem.coefficient_terms();
        const Eigen::Map<const VectorXd> now(problem.beta().data(), problem.beta().size());
        H_ = at.H, y_ = at.H * now - at.g;
        for (Index j = 0; j < lobes_; ++j) which_.push_back(j);
        solve();
    }

    /// Drops lobes until so many remain.
    void drop(std::size_t most) {
        while (which_.size() > most) {
            const std::size_t surplus = which_.size() - most;
            for (std::size_t k = 0; k < (surplus + k_surplus_per_drop - 1) / k_surplus_per_drop; ++k) erase_cheapest();
            solve();
        }
    }
    /// Exchanges the cheapest lobe for the best of the others; whether that lowers the loss. If not, nothing changes.
    bool exchange() {
        const auto which = which_;
        const VectorXd b = b_;
        const double loss = loss_;
        erase_cheapest();
        solve();
        which_.push_back(best_addition());
        solve();
        if (loss_ < loss) return true;
        which_ = which, b_ = b, loss_ = loss;
        return false;
    }
    std::vector<std::size_t> which() const {
        std::vector<std::size_t> sorted(which_.begin(), which_.end());
        std::ranges::sort(sorted);
        return sorted;
    }

  private:
    /// The coefficients of the active lobes; `free`: those above 0.
    std::vector<Index> coefficients(bool free) const {
        std::vector<Index> of;
        for (Index c = 0; c < channels_; ++c)
            for (const Index j : which_)
                if (const Index i = c * lobes_ + j; !free || b_[i] > 0) of.push_back(i);
        return of;
    }
    void solve() {
        const auto active = coefficients(false);
        const MatrixXd H = H_(active, active);
        const VectorXd y = y_(active), no_limit = VectorXd::Constant(y.size(), std::numeric_limits<double>::infinity()),
                       b = bounded_least_squares(H, y, no_limit);
        b_ = VectorXd::Zero(y_.size());
        b_(active) = b;
        loss_ = b.dot(H * b) - 2 * y.dot(b);
    }
    /// Erases the lobe without which the loss rises least while the other coefficients above 0 adapt: by bᵀ P⁻¹ b, with b
    /// those of the lobe and P their part of the inverse Hessian.
    void erase_cheapest() {
        const auto free = coefficients(true);
        const auto count = Index(free.size());
        const MatrixXd inverse = ridged(H_(free, free)).ldlt().solve(MatrixXd::Identity(count, count));
        std::vector<double> cost(which_.size());
        for (std::size_t k = 0; k < which_.size(); ++k) {
            std::vector<Index> own, there;
            for (Index f = 0; f < count; ++f)
                if (free[std::size_t(f)] % lobes_ == which_[k]) own.push_back(f), there.push_back(free[std::size_t(f)]);
            if (own.empty()) continue;
            const VectorXd b = b_(there);
            cost[k] = b.dot(inverse(own, own).ldlt().solve(b));
        }
        which_.erase(which_.begin() + (std::ranges::min_element(cost) - cost.begin()));
    }
    /// The lobe that would lower the loss most, about: by r² over the square across the free ones, of each channel.
    Index best_addition() const {
        const auto free = coefficients(true);
        const VectorXd rest = y_ - H_ * b_;
        const Eigen::LDLT<MatrixXd> factor(ridged(H_(free, free)));
        Index best = 0;
        double most = -1;
        for (Index j = 0; j < lobes_; ++j) {
            if (std::ranges::find(which_, j) != which_.end()) continue;
            double gain = 0;
            for (Index i = j; i < y_.size(); i += lobes_) {
                const VectorXd with = H_(free, i);
                const double across = std::max(H_(i, i) - with.dot(factor.solve(with)), k_least_across * H_(i, i));
                if (across > 0) gain += elementary::square(std::max(rest[i], 0.0)) / across;
            }
            if (gain > most) most = gain, best = j;
        }
        return best;
    }

    Index lobes_, channels_;
    MatrixXd H_;
    VectorXd y_, b_;
    std::vector<Index> which_;
    double loss_ = 0;
};

}  // namespace

std::vector<std::size_t> active_lobes(LobeProblem& problem, std::size_t most) {
    ActiveLobes active(problem);
    active.drop(most);
    if (most < std::size_t(problem.beta().rows()))
        for (std::size_t k = 0; k < most && active.exchange(); ++k) continue;
    return active.which();
}

}  // namespace srbf
