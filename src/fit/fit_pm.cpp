#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "fit/batched_fits.h"
#include "fit/excess.h"
#include "fit/objective.h"
#include "fit/phases.h"
#include "fit/rounding.h"
#include "fit/sample.h"
#include "least_squares.h"
#include "parallel.h"
#include "srbf/elementary.h"
#include "srbf/half.h"

namespace srbf {
namespace {

/// That share of the starts of a fit, at least one.
int some_starts(double share, const FitOptions& options) {
    return std::max(int(std::lround(share * starts_of(options))), 1);
}
/// A round of the tournament: the share of the starts that continue, until this share of the perturbations is done.
struct Round {
    double starts, perturbations;
    int candidates(const FitOptions& options) const { return some_starts(starts, options); }
    int perturbations_until(const FitOptions& options) const {
        return int(std::lround(perturbations * perturbations_of(options)));
    }
};
constexpr Round k_rounds[] = {{1, 0.2}, {0.5, 0.5}, {0.25, 1}};
/// Candidates with the same loss of pairs look different, and further perturbations lower that loss by little: all of
/// them remain for pictures to choose from.
constexpr Round k_rounds_to_pictures[] = {{1, 0.12}, {1, 0.28}};
/// A round of steps with pictures: the share of the starts that take so many more. The best after all are nearly always
/// among the best after three.
struct SeenRound {
    double starts;
    int steps;
};
constexpr SeenRound k_seen_rounds[] = {{1, 3}, {0.25, 4}, {0.125, 8}};
/// With phase weights this many of them then take so many steps on all observations. The least sum decides, which knows
/// radiance; ΔE_ITP does not.
constexpr std::size_t k_compared_candidates = 2;
constexpr int k_compared_steps = 6;
std::span<const Round> rounds_of(const Observations& observations) {
    return observations.views.empty() ? std::span<const Round>(k_rounds) : std::span<const Round>(k_rounds_to_pictures);
}
// This many candidates advance to the next stage.
constexpr std::size_t k_polished = 4, k_finished = 3;
constexpr int k_check_rounds = 12;
/// After the best candidate another one is finished only if its error is at most this much larger than the best
/// finished one: the last steps lower the loss by 1 to 4 %, or fail where a fit exceeds many checks.
constexpr double k_nearly_best = 0.01;
/// The last steps run in batches of ten until one lowers the loss by less than this. Most fits need two batches; a fit
/// whose narrow lobes must match a radiance needs twenty.
constexpr int k_last_steps = 10, k_most_tens = 26;
constexpr double k_least_gain = 0.005;
/// Instead, for pictures of scattered samples, which are known less well.
constexpr double k_least_gain_of_samples = 0.02;
/// Upper bound on the log of the coefficient of a lobe with peak 1. The peak may lie where no pair of directions maps
/// to; but opposing lobes of ever larger bandwidths gain less than 1 % on the measured materials and lose precision in
/// float.
constexpr double k_log_peak_limit = 300;

/// The least and the largest factor of a weight for an error that is not small.
constexpr double k_most_large_error_weight = 10;

/// If rounding raises the loss by more than this factor, parameters are rounded one after the other instead.
struct CostlyRounding {
    double factor;
    Turns turns;
};
constexpr CostlyRounding k_costly_rounding[] = {{1.003, {4, 2, 2}}, {1.02, {12, 3, 6}}};

Result<Done> validate(const Observations& observations, const FitOptions& options) {
    const auto in_range = [](const char* what, int x, int least, int most) -> Result<Done> {
        if (x >= least && x <= most) return Done{};
        return Error{"fit", {}, what, fmt::format("{} to {}", least, most), fmt::format("{}", x), ErrorCode::argument};
    };
    for (const auto& result : {in_range("number of lobes", options.lobes, 1, k_most_fitted_lobes),
                               in_range("number of variates", options.variates, 1, k_most_variates),
                               in_range("number of starts", starts_of(options), 1, 1000),
                               in_range("number of perturbations", perturbations_of(options), 0, 100000),
                               in_range("number of threads", options.threads, 0, 1024)})
        if (!result) return result.error();
    if (!(options.finest >= 0 && options.finest < 1))
        return Error{
            "fit", {}, "finest width", "0 to 1 radian", fmt::format("{}", options.finest), ErrorCode::argument};
    if (!options.log_scale && options.form != PmForm::gaussian)
        return Error{"fit", {}, "log scale", "one, in all forms but gaussian", "none", ErrorCode::argument};
    if (options.reciprocal && options.variates % 2 == 1)
        return Error{"fit",
                     {},
                     "number of variates",
                     "an even one, for a reciprocal model",
                     fmt::format("{}", options.variates),
                     ErrorCode::argument};
    return validate(observations, parameter_count(options));
}

/// Weights for which Σ w |f|² over the wavelengths equals that over R, G, B.
void weigh_for_spectra(Observations& observations) {
    const std::size_t count = observations.f.size() - observations.checks, C = observations.wavelengths.size();
    const double of_colours =
        energy_of(std::span(observations.f).first(count), std::span(observations.weight).first(count));
    double of_spectra = 0;
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t c = 0; c < C; ++c)
            of_spectra += observations.weight[i] * elementary::square(double(observations.spectrum[i * C + c]));
    if (!(of_spectra > 0)) return;
    for (double& weight : observations.weight) weight *= of_colours / of_spectra;
}

/// Levenberg-Marquardt from x as long as the steps pay off.
LevenbergMarquardtSummary last_steps(LobeProblem& problem, Eigen::VectorXd& x, double least_gain,
                                     const Reporter& reporter) {
    LevenbergMarquardtOptions steps;
    steps.max_iterations = reporter.cancelled() ? 0 : k_last_steps;
    LevenbergMarquardtSummary summary;
    double before = std::numeric_limits<double>::infinity();
    for (int i = 0; i < k_most_tens; ++i) {
        summary = levenberg_marquardt(problem, x, steps);
        const bool pays = summary.loss <= (1 - least_gain) * before;
        if (!pays || summary.stop != Stop::iterations || reporter.cancelled()) break;
        before = summary.loss;
    }
    return summary;
}

/// Optimises on all observations, for spectral ones with the spectra. Checks that the fit exceeds become observations,
/// until none is exceeded. Then rounds.
PmFit finish(Lobes lobes, Observations all, double radiance_importance, double picture_importance, bool has_phases,
             const FitOptions& options, double log_peak_limit, const Reporter& reporter) {
    PmFit fit;
    const bool spectral = !all.wavelengths.empty();
    if (spectral) weigh_for_spectra(all);
    const std::size_t first_check = all.f.size() - all.checks;
    for (int round = 0;; ++round) {
        const Rows rows(all, {.radiance_importance = radiance_importance,
                              .spectra = spectral,
                              .picture_importance = picture_importance});
        LobeProblem problem(rows, lobes.shape, true, log_peak_limit);
        Eigen::VectorXd x = LobeProblem::pack(lobes);
        const bool of_samples = rows.views > 0 && !has_phases;
        const auto summary = last_steps(problem, x, of_samples ? k_least_gain_of_samples : k_least_gain, reporter);
        lobes = problem.unpack(x);
        fit.unrounded_loss = summary.loss;
        fit.stop = summary.stop == Stop::iterations ? StopReason::iterations : StopReason::converged;
        fit.unrounded = to_model(problem, lobes, options.log_scale, all.wavelengths);

        // The nonlinear parameters are rounded, then the coefficients are solved again.
        Lobes halves = to_lobes(to_halves(fit.unrounded, lobes), lobes.shape);
        fit.loss = problem.loss(LobeProblem::pack(halves));
        for (const auto& [factor, turns] : k_costly_rounding) {
            if (fit.loss <= factor * fit.unrounded_loss) break;
            const Lobes in_turn = rounded_in_turn(problem, lobes, turns);
            if (const double loss = problem.loss(LobeProblem::pack(in_turn)); loss < fit.loss)
                halves = in_turn, fit.loss = loss;
            else
                problem.loss(LobeProblem::pack(halves));
        }
        fit.model = to_halves(to_model(problem, halves, options.log_scale, all.wavelengths), halves);
        if (round == k_check_rounds || reporter.cancelled()) return fit;
        if (take_exceeded(all, first_check, fit.model, fit.loss) == 0) return fit;
    }
}

}  // namespace

