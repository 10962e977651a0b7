#include "extras/maps/shared_problem.h"

#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace SRBF_NAMESPACE {
namespace {

/// Lower bound on √L_t, as a fraction of the largest one: a material that the lobes match perfectly must not outweigh
/// others.
constexpr double k_min_root = 0.1;
/// The number of materials whose Hessians are in memory at once.
constexpr std::size_t k_hessians = 8;

}  // namespace

SharedProblem::SharedProblem(std::span<const std::unique_ptr<PackedObservations>> materials, const LobeShape& shape) {
    for (const auto& rows : materials) problems_.push_back(std::make_unique<LobeProblem>(*rows, shape, false));
    factor_.assign(materials.size(), 1.0);
    loss_.assign(materials.size(), 0.0);
}

Eigen::VectorXd SharedProblem::lower(const Eigen::VectorXd& x) const {
    return problems_[0]->lower(x).cwiseMax(x - problems_[0]->longest_step(x));
}

Eigen::VectorXd SharedProblem::upper(const Eigen::VectorXd& x) const {
    return problems_[0]->upper(x).cwiseMin(x + problems_[0]->longest_step(x));
}

Eigen::VectorXd SharedProblem::longest_step(const Eigen::VectorXd& x) const {
    return Eigen::VectorXd::Constant(x.size(), std::numeric_limits<double>::infinity());
}

double SharedProblem::loss(const Eigen::VectorXd& x) {
    parallel_for(problems_.size(), [&](std::size_t t) { loss_[t] = problems_[t]->loss(x); });
    double sum = 0;
    for (std::size_t t = 0; t < loss_.size(); ++t) sum += factor_[t] * loss_[t];
    return sum;
}

void SharedProblem::linearise(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g) {
    H = Eigen::MatrixXd::Zero(x.size(), x.size());
    g = Eigen::VectorXd::Zero(x.size());
    std::vector<Eigen::MatrixXd> hessian(k_hessians);
    std::vector<Eigen::VectorXd> gradient(k_hessians);
    for (std::size_t first = 0; first < problems_.size(); first += k_hessians) {
        const std::size_t count = std::min(k_hessians, problems_.size() - first);
        parallel_for(count, [&](std::size_t i) { problems_[first + i]->linearise(x, hessian[i], gradient[i]); });
        for (std::size_t i = 0; i < count; ++i) {
            H += factor_[first + i] * hessian[i];
            g += factor_[first + i] * gradient[i];
        }
    }
}

void SharedProblem::weigh() {
    const double largest = std::sqrt(std::max(*std::ranges::max_element(loss_), 1e-12));
    for (std::size_t t = 0; t < loss_.size(); ++t)
        factor_[t] = 1 / std::max(std::sqrt(std::max(loss_[t], 0.0)), k_min_root * largest);
}

std::vector<double> SharedProblem::best_addition(const std::vector<std::vector<double>>& candidates) {
    std::vector<Eigen::VectorXd> gains(problems_.size());
    parallel_for(problems_.size(), [&](std::size_t t) { gains[t] = problems_[t]->gains(candidates); });
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(Eigen::Index(candidates.size()));
    for (std::size_t t = 0; t < gains.size(); ++t) sum += factor_[t] * gains[t].cwiseMax(0.0);
    Eigen::Index best = 0;
    return sum.size() > 0 && sum.maxCoeff(&best) > 0 ? candidates[std::size_t(best)] : std::vector<double>();
}

}  // namespace
