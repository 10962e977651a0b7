#include "models/pm/search/fit_pm.h"

#include <bit>

#include "base/errors.h"
#include "base/levenberg_marquardt.h"
#include "base/parallel.h"
#include "models/pm/search/search.h"
#include "models/pm/search/subsets.h"
#include "models/pm/solve/rounding.h"

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

constexpr int k_max_perturbations = 100000;
/// By pairs alone, this many candidates take these last steps, and at most so many of them are finished.
constexpr std::size_t k_polished = 4, k_finished = 3;
constexpr int k_polish_steps = 25;
/// A candidate after the best one is finished only if its error is at most this fraction larger.
constexpr double k_nearly_best = 0.01;
/// If pictures of the best candidate have a larger ΔE_ITP, which is visible at once, all candidates that remain are
/// finished: the last steps change such pictures much, and so the order of the candidates.
constexpr double k_visible_at_once = 10;
/// How pictures choose: this fraction of the starts remains, and takes so many steps. The best candidate after all
/// steps is nearly always among the best ones after three.
struct Ranking {
    double fraction;
    int steps;
};
constexpr Ranking k_rankings[] = {{1, 3}, {0.25, 4}, {0.125, 8}};

Result<Done> validate(const Observations& observations, const PmFitOptions& options) {
    if (const auto effort = require_range("fit", "effort", options.effort, k_min_effort, k_max_effort); !effort)
        return effort.error();
    for (const auto& result :
         {require_range("fit", "number of lobes", options.lobes, 1, k_max_fitted_lobes),
          require_range("fit", "number of variates", options.variates, 1, int(k_max_variates)),
          require_range("fit", "number of starts", options.starts.value_or(1), 1, k_max_starts),
          require_range("fit", "number of perturbations", options.perturbations.value_or(0), 0, k_max_perturbations),
          require_range("fit", "number of threads", options.threads, 0, k_max_threads)})
        if (!result) return result.error();
    if (!(options.finest >= 0 && options.finest < 1))
        return argument_error("fit", "finest width", "0 to 1 radian", fmt::format("{}", options.finest));
    return validate(observations, parameter_count(options));
}

/// A stage of the perturbations of a fit. The first `fraction` of the starts, but at least `min` if there are that
/// many, are perturbed on the rows of `pairs` until each candidate has had the fraction `until` of the options' number.
struct Perturbations {
    RowSet pairs;
    double fraction, until;
    std::size_t min = 1;
};
constexpr Perturbations k_by_pairs[] = {
    {RowSet::search, 1, 0.2}, {RowSet::selection, 0.5, 0.5}, {RowSet::selection, 0.25, 1}};
/// Candidates with the same loss of pairs look different, and further perturbations hardly lower that loss: half
/// of the candidates remain for pictures to choose from.
constexpr Perturbations k_by_pictures[] = {{RowSet::search, 1, 0.12}, {RowSet::search, 0.5, 0.28, 6}};

/// Number of pairs while there are many candidates; in a short search about ten for each parameter.
std::size_t search_pairs(const Observations& observations, const PmFitOptions& options) {
    if (!has_short_search(options) || observations.is_noisy()) return k_search_pairs;
    return std::clamp(std::bit_ceil(10 * parameter_count(options)), k_search_pairs / 2, k_search_pairs);
}

std::size_t count_of(double fraction, const PmFitOptions& options) {
    return std::size_t(std::max(std::lround(fraction * starts_of(options)), 1L));
}
std::size_t count_of(const Perturbations& stage, const PmFitOptions& options) {
    return std::max(count_of(stage.fraction, options), std::min(stage.min, count_of(1, options)));
}
int until(const Perturbations& stage, const PmFitOptions& options) {
    return int(std::lround(stage.until * perturbations_of(options)));
}

/// WorkUnits of a fit in units of grown lobes and perturbations. The steps after the search, and the last ones, each take a
/// fifth of the time of the perturbations.
struct WorkUnits {
    double search = 0, polish = 0;
    double total() const { return search + 2 * polish; }
};
WorkUnits planned_work(const Observations& observations, const PmFitOptions& options) {
    constexpr double k_polish = 0.2;
    int count = 0, previous = 0;
    using Stages = std::span<const Perturbations>;
    for (const Perturbations& stage : observations.views.empty() ? Stages(k_by_pairs) : Stages(k_by_pictures)) {
        const int next = until(stage, options);
        count += int(count_of(stage, options)) * (next - previous);
        previous = next;
    }
    return {double(starts_of(options) * options.lobes + count), k_polish * count + 1};
}

/// The search for the lobes of one material. Runs on the threads of the caller's `on_threads`.
class StagedSearch {
  public:
    /// Makes a candidate for each start of the options, or one with the lobes of `initial_model`.
    StagedSearch(const Observations& observations, const PmFitOptions& options, const PmModel* initial_model,
                 Reporter& reporter)
        : observations_(observations), options_(options), reporter_(reporter), begins_from_model_(initial_model) {
        candidates_.resize(initial_model ? 1 : std::size_t(starts_of(options)));
        for (std::size_t start = 0; start < candidates_.size(); ++start) candidates_[start].start = int(start);
        if (initial_model) candidates_[0].lobes = to_lobes(*initial_model, shape_of(options));
    }

