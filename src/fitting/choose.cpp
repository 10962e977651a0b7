#include "srbf/choose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "fit/search/search.h"
#include "fitting/choose.h"
#include "parallel.h"
#include "srbf/elementary.h"

namespace srbf {
namespace {

/// Effort of a short fit.
struct Look {
    std::size_t rows;
    int starts, perturbations;
};
constexpr Look k_glance{4096, 2, 2}, k_look{8192, 4, 8};
/// Numbers of kinds that get the second short fit, and of models that get full fits: two, and a third one if the error
/// of its short fit is at most so many times the least.
constexpr std::size_t k_looked_at = 8, k_fitted_whole = 2;
constexpr double k_as_promising = 1.2;

/// Expected ratio of the error of a full fit to that of its first short fit, before one is known. For the most
/// promising kinds it is 0.75 to 1.
constexpr double k_of_glance = 0.75;
/// In the search for the smallest model: the number of kinds that get first short fits once enough sizes are known, of
/// kinds for which all sizes are tried, and of full fits per doubling of the bytes.
constexpr std::size_t k_some_kinds = 8, k_few_kinds = 2, k_most_whole = 3;
constexpr std::size_t k_telling_bytes = 64;

/// A kind of model: everything but J.
struct Kind {
    PmForm form;
    bool axial;
    int variates;

    FitOptions with_lobes(FitOptions options, int lobes) const {
        options.form = form;
        options.axial = axial;
        options.variates = variates;
        options.lobes = lobes;
        if (form != PmForm::gaussian) options.log_scale = true;
        return options;
    }
    std::size_t bytes(int lobes, bool log_scale) const {
        return payload_bytes(form, axial, log_scale || form != PmForm::gaussian, lobes, variates);
    }
    /// The largest number of lobes within a number of bytes, possibly 0.
    int most_lobes(std::size_t within, bool log_scale) const {
        int lobes = 0;
        while (lobes < k_most_fitted_lobes && bytes(lobes + 1, log_scale) <= within) ++lobes;
        return lobes;
    }
};

std::vector<Kind> kinds(const FitOptions& options) {
    std::vector<Kind> all;
    for (const PmForm form : k_forms)
        for (const bool axial : {true, false})
            for (int n = 1; n <= k_most_chosen_variates; ++n)
                if ((axial || !options.axial) && !(options.reciprocal && n % 2 == 1) &&
                    (options.log_scale || form == PmForm::gaussian))
                    all.push_back({form, axial, n});
    return all;
}

Kind kind_of(const Step& step) { return {step.form, step.axial, step.variates}; }

bool by_error(const Step& a, const Step& b) { return a.error < b.error; }
bool by_bytes(const Step& a, const Step& b) { return a.bytes != b.bytes ? a.bytes < b.bytes : a.error < b.error; }

/// Fits and judges models.
class Search {
  public:
    Search(const Observations& observations, const FitOptions& options, const JudgeModel& judge,
           const ProgressToken& progress)
        : observations_(observations), options_(options), judge_(judge), progress_(progress) {}

    struct Tried {
        Step step;
        PmFit fit;
    };

    /// Short fits of these kinds and numbers of lobes in parallel, most promising first.
    Result<std::vector<Step>> in_short(const std::vector<std::pair<Kind, int>>& asked, const Look& look) {
        const Observations some = beginning(observations_, look.rows);
        std::vector<Result<Tried>> tried(asked.size(), Error{});
        parallel_for(asked.size(), options_.threads, [&](std::size_t i) {
            const FitOptions options = asked[i].first.with_lobes(options_, asked[i].second);
            tried[i] = attempt(some, srbf::in_short(options, look.starts, look.perturbations), true);
        });
        std::vector<Step> steps;
        for (const auto& one : tried) {
            if (!one) return one.error();
            steps.push_back(one->step);
        }
        path_.insert(path_.end(), steps.begin(), steps.end());
        std::stable_sort(steps.begin(), steps.end(), by_error);
        return steps;
    }
    /// A first short fit of each of these kinds with the largest number of lobes within the bytes; nothing for kinds
    /// without one.
    Result<std::vector<Step>> glance(const std::vector<Kind>& of, std::size_t bytes) {
        std::vector<std::pair<Kind, int>> asked;
        for (const Kind& kind : of)
            if (const int most = kind.most_lobes(bytes, options_.log_scale); most > 0) asked.emplace_back(kind, most);
        return in_short(asked, k_glance);
    }

