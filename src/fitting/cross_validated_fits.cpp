#include "fitting/cross_validated_fits.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "fit/data/observe_samples.h"
#include "fit/objective/objective.h"
#include "fitting/requests.h"

namespace srbf {
namespace {

/// Number of lobes for the decision whether to fill the gaps between samples.
constexpr int k_first_tried = 6;
/// The smallest model whose error is at most this times the least is chosen.
constexpr double k_as_good = 1.03;
/// A few thousand samples need a shorter search than a table, and are searched a dozen times.
constexpr int k_sample_starts = 6, k_sample_perturbations = 14;
constexpr int k_draft_starts = 3, k_draft_perturbations = 2;

FitOptions sample_options(const ScatteredSamples& samples, const FitRequest& request, std::optional<int> lobes) {
    FitOptions options = pm_options(request, std::get<PmRequest>(request.model).axial.value_or(samples.isotropic));
    if (lobes) options.lobes = *lobes;
    options.starts = k_sample_starts;
    options.perturbations = k_sample_perturbations;
    return options;
}

/// What distinguishes the fits of a request that are compared.
struct Variant {
    std::optional<int> lobes = {};
    bool fill = false;
};

/// Fits to the samples of one measurement: to all of them, and to those of all folds but one.
class SampleFits {
  public:
    SampleFits(const ScatteredSamples& samples, const SampleObservations* observed, const FitRequest& request,
               std::vector<int> fold, const ProgressToken& progress)
        : samples_(samples), observed_(observed), request_(request), fold_(std::move(fold)), progress_(progress) {}

    Result<FitOutcome> run() {
        const auto* pm = std::get_if<PmRequest>(&request_.model);
        if (!pm) {
            auto one = judged({{}});
            if (!one) return one.error();
            return std::move(one->front());
        }
        const std::optional<int> asked = lobes_of(*pm);
        const auto goal = goal_of(request_);
        std::vector<int> lobes;
        if (asked)
            lobes = {*asked};
        else
            for (const int j : k_tried_lobes)
                if (enough_samples(j) && is_within(goal, bytes(j))) lobes.push_back(j);
        if (lobes.empty()) lobes = {1};
        if (completes(request_)) {
            // Completed samples constrain any number of lobes. The most look best; held-out samples, which are few and
            // crowded about highlights, prefer fewer half of the time.
            if (!goal) lobes = {lobes.back()};
            std::vector<Variant> candidates;
            for (const int j : lobes) candidates.push_back({j, true});
            validations_ = double(candidates.size());
            auto all = judged(candidates);
            if (!all) return all.error();
            return chosen(*all, goal);
        }
        validations_ = double(lobes.size()) + 1;
        const int first = asked.value_or(std::min(lobes.back(), k_first_tried));
        auto both = judged({{first, false}, {first, true}});
        if (!both) return both.error();
        const bool fill = error((*both)[1]) < error((*both)[0]);
        std::vector<Variant> others;
        for (const int j : lobes)
            if (j != first) others.push_back({j, fill});
        auto all = judged(others);
        if (!all) return all.error();
        const auto before = std::ranges::count_if(lobes, [&](int j) { return j < first; });
        all->insert(all->begin() + before, std::move((*both)[fill]));
        return chosen(*all, goal);
    }

  private:
    static bool is_within(const std::optional<SizeGoal>& goal, std::size_t bytes) {
        const auto* budget = goal ? std::get_if<ByteBudget>(&*goal) : nullptr;
        return !budget || bytes <= budget->bytes;
    }
    double error(const FitOutcome& outcome) const { return error_of(outcome.errors->heldout, request_.objective); }
    std::size_t bytes(int lobes) const {
        const FitOptions options = sample_options(samples_, request_, lobes);
        return payload_bytes(options.form, options.axial, options.log_scale, lobes, options.variates);
    }
    /// Three values of each sample outside a fold are at least twice as many as the numbers to find, of two bytes each.
    bool enough_samples(int lobes) const { return bytes(lobes) <= 3 * samples_.wl.size() * (k_folds - 1) / k_folds; }

    /// One fit of `samples`; `observed` is of these, and required for PM and GGX.
    Result<FitOutcome> fitted(const ScatteredSamples& samples, const SampleObservations* observed,
                              const Variant& candidate, const ProgressToken& progress) const {
        if (std::holds_alternative<SuRequest>(request_.model)) {
            const Measured measured{"", "", 0, samples};
            return fit_su(signed_evaluator(measured), request_, progress);
        }
        FitOutcome outcome;
        if (std::holds_alternative<GgxRequest>(request_.model)) {
            auto ggx = fit_ggx(observed->samples, request_, progress);
            if (!ggx) return ggx;
            outcome = *std::move(ggx);
        } else {
            auto pm =
                fit_pm(*observed, {sample_options(samples_, request_, candidate.lobes), candidate.fill}, progress);
            if (!pm) return pm.error();
            if (progress.cancelled()) return cancelled_error("fit");
            outcome.stop = pm->stop;
            outcome.filled = candidate.fill;
            take(outcome, *std::move(pm));
        }
        outcome.masked = observed->samples.masked;
        outcome.clamped = observed->samples.clamped;
        return outcome;
    }

    /// All candidates' fits of these samples.
    Result<std::vector<FitOutcome>> fitted(const ScatteredSamples& samples, const SampleObservations* observed,
                                           const std::vector<Variant>& candidates,
                                           const ProgressToken& progress) const {
        std::vector<FitOutcome> all;
        for (const Variant& candidate : candidates) {
            const double done = double(all.size()) / double(candidates.size());
            auto one = fitted(samples, observed, candidate, progress.part(done, done + 1 / double(candidates.size())));
            if (!one) return one.error();
            all.push_back(*std::move(one));
        }
        return all;
    }