std::string_view name(StopReason reason) {
    switch (reason) {
        case StopReason::converged:
            return "converged";
        case StopReason::iterations:
            return "iterations";
        case StopReason::cancelled:
            return "cancelled";
    }
    return "";
}

namespace {

/// The units of work of a fit: a grown lobe or a perturbation.
struct Work {
    double search = 0, polish = 0;
    double all() const { return search + 2 * polish; }
};
Work work_of(const Observations& observations, const FitOptions& options) {
    int perturbations = 0, before = 0;
    for (const Round& round : rounds_of(observations)) {
        const int until = round.perturbations_until(options);
        perturbations += round.candidates(options) * (until - before);
        before = until;
    }
    return {double(starts_of(options) * options.lobes + perturbations), 0.2 * perturbations + 1};
}

double log_peak_limit_of(const FitOptions& options) {
    return options.log_scale ? k_log_peak_limit : elementary::log(double(k_half_max));
}

void sort_by_loss(std::vector<Candidate>& found) {
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.loss < b.loss; });
}

/// A fit from its observations on, on the threads of the caller's `on_threads`.
struct Fit {
    const Observations& observations;
    const FitOptions& options;
    Reporter& reporter;
    double log_peak_limit = log_peak_limit_of(options);
    Work work = work_of(observations, options);
    Sample sample{observations};
    std::vector<Candidate> found = std::vector<Candidate>(std::size_t(starts_of(options)));

