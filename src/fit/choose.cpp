#include "srbf/choose.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <optional>

#include "fit/search.h"
#include "parallel.h"

namespace srbf {
namespace {

constexpr std::size_t k_short_rows = 8192;
constexpr int k_short_starts = 4, k_short_kicks = 8;
/// So many of those that look best in short are fitted whole.
constexpr std::size_t k_whole_fits = 6;
/// A model that in short errs more than this much as asked for is not taken for one that reaches it.
constexpr double k_short_excess = 2;
/// On the way to the smallest model so many kinds take part, of which so many are fitted whole; and what counts as just below it.
constexpr std::size_t k_few_kinds = 4, k_whole_each = 2;
constexpr double k_just_below = 0.92;

/// A kind of model, of which only J is open.
struct Kind {
    PmForm form;
    bool axial;
    int variates;

    FitOptions with_lobes(FitOptions options, int lobes) const {
        options.form = form;
        options.axial = axial;
        options.variates = variates;
        options.lobes = lobes;
        if (form != PmForm::source) options.log_scale = true;
        return options;
    }
    std::size_t bytes(int lobes, bool log_scale) const {
        return payload_bytes(form, axial, log_scale || form != PmForm::source, lobes, variates);
    }
    /// The most lobes within so many bytes, maybe 0.
    int most_lobes(std::size_t within, bool log_scale) const {
        int lobes = 0;
        while (lobes < k_most_fitted_lobes && bytes(lobes + 1, log_scale) <= within) ++lobes;
        return lobes;
    }
};

std::vector<Kind> kinds(const FitOptions& options) {
    std::vector<Kind> all;
    for (const PmForm form : {PmForm::source, PmForm::horizon, PmForm::extended})
        for (const bool axial : {true, false})
            for (int n = 1; n <= k_most_chosen_variates; ++n)
                if ((axial || !options.axial) && !(options.reciprocal && n % 2 == 1) &&
                    (options.log_scale || form == PmForm::source))
                    all.push_back({form, axial, n});
    return all;
}

/// Fits and judges models, each once.
class Search {
  public:
    Search(const Observations& observations, const FitOptions& options, const JudgeModel& judge,
           const ProgressCallback& progress)
        : observations_(observations),
          some_(beginning(observations, k_short_rows)),
          options_(options),
          judge_(judge),
          progress_(progress) {}

    struct Tried {
        Step step;
        PmFit fit;
    };

    /// Fits of these kinds and numbers of lobes in short, side by side.
    Result<std::vector<Step>> in_short(const std::vector<std::pair<Kind, int>>& asked) {
        std::vector<Result<Tried>> tried(asked.size(), Error{});
        parallel_for(asked.size(), options_.threads, [&](std::size_t i) {
            const FitOptions options = asked[i].first.with_lobes(options_, asked[i].second);
            tried[i] = attempt(some_, srbf::in_short(options, k_short_starts, k_short_kicks), true);
        });
        std::vector<Step> steps;
        for (const auto& one : tried) {
            if (!one) return one.error();
            steps.push_back(one->step);
        }
        path_.insert(path_.end(), steps.begin(), steps.end());
        return steps;
    }

    Result<Tried> whole(const Step& step) {
        const Kind kind{step.form, step.axial, step.variates};
        auto tried = attempt(observations_, kind.with_lobes(options_, step.lobes), false);
        if (tried) path_.push_back(tried->step);
        return tried;
    }

    /// Whether that model was fitted whole.
    bool has_whole(const Step& step) const {
        return std::any_of(path_.begin(), path_.end(), [&](const Step& one) {
            return one.whole && one.form == step.form && one.axial == step.axial && one.variates == step.variates &&
                   one.lobes == step.lobes;
        });
    }

    bool report(double fraction) {
        if (progress_ && !cancelled_) cancelled_ = !progress_({"choosing", std::min(fraction, 1.0)});
        return !cancelled_;
    }
    std::vector<Step> path() const {
        // Where a model was fitted both ways the whole fit counts.
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
        auto fit = fit_pm(observations, options, [&](const Progress&) { return !cancelled_.load(); });
        if (!fit) return fit.error();
        const double error = judge_(fit->model, in_short);
        const Step step{options.form, options.axial, options.lobes, options.variates, payload_bytes(fit->model),
                        error,        !in_short};
        return Tried{step, *std::move(fit)};
    }