    /// Fits with pairs and albedos only. A candidate after the best one is finished only if its error is at most 1 %
    /// larger: the last steps lower the loss by 1 to 4 %.
    PmFit by_pairs() {
        grow_all();
        perturb_all(k_by_pairs);
        add_exceeded_pairs();
        keep(k_polished);
        for_candidates(subsets_.rows(RowSet::polish, {}), [&](LobeProblem& problem, Candidate& candidate) {
            polish(problem, options_, k_polish_steps, candidate);
        });
        reporter_.advance("polishing", work_.polish);
        sort_by_all_pairs();
        return finish_best(k_finished, {.integral_importance = subsets_.integral_importance()});
    }

    /// Fits with pictures.
    PmFit by_pictures() {
        grow_all();
        perturb_all(k_by_pictures);
        if (!reporter_.cancelled()) add_exceeded_pairs();
        const double importance = subsets_.picture_importance(candidates_.front());
        for (const auto& [fraction, steps] : k_rankings) {
            keep(count_of(fraction, options_));
            rank_by_pictures(steps, importance);
        }
        return finish_best(1,
                           {.integral_importance = subsets_.integral_importance(), .picture_importance = importance});
    }

  private:
    /// Calls advance(problem, candidate) with a problem on these rows, with one candidate per thread, and orders the
    /// candidates by their loss.
    template <typename Advance> void for_candidates(const PackedObservations& rows, const Advance& advance) {
        parallel_for(candidates_.size(), [&](std::size_t i) {
            LobeProblem problem(rows, shape_of(options_), false);
            advance(problem, candidates_[i]);
        });
        std::ranges::stable_sort(candidates_, {}, &Candidate::loss);
    }
    void grow_all() {
        for_candidates(
            subsets_.rows(RowSet::search, {.albedos = false}),
            [&](LobeProblem& problem, Candidate& candidate) { srbf::grow(problem, options_, candidate, reporter_); });
    }
    void perturb_all(std::span<const Perturbations> all) {
        if (begins_from_model_) return;
        for (const Perturbations& stage : all) {
            keep(count_of(stage, options_));
            add_exceeded_pairs();
            for_candidates(subsets_.rows(stage.pairs, {}), [&](LobeProblem& problem, Candidate& candidate) {
                srbf::perturb(problem, options_, until(stage, options_), candidate, reporter_);
            });
        }
    }
    void add_exceeded_pairs() { subsets_.add_exceeded_pairs(candidates_, shape_of(options_)); }
    /// Keeps at most the `count` best candidates.
    void keep(std::size_t count) { candidates_.resize(std::min(candidates_.size(), count)); }

    /// Takes steps, and orders the candidates by the mean ΔE_ITP of their pictures.
    void rank_by_pictures(int steps, double importance) {
        if (reporter_.cancelled()) return;
        for_candidates(subsets_.rows(RowSet::selection, {.pictures = importance}),
                       [&](LobeProblem& problem, Candidate& candidate) {
                           if (reporter_.cancelled()) return;
                           Eigen::VectorXd x = pack(candidate.lobes);
                           levenberg_marquardt(problem, x, {.max_iterations = steps});
                           candidate.lobes = unpack(x, candidate.lobes.shape);
                           candidate.loss = problem.delta_e();
                       });
        reporter_.advance("polishing", work_.polish / double(std::size(k_rankings)));
    }
    void sort_by_all_pairs() {
        const PackedObservations rows = subsets_.rows(RowSet::all, {});
        LobeProblem problem(rows, shape_of(options_), true);
        for (Candidate& candidate : candidates_) candidate.loss = problem.loss(pack(candidate.lobes));
        std::ranges::stable_sort(candidates_, {}, &Candidate::loss);
    }

    /// Finishes the first candidate, and further ones of `max` that are nearly as good, and returns the best. Finishes
    /// all remaining candidates for noisy tables, where albedos cost most and pictures do not show which candidate can
    /// follow them, and if pictures of the best one are far off; then pictures choose.
    PmFit finish_best(std::size_t max, const PackingOptions& terms) {
        const bool is_noisy = observations_.is_noisy();
        const bool is_far_off =
            !is_noisy && terms.picture_importance > 0 && candidates_.front().loss > k_visible_at_once;
        const bool finishes_all = is_noisy || is_far_off;
        if (!finishes_all) keep(max);
        PmFit fit;
        for (std::size_t i = 0; i < candidates_.size(); ++i) {
            const bool may_be_best = i == 0 || finishes_all || candidates_[i].loss <= (1 + k_nearly_best) * fit.loss;
            if (!may_be_best || (i > 0 && reporter_.cancelled())) break;
            PmFit next = srbf::finish(candidates_[i].lobes, observations_, terms, options_, reporter_);
            const bool is_better = is_far_off ? next.delta_e < fit.delta_e : next.loss < fit.loss;
            if (i == 0 || is_better) fit = std::move(next);
        }
        if (!reporter_.advance("polishing", work_.polish)) fit.stop = StopReason::cancelled;
        return fit;
    }

    const Observations& observations_;
    const PmFitOptions& options_;
    Reporter& reporter_;
    bool begins_from_model_;
    std::vector<Candidate> candidates_;
    WorkUnits work_ = planned_work(observations_, options_);
    Subsets subsets_{observations_, search_pairs(observations_, options_)};
};

}  // namespace

Result<PmFit> fit_pm(const Observations& observations, const PmFitOptions& options, const ProgressToken& progress,
                     const PmModel* initial_model) {
    const StandardArithmetic mode;
    if (const auto valid = validate(observations, options); !valid) return valid.error();
    Reporter reporter(progress, planned_work(observations, options).total());
    PmFit done;
    on_threads(options.threads, [&] {
        StagedSearch search(observations, options, initial_model, reporter);
        done = observations.views.empty() ? search.by_pairs() : search.by_pictures();
    });
    return done;
}

}  // namespace