    template <typename Body> void each(const Body& body) { parallel_for(found.size(), body); }
    void polished_one(std::size_t rounds = 1) {
        reporter.advance("polishing", work.polish / double(rounds * found.size()));
    }
    PmFit finished(const Candidate& candidate, Observations all, double picture_importance, bool has_phases) const {
        const double channels = observations.wavelengths.empty() ? 3 : double(observations.wavelengths.size());
        const double radiance_importance = sample.radiance_importance(has_phases) * 3 / channels;
        return finish(candidate.lobes, std::move(all), radiance_importance, picture_importance, has_phases, options,
                      log_peak_limit, reporter);
    }
    /// A candidate with the coefficients for these rows.
    PmModel on(const Rows& rows, const Candidate& candidate) const {
        LobeProblem problem(rows, shape_of(options), true, log_peak_limit);
        problem.loss(LobeProblem::pack(candidate.lobes));
        return to_model(problem, candidate.lobes, options.log_scale, {});
    }

    void search() {
        const Rows to_grow_on = sample.to_grow_on();
        each(
            [&](std::size_t start) { found[start] = grow(to_grow_on, options, log_peak_limit, int(start), reporter); });
        sort_by_loss(found);
        for (const Round& round : rounds_of(observations)) {
            sample.look_about(found, options, log_peak_limit);
            found.resize(std::size_t(round.candidates(options)));
            const Rows rows = sample.to_search(round.starts == 1);
            const int until = round.perturbations_until(options);
            each([&](std::size_t i) {
                if (!reporter.cancelled()) improve(rows, options, log_peak_limit, until, found[i], reporter);
            });
            sort_by_loss(found);
        }
        sample.look_about(found, options, log_peak_limit);
    }

