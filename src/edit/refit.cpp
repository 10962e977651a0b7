#include "edit/lobes.h"

#include "base/least_squares.h"
#include "base/levenberg_marquardt.h"
#include "base/parallel.h"
#include "models/pm/search/fit_pm.h"
#include "models/pm/search/search.h"
#include "models/pm/solve/rounding.h"

namespace SRBF_NAMESPACE {
namespace {

/// Numbers of observations of a function, which has no noise: a quarter of the numbers for a measurement.
constexpr std::size_t k_observed_pairs = 16384, k_fewer = 4;
/// The number of pairs by which the initial lobes are chosen.
constexpr std::size_t k_initial_pairs = 4096;

/// Lobes with which a fit begins, and their loss of pairs.
struct InitialLobes {
    PmModel model;
    double loss;
};
/// The model without the lobes that are least useful, dropped one after the other, after a few steps.
InitialLobes pruned_lobes(const PmModel& model, int lobes, const LobeShape& shape, LobeProblem& problem) {
    constexpr int k_first_steps = 8;
    Lobes kept = to_lobes(model, shape);
    for (problem.loss(pack(kept)); kept.count() > lobes; problem.loss(pack(kept))) {
        const std::vector<double> cost = cost_of_dropping(problem.gram(), problem.beta());
        kept = without_lobe(std::move(kept), std::ranges::min_element(cost) - cost.begin());
    }
    Eigen::VectorXd x = pack(kept);
    const double loss = levenberg_marquardt(problem, x, {.max_iterations = k_first_steps}).loss;
    problem.loss(x);
    return {to_model(problem, unpack(x, shape)), loss};
}

}  // namespace

Result<PmModel> refit(const Evaluate& f, std::span<const PmModel> begin, int lobes, double albedo_limit,
                      const EditOptions& options) {
    auto observations =
        observe(f, {.count = k_observed_pairs, .threads = options.threads, .fewer = k_fewer}, options.progress);
    if (!observations) return observations.error();
    const PmModel& first = begin[0];
    const PmFitOptions fit{.form = first.form,
                           .axial = first.axial,
                           .lobes = lobes,
                           .variates = first.variates,
                           .albedo_limit = albedo_limit,
                           .threads = options.threads};
    std::optional<InitialLobes> best;
    on_threads(options.threads, [&] {
        const PackedObservations rows(first_pairs(*observations, k_initial_pairs));
        LobeProblem problem(rows, shape_of(fit), true);
        for (const PmModel& model : begin) {
            InitialLobes next = pruned_lobes(model, lobes, shape_of(fit), problem);
            if (!best || next.loss < best->loss) best = std::move(next);
        }
    });
    auto fitted = fit_pm(*observations, fit, options.progress, &best->model);
    if (!fitted) return fitted.error();
    return std::move(fitted->model);
}

}  // namespace
