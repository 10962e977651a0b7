#include "edit/refit.h"

#include <algorithm>

#include "base/least_squares.h"
#include "models/pm/search/fit_pm.h"
#include "models/pm/search/options.h"
#include "models/pm/search/random_lobes.h"
#include "models/pm/solve/rounding.h"

namespace srbf {
namespace {

/// Observations of a function without noise: a quarter of those of a measurement.
constexpr std::size_t k_observed_pairs = 16384, k_fewer = 4;

/// The model without the lobes that are least useful, one after the other.
PmModel with_most_useful(PmModel model, int lobes, const Observations& observations, const LobeShape& shape) {
    if (model.lobes <= lobes) return model;
    const Rows rows(beginning(observations, 4096));
    LobeProblem problem(rows, shape, true);
    Lobes left = to_lobes(model, shape);
    for (;;) {
        problem.loss(pack(left));
        if (left.count() <= lobes) break;
        const std::vector<double> cost = cost_of_dropping(problem.gram(), problem.beta());
        left = without_lobe(std::move(left), std::ranges::min_element(cost) - cost.begin());
    }
    return to_model(problem, left, true);
}

}  // namespace

Result<PmModel> refit(const Evaluate& f, const PmModel& begin, int lobes, double albedo_limit,
                      const EditOptions& options) {
    auto observations =
        observe(f, {.count = k_observed_pairs, .threads = options.threads, .fewer = k_fewer}, options.progress);
    if (!observations) return observations.error();
    PmFitOptions fit{.form = begin.form, .axial = begin.axial, .lobes = lobes, .variates = begin.variates};
    fit.albedo_limit = albedo_limit, fit.threads = options.threads;
    const PmModel first = with_most_useful(begin, lobes, *observations, shape_of(fit));
    auto fitted = fit_pm(*observations, fit, options.progress, &first);
    if (!fitted) return fitted.error();
    return std::move(fitted->model);
}

}  // namespace srbf