    /// With views. Weights are those of small errors until here.
    PmFit seen() {
        sample.weigh_by_errors(on(sample.to_search(false), found.front()), k_most_large_error_weight);
        const double importance = sample.picture_importance(found.front(), options, log_peak_limit);
        const Rows to_see = sample.to_see(importance);
        for (const SeenRound& round : k_seen_rounds) {
            found.resize(std::size_t(some_starts(round.starts, options)));
            each([&](std::size_t i) {
                if (!reporter.cancelled()) see(to_see, options, log_peak_limit, round.steps, found[i]);
                polished_one(std::size(k_seen_rounds));
            });
            sort_by_loss(found);
        }
        const bool has_phases = observations.wavelengths.empty() && !observations.phase_weight.empty();
        Observations weighed = weighed_by_errors(on(to_see, found.front()), has_phases);
        if (has_phases && !reporter.cancelled()) {
            const Rows all(weighed, {.radiance_importance = sample.radiance_importance(has_phases),
                                     .picture_importance = importance});
            weighed = weighed_by_errors(compared(all), has_phases);
        }
        return finished(found.front(), std::move(weighed), importance, has_phases);
    }
    Observations weighed_by_errors(const PmModel& model, bool has_phases) const {
        Observations weighed = observations;
        const Evaluate fitted = evaluator(model);
        weigh_large_errors(weighed, weighed.f.size() - weighed.checks, fitted, k_most_large_error_weight);
        if (has_phases) add_phase_weights(weighed, fitted);
        return weighed;
    }
    /// Of the first candidates the one with the least sum on these rows after some steps.
    PmModel compared(const Rows& rows) {
        found.resize(std::min(found.size(), k_compared_candidates));
        each([&](std::size_t i) {
            LobeProblem problem(rows, shape_of(options), true, log_peak_limit);
            Eigen::VectorXd x = LobeProblem::pack(found[i].lobes);
            LevenbergMarquardtOptions steps;
            steps.max_iterations = k_compared_steps;
            found[i].loss = levenberg_marquardt(problem, x, steps).loss;
            found[i].lobes = problem.unpack(x);
        });
        sort_by_loss(found);
        return on(rows, found.front());
    }

    void polish_best() {
        found.resize(std::min(found.size(), k_polished));
        const Rows to_polish = sample.to_polish();
        each([&](std::size_t i) {
            if (!reporter.cancelled()) polish(to_polish, options, log_peak_limit, found[i]);
            polished_one();
        });
    }
    /// Of polished candidates.
    PmFit best_finished() {
        // The loss over all observations decides which candidates continue.
        const Rows all(observations, {.radiance_importance = sample.radiance_importance()});
        LobeProblem whole(all, shape_of(options), true, log_peak_limit);
        for (Candidate& candidate : found) candidate.loss = whole.loss(LobeProblem::pack(candidate.lobes));
        sort_by_loss(found);
        found.resize(std::min(found.size(), k_finished));
        PmFit fit;
        for (std::size_t i = 0; i < found.size(); ++i) {
            if (i > 0 && (found[i].loss > (1 + k_nearly_best) * fit.loss || reporter.cancelled())) break;
            PmFit next = finished(found[i], observations, 0, false);
            if (i == 0 || next.loss < fit.loss) fit = std::move(next);
        }
        return fit;
    }
};

