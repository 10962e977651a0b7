#include "srbf/choose.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <optional>

#include "parallel.h"

namespace srbf {
namespace {

constexpr std::size_t k_short_rows = 8192;
constexpr int k_short_starts = 4, k_short_kicks = 4, k_largest_j = k_most_fitted_lobes;
/// So many of those that look best in short are fitted whole.
constexpr std::size_t k_whole_fits = 6;
/// A model that in short errs more than this much as asked for is not taken for one that reaches it.
constexpr double k_short_excess = 2;

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
        const int of_lobe = 3 + (axial ? 1 : 3) * variates + features(form) + int(log_scale || form != PmForm::source);
        return 2 * std::size_t(lobes * of_lobe + 2 * variates);
    }
    /// The most lobes within so many bytes, maybe 0.
    int most_lobes(std::size_t within, bool log_scale) const {
        int lobes = 0;
        while (lobes < k_largest_j && bytes(lobes + 1, log_scale) <= within) ++lobes;
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
        FitOptions options;
        PmFit fit;
    };

    /// Fits of these kinds and numbers of lobes in short, side by side.
    Result<std::vector<Step>> in_short(const std::vector<std::pair<Kind, int>>& asked) {
        std::vector<Result<Tried>> tried(asked.size(), Error{});
        parallel_for(asked.size(), options_.threads, [&](std::size_t i) {
            FitOptions options = asked[i].first.with_lobes(options_, asked[i].second);
            options.starts = std::min(options.starts, k_short_starts);
            options.kicks = std::min(options.kicks, k_short_kicks);
            tried[i] = attempt(some_, options, true);
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
        return Tried{step, options, *std::move(fit)};
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

/// The least error within the bytes: of each kind the most lobes, and one fewer.
Result<Search::Tried> within_bytes(Search& search, const FitOptions& options, std::size_t bytes) {
    std::vector<std::pair<Kind, int>> asked;
    for (const Kind& kind : kinds(options)) {
        const int most = kind.most_lobes(bytes, options.log_scale);
        for (int lobes = std::max(most - 1, 1); lobes <= most; ++lobes) asked.emplace_back(kind, lobes);
    }
    if (asked.empty()) return Error{"fit", {}, "bytes", "enough for one lobe, 12", fmt::format("{}", bytes)};
    auto steps = search.in_short(asked);
    if (!steps) return steps.error();
    std::stable_sort(steps->begin(), steps->end(), by_error);
    std::optional<Search::Tried> best;
    const std::size_t count = std::min(k_whole_fits, steps->size());
    for (std::size_t i = 0; i < count && search.report(0.3 + 0.7 * double(i) / double(count)); ++i) {
        auto tried = search.whole((*steps)[i]);
        if (!tried) return tried;
        if (tried->step.bytes <= bytes && (!best || by_error(tried->step, best->step))) best = *std::move(tried);
    }
    return *std::move(best);
}

/// The fewest bytes at most that error. Of each kind the fewest lobes that reach it in short, or nearly so, by bisection; from the smallest
/// model on these and their smaller neighbours are fitted whole, until one reaches it.
Result<Search::Tried> within_error(Search& search, const FitOptions& options, double error, bool& reached) {
    struct Bracket {
        Kind kind;
        int least, most;  // too few lobes; enough, or the most there are
    };
    std::vector<Bracket> brackets;
    for (const Kind& kind : kinds(options))
        brackets.push_back({kind, 0, kind.most_lobes(k_most_chosen_bytes, options.log_scale)});
    std::vector<Step> candidates;
    for (int round = 0; round < 7; ++round) {
        std::vector<std::pair<Kind, int>> asked;
        std::vector<Bracket*> of;
        for (Bracket& b : brackets)
            if (b.most - b.least > 1) {
                // Few lobes first: they are fitted sooner, and often do.
                const int lobes =
                    b.least == 0 ? std::min(b.most - 1, 4) : std::min((b.least + b.most) / 2, 2 * b.least);
                asked.emplace_back(b.kind, lobes), of.push_back(&b);
            }
        if (asked.empty()) break;
        const auto steps = search.in_short(asked);
        if (!steps) return steps.error();
        for (std::size_t i = 0; i < asked.size(); ++i) {
            const bool enough = (*steps)[i].error <= k_short_excess * error;
            (enough ? of[i]->most : of[i]->least) = asked[i].second;
        }
        if (!search.report(0.08 * (round + 1))) break;
    }
    for (const Bracket& b : brackets)
        for (int lobes = std::max(b.most, 1);
             lobes <= k_largest_j && b.kind.bytes(lobes, options.log_scale) <= k_most_chosen_bytes; ++lobes)
            candidates.push_back(
                {b.kind.form, b.kind.axial, lobes, b.kind.variates, b.kind.bytes(lobes, options.log_scale), 0, false});
    std::stable_sort(candidates.begin(), candidates.end(), by_bytes);
    std::optional<Search::Tried> best;
    double fraction = 0.5;
    for (const Step& step : candidates) {
        if (!search.report(fraction += 0.5 * (1 - fraction) / 10)) break;
        auto tried = search.whole(step);
        if (!tried) return tried;
        const bool better = !best || by_error(tried->step, best->step);
        reached = tried->step.error <= error;
        if (better || reached) best = *std::move(tried);
        if (reached) break;
    }
    return *std::move(best);
}

}  // namespace

Result<Chosen> choose_pm(const Observations& observations, const FitOptions& options, const Wish& wish,
                         const JudgeModel& judge, const ProgressCallback& progress) {
    Search search(observations, options, judge, progress);
    Chosen chosen;
    auto found = wish.bytes > 0 ? within_bytes(search, options, wish.bytes)
                                : within_error(search, options, wish.error, chosen.reached);
    if (!found) return found.error();
    chosen.options = found->options;
    chosen.fit = std::move(found->fit);
    chosen.path = search.path();
    return chosen;
}

}  // namespace srbf
