#include <fmt/format.h>

#include <algorithm>

#include "base/errors.h"
#include "base/levenberg_marquardt.h"
#include "base/parallel.h"
#include "models/pm/search/finish.h"
#include "models/pm/search/fit_pm.h"
#include "models/pm/search/schedule.h"
#include "models/pm/search/search.h"
#include "models/pm/search/subsets.h"
#include "models/pm/solve/rounding.h"
#include "observe/directional_lights.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {

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

/// A candidate after the best one is finished only if its error is at most this fraction larger.
constexpr double k_nearly_best = 0.01;
/// If pictures of the best candidate have a larger ΔE_ITP, which is visible at once, all candidates that remain are
/// finished: the last steps change such pictures much, and so the order of the candidates.
constexpr double k_visible_at_once = 10;
/// The cost of directional lights is relative to the loss of the pairs. Errors between the rows of the last stage
/// count in that loss only up to this multiple of its least value: a lobe between the rows can raise it by
/// thousands.
constexpr double k_missed = 10;

Result<Done> validate(const Observations& observations, const PmFitOptions& options) {
    if (const auto effort = require_range("fit", "effort", options.effort, k_least_effort, k_most_effort); !effort)
        return effort.error();
    for (const auto& result :
         {require_range("fit", "number of lobes", options.lobes, 1, k_most_fitted_lobes),
          require_range("fit", "number of variates", options.variates, 1, int(k_most_variates)),
          require_range("fit", "number of starts", options.starts.value_or(1), 1, k_most_starts),
          require_range("fit", "number of perturbations", options.perturbations.value_or(0), 0, 100000),
          require_range("fit", "number of threads", options.threads, 0, 1024)})
        if (!result) return result.error();
    if (!(options.finest >= 0 && options.finest < 1))
        return argument_error("fit", "finest width", "0 to 1 radian", fmt::format("{}", options.finest));
    if (!options.log_scale && options.form != PmForm::gaussian)
        return argument_error("fit", "log scale", "one, in all forms but gaussian", "none");
    return validate(observations, parameter_count(options));
}

/// Work of a fit in units of grown lobes and perturbations.
struct Work {
    double search = 0, finish = 0, polish = 0;  ///< polish: work of each stage between the search and the last
    double total() const { return search + 2 * finish; }
};
bool is_polish(const Stage& stage) { return stage.kind == StageKind::by_pictures || stage.kind == StageKind::polish; }
Work planned_work(const Observations& observations, const PmFitOptions& options) {
    int perturbations = 0, previous = 0, polishes = 0;
    for (const Stage& stage : schedule(!observations.views.empty())) {
        polishes += is_polish(stage);
        if (stage.kind != StageKind::perturb) continue;
        const int next = stage.perturbations_until(options);
        perturbations += int(stage.candidates(options)) * (next - previous);
        previous = next;
    }
    constexpr double k_finish = 0.2;  // fraction of the perturbations, as measured
    const double finish = k_finish * perturbations + 1;
    return {double(starts_of(options) * options.lobes + perturbations), finish, finish / polishes};
}

/// The fit of one material. Runs on the threads of the caller's `on_threads`.
class Fit {
  public:
    /// The candidates are those of the options' starts, or the lobes of `begin`.
    Fit(const Observations& observations, const PmFitOptions& options, const PmModel* begin, Reporter& reporter)
        : observations_(observations), options_(options), reporter_(reporter) {
        candidates_.resize(begin ? 1 : std::size_t(starts_of(options)));
        for (std::size_t start = 0; start < candidates_.size(); ++start) candidates_[start].start = int(start);
        if (begin) candidates_[0].lobes = to_lobes(*begin, shape_of(options));
    }

    /// A stage before the last, with one candidate per thread.
    void search(const Stage& stage) {
        if (stage.kind == StageKind::by_pictures && reporter_.cancelled()) return;
        prepare(stage);
        const Rows rows = rows_of(stage);
        parallel_for(candidates_.size(), [&](std::size_t i) {
            LobeProblem problem(rows, shape_of(options_), false, log_peak_limit_);
            search(stage, problem, candidates_[i]);
        });
        std::ranges::stable_sort(candidates_, {}, &Candidate::loss);
        if (stage.kind == StageKind::by_pictures) last_steps_ = &stage;
        if (is_polish(stage)) reporter_.advance("polishing", work_.polish);
    }
    /// The last stage. It finishes the first candidate, and further ones that are nearly as good, and returns the
    /// best. It finishes all remaining candidates for noisy tables, where albedos cost most and pictures do not show
    /// which candidate can follow them, and if pictures of the best one are far off; then pictures choose.
    PmFit finish(const Stage& stage) {
        if (stage.adds_directional_lights) add_directional_lights(stage);
        if (!stage.pictures) sort_by_all_pairs();
        const bool is_noisy = observations_.is_noisy();
        const bool is_far_off = !is_noisy && stage.pictures && candidates_.front().loss > k_visible_at_once;
        const bool finishes_all = is_noisy || is_far_off;
        if (!finishes_all) candidates_.resize(std::min(candidates_.size(), stage.max_candidates));
        PmFit fit;
        for (std::size_t i = 0; i < candidates_.size(); ++i) {
            const bool may_be_best = i == 0 || finishes_all || candidates_[i].loss <= (1 + k_nearly_best) * fit.loss;
            if (!may_be_best || (i > 0 && reporter_.cancelled())) break;
            TermFactors factors = factors_;
            factors.integrals = subsets_.integral_importance(factors_.has_directional_lights);
            PmFit next = srbf::finish(candidates_[i].lobes, weighted_observations(), factors, options_, reporter_);
            const bool is_better = is_far_off ? next.delta_e < fit.delta_e : next.loss < fit.loss;
            if (i == 0 || is_better) fit = std::move(next);
        }
        if (!reporter_.advance("polishing", work_.finish)) fit.stop = StopReason::cancelled;
        return fit;
    }