    Result<Tried> whole(const Step& step) {
        auto tried = attempt(observations_, kind_of(step).with_lobes(options_, step.lobes), false);
        if (tried) path_.push_back(tried->step);
        return tried;
    }

    bool report(double fraction) {
        done_ = fraction;
        return progress_.report("choosing a size", fraction);
    }
    std::vector<Step> path() const {
        // If a model has both a short and a full fit, the full fit counts.
        std::map<std::tuple<std::size_t, PmForm, bool, int, int>, Step> best;
        for (const Step& step : path_) {
            auto& at = best[{step.bytes, step.form, step.axial, step.variates, step.lobes}];
            if (at.lobes == 0 || step.whole) at = step;
        }
        std::vector<Step> sorted;
        for (const auto& [key, step] : best) sorted.push_back(step);
        return sorted;
    }

  private:
    Result<Tried> attempt(const Observations& observations, const FitOptions& options, bool in_short) {
        auto fit = fit_pm(observations, options, progress_.part(done_, done_));
        if (!fit) return fit.error();
        const double error = judge_(fit->model, in_short);
        const Step step{options.form, options.axial, options.lobes, options.variates, payload_bytes(fit->model),
                        error,        !in_short};
        return Tried{step, *std::move(fit)};
    }

    const Observations& observations_;
    FitOptions options_;
    const JudgeModel& judge_;
    ProgressToken progress_;
    double done_ = 0;  // share of the whole that is complete
    std::vector<Step> path_;
};

Result<Search::Tried> found_or_cancelled(std::optional<Search::Tried>& best) {
    if (!best)
        return Error{
            "fit", {}, "models that were tried", "one at least", "none before it was cancelled", ErrorCode::cancelled};
    return *std::move(best);
}

/// The least error within the bytes; each kind has the largest number of lobes that fits.
Result<Search::Tried> within_bytes(Search& search, const FitOptions& options, std::size_t bytes) {
    auto steps = search.glance(kinds(options), bytes);
    if (!steps) return steps.error();
    if (steps->empty())
        return Error{"fit", {}, "bytes", "enough for one lobe, 12", fmt::format("{}", bytes), ErrorCode::argument};
    if (search.report(0.2)) {
        std::vector<std::pair<Kind, int>> asked;
        for (std::size_t i = 0; i < std::min(k_looked_at, steps->size()); ++i)
            asked.emplace_back(kind_of((*steps)[i]), (*steps)[i].lobes);
        steps = search.in_short(asked, k_look);
        if (!steps) return steps.error();
    }
    std::optional<Search::Tried> best;
    std::size_t count = std::min(k_fitted_whole, steps->size());
    if (count < steps->size() && (*steps)[count].error <= k_as_promising * steps->front().error) ++count;
    for (std::size_t i = 0; i < count && search.report(0.4 + 0.6 * double(i) / double(count)); ++i) {
        auto tried = search.whole((*steps)[i]);
        if (!tried) return tried;
        if (tried->step.bytes <= bytes && (!best || by_error(tried->step, best->step))) best = *std::move(tried);
    }
    return found_or_cancelled(best);
}

/// Whether a model replaces the best: a model that reaches the error must be smaller than a best that does; a model
/// that does not must have a smaller error than a best that does not.
bool is_better(const Step& step, const std::optional<Search::Tried>& best, double error) {
    if (!best) return true;
    const bool reaches = step.error <= error, best_reaches = best->step.error <= error;
    return reaches ? !best_reaches || by_bytes(step, best->step) : !best_reaches && by_error(step, best->step);
}

/// The fewest bytes for at most that error. The bytes are doubled until short fits of the kinds' largest models predict
/// that one may reach the error, or that none would even if each further doubling lowered the error as much as the last
/// one. For the most promising kinds all sizes down to the previous number of bytes get short fits. The smallest model
/// that is expected to reach the error gets a full fit, which corrects the expectation for the others; and so on.
Result<Search::Tried> within_error(Search& search, const FitOptions& options, double error, bool& reached) {
    std::optional<Search::Tried> best;
    reached = false;
    double expected = k_of_glance;  // ratio of the errors of full fits to those of short fits
    const auto fit_whole = [&](const Step& step) -> Result<Done> {
        auto tried = search.whole(step);
        if (!tried) return tried.error();
        expected = tried->step.error / step.error;
        if (is_better(tried->step, best, error)) best = *std::move(tried);
        reached = best->step.error <= error;
        return Done{};
    };
    std::vector<Kind> of = kinds(options);
    double before_error = std::numeric_limits<double>::infinity();
    for (std::size_t before = 0, bytes = 32; !reached; before = bytes, bytes *= 2) {
        const auto glanced = search.glance(of, bytes);
        if (!glanced) return glanced.error();
        const double doublings = elementary::log2(double(k_most_chosen_bytes) / double(bytes)),
                     now = glanced->front().error,
                     at_most = now * elementary::pow(std::min(now / before_error, 1.0), doublings);
        const bool last = doublings < 1 || (before >= k_telling_bytes && k_of_glance * at_most > error);
        before_error = now;
        if (!search.report(0.1 * elementary::log2(double(bytes) / 16))) break;
        if (k_of_glance * now > error) {
            if (!last) {
                if (bytes >= k_telling_bytes) {
                    of.clear();
                    for (std::size_t i = 0; i < std::min(k_some_kinds, glanced->size()); ++i)
                        of.push_back(kind_of((*glanced)[i]));
                }
                continue;
            }
            if (const auto done = fit_whole(glanced->front()); !done) return done.error();
            break;
        }

        std::vector<std::pair<Kind, int>> asked;
        for (std::size_t i = 0; i < std::min(k_few_kinds, glanced->size()); ++i) {
            const Kind kind = kind_of((*glanced)[i]);
            for (int lobes = (*glanced)[i].lobes - 1; lobes > 0 && kind.bytes(lobes, options.log_scale) > before;
                 --lobes)
                asked.emplace_back(kind, lobes);
        }
        auto smaller = search.in_short(asked, k_glance);
        if (!smaller) return smaller.error();
        std::vector<Step> open = *std::move(smaller);
        open.insert(open.end(), glanced->begin(), glanced->end());
        std::stable_sort(open.begin(), open.end(), by_bytes);
        for (std::size_t whole = 0; whole < k_most_whole && !open.empty() && search.report(0.6); ++whole) {
            // The smallest model that is expected to reach the error; if there is none, the one that comes closest.
            auto next = std::find_if(open.begin(), open.end(),
                                     [&](const Step& step) { return expected * step.error <= error; });
            if (next == open.end()) {
                if (reached) break;
                next = std::min_element(open.begin(), open.end(), by_error);
            }
            const Step step = *next;
            open.erase(next);
            if (const auto done = fit_whole(step); !done) return done.error();
            if (reached) std::erase_if(open, [&](const Step& one) { return !by_bytes(one, best->step); });
        }
        if (last || !search.report(0.7)) break;
    }
    return found_or_cancelled(best);
}

}  // namespace

Result<Chosen> choose_pm(const Observations& observations, const FitOptions& options, const SizeGoal& goal,
                         const JudgeModel& judge, const ProgressToken& progress) {
    const FlushSubnormals mode;
    Search search(observations, options, judge, progress);
    Chosen chosen;
    const auto* budget = std::get_if<ByteBudget>(&goal);
    const auto* target = std::get_if<TargetError>(&goal);
    const auto* seen = std::get_if<TargetDeltaE>(&goal);
    const double error = target ? target->error : seen ? seen->delta_e : 1;
    if (budget && budget->bytes > k_most_chosen_bytes)
        return Error{"fit",
                     {},
                     "budget",
                     fmt::format("12 to {} bytes", k_most_chosen_bytes),
                     fmt::format("{}", budget->bytes),
                     ErrorCode::argument};
    if (!(error > 0 && error <= (seen ? k_most_delta_e : 1)))
        return Error{"fit",
                     {},
                     seen ? "target delta E" : "target error",
                     fmt::format("above 0, at most {}", seen ? k_most_delta_e : 1),
                     fmt::format("{}", error),
                     ErrorCode::argument};
    auto found =
        budget ? within_bytes(search, options, budget->bytes) : within_error(search, options, error, chosen.reached);
    if (!found) return found.error();
    chosen.fit = std::move(found->fit);
    chosen.path = search.path();
    return chosen;
}

}  // namespace srbf
