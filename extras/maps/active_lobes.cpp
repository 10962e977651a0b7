#include "extras/maps/active_lobes.h"

#include <algorithm>
#include <limits>

#include "base/least_squares.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

/// For every four surplus lobes, one is dropped before the coefficients adapt.
constexpr std::size_t k_surplus_per_drop = 4;
/// Lower bound on the fraction of a lobe's square that is orthogonal to the others: smaller fractions are noise.
constexpr double k_least_orthogonal = 1e-4;

/// The minimum of bᵀHb − 2yᵀb over b ≥ 0 that is 0 for all except the active lobes. The coefficients of channel c
/// follow those of channel c − 1.
class ActiveLobes {
  public:
    explicit ActiveLobes(LobeProblem& problem) : lobes_(problem.beta().rows()), channels_(problem.beta().cols()) {
        const CoefficientTerms terms = problem.coefficient_terms();
        const Eigen::Map<const VectorXd> current(problem.beta().data(), problem.beta().size());
        H_ = terms.H, y_ = terms.H * current - terms.g;
        for (Index j = 0; j < lobes_; ++j) active_.push_back(j);
        solve();
    }

    /// Drops lobes until `most` remain.
    void drop(std::size_t most) {
        while (active_.size() > most) {
            const std::size_t surplus = active_.size() - most;
            for (std::size_t k = 0; k < (surplus + k_surplus_per_drop - 1) / k_surplus_per_drop; ++k) erase_cheapest();
            solve();
        }
    }
    /// Exchanges the cheapest lobe for the best of the others, and returns whether that lowers the loss. If not,
    /// nothing changes.
    bool exchange() {
        const auto active = active_;
        const VectorXd b = b_;
        const double loss = loss_;
        erase_cheapest();
        solve();
        active_.push_back(best_addition());
        solve();
        if (loss_ < loss) return true;
        active_ = active, b_ = b, loss_ = loss;
        return false;
    }
    std::vector<std::size_t> lobes() const {
        std::vector<std::size_t> sorted(active_.begin(), active_.end());
        std::ranges::sort(sorted);
        return sorted;
    }

  private:
    /// The indices of the active lobes' coefficients; `free`: only of those above 0.
    std::vector<Index> coefficients(bool free) const {
        std::vector<Index> indices;
        for (Index c = 0; c < channels_; ++c)
            for (const Index j : active_)
                if (const Index i = c * lobes_ + j; !free || b_[i] > 0) indices.push_back(i);
        return indices;
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
    /// Erases the lobe whose removal raises the loss least while the other coefficients above 0 adapt. The rise is
    /// bᵀ P⁻¹ b, where b is the lobe's coefficients and P their block of the inverse Hessian.
    void erase_cheapest() {
        const auto free = coefficients(true);
        const auto count = Index(free.size());
        const MatrixXd inverse = with_ridge(H_(free, free)).ldlt().solve(MatrixXd::Identity(count, count));
        std::vector<double> cost(active_.size());
        for (std::size_t k = 0; k < active_.size(); ++k) {
            std::vector<Index> rows, coefficient_indices;
            for (Index f = 0; f < count; ++f)
                if (free[std::size_t(f)] % lobes_ == active_[k])
                    rows.push_back(f), coefficient_indices.push_back(free[std::size_t(f)]);
            if (rows.empty()) continue;
            const VectorXd b = b_(coefficient_indices);
            cost[k] = b.dot(inverse(rows, rows).ldlt().solve(b));
        }
        active_.erase(active_.begin() + (std::ranges::min_element(cost) - cost.begin()));
    }
    /// The lobe that would lower the loss most, approximately: by r² over the square orthogonal to the free ones,
    /// in each channel.
    Index best_addition() const {
        const auto free = coefficients(true);
        const VectorXd residual = y_ - H_ * b_;
        const Eigen::LDLT<MatrixXd> factor(with_ridge(H_(free, free)));
        Index best = 0;
        double largest_gain = -1;
        for (Index j = 0; j < lobes_; ++j) {
            if (std::ranges::find(active_, j) != active_.end()) continue;
            double gain = 0;
            for (Index i = j; i < y_.size(); i += lobes_) {
                const VectorXd products = H_(free, i);
                const double orthogonal =
                    std::max(H_(i, i) - products.dot(factor.solve(products)), k_least_orthogonal * H_(i, i));
                if (orthogonal > 0) gain += elementary::square(std::max(residual[i], 0.0)) / orthogonal;
            }
            if (gain > largest_gain) largest_gain = gain, best = j;
        }
        return best;
    }

    Index lobes_, channels_;
    MatrixXd H_;
    VectorXd y_, b_;
    std::vector<Index> active_;
    double loss_ = 0;
};

}  // namespace

std::vector<std::size_t> active_lobes(LobeProblem& problem, std::size_t most) {
    ActiveLobes active(problem);
    active.drop(most);
    if (most < std::size_t(problem.beta().rows()))
        for (std::size_t k = 0; k < most && active.exchange(); ++k) continue;
    return active.lobes();
}

}  // namespace srbf