  private:
    /// Prepares the candidates and weights of a stage.
    void prepare(const Stage& stage) {
        if (stage.adds_exceeded_pairs) subsets_.add_exceeded_pairs(candidates_, options_, log_peak_limit_);
        if (stage.adds_directional_lights) add_directional_lights(stage);
        candidates_.resize(std::min(candidates_.size(), stage.candidates(options_)));
    }
    Rows rows_of(const Stage& stage) const {
        if (stage.pairs != Pairs::all) return subsets_.rows(stage, factors_.pictures);
        return Rows(weighted_observations(),
                    {.integral_importance = subsets_.integral_importance(factors_.has_directional_lights),
                     .picture_importance = stage.pictures ? factors_.pictures : 0});
    }

    void search(const Stage& stage, LobeProblem& problem, Candidate& candidate) const {
        switch (stage.kind) {
            case StageKind::grow:
                return grow(problem, options_, candidate, reporter_);
            case StageKind::perturb:
                return perturb(problem, options_, stage.perturbations_until(options_), candidate, reporter_);
            case StageKind::polish:
                return polish(problem, options_, stage.steps, candidate);
            case StageKind::by_pictures:
                if (!reporter_.cancelled()) take_steps(problem, stage.steps, candidate);
                return;
            case StageKind::finish:  // handled by `finish`
                return;
        }
    }
    /// Takes steps, and sets the loss to ΔE_ITP, so that candidates are ordered by their pictures.
    void take_steps(LobeProblem& problem, int steps, Candidate& candidate) const {
        Eigen::VectorXd x = pack(candidate.lobes);
        levenberg_marquardt(problem, x, {.max_iterations = steps});
        candidate.lobes = unpack(x, candidate.lobes.shape);
        candidate.loss = problem.delta_e();
    }
    const Observations& weighted_observations() const { return relit_.f.empty() ? observations_ : relit_; }

    /// Adds the weights of directional lights, if there are any: to a subset before the first stage with pictures,
    /// later to all observations.
    void add_directional_lights(const Stage& stage) {
        if (stage.pairs != Pairs::all) {
            // without pixels, whose importance is not known yet
            subsets_.add_directional_lights(evaluator_of_best(rows_of(stage)));
            factors_.pictures = subsets_.picture_importance(candidates_.front(), stage, options_, log_peak_limit_);
            factors_.has_directional_lights = !observations_.directional_light_weight.empty();
        } else if (factors_.has_directional_lights && last_steps_) {  // if cancelled, there may have been no steps
            relit_ = observations_;
            const double least = loss_of(observations_, evaluator_of_best(Rows(observations_)));
            srbf::add_directional_lights(relit_, evaluator_of_best(rows_of(*last_steps_)), k_missed * least);
        }
    }
    /// Evaluates the best candidate, with coefficients fitted to these rows.
    Evaluate evaluator_of_best(const Rows& rows) const {
        LobeProblem problem(rows, shape_of(options_), true, log_peak_limit_);
        problem.loss(pack(candidates_.front().lobes));
        return evaluator(to_model(problem, candidates_.front().lobes, options_.log_scale, {}));
    }
    void sort_by_all_pairs() {
        const Rows rows(observations_, {.integral_importance = subsets_.integral_importance()});
        LobeProblem problem(rows, shape_of(options_), true, log_peak_limit_);
        for (Candidate& candidate : candidates_) candidate.loss = problem.loss(pack(candidate.lobes));
        std::ranges::stable_sort(candidates_, {}, &Candidate::loss);
    }

    const Observations& observations_;
    const PmFitOptions& options_;
    Reporter& reporter_;
    std::vector<Candidate> candidates_;
    double log_peak_limit_ = log_peak_limit_of(options_);
    Work work_ = planned_work(observations_, options_);
    Subsets subsets_{observations_};
    Observations relit_;  ///< all observations, once their weights include directional lights; otherwise empty
    TermFactors factors_;
    const Stage* last_steps_ = nullptr;  ///< the last stage that took steps
};

}  // namespace

Result<PmFit> fit_pm(const Observations& observations, const PmFitOptions& options, const ProgressToken& progress,
                     const PmModel* begin) {
    const StandardArithmetic mode;
    if (const auto valid = validate(observations, options); !valid) return valid.error();
    Reporter reporter(progress, planned_work(observations, options).total());
    PmFit done;
    on_threads(options.threads, [&] {
        Fit fit(observations, options, begin, reporter);
        for (const Stage& stage : schedule(!observations.views.empty())) {
            if (begin && stage.kind == StageKind::perturb) continue;
            if (stage.kind == StageKind::finish)
                done = fit.finish(stage);
            else
                fit.search(stage);
        }
    });
    return done;
}

}  // namespace srbf
