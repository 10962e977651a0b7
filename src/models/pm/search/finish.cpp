#include "models/pm/search/finish.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "base/levenberg_marquardt.h"
#include "models/pm/solve/rounding.h"
#include "observe/bound.h"
#include "observe/pair_weights.h"
#include "srbf/elementary.h"

namespace srbf {
namespace {

constexpr int k_bound_rounds = 12;
/// Rounds that raise the loss by this factor are given up.
constexpr double k_costly_bounds = 2;
/// The last steps run in batches of ten until one lowers the loss by less than this. Most fits need two batches; a fit
/// whose narrow lobes must match an albedo needs twenty.
constexpr int k_last_steps = 10, k_most_tens = 26;
constexpr double k_least_gain = 0.005;
/// Instead, for pictures of scattered samples, which are known less well.
constexpr double k_least_gain_of_samples = 0.02;
/// Instead of tens, once bounds are exceeded: weights move lobes below them in a few steps. Lobes that begin without their
/// factors take tens again.
constexpr int k_bound_steps_of_samples = 4;

/// Weights for which Σ w |f|² over the wavelengths equals that over R, G, B.
void weigh_for_spectra(Observations& observations) {
    const std::size_t count = observations.fitted_count(), C = observations.wavelengths.size();
    const double of_colours =
        energy_of(std::span(observations.f).first(count), std::span(observations.weight).first(count));
    double of_spectra = 0;
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t c = 0; c < C; ++c)
            of_spectra += observations.weight[i] * elementary::square(double(observations.spectrum[i * C + c]));
    if (!(of_spectra > 0)) return;
    for (double& weight : observations.weight) weight *= of_colours / of_spectra;
}

/// Levenberg-Marquardt from x, so many steps.
LevenbergMarquardtSummary few_steps(LobeProblem& problem, Eigen::VectorXd& x, int count, const Reporter& reporter) {
    return levenberg_marquardt(problem, x, {.max_iterations = reporter.cancelled() ? 0 : count});
}

/// Levenberg-Marquardt from x as long as the steps pay off.
LevenbergMarquardtSummary last_steps(LobeProblem& problem, Eigen::VectorXd& x, double least_gain,
                                     const Reporter& reporter) {
    LevenbergMarquardtSummary summary;
    double before = std::numeric_limits<double>::infinity();
    for (int i = 0; i < k_most_tens; ++i) {
        summary = few_steps(problem, x, k_last_steps, reporter);
        const bool pays = summary.loss <= (1 - least_gain) * before;
        if (!pays || summary.stop != Stop::iterations || reporter.cancelled()) break;
        before = summary.loss;
    }
    return summary;
}

/// `lobes`, of which these have no factors by which they rise towards the horizon.
Lobes without_features(Lobes lobes, std::span<const int> which) {
    for (const int j : which) {
        const auto begin = lobes.weight.begin() + j * lobes.shape.width();
        std::fill(begin + lobes.shape.directional(), begin + lobes.shape.width(), 0.0);
    }
    return lobes;
}

}  // namespace

PmFit finish(Lobes lobes, Observations all, const TermFactors& factors, const FitOptions& options,
             double log_peak_limit, const Reporter& reporter) {
    PmFit fit;
    const bool spectral = !all.wavelengths.empty();
    if (spectral) weigh_for_spectra(all);
    const std::size_t first_bound = all.fitted_count();
    Lobes first_lobes;
    std::optional<std::vector<int>> lowered;  // those of them that began again without their factors
    double first_loss = 0;
    bool begins = true;  // with lobes that no round has improved
    for (int round = 0;; ++round) {
        const Rows rows(
            all,
            {.integral_importance = factors.integrals, .spectra = spectral, .picture_importance = factors.pictures});
        LobeProblem problem(rows, lobes.shape, true, log_peak_limit);
        Eigen::VectorXd x = pack(lobes);
        const bool of_samples = rows.views > 0 && !factors.has_directional_lights;
        const double least_gain = of_samples ? k_least_gain_of_samples : k_least_gain;
        const auto summary = of_samples && !begins ? few_steps(problem, x, k_bound_steps_of_samples, reporter)
                                                   : last_steps(problem, x, least_gain, reporter);
        lobes = unpack(x, lobes.shape), begins = false;
        fit.unrounded_loss = summary.loss;
        fit.stop = summary.stop == Stop::iterations ? StopReason::iterations : StopReason::converged;
        fit.unrounded = to_model(problem, lobes, options.log_scale, all.wavelengths);

        // The nonlinear parameters are rounded, then the coefficients are solved again.
        const Lobes halves = rounded_lobes(problem, lobes, fit.unrounded_loss);
        fit.loss = problem.loss(pack(halves));
        fit.model = to_halves(to_model(problem, halves, options.log_scale, all.wavelengths), halves);
        if (round == k_bound_rounds || reporter.cancelled()) return fit;
        if (round == 0) first_lobes = lobes, first_loss = fit.loss;
        const bool costs_much = fit.unrounded_loss > k_costly_bounds * first_loss;
        const auto rising = costs_much ? exceeding_lobes(all, first_bound, fit.model) : std::vector<int>{};
        if (costs_much && rising != lowered) {
            // Larger weights narrow a lobe that rises steeply towards the horizon, and the others suffer. Without those
            // factors it begins below the bound, which then holds it there.
            lobes = without_features(first_lobes, rising), lowered = rising;
            reset_bound_weights(all, first_bound, first_loss);
            begins = true;
        } else if (add_exceeded_pairs(all, first_bound, fit.model, fit.loss) == 0) {
            return fit;
        }
    }
}

}  // namespace srbf
