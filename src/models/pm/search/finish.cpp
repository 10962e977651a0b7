#include "models/pm/search/search.h"

#include "base/least_squares.h"
#include "base/levenberg_marquardt.h"
#include "brdf/colour.h"
#include "models/pm/pm_functions.h"
#include "models/pm/search/fit_pm.h"
#include "models/pm/solve/rounding.h"
#include "observe/albedo_bound.h"
#include "observe/excess.h"
#include "observe/pair_weights.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

/// The cost of an error of a lobe's colour, compared with the cost of an error of its spectrum. It is small, so that
/// the problem stays well-conditioned; further rounds fit the remaining difference until the colour is exact.
constexpr double k_colour_importance = 10;
constexpr int k_colour_rounds = 5;

/// The coefficients of the model's lobes in the units of a problem that has evaluated them, J × 3.
Eigen::MatrixXd coefficients_in(const LobeProblem& problem, const PmModel& model, const Lobes& lobes) {
    Eigen::MatrixXd beta(model.lobes, 3);
    for (int j = 0; j < model.lobes; ++j) {
        const auto k = std::size_t(j);
        const double factor = elementary::exp(double(model.log_scale[k]) - problem.log_unit(lobes, j));
        for (int c = 0; c < 3; ++c) beta(j, c) = factor * double(model.coefficient[k][c]);
    }
    return beta;
}

/// `model`, a fit to the colours of these spectral observations, with a coefficient ≥ 0 for each wavelength. Lobes and
/// colours remain: with the fundamental of a lobe's spectrum, which is its component that has a colour, only the other
/// component, the metameric black (Cohen & Kappauf 1982), is fitted to the spectra.
PmModel fit_spectra(PmModel model, const LobeShape& shape, const Observations& observations) {
    // Σ |y − Σ_j E_j s_j|², where s_j are spectra of given colours and y is data, is least if each s_j is the one of
    // these colours nearest to the spectrum without that condition, whatever the products of the lobes are.
    const Lobes lobes = to_lobes(model, shape);
    const PackedObservations rows(observations, {.spectra = true});
    LobeProblem problem(rows, shape, true);
    problem.loss(pack(lobes));

    const std::vector<Rgb> weights = rgb_weights(observations.wavelengths);
    const auto C = Eigen::Index(weights.size());
    Eigen::MatrixXd to_colour(C, 3);
    for (Eigen::Index i = 0; i < C; ++i)
        for (int c = 0; c < 3; ++c) to_colour(i, c) = double(weights[std::size_t(i)][c]);
    const double importance = k_colour_importance * double(C);  // Σ |to_colour|² falls with the number of wavelengths
    const Eigen::MatrixXd G = Eigen::MatrixXd::Identity(C, C) + importance * to_colour * to_colour.transpose();
    const Eigen::VectorXd unlimited = Eigen::VectorXd::Constant(C, std::numeric_limits<double>::infinity());
    const Eigen::MatrixXd colour = coefficients_in(problem, model, lobes);
    Eigen::MatrixXd spectrum = problem.beta();
    for (Eigen::Index j = 0; j < spectrum.rows(); ++j) {
        const Eigen::VectorXd free = spectrum.row(j).transpose(), wanted = colour.row(j).transpose();
        Eigen::VectorXd asked = wanted, nearest;
        for (int round = 0; round < k_colour_rounds; ++round) {
            nearest = bounded_least_squares(G, free + importance * to_colour * asked, unlimited);
            asked += wanted - to_colour.transpose() * nearest;
        }
        spectrum.row(j) = nearest.transpose();
    }
    problem.continue_from(spectrum);
    const PmModel spectral = to_model(problem, lobes, observations.wavelengths);
    model.spectrum = spectral.spectrum, model.wavelength = spectral.wavelength;
    model.coefficient = spectral.coefficient, model.log_scale = spectral.log_scale;
    return model;
}

/// The last steps run in batches of ten until a batch lowers the loss by less than `k_min_gain`. Most fits need
/// two batches; a fit whose narrow lobes must match an albedo needs twenty.
constexpr int k_last_steps = 10, k_max_batches = 26;
constexpr double k_min_gain = 0.01;
/// After bounds were exceeded, a few steps with larger weights move lobes below them.
constexpr int k_bound_rounds = 12, k_bound_steps = 4;

/// Levenberg-Marquardt from x, with `count` steps.
LevenbergMarquardtSummary take_steps(LobeProblem& problem, Eigen::VectorXd& x, int count, const Reporter& reporter) {
    return levenberg_marquardt(problem, x, {.max_iterations = reporter.cancelled() ? 0 : count});
}

/// Levenberg-Marquardt from x, until a batch of steps lowers the loss by less than `k_min_gain`.
LevenbergMarquardtSummary take_last_steps(LobeProblem& problem, Eigen::VectorXd& x, const Reporter& reporter) {
    LevenbergMarquardtSummary summary;
    double previous = std::numeric_limits<double>::infinity();
    for (int i = 0; i < k_max_batches; ++i) {
        summary = take_steps(problem, x, k_last_steps, reporter);
        const bool pays = summary.loss <= (1 - k_min_gain) * previous;
        if (!pays || summary.stop != Stop::iterations || reporter.cancelled()) break;
        previous = summary.loss;
    }
    return summary;
}

/// The limit on the albedo of a fit; none: there is none.
std::optional<AlbedoBound> albedo_bound(const PmFitOptions& options) {
    constexpr int k_azimuths = 5;  // azimuths of views for lobes that may be anisotropic
    const double limit = options.albedo_limit.value_or(default_albedo_limit(options.form));
    if (std::isinf(limit)) return {};
    return AlbedoBound(limit, options.axial ? 1 : k_azimuths);
}

/// Runs a round: `steps(problem, x)`, then rounding. `lobes` receives the lobes after the steps.
template <typename Steps>
PmFit fit_round(const Observations& observations, Lobes& lobes, const PackingOptions& terms, const Steps& steps) {
    const PackedObservations rows(observations, terms);
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

/// `fit`, with lobes lowered to the limit on albedos if steps did not suffice.
PmFit limit_albedo(const AlbedoBound& bound, PmFit fit, const Observations& observations) {
    fit.unrounded = limit_albedo(bound, std::move(fit.unrounded));
    PmModel within = limit_albedo(bound, fit.model);
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
        *model = fit_spectra(std::move(*model), shape_of(options), observations);
    fit.model = rounded(fit.model);
    return fit;
}

PmFit finish(Lobes lobes, Observations observations, const PackingOptions& terms, const PmFitOptions& options,
             const Reporter& reporter) {
    const std::size_t first_bound = observations.fitted_count();
    std::optional<AlbedoBound> bound = albedo_bound(options);
    PmFit fit = fit_round(observations, lobes, terms, [&](LobeProblem& problem, Eigen::VectorXd& x) {
        return take_last_steps(problem, x, reporter);
    });
    for (int round = 0; round < k_bound_rounds && !reporter.cancelled(); ++round) {
        std::size_t exceeded = promote_exceeded_pairs(observations, first_bound, fit.model, fit.loss);
        if (bound) exceeded += bound->add_exceeded(observations, evaluator(fit.model));
        if (exceeded == 0) break;
        fit = fit_round(observations, lobes, terms, [&](LobeProblem& problem, Eigen::VectorXd& x) {
            return take_steps(problem, x, k_bound_steps, reporter);
        });
    }
    if (!observations.wavelengths.empty()) fit = with_spectra(std::move(fit), observations, options);
    return bound ? limit_albedo(*bound, std::move(fit), observations) : fit;
}

}  // namespace
