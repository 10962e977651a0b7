#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "base/errors.h"
#include "base/parallel.h"
#include "fit/choose.h"
#include "fit/request_traits.h"
#include "fit/requests.h"
#include "models/pm/pm_functions.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

/// The rows of a short fit, and its work.
struct ShortFit {
    std::size_t rows;
    int starts, perturbations;
};
constexpr ShortFit k_shortest_fit{4096, 2, 2}, k_short_fit{8192, 4, 8};
/// Numbers of kinds that get the second short fit, and of models that get full fits: two, and a third one if the error
/// of its short fit is at most so many times the least.
constexpr std::size_t k_short_fits = 8, k_full_fits = 2;
constexpr double k_as_promising = 1.2;

/// Expected ratio of the error of a full fit to that of its shortest fit, before one is known. For the most promising
/// kinds it is 0.75 to 1.
constexpr double k_of_shortest = 0.75;
/// In the search for the smallest model: the number of kinds that continue once models of some size have told which are
/// promising, of kinds for which all trials are tried, and of full fits per doubling of the bytes.
constexpr std::size_t k_some_kinds = 8, k_few_kinds = 2, k_most_full_fits = 3;
constexpr std::size_t k_first_bytes = 32, k_conclusive_bytes = 64;
/// Where no size is expected to reach the error, doubling the bytes is worth while if it lowers the error below this
/// fraction.
constexpr double k_worth_doubling = 0.9;

/// Approximate progress after the short fits of each kind, and when the bytes have been doubled to the most.
constexpr double k_done_by_shortest = 0.2, k_done_by_short = 0.4, k_done_by_doubling = 0.1, k_done_by_doublings = 0.6;

/// The options of a model to try, of which a `Trial` has everything but the error; a *kind* is everything but J.
PmFitOptions with_model(PmFitOptions options, const Trial& model) {
    options.form = model.form;
    options.axial = model.axial;
    options.variates = model.variates;
    options.lobes = model.lobes;
    return options;
}
std::size_t bytes_of(const Trial& kind, int lobes) {
    return payload_bytes(kind.form, kind.axial, has_log_scales(kind.form), lobes, kind.variates);
}

std::vector<Trial> kinds(const PmFitOptions& options) {
    std::vector<Trial> all;
    for (const PmForm form : k_forms)
        for (const bool axial : {true, false})
            for (int n = 1; n <= k_most_chosen_variates; ++n)
                if (is_fitted(form) && (axial || !options.axial) && is_reciprocal(form) == is_reciprocal(options.form))
                    all.push_back({.form = form, .axial = axial, .variates = n});
    return all;
}
std::vector<Trial> first_of(const std::vector<Trial>& trials, std::size_t most) {
    return {trials.begin(), trials.begin() + std::ptrdiff_t(std::min(most, trials.size()))};
}

bool by_error(const Trial& a, const Trial& b) { return a.error < b.error; }
bool by_bytes(const Trial& a, const Trial& b) { return a.bytes != b.bytes ? a.bytes < b.bytes : a.error < b.error; }

struct Tried {
    Trial trial;
    PmFit fit;
};

/// Fits and judges models.
class Search {
  public:
    Search(const Observations& observations, const PmFitOptions& options, const JudgeModel& judge,
           const ProgressToken& progress)
        : observations_(observations), options_(options), judge_(judge), progress_(progress) {}

    const PmFitOptions& options() const { return options_; }

    /// Short fits in parallel, most promising first.
    Result<std::vector<Trial>> fit_in_short(const std::vector<Trial>& models, const ShortFit& short_fit) {
        const Observations some = beginning(observations_, short_fit.rows);
        std::vector<Result<Tried>> tried(models.size(), Error{});
        parallel_for(models.size(), options_.threads, [&](std::size_t i) {
            const PmFitOptions options = with_model(options_, models[i]);
            tried[i] = attempt(some, quick_options(options, short_fit.starts, short_fit.perturbations), true);
        });
        std::vector<Trial> trials;
        for (const auto& one : tried) {
            if (!one) return one.error();
            trials.push_back(one->trial);
        }
        path_.insert(path_.end(), trials.begin(), trials.end());
        std::ranges::stable_sort(trials, by_error);
        return trials;
    }
    /// The shortest fit of each of these kinds with the largest number of lobes within the bytes; nothing for kinds
    /// without one.
    Result<std::vector<Trial>> fit_largest(const std::vector<Trial>& kinds, std::size_t bytes) {
        std::vector<Trial> models;
        for (Trial model : kinds) {
            model.lobes = 0;
            while (model.lobes < k_most_fitted_lobes && bytes_of(model, model.lobes + 1) <= bytes) ++model.lobes;
            if (model.lobes > 0) models.push_back(model);
        }
        return fit_in_short(models, k_shortest_fit);
    }

