#include "fit/cross_validated_fits.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "fit/requests.h"

namespace srbf {
namespace {

/// Number of lobes for the decision whether to fill the gaps between samples.
constexpr int k_first_tried = 6;
/// The smallest model whose error is at most this times the least is chosen.
constexpr double k_as_good = 1.03;
/// A few thousand samples need a shorter search than a table, and are searched a dozen times.
constexpr int k_sample_starts = 6, k_sample_perturbations = 14;
constexpr int k_draft_starts = 3, k_draft_perturbations = 2;

ObserveSamplesOptions observe_options(const FitRequest& request) {
    return {request.objective, request.theta(), request.seed, request.spectral};
}

FitOptions sample_options(const ScatteredSamples& samples, const FitRequest& request, std::optional<int> lobes) {
    FitOptions options = pm_options(request, std::get<PmRequest>(request.model).axial.value_or(samples.isotropic));
    if (lobes) options.lobes = *lobes;
    options.starts = k_sample_starts;
    options.perturbations = k_sample_perturbations;
    return options;
}

/// Fits to the samples of one measurement: to all of them, and to those of all folds but one.
class SampleFits {
  public:
    SampleFits(const ScatteredSamples& samples, const SampleObservations* observed, const FitRequest& request,
               std::vector<int> fold, const ProgressToken& progress)
        : samples_(samples), observed_(observed), request_(request), fold_(std::move(fold)), progress_(progress) {}

    Result<FitOutcome> run() {
        const auto* pm = std::get_if<PmRequest>(&request_.model);
        if (!pm) return judged({}, false);
        const std::optional<int> asked = lobes_of(*pm);
        const auto goal = goal_of(request_);
        std::vector<int> lobes;
        if (asked)
            lobes = {*asked};
        else
            for (const int j : k_tried_lobes)
                if (enough_samples(j) && is_within(goal, bytes(j))) lobes.push_back(j);
        if (lobes.empty()) lobes = {1};
        validations_ = double(lobes.size()) + 1;
        const int first = asked.value_or(std::min(lobes.back(), k_first_tried));
        auto alone = judged(first, false);
        if (!alone) return alone;
        auto filled = judged(first, true);
        if (!filled) return filled;
        const bool fill = error(*filled) < error(*alone);
        std::vector<FitOutcome> all;
        for (const int j : lobes) {
            auto one = j == first ? (fill ? filled : alone) : judged(j, fill);
            if (!one) return one;
            all.push_back(*std::move(one));
        }
        return chosen(all, goal);
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

    /// The fit of `samples`, all of them or those of all folds but one.
    Result<FitOutcome> fitted(const ScatteredSamples& samples, std::optional<int> lobes, bool fill,
                              const ProgressToken& progress) const {
        if (std::holds_alternative<SuRequest>(request_.model)) {
            const Measured measured{"", "", 0, samples};
            return fit_su(signed_evaluator(measured), request_, progress);
        }
        const bool whole = &samples == &samples_;
        std::optional<SampleObservations> of_rest;
        if (!whole) {
            auto observed = observe(samples, observe_options(request_), progress.part(0, 0.2));
            if (!observed) return observed.error();
            of_rest = *std::move(observed);
        }
        const SampleObservations& observed = whole ? *observed_ : *of_rest;
        const ProgressToken fitting = progress.part(0.2, 1);
        FitOutcome outcome;
        if (std::holds_alternative<GgxRequest>(request_.model)) {
            auto ggx = fit_ggx(observed.samples, request_, fitting);
            if (!ggx) return ggx;
            outcome = *std::move(ggx);
        } else {
            auto pm = fit_pm(observed, {sample_options(samples_, request_, lobes), fill}, fitting);
            if (!pm) return pm.error();
            if (fitting.cancelled()) return cancelled_error("fit");
            outcome.stop = pm->stop;
            outcome.filled = fill;
            take(outcome, *std::move(pm));
        }
        outcome.masked = observed.samples.masked;
        outcome.clamped = observed.samples.clamped;
        return outcome;
    }

    /// The fit of all samples, with its errors at them and its cross-validated errors.
    Result<FitOutcome> judged(std::optional<int> lobes, bool fill) {
        const ProgressToken progress = progress_.part(done_ / validations_, (done_ + 1) / validations_);
        auto outcome = fitted(samples_, lobes, fill, progress.part(0, 1.0 / (k_folds + 1)));
        if (!outcome) return outcome;
        std::atomic<int> fits = 1;
        const auto predicted =
            cross_validate(samples_, fold_, [&](const ScatteredSamples& training) -> Result<std::vector<Model>> {
                const int before = fits;
                auto of_fold = fitted(training, lobes, fill,
                                      progress.part(double(before) / (k_folds + 1), (before + 1.0) / (k_folds + 1)));
                ++fits;
                if (!of_fold) return of_fold.error();
                return std::vector<Model>{std::move(of_fold->model), std::move(of_fold->unrounded)};
            });
        if (!predicted) return predicted.error();
        const auto measured_with = [&](const Model& model, std::span<const float> heldout) {
            const Channels fitted = channels(model);
            std::vector<float> f(heldout.size());
            fitted.evaluate(samples_.wl, samples_.wv, f);
            return Comparison{measured_against(f), measured_against(heldout), 0};
        };
        outcome->errors = measured_with(outcome->model, (*predicted)[0]);
        outcome->unrounded_errors = measured_with(outcome->unrounded, (*predicted)[1]);
        outcome->samples = outcome->errors->matrix.pairs;
        outcome->raw_bytes = (*predicted)[0].size() * sizeof(float);
        done_ += 1;
        return outcome;
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
    double done_ = 0, validations_ = 1;
};

}  // namespace

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
    outcome.filled = !in_short;
    take(outcome, *std::move(pm));
    return outcome;
}

}  // namespace srbf