/// The search of all fits, which have the same options, in batches.
Result<Done> search(std::span<const std::unique_ptr<Fit>> fits, const FitOptions& options, Batches::Where where) {
    if (fits.empty()) return Done{};
    Reporter& reporter = fits[0]->reporter;
    const double limit = log_peak_limit_of(options);
    // Calls stage(batches, candidates) with the candidates of all fits on these rows.
    const auto together = [&](const auto& rows_of, const auto& stage) -> Result<Done> {
        std::vector<std::unique_ptr<Rows>> rows(fits.size());
        parallel_for(fits.size(), [&](std::size_t i) { rows[i] = std::make_unique<Rows>(rows_of(*fits[i])); });
        std::vector<const Rows*> pointers;
        std::vector<BatchedCandidate> all;
        for (std::size_t i = 0; i < fits.size(); ++i) {
            pointers.push_back(rows[i].get());
            for (Candidate& of : fits[i]->found) all.push_back({std::move(of), i});
        }
        auto batches = Batches::make(where, pointers);
        if (!batches) return batches.error();
        const auto done = stage(*batches, std::span(all));
        if (!done) return done;
        for (const auto& fit : fits) fit->found.clear();
        for (BatchedCandidate& of : all) fits[of.rows]->found.push_back(std::move(of.candidate));
        for (const auto& fit : fits) sort_by_loss(fit->found);
        return Done{};
    };
    for (const auto& fit : fits)
        for (std::size_t start = 0; start < fit->found.size(); ++start) fit->found[start].start = int(start);
    const auto look_about = [&] {
        for (const auto& fit : fits) fit->sample.look_about(fit->found, options, limit);
    };
    auto done = together([](const Fit& fit) { return fit.sample.to_grow_on(); },
                         [&](Batches& batches, std::span<BatchedCandidate> all) {
                             return grow(batches, options, limit, all, reporter);
                         });
    if (!done) return done;
    const bool has_views = !fits[0]->observations.views.empty();
    for (const Round& round : rounds_of(fits[0]->observations)) {
        look_about();
        for (const auto& fit : fits) fit->found.resize(std::size_t(round.candidates(options)));
        done = together([&](const Fit& fit) { return fit.sample.to_search(round.starts == 1); },
                        [&](Batches& batches, std::span<BatchedCandidate> all) {
                            return improve(batches, options, limit, round.perturbations_until(options), all, reporter);
                        });
        if (!done) return done;
    }
    look_about();
    if (has_views) return Done{};
    for (const auto& fit : fits) fit->found.resize(std::min(fit->found.size(), k_polished));
    return together(
        [](const Fit& fit) { return fit.sample.to_polish(); },
        [&](Batches& batches, std::span<BatchedCandidate> all) { return polish(batches, options, limit, all); });
}

}  // namespace

Result<std::vector<PmFit>> fit_pm_in_batches(std::span<const Observations* const> observations,
                                             const FitOptions& options, Batches::Where where,
                                             const ProgressToken& progress) {
    const FlushSubnormals mode;
    double all = 0;
    for (const Observations* of : observations) {
        if (const auto valid = validate(*of, options); !valid) return valid.error();
        if (of->views.empty() != observations[0]->views.empty())
            return Error{"fit", {}, "observations", "with views, or without any", "both", ErrorCode::argument};
        all += work_of(*of, options).all();
    }
    Reporter reporter(progress, all);
    std::vector<PmFit> done(observations.size());
    Result<Done> searched = Done{};
    on_threads(options.threads, [&] {
        std::vector<std::unique_ptr<Fit>> fits(observations.size());
        parallel_for(fits.size(), [&](std::size_t i) {
            fits[i] = std::unique_ptr<Fit>(new Fit{*observations[i], options, reporter});
        });
        searched = search(fits, options, where);
        if (!searched) return;
        parallel_for(fits.size(), [&](std::size_t i) {
            done[i] = observations[i]->views.empty() ? fits[i]->best_finished() : fits[i]->seen();
            if (!reporter.advance("polishing", fits[i]->work.polish)) done[i].stop = StopReason::cancelled;
        });
    });
    if (!searched) return searched.error();
    return done;
}

Result<PmFit> fit_pm(const Observations& observations, const FitOptions& options, const ProgressToken& progress) {
    const FlushSubnormals mode;
    if (const auto valid = validate(observations, options); !valid) return valid.error();
    if (options.device == Device::cuda) {
        const Observations* const one = &observations;
        auto fits = fit_pm_in_batches({&one, 1}, options, Batches::Where::cuda, progress);
        if (!fits) return fits.error();
        return std::move(fits->front());
    }
    Reporter reporter(progress, work_of(observations, options).all());
    PmFit fit;
    on_threads(options.threads, [&] {
        Fit whole{observations, options, reporter};
        whole.search();
        if (!observations.views.empty()) {
            fit = whole.seen();
        } else {
            whole.polish_best();
            fit = whole.best_finished();
        }
        if (!reporter.advance("polishing", whole.work.polish)) fit.stop = StopReason::cancelled;
    });
    return fit;
}

}  // namespace srbf
