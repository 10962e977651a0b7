#include <fmt/format.h>

#include <algorithm>

#include "base/errors.h"
#include "base/half.h"
#include "base/levenberg_marquardt.h"
#include "base/parallel.h"
#include "models/pm/search/finish.h"
#include "models/pm/search/fit_pm.h"
#include "models/pm/search/schedule.h"
#include "models/pm/search/search.h"
#include "models/pm/search/subsets.h"
#include "models/pm/solve/rounding.h"
#include "observe/point_lights.h"
#include "srbf/elementary.h"

namespace srbf {

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

/// After the best candidate another one is finished only if its error is at most this much larger.
constexpr double k_nearly_best = 0.01;
/// The cost of point lights is relative to the loss of the pairs. Errors that the last stage's rows missed count in that
/// loss up to this many times its least value: a lobe between the rows can raise it by thousands.
constexpr double k_missed = 10;

Result<Done> validate(const Observations& observations, const FitOptions& options) {
    for (const auto& result : {require_range("fit", "number of lobes", options.lobes, 1, k_most_fitted_lobes),
                               require_range("fit", "number of variates", options.variates, 1, int(k_most_variates)),
                               require_range("fit", "number of starts", starts_of(options), 1, 1000),
                               require_range("fit", "number of perturbations", perturbations_of(options), 0, 100000),
                               require_range("fit", "number of threads", options.threads, 0, 1024)})
        if (!result) return result.error();
    if (!(options.finest >= 0 && options.finest < 1))
        return argument_error("fit", "finest width", "0 to 1 radian", fmt::format("{}", options.finest));
    if (!options.log_scale && options.form != PmForm::gaussian)
        return argument_error("fit", "log scale", "one, in all forms but gaussian", "none");
    if (options.reciprocal && options.variates % 2 == 1)
        return argument_error("fit", "number of variates", "an even one, for a reciprocal model",
                              fmt::format("{}", options.variates));
    return validate(observations, parameter_count(options));
}

double log_peak_limit_of(const FitOptions& options) {
    return options.log_scale ? k_log_peak_limit : elementary::log(double(k_half_max));
}

/// Work of a fit in grown lobes and perturbations: of the search, and of what follows.
struct Effort {
    double search = 0, rest = 0, polish = 0;  ///< polish: of each stage between the search and the last
    double all() const { return search + 2 * rest; }
};
bool is_polish(const Stage& stage) { return stage.work == StageKind::by_pictures || stage.work == StageKind::polish; }
Effort effort_of(const Observations& observations, const FitOptions& options) {
    int perturbations = 0, before = 0, polishes = 0;
    for (const Stage& stage : schedule(!observations.views.empty())) {
        polishes += is_polish(stage);
        if (stage.work != StageKind::perturb) continue;
        const int until = stage.perturbations_until(options);
        perturbations += int(stage.candidates(options)) * (until - before);
        before = until;
    }
    constexpr double k_rest = 0.2;  // of the perturbations, as measured
    const double rest = k_rest * perturbations + 1;
    return {double(starts_of(options) * options.lobes + perturbations), rest, rest / polishes};
}

/// The fit of one material, on the threads of the caller's `on_threads`.
class Fit {
  public:
    /// The candidates are those of the options' starts, or the lobes of `begin`.
    Fit(const Observations& observations, const FitOptions& options, const PmModel* begin, Reporter& reporter)
        : observations_(observations), options_(options), reporter_(reporter) {
        found_.resize(begin ? 1 : std::size_t(starts_of(options)));
        for (std::size_t start = 0; start < found_.size(); ++start) found_[start].start = int(start);
        if (begin) found_[0].lobes = to_lobes(*begin, shape_of(options));
    }

    /// A stage before the last, a candidate a thread.
    void search(const Stage& stage) {
        if (stage.work == StageKind::by_pictures && reporter_.cancelled()) return;
        prepare(stage);
        const Rows rows = rows_of(stage);
        parallel_for(found_.size(), [&](std::size_t i) {
            LobeProblem problem(rows, shape_of(options_), false, log_peak_limit_);
            search(stage, problem, found_[i]);
        });
        std::ranges::stable_sort(found_, {}, &Candidate::loss);
        if (stage.work == StageKind::by_pictures) last_ = &stage;
        if (is_polish(stage)) reporter_.advance("polishing", effort_.polish);
    }
    /// The last stage: the first candidate, or of those that are nearly as good the best. Of noisy tables the best of all that are
    /// left: albedos cost most then, and pictures do not show which candidate can follow them.
    PmFit finished(const Stage& stage) {
        if (stage.lights) add_point_lights(stage);
        if (!stage.pictures) sort_by_all();
        const bool is_noisy = observations_.is_noisy();
        if (!is_noisy) found_.resize(std::min(found_.size(), stage.most));
        PmFit fit;
        for (std::size_t i = 0; i < found_.size(); ++i) {
            const bool may_be_best = i == 0 || is_noisy || found_[i].loss <= (1 + k_nearly_best) * fit.loss;
            if (!may_be_best || (i > 0 && reporter_.cancelled())) break;
            const double channels = spectral() ? double(observations_.wavelengths.size()) : 3;
            TermFactors factors = factors_;
            factors.integrals = subsets_.integral_importance(factors_.has_point_lights) * 3 / channels;
            PmFit next = finish(found_[i].lobes, all(), factors, options_, log_peak_limit_, reporter_);
            if (i == 0 || next.loss < fit.loss) fit = std::move(next);
        }
        if (!reporter_.advance("polishing", effort_.rest)) fit.stop = StopReason::cancelled;
        return fit;
    }