    Result<Tried> fit_whole(const Trial& trial) {
        auto tried = attempt(observations_, with_model(options_, trial), false);
        if (tried) path_.push_back(tried->trial);
        return tried;
    }

    bool report(double fraction) {
        done_ = fraction;
        return progress_.report("choosing a size", fraction);
    }
    std::vector<Trial> path() const {
        // If a model has both a short and a full fit, the full fit counts.
        std::map<std::tuple<std::size_t, PmForm, bool, int, int>, Trial> best;
        for (const Trial& trial : path_) {
            auto& at = best[{trial.bytes, trial.form, trial.axial, trial.variates, trial.lobes}];
            if (at.lobes == 0 || trial.whole) at = trial;
        }
        std::vector<Trial> sorted;
        for (const auto& [key, trial] : best) sorted.push_back(trial);
        return sorted;
    }

  private:
    Result<Tried> attempt(const Observations& observations, const PmFitOptions& options, bool in_short) {
        auto fit = fit_pm(observations, options, progress_.part(done_, done_));
        if (!fit) return fit.error();
        const double error = judge_(fit->model, in_short);
        return Tried{trial_of(fit->model, error, !in_short), *std::move(fit)};
    }

    const Observations& observations_;
    PmFitOptions options_;
    const JudgeModel& judge_;
    ProgressToken progress_;
    double done_ = 0;  // share of the whole that is complete
    std::vector<Trial> path_;
};

Result<Chosen> chosen(const Search& search, std::optional<Tried>& best, bool reached) {
    if (best) return Chosen{std::move(best->fit), search.path(), reached};
    return Error{
        "fit", {}, "models that were tried", "one at least", "none before it was cancelled", ErrorCode::cancelled};
}

/// The least error within the bytes; each kind has the largest number of lobes that fits.
Result<Chosen> within_bytes(Search& search, std::size_t bytes) {
    const std::vector<Trial> all = kinds(search.options());
    auto trials = search.fit_largest(all, bytes);
    if (!trials) return trials.error();
    if (trials->empty()) {
        std::size_t least = k_most_chosen_bytes;
        for (const Trial& kind : all) least = std::min(least, bytes_of(kind, 1));
        return argument_error("fit", "budget", fmt::format("at least {} bytes, for one lobe", least),
                              fmt::format("{}", bytes));
    }
    if (search.report(k_done_by_shortest)) {
        trials = search.fit_in_short(first_of(*trials, k_short_fits), k_short_fit);
        if (!trials) return trials.error();
    }
    std::optional<Tried> best;
    std::size_t count = std::min(k_full_fits, trials->size());
    if (count < trials->size() && (*trials)[count].error <= k_as_promising * trials->front().error) ++count;
    for (std::size_t i = 0;
         i < count && search.report(k_done_by_short + (1 - k_done_by_short) * double(i) / double(count)); ++i) {
        auto tried = search.fit_whole((*trials)[i]);
        if (!tried) return tried.error();
        if (tried->trial.bytes <= bytes && (!best || by_error(tried->trial, best->trial))) best = *std::move(tried);
    }
    return chosen(search, best, true);
}

/// The fewest bytes for at most an error.
class SmallestWithin {
  public:
    SmallestWithin(Search& search, double error) : search_(search), error_(error), kinds_(kinds(search.options())) {}