    const Observations& observations_;
    Observations some_;
    FitOptions options_;
    const JudgeModel& judge_;
    const ProgressCallback& progress_;
    std::vector<Step> path_;
    std::atomic<bool> cancelled_ = false;
};

bool by_error(const Step& a, const Step& b) { return a.error < b.error; }
bool by_bytes(const Step& a, const Step& b) { return a.bytes != b.bytes ? a.bytes < b.bytes : a.error < b.error; }

Result<Search::Tried> found_or_cancelled(std::optional<Search::Tried>& best) {
    if (!best) return Error{"fit", {}, "models that were tried", "one at least", "none before it was cancelled"};
    return *std::move(best);
}

/// Of these kinds the models of the most lobes that fit into the bytes, and of up to so many fewer; those first that look best in short.
Result<std::vector<Step>> best_in_short(Search& search, const FitOptions& options, const std::vector<Kind>& of,
                                        std::size_t bytes, int fewer) {
    std::vector<std::pair<Kind, int>> asked;
    for (const Kind& kind : of) {
        const int most = kind.most_lobes(bytes, options.log_scale);
        for (int lobes = std::max(most - fewer, 1); lobes <= most; ++lobes) asked.emplace_back(kind, lobes);
    }
    auto steps = search.in_short(asked);
    if (steps) std::stable_sort(steps->begin(), steps->end(), by_error);
    return steps;
}

/// The least error within the bytes.
Result<Search::Tried> within_bytes(Search& search, const FitOptions& options, std::size_t bytes) {
    const auto steps = best_in_short(search, options, kinds(options), bytes, 1);
    if (!steps) return steps.error();
    if (steps->empty()) return Error{"fit", {}, "bytes", "enough for one lobe, 12", fmt::format("{}", bytes)};
    std::optional<Search::Tried> best;
    const std::size_t count = std::min(k_whole_fits, steps->size());
    for (std::size_t i = 0; i < count && search.report(0.3 + 0.7 * double(i) / double(count)); ++i) {
        auto tried = search.whole((*steps)[i]);
        if (!tried) return tried;
        if (tried->step.bytes <= bytes && (!best || by_error(tried->step, best->step))) best = *std::move(tried);
    }
    return found_or_cancelled(best);
}

/// The fewest bytes at most that error. Doubles the bytes until some model reaches it, then halves the gap to those that were too few. On the
/// way down only the kinds that looked best take part, and of these two are fitted whole; at last the models just below the smallest
/// that was found are tried.
Result<Search::Tried> within_error(Search& search, const FitOptions& options, double error, bool& reached) {
    std::optional<Search::Tried> best;
    std::vector<Kind> few;
    // Whether some model within the bytes reaches the error; it or the nearest one becomes the best.
    const auto attempt = [&](const std::vector<Kind>& of, std::size_t bytes) -> Result<bool> {
        const auto steps = best_in_short(search, options, of, bytes, 0);
        if (!steps) return steps.error();
        few.clear();
        for (const Step& step : *steps)
            if (few.size() < k_few_kinds) few.push_back({step.form, step.axial, step.variates});
        for (std::size_t i = 0; i < std::min(k_whole_each, steps->size()); ++i) {
            if ((*steps)[i].error > k_short_excess * error && bytes < k_most_chosen_bytes) continue;
            auto tried = search.whole((*steps)[i]);
            if (!tried) return tried.error();
            const bool enough = tried->step.error <= error, was_enough = best && best->step.error <= error;
            if (!best || (enough ? !was_enough || by_bytes(tried->step, best->step)
                                 : !was_enough && by_error(tried->step, best->step)))
                best = *std::move(tried);
            if (enough) return true;
        }
        return false;
    };

    std::size_t too_few = 0, enough = 32;
    for (;; too_few = enough, enough = std::min(2 * enough, k_most_chosen_bytes)) {
        const auto found = attempt(kinds(options), enough);
        if (!found) return found.error();
        reached = *found;
        if (reached || enough == k_most_chosen_bytes || !search.report(0.1 * std::log2(double(enough) / 16))) break;
    }
    if (!reached) return found_or_cancelled(best);
    const std::vector<Kind> looked_best = few;
    while (enough - too_few > std::max<std::size_t>(4, enough / 24) && search.report(0.9)) {
        const std::size_t between = (too_few + enough) / 2;
        const auto found = attempt(looked_best, between);
        if (!found) return found.error();
        (*found ? enough : too_few) = *found ? std::min(between, best->step.bytes) : between;
    }
    std::vector<Step> below;
    for (const Kind& kind : looked_best)
        for (int lobes = kind.most_lobes(best->step.bytes - 1, options.log_scale);
             lobes > 0 && double(kind.bytes(lobes, options.log_scale)) > k_just_below * double(best->step.bytes);
             --lobes)
            below.push_back(
                {kind.form, kind.axial, lobes, kind.variates, kind.bytes(lobes, options.log_scale), 0, false});
    std::stable_sort(below.begin(), below.end(), by_bytes);
    for (const Step& step : below) {
        if (search.has_whole(step)) continue;
        if (!search.report(0.95)) break;
        auto tried = search.whole(step);
        if (!tried) return tried;
        if (tried->step.error > error) continue;
        best = *std::move(tried);
        break;
    }
    return found_or_cancelled(best);
}

}  // namespace

Result<Chosen> choose_pm(const Observations& observations, const FitOptions& options, const Wish& wish,
                         const JudgeModel& judge, const ProgressCallback& progress) {
    const FlushSubnormals mode;
    Search search(observations, options, judge, progress);
    Chosen chosen;
    auto found = wish.bytes > 0 ? within_bytes(search, options, wish.bytes)
                                : within_error(search, options, wish.error, chosen.reached);
    if (!found) return found.error();
    chosen.fit = std::move(found->fit);
    chosen.path = search.path();
    return chosen;
}

}  // namespace srbf