  private:
    /// Candidates and weights for a stage.
    void prepare(const Stage& stage) {
        if (stage.bounds) subsets_.add_exceeded(found_, options_, log_peak_limit_);
        if (stage.lights) add_point_lights(stage);
        found_.resize(std::min(found_.size(), stage.candidates(options_)));
    }
    Rows rows_of(const Stage& stage) const {
        if (stage.pairs != Pairs::all) return subsets_.rows(stage, factors_.pictures);
        return Rows(all(), {.integral_importance = subsets_.integral_importance(factors_.has_point_lights),
                            .picture_importance = stage.pictures ? factors_.pictures : 0});
    }

    void search(const Stage& stage, LobeProblem& problem, Candidate& candidate) const {
        switch (stage.work) {
            case StageKind::grow:
                return grow(problem, options_, candidate, reporter_);
            case StageKind::perturb:
                return perturb(problem, options_, stage.perturbations_until(options_), candidate, reporter_);
            case StageKind::polish:
                return polish(problem, options_, stage.steps, candidate);
            case StageKind::by_pictures:
                if (!reporter_.cancelled()) take_steps(problem, stage.steps, candidate);
                return;
            case StageKind::finish:  // of all candidates: `finished`
                return;
        }
    }
    /// Afterwards candidates are ordered by their pictures.
    void take_steps(LobeProblem& problem, int steps, Candidate& candidate) const {
        Eigen::VectorXd x = pack(candidate.lobes);
        levenberg_marquardt(problem, x, {.max_iterations = steps});
        candidate.lobes = unpack(x, candidate.lobes.shape);
        candidate.loss = problem.delta_e();
    }
    bool spectral() const { return !observations_.wavelengths.empty(); }
    const Observations& all() const { return with_lights_.f.empty() ? observations_ : with_lights_; }

    /// Adds weights of point lights, where there are any: to a subset before the first pictures, later to all
    /// observations.
    void add_point_lights(const Stage& stage) {
        if (stage.pairs != Pairs::all) {
            subsets_.add_point_lights(fitted(rows_of(stage)));  // without pixels, which have no importance yet
            factors_.pictures = subsets_.picture_importance(found_.front(), stage, options_, log_peak_limit_);
            factors_.has_point_lights = !spectral() && !observations_.point_light_weight.empty();
        } else if (factors_.has_point_lights && last_) {  // cancelled, there may have been no steps
            with_lights_ = observations_;
            const double least = loss_of(observations_, fitted(Rows(observations_)));
            srbf::add_point_lights(with_lights_, fitted(rows_of(*last_)), k_missed * least);
        }
    }
    /// The best candidate, with coefficients for these rows.
    Evaluate fitted(const Rows& rows) const {
        LobeProblem problem(rows, shape_of(options_), true, log_peak_limit_);
        problem.loss(pack(found_.front().lobes));
        return evaluator(to_model(problem, found_.front().lobes, options_.log_scale, {}));
    }
    void sort_by_all() {
        const Rows all(observations_, {.integral_importance = subsets_.integral_importance()});
        LobeProblem problem(all, shape_of(options_), true, log_peak_limit_);
        for (Candidate& candidate : found_) candidate.loss = problem.loss(pack(candidate.lobes));
        std::ranges::stable_sort(found_, {}, &Candidate::loss);
    }

    const Observations& observations_;
    const FitOptions& options_;
    Reporter& reporter_;
    std::vector<Candidate> found_;
    double log_peak_limit_ = log_peak_limit_of(options_);
    Effort effort_ = effort_of(observations_, options_);
    Subsets subsets_{observations_};
    Observations with_lights_;  ///< all observations, once their weights have those of point lights
    TermFactors factors_;
    const Stage* last_ = nullptr;  ///< the last stage of steps
};

}  // namespace

Result<PmFit> fit_pm(const Observations& observations, const FitOptions& options, const ProgressToken& progress,
                     const PmModel* begin) {
    const StandardArithmetic mode;
    if (const auto valid = validate(observations, options); !valid) return valid.error();
    Reporter reporter(progress, effort_of(observations, options).all());
    PmFit done;
    on_threads(options.threads, [&] {
        Fit fit(observations, options, begin, reporter);
        for (const Stage& stage : schedule(!observations.views.empty())) {
            if (begin && (stage.work == StageKind::grow || stage.work == StageKind::perturb)) continue;
            if (stage.work == StageKind::finish)
                done = fit.finished(stage);
            else
                fit.search(stage);
        }
    });
    return done;
}

}  // namespace srbf
