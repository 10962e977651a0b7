#include "models/pm/search/finish.h"

#include "base/levenberg_marquardt.h"
#include "models/pm/pm_functions.h"
#include "models/pm/search/options.h"
#include "models/pm/solve/rounding.h"
#include "models/pm/solve/spectra.h"
#include "observe/albedo_bound.h"
#include "observe/bound.h"
#include "observe/pair_weights.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

/// The last steps run in batches of ten until a batch lowers the loss by less than `k_least_gain`. Most fits need
/// two batches; a fit whose narrow lobes must match an albedo needs twenty.
constexpr int k_last_steps = 10, k_most_batches = 26;
constexpr double k_least_gain = 0.005;
/// Once bounds are exceeded, a few steps with larger weights move lobes below them.
constexpr int k_bound_rounds = 12, k_bound_steps = 4;

/// Levenberg-Marquardt from x, with `count` steps.
LevenbergMarquardtSummary take_steps(LobeProblem& problem, Eigen::VectorXd& x, int count, const Reporter& reporter) {
    return levenberg_marquardt(problem, x, {.max_iterations = reporter.cancelled() ? 0 : count});
}

/// Levenberg-Marquardt from x, as long as the steps pay off.
LevenbergMarquardtSummary take_last_steps(LobeProblem& problem, Eigen::VectorXd& x, const Reporter& reporter) {
    LevenbergMarquardtSummary summary;
    double previous = std::numeric_limits<double>::infinity();
    for (int i = 0; i < k_most_batches; ++i) {
        summary = take_steps(problem, x, k_last_steps, reporter);
        const bool pays = summary.loss <= (1 - k_least_gain) * previous;
        if (!pays || summary.stop != Stop::iterations || reporter.cancelled()) break;
        previous = summary.loss;
    }
    return summary;
}

/// The limit on the albedo of a fit; none: there is none.
std::optional<AlbedoBound> albedo_bound(const PmFitOptions& options) {
    constexpr int k_azimuths = 5;  // of lobes that need not be isotropic
    const double limit = options.albedo_limit.value_or(default_albedo_limit(options.form));
    if (std::isinf(limit)) return {};
    return AlbedoBound(limit, options.axial ? 1 : k_azimuths);
}

/// A round: `steps(problem, x)`, then rounding. `lobes` become those of the steps.
template <typename Steps>
PmFit fit_round(const Observations& observations, Lobes& lobes, const TermFactors& factors, const Steps& steps) {
    const Rows rows(observations, {.integral_importance = factors.integrals, .picture_importance = factors.pictures});
    LobeProblem problem(rows, lobes.shape, true);
    Eigen::VectorXd x = pack(lobes);
    const LevenbergMarquardtSummary summary = steps(problem, x);
    lobes = unpack(x, lobes.shape);
    PmFit fit;
    fit.unrounded_loss = summary.loss;
    fit.stop = summary.stop == Stop::iterations ? StopReason::iterations : StopReason::converged;
    fit.unrounded = to_model(problem, lobes);

    // The nonlinear parameters are rounded, then the coefficients are solved again.
    const Lobes halves = round_lobes(problem, lobes, fit.unrounded_loss);
    fit.loss = problem.loss(pack(halves));
    if (rows.views > 0) fit.delta_e = problem.delta_e();
    fit.model = to_halves(to_model(problem, halves), halves);
    return fit;
}

/// `fit`, with lobes lowered to the limit on albedos where steps did not suffice.
PmFit lowered_to(const AlbedoBound& bound, PmFit fit, const Observations& observations) {
    fit.unrounded = lowered_to(bound, std::move(fit.unrounded));
    PmModel within = lowered_to(bound, fit.model);
    if (within.coefficient == fit.model.coefficient) return fit;
    const double loss = loss_of(observations, evaluator(fit.model));
    fit.model = rounded(within);
    const double lowered = loss > 0 ? std::max(1.0, loss_of(observations, evaluator(fit.model)) / loss) : 1;
    fit.loss *= lowered, fit.delta_e *= lowered;
    return fit;
}

}  // namespace

PmFit with_spectra(PmFit fit, const Observations& observations, const PmFitOptions& options) {
    for (PmModel* model : {&fit.model, &fit.unrounded})
        *model = with_spectra(std::move(*model), shape_of(options), observations);
    fit.model = rounded(fit.model);
    return fit;
}

PmFit finish(Lobes lobes, Observations observations, const TermFactors& factors, const PmFitOptions& options,
             const Reporter& reporter) {
    const std::size_t first_bound = observations.fitted_count();
    std::optional<AlbedoBound> bound = albedo_bound(options);
    PmFit fit = fit_round(observations, lobes, factors, [&](LobeProblem& problem, Eigen::VectorXd& x) {
        return take_last_steps(problem, x, reporter);
    });
    for (int round = 0; round < k_bound_rounds && !reporter.cancelled(); ++round) {
        std::size_t exceeded = add_exceeded_pairs(observations, first_bound, fit.model, fit.loss);
        if (bound) exceeded += bound->add_exceeded(observations, evaluator(fit.model));
        if (exceeded == 0) break;
        fit = fit_round(observations, lobes, factors, [&](LobeProblem& problem, Eigen::VectorXd& x) {
            return take_steps(problem, x, k_bound_steps, reporter);
        });
    }
    if (!observations.wavelengths.empty()) fit = with_spectra(std::move(fit), observations, options);
    return bound ? lowered_to(*bound, std::move(fit), observations) : fit;
}

}  // namespace srbf