    /// The candidates' fits of all samples, with their errors at them and their cross-validated errors.
    Result<std::vector<FitOutcome>> judged(const std::vector<Variant>& candidates) {
        if (candidates.empty()) return std::vector<FitOutcome>{};
        const double share = double(candidates.size()) / validations_;
        const ProgressToken progress = progress_.part(done_, done_ + share);
        done_ += share;
        auto outcomes = fitted(samples_, observed_, candidates, progress.part(0, 1.0 / (k_folds + 1)));
        if (!outcomes) return outcomes;
        std::atomic<int> fits = 1;
        const auto predicted =
            cross_validate(samples_, fold_, [&](const ScatteredSamples& training) -> Result<std::vector<Model>> {
                const int before = fits;
                const ProgressToken of_fold =
                    progress.part(double(before) / (k_folds + 1), (before + 1.0) / (k_folds + 1));
                std::optional<SampleObservations> observed;
                if (!std::holds_alternative<SuRequest>(request_.model)) {
                    auto made = observe(training, observe_options(request_), of_fold.part(0, 0.2));
                    if (!made) return made.error();
                    observed = *std::move(made);
                }
                auto all = fitted(training, observed ? &*observed : nullptr, candidates, of_fold.part(0.2, 1));
                ++fits;
                if (!all) return all.error();
                std::vector<Model> models;
                for (FitOutcome& one : *all)
                    models.push_back(std::move(one.model)), models.push_back(std::move(one.unrounded));
                return models;
            });
        if (!predicted) return predicted.error();
        const auto measured_with = [&](const Model& model, std::span<const float> heldout) {
            const Channels fitted = channels(model);
            std::vector<float> f(heldout.size());
            fitted.evaluate(samples_.wl, samples_.wv, f);
            return Comparison{measured_against(f), measured_against(heldout), 0};
        };
        for (std::size_t k = 0; k < outcomes->size(); ++k) {
            FitOutcome& outcome = (*outcomes)[k];
            outcome.errors = measured_with(outcome.model, (*predicted)[2 * k]);
            outcome.unrounded_errors = measured_with(outcome.unrounded, (*predicted)[2 * k + 1]);
            outcome.samples = outcome.errors->matrix.pairs;
            outcome.raw_bytes = (*predicted)[2 * k].size() * sizeof(float);
        }
        return outcomes;
    }

    Measures measured_against(std::span<const float> f) const {
        if (request_.spectral) return measure_samples(samples_.wl, samples_.wv, samples_.spectrum, f, request_.theta());
        std::vector<float> colours;
        for (const Rgb& c : samples_.colour) colours.insert(colours.end(), {c.r, c.g, c.b});
        return measure_samples(samples_.wl, samples_.wv, colours, f, request_.theta());
    }

    Result<FitOutcome> chosen(std::vector<FitOutcome>& all, const std::optional<SizeGoal>& goal) const {
        const auto by_error = [&](const FitOutcome& a, const FitOutcome& b) { return error(a) < error(b); };
        const double least = error(*std::min_element(all.begin(), all.end(), by_error));
        const auto* target = goal ? std::get_if<TargetError>(&*goal) : nullptr;
        const double enough = !goal ? k_as_good * least : target ? target->error : least;
        auto taken = std::find_if(all.begin(), all.end(), [&](const FitOutcome& one) { return error(one) <= enough; });
        const bool reached = taken != all.end();
        if (!reached) taken = std::min_element(all.begin(), all.end(), by_error);
        std::vector<Step> path;
        if (all.size() > 1)
            for (const FitOutcome& one : all) {
                const PmModel& model = std::get<PmModel>(one.model.model);
                path.push_back(
                    {model.form, model.axial, model.lobes, model.variates, payload_bytes(model), error(one), true});
            }
        FitOutcome outcome = std::move(*taken);
        outcome.path = std::move(path);
        outcome.reached = reached && is_within(goal, payload_bytes(outcome.model));
        return outcome;
    }

    const ScatteredSamples& samples_;
    const SampleObservations* observed_;
    const FitRequest& request_;
    std::vector<int> fold_;
    ProgressToken progress_;
    double done_ = 0, validations_ = 1;  ///< share of the work done; number of candidates
};

}  // namespace

bool completes(const FitRequest& request) {
    return std::holds_alternative<PmRequest>(request.model) && traits(request.objective).of_pictures &&
           !request.spectral;
}

ObserveSamplesOptions observe_options(const FitRequest& request) {
    return {request.objective, request.theta(), request.seed, request.spectral, completes(request), request.threads};
}

Result<FitOutcome> fit_to_samples(const ScatteredSamples& samples, const SampleObservations* observed,
                                  const FitRequest& request, const ProgressToken& progress) {
    auto fold = assign_folds(samples, request.theta(), request.seed);
    if (!fold) return fold.error();
    return SampleFits(samples, observed, request, *std::move(fold), progress).run();
}

Result<FitOutcome> draft_of_samples(const ScatteredSamples& samples, const SampleObservations& observed,
                                    const FitRequest& request, bool in_short, const ProgressToken& progress) {
    FitOptions options = sample_options(samples, request, {});
    if (in_short) options = srbf::in_short(options, k_draft_starts, k_draft_perturbations);
    auto pm = fit_pm(observed, {options, !in_short}, progress);
    if (!pm) return pm.error();
    FitOutcome outcome;
    outcome.stop = pm->stop;
    outcome.filled = !in_short || completes(request);
    take(outcome, *std::move(pm));
    return outcome;
}

}  // namespace srbf