    /// The bytes are doubled until shortest fits of the kinds' largest models predict that one may reach the error, or
    /// that none would even if each further doubling lowered the error as much as the last one. In that case bytes are
    /// doubled as long as that lowers the error much.
    Result<Chosen> run() {
        double error_before = std::numeric_limits<double>::infinity();
        for (std::size_t before = 0, bytes = k_first_bytes; !reached(); before = bytes, bytes *= 2) {
            const auto largest = search_.fit_largest(kinds_, bytes);
            if (!largest) return largest.error();
            const double doublings = elementary::log2(double(k_most_chosen_bytes) / double(bytes)),
                         now = largest->front().error,
                         at_most = now * elementary::pow(std::min(now / error_before, 1.0), doublings);
            const bool reachable = before < k_conclusive_bytes || k_of_shortest * at_most <= error_;
            const bool last = doublings < 1 || (!reachable && now > k_worth_doubling * error_before);
            error_before = now;
            if (!search_.report(k_done_by_doubling * elementary::log2(double(2 * bytes) / double(k_first_bytes))))
                break;
            if (k_of_shortest * now <= error_) {
                if (const auto done = fit_between(*largest, before); !done) return done.error();
                if (last || !search_.report(k_done_by_doublings + k_done_by_doubling)) break;
            } else if (last) {
                if (const auto done = fit_whole(largest->front()); !done) return done.error();
                break;
            } else if (bytes >= k_conclusive_bytes) {
                kinds_ = first_of(*largest, k_some_kinds);
            }
        }
        return chosen(search_, best_, reached());
    }

  private:
    bool reached() const { return best_ && best_->trial.error <= error_; }
    /// For the most promising kinds all sizes down to the previous number of bytes get shortest fits. The smallest
    /// model that is expected to reach the error gets a full fit, which corrects the expectation for the others; and so
    /// on.
    Result<Done> fit_between(const std::vector<Trial>& largest, std::size_t bytes_before) {
        std::vector<Trial> models;
        for (Trial model : first_of(largest, k_few_kinds))
            while (--model.lobes > 0 && bytes_of(model, model.lobes) > bytes_before) models.push_back(model);
        const auto smaller = search_.fit_in_short(models, k_shortest_fit);
        if (!smaller) return smaller.error();
        std::vector<Trial> open = *smaller;
        open.insert(open.end(), largest.begin(), largest.end());
        std::ranges::stable_sort(open, by_bytes);
        for (std::size_t fits = 0; fits < k_most_full_fits && !open.empty() && search_.report(k_done_by_doublings);
             ++fits) {
            auto next =
                std::ranges::find_if(open, [&](const Trial& trial) { return expected_ * trial.error <= error_; });
            if (next == open.end()) {
                if (reached()) break;
                next = std::ranges::min_element(open, by_error);  // comes closest
            }
            const Trial trial = *next;
            open.erase(next);
            if (const auto done = fit_whole(trial); !done) return done;
            if (reached()) std::erase_if(open, [&](const Trial& one) { return !by_bytes(one, best_->trial); });
        }
        return Done{};
    }

    Result<Done> fit_whole(const Trial& trial) {
        auto tried = search_.fit_whole(trial);
        if (!tried) return tried.error();
        expected_ = tried->trial.error / trial.error;
        if (is_better(tried->trial)) best_ = *std::move(tried);
        return Done{};
    }
    /// True if a model replaces the best: a model that reaches the error must be smaller than a best that does; a model
    /// that does not must have a smaller error than a best that does not.
    bool is_better(const Trial& trial) const {
        if (!best_) return true;
        if (trial.error <= error_) return !reached() || by_bytes(trial, best_->trial);
        return !reached() && by_error(trial, best_->trial);
    }

    Search& search_;
    const double error_;
    std::vector<Trial> kinds_;
    std::optional<Tried> best_;
    double expected_ = k_of_shortest;  // ratio of the errors of full fits to those of shortest fits
};

}  // namespace

Result<Chosen> choose_pm(const Observations& observations, const PmFitOptions& options, const SizeGoal& goal,
                         const JudgeModel& judge, const ProgressToken& progress) {
    const StandardArithmetic mode;
    Search search(observations, options, judge, progress);
    if (const auto* budget = std::get_if<ByteBudget>(&goal)) {
        if (budget->bytes > k_most_chosen_bytes)
            return argument_error("fit", "budget", fmt::format("12 to {} bytes", k_most_chosen_bytes),
                                  fmt::format("{}", budget->bytes));
        return within_bytes(search, budget->bytes);
    }
    const double delta_e = std::get<TargetDeltaE>(goal).delta_e;
    if (!(delta_e > 0 && delta_e <= k_most_delta_e))
        return argument_error("fit", "target delta E", fmt::format("above 0, at most {}", k_most_delta_e),
                              fmt::format("{}", delta_e));
    return SmallestWithin(search, delta_e).run();
}

}  // namespace srbf
