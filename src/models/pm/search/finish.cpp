#include "models/pm/search/finish.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <vector>

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

constexpr int k_bound_rounds = 12;
/// A round that raises the loss by more than this factor is abandoned.
constexpr double k_costly_bounds = 2;
/// The last steps run in batches of ten until a batch lowers the loss by less than `k_least_gain`. Most fits need
/// two batches; a fit whose narrow lobes must match an albedo needs twenty.
constexpr int k_last_steps = 10, k_most_batches = 26;
constexpr double k_least_gain = 0.005;
/// Replaces `k_least_gain` for pictures of scattered samples, which are less certain.
constexpr double k_least_gain_of_samples = 0.02;
/// Replaces the batches of ten once bounds are exceeded: a few steps with larger weights move lobes below the
/// bounds. Lobes that begin without features take batches of ten again.
constexpr int k_bound_steps_of_samples = 4;

/// Levenberg-Marquardt from x, with `count` steps.
LevenbergMarquardtSummary take_steps(LobeProblem& problem, Eigen::VectorXd& x, int count, const Reporter& reporter) {
    return levenberg_marquardt(problem, x, {.max_iterations = reporter.cancelled() ? 0 : count});
}

/// Levenberg-Marquardt from x, as long as the steps pay off.
LevenbergMarquardtSummary take_last_steps(LobeProblem& problem, Eigen::VectorXd& x, double least_gain,
                                          const Reporter& reporter) {
    LevenbergMarquardtSummary summary;
    double previous = std::numeric_limits<double>::infinity();
    for (int i = 0; i < k_most_batches; ++i) {
        summary = take_steps(problem, x, k_last_steps, reporter);
        const bool pays = summary.loss <= (1 - least_gain) * previous;
        if (!pays || summary.stop != Stop::iterations || reporter.cancelled()) break;
        previous = summary.loss;
    }
    return summary;
}

/// Sets the exponent weights of the given lobes to 0, with which they rise towards the horizon.
Lobes without_features(Lobes lobes, std::span<const int> which) {
    for (const int j : which) {
        const auto begin = lobes.weight.begin() + j * lobes.shape.width();
        std::fill(begin + lobes.shape.directional(), begin + lobes.shape.width(), 0.0);
    }
    return lobes;
}

/// The limit on the albedo of a fit; none: there is none.
std::optional<AlbedoBound> albedo_bound(const PmFitOptions& options) {
    constexpr int k_azimuths = 5;  // of lobes that need not be isotropic
    const double limit = options.albedo_limit.value_or(default_albedo_limit(options.form));
    if (std::isinf(limit)) return {};
    return AlbedoBound(limit, options.axial ? 1 : k_azimuths);
}

/// A round: steps, then rounding. `lobes` become those of the steps; `is_new`: no round has improved them yet.
PmFit fit_round(const Observations& observations, Lobes& lobes, bool is_new, const TermFactors& factors,
                const PmFitOptions& options, const Reporter& reporter) {
    const Rows rows(observations, {.integral_importance = factors.integrals, .picture_importance = factors.pictures});
    LobeProblem problem(rows, lobes.shape, true, log_peak_limit_of(options));
    Eigen::VectorXd x = pack(lobes);
    const bool is_sampled = rows.views > 0 && !factors.has_directional_lights;
    const double least_gain = is_sampled ? k_least_gain_of_samples : k_least_gain;
    const auto summary = is_sampled && !is_new ? take_steps(problem, x, k_bound_steps_of_samples, reporter)
                                               : take_last_steps(problem, x, least_gain, reporter);
    lobes = unpack(x, lobes.shape);
    PmFit fit;
    fit.unrounded_loss = summary.loss;
    fit.stop = summary.stop == Stop::iterations ? StopReason::iterations : StopReason::converged;
    fit.unrounded = to_model(problem, lobes, options.log_scale);

    // The nonlinear parameters are rounded, then the coefficients are solved again.
    const Lobes halves = round_lobes(problem, lobes, fit.unrounded_loss);
    fit.loss = problem.loss(pack(halves));
    if (rows.views > 0) fit.delta_e = problem.delta_e();
    fit.model = to_halves(to_model(problem, halves, options.log_scale), halves);
    return fit;
}

}  // namespace

PmFit with_spectra(PmFit fit, const Observations& observations, const PmFitOptions& options) {
    for (PmModel* model : {&fit.model, &fit.unrounded})
        *model = with_spectra(std::move(*model), shape_of(options), observations, log_peak_limit_of(options),
                              options.log_scale);
    fit.model = rounded(fit.model);
    return fit;
}

PmFit finish(Lobes lobes, Observations observations, const TermFactors& factors, const PmFitOptions& options,
             const Reporter& reporter) {
    const std::size_t first_bound = observations.fitted_count();
    std::optional<AlbedoBound> bound = albedo_bound(options);
    const auto within_limits = [&](PmFit fit) {
        if (!observations.wavelengths.empty()) fit = with_spectra(std::move(fit), observations, options);
        if (!bound) return fit;
        fit.unrounded = lowered_to(*bound, std::move(fit.unrounded));
        PmModel within = lowered_to(*bound, fit.model);
        if (within.coefficient == fit.model.coefficient) return fit;
        const double loss = loss_of(observations, evaluator(fit.model));
        fit.model = rounded(within);
        const double lowered = loss > 0 ? std::max(1.0, loss_of(observations, evaluator(fit.model)) / loss) : 1;
        fit.loss *= lowered, fit.delta_e *= lowered;
        return fit;
    };
    Lobes first_lobes;
    std::set<std::vector<int>> without_features_before;  // lobes that began again without features
    double first_loss = 0;
    bool is_new = true, bounds_albedos = bound.has_value();
    // Where the table exceeds the limit, bounds must raise the loss.
    const bool exceeds_limit = bound && most_measured_albedo(observations) > bound->limit();
    for (int round = 0;; ++round) {
        PmFit fit = fit_round(observations, lobes, is_new, factors, options, reporter);
        is_new = false;
        if (round == k_bound_rounds || reporter.cancelled()) return within_limits(std::move(fit));
        if (round == 0) first_lobes = lobes, first_loss = fit.loss;
        if (fit.unrounded_loss > k_costly_bounds * first_loss && !exceeds_limit) {
            const std::vector<int> rising = exceeding_lobes(observations, first_bound, fit.model);
            const bool is_untried = without_features_before.insert(rising).second;
            if (is_untried || bounds_albedos) {
                // Larger weights would narrow a lobe that rises steeply towards the horizon, at the expense of the
                // others. Without features the lobe begins below the bounds, which then hold it there. Where that
                // does not help, albedos are not bounded: lobes are lowered in the end.
                bounds_albedos = bounds_albedos && is_untried;
                lobes = without_features(first_lobes, rising);
                reset_bound_weights(observations, first_bound, first_loss);
                if (bound) bound->remove_from(observations);
                is_new = true;
                continue;
            }
        }
        const std::size_t exceeded_pairs = add_exceeded_pairs(observations, first_bound, fit.model, fit.loss);
        const std::size_t exceeded_albedos =
            bounds_albedos ? bound->add_exceeded(observations, evaluator(fit.model)) : 0;
        if (exceeded_pairs + exceeded_albedos == 0) return within_limits(std::move(fit));
    }
}

}  // namespace srbf
