#include "fit/cross_validated_fits.h"

#include <atomic>

#include "base/errors.h"
#include "base/parallel.h"
#include "brdf/values.h"
#include "errors/measures.h"
#include "errors/picture_errors.h"
#include "errors/sphere.h"
#include "fit/request_traits.h"
#include "fit/requests.h"
#include "measured/tables.h"
#include "models/pm/pm_functions.h"
#include "observe/pair_weights.h"
#include "samples/fit_pm_to_samples.h"
#include "samples/folds.h"

namespace SRBF_NAMESPACE {
namespace {

/// Number of lobes for the decision whether to fill the gaps between samples.
constexpr int k_first_tried = 6;
/// The smallest model whose error is at most this times the least is chosen.
constexpr double k_as_good = 1.03;
/// A few thousand samples need a shorter search than a table, and are searched a dozen times.
constexpr int k_sample_starts = 6, k_sample_perturbations = 14;
/// The fits to folds, which only estimate the error of the fit to all samples, have fewer starts.
constexpr int k_fold_starts = 3;
/// Approximate share of observing in the time of the fits to a fold's samples.
constexpr double k_observed_of_fold = 0.2;

PmFitOptions sample_options(const ScatteredSamples& samples, const FitRequest& request, std::optional<int> lobes) {
    PmFitOptions options =
        pm_options(request, std::get<PmRequest>(request.model).axial.value_or(samples.isotropic), PmForm::extended);
    if (lobes) options.lobes = *lobes;
    options.starts = k_sample_starts;
    options.perturbations = k_sample_perturbations;
    return options;
}

/// The fits of a request that are compared differ in these.
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
        const std::vector<int> lobes = tried_lobes(*pm);
        // Gap-filled samples constrain any number of lobes. The largest number has the least visible error; held-out
        // samples, which are few and crowded about highlights, prefer fewer half of the time.
        auto all = fills_gaps(request_)                    ? fit_each({lobes.back()}, true)
                   : traits(request_.objective).of_scatter ? fit_each(lobes, true)
                                                           : fit_alone_or_filled(lobes, lobes_of(*pm));
        if (!all) return all.error();
        return chosen(*all);
    }

  private:
    double error(const FitOutcome& outcome) const { return error_of(outcome.errors->heldout, request_.objective); }
    /// Three values of each sample outside a fold are at least twice as many as the numbers to find, of two bytes each.
    bool enough_samples(int lobes) const {
        const PmFitOptions options = sample_options(samples_, request_, lobes);
        return payload_bytes(options.form, options.axial, has_log_scales(options.form), lobes, options.variates) <=
               3 * samples_.wl.size() * (k_folds - 1) / k_folds;
    }

    /// The requested number of lobes, or those to choose from.
    std::vector<int> tried_lobes(const PmRequest& pm) const {
        if (const auto asked = lobes_of(pm)) return {*asked};
        std::vector<int> lobes;
        for (const int j : k_tried_lobes)
            if (j <= k_most_sample_lobes && enough_samples(j)) lobes.push_back(j);
        return lobes.empty() ? std::vector{1} : lobes;
    }

    Result<std::vector<FitOutcome>> fit_each(const std::vector<int>& lobes, bool fill) {
        std::vector<Variant> candidates;
        for (const int j : lobes) candidates.push_back({j, fill});
        validations_ = double(candidates.size());
        return judged(candidates);
    }
    /// Decides for one number of lobes whether to fill the gaps between samples, and fits the others alike.
    Result<std::vector<FitOutcome>> fit_alone_or_filled(const std::vector<int>& lobes, std::optional<int> asked) {
        validations_ = double(lobes.size()) + 1;
        const int first = asked.value_or(std::min(lobes.back(), k_first_tried));
        auto both = judged({{first, false}, {first, true}});
        if (!both) return both;
        const bool fill = error((*both)[1]) < error((*both)[0]);
        std::vector<Variant> others;
        for (const int j : lobes)
            if (j != first) others.push_back({j, fill});
        auto all = judged(others);
        if (!all) return all;
        const auto before = std::ranges::count_if(lobes, [&](int j) { return j < first; });
        all->insert(all->begin() + before, std::move((*both)[fill]));
        return all;
    }

    // Fits `samples`. `observed` holds their observations; null for view-by-view models.
    Result<FitOutcome> fitted(const SuRequest&, const ScatteredSamples& samples, const SampleObservations*,
                              const Variant&, const ProgressToken& progress) const {
        const Measured measured{"", "", 0, samples};
        return fit_view_by_view(signed_evaluator(measured), request_, progress);
    }
    template <typename R>
    Result<FitOutcome> fitted(const R&, const ScatteredSamples&, const SampleObservations* observed, const Variant&,
                              const ProgressToken& progress) const {
        return counted(fit_by_kind(request_, observed->samples, samples_.isotropic, progress), *observed);
    }
    Result<FitOutcome> fitted(const PmRequest&, const ScatteredSamples&, const SampleObservations* observed,
                              const Variant& candidate, const ProgressToken& progress) const {
        PmFitOptions options = sample_options(samples_, request_, candidate.lobes);
        if (fills_gaps(request_) && observed != observed_) options.starts = k_fold_starts;
        auto pm = fit_pm(*observed, {options, candidate.fill}, progress);
        if (!pm) return pm.error();
        if (progress.cancelled()) return cancelled_error("fit");
        FitOutcome outcome = outcome_of(*std::move(pm));
        outcome.filled = candidate.fill;
        if (observed->gap_filled) outcome.continued = words(*observed->gap_filled);
        return counted(std::move(outcome), *observed);
    }
    static Result<FitOutcome> counted(Result<FitOutcome> outcome, const SampleObservations& observed) {
        if (!outcome) return outcome;
        outcome->masked = observed.samples.masked;
        outcome->clamped = observed.samples.clamped;
        return outcome;
    }

    /// All candidates' fits of these samples.
    Result<std::vector<FitOutcome>> fitted(const ScatteredSamples& samples, const SampleObservations* observed,
                                           const std::vector<Variant>& candidates,
                                           const ProgressToken& progress) const {
        std::vector<FitOutcome> all;
        for (const Variant& candidate : candidates) {
            const double done = double(all.size()) / double(candidates.size());
            const ProgressToken part = progress.part(done, done + 1 / double(candidates.size()));
            auto one = std::visit([&](const auto& of) { return fitted(of, samples, observed, candidate, part); },
                                  request_.model);
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
        std::atomic<int> fits = 0;
        const auto next_part = [&] {
            const int before = fits;
            return progress.part(double(before) / (k_folds + 1), (before + 1.0) / (k_folds + 1));
        };
        // Together with the folds, whose number is odd.
        Result<std::vector<FitOutcome>> outcomes = std::vector<FitOutcome>{};
        Result<std::vector<std::vector<float>>> predicted = std::vector<std::vector<float>>{};
        std::array<std::vector<Model>, k_folds> of_folds;
        parallel_for(2, request_.threads, [&](std::size_t which) {
            if (which == 0) {
                outcomes = fitted(samples_, observed_, candidates, next_part());
                ++fits;
                return;
            }
            predicted = cross_validate(samples_, fold_, [&](const ScatteredSamples& training, std::size_t left_out) {
                auto models = fitted_models(training, left_out, candidates, next_part());
                ++fits;
                if (models) of_folds[left_out] = *models;
                return models;
            });
        });
        if (!outcomes) return outcomes;
        if (!predicted) return predicted.error();
        for (std::size_t k = 0; k < outcomes->size(); ++k) {
            FitOutcome& outcome = (*outcomes)[k];
            outcome.errors = compared(outcome.model, (*predicted)[2 * k]);
            outcome.unrounded_errors = compared(outcome.unrounded, (*predicted)[2 * k + 1]);
            outcome.samples = outcome.errors->matrix.pairs;
            outcome.raw_bytes = (*predicted)[2 * k].size() * sizeof(float);
            for (std::vector<Model>& of_fold : of_folds)
                if (!of_fold.empty()) outcome.without_fold.push_back(std::move(of_fold[2 * k]));
            outcome.ggx_heldout = errors_of_ggx();
        }
        return outcomes;
    }

    /// The candidates' models of the samples of all folds but one: of each the rounded and the unrounded one.
    Result<std::vector<Model>> fitted_models(const ScatteredSamples& training, std::size_t left_out,
                                             const std::vector<Variant>& candidates,
                                             const ProgressToken& progress) const {
        std::optional<SampleObservations> observed;
        if (!std::holds_alternative<SuRequest>(request_.model)) {
            ObserveSamplesOptions options = observe_options(request_);
            if (observed_ && observed_->gap_filled) options.gap_filled = &observed_->without_fold[left_out];
            auto made = observe(training, options, progress.part(0, k_observed_of_fold));
            if (!made) return made.error();
            observed = *std::move(made);
        }
        auto all = fitted(training, observed ? &*observed : nullptr, candidates, progress.part(k_observed_of_fold, 1));
        if (!all) return all.error();
        std::vector<Model> models;
        for (FitOutcome& one : *all) models.push_back(std::move(one.model)), models.push_back(std::move(one.unrounded));
        return models;
    }

    /// The errors of a model at the samples, and of what the fits to other folds predict there.
    Comparison compared(const Model& model, std::span<const float> heldout) const {
        std::vector<float> f(heldout.size());
        channels(model).evaluate(samples_.wl, samples_.wv, f);
        Comparison errors{measured_against(f), measured_against(heldout), 0};
        errors.samples_delta_e = shown_error(model), errors.measure = measure_of(request_.objective);
        return errors;
    }
    /// `Comparison::samples_delta_e`, within θmax.
    double shown_error(const Model& model) const {
        Image lit, fitted;
        for (const std::size_t i : samples_within(samples_, request_.theta())) {
            const Vec3f &wl = samples_.wl[i], &wv = samples_.wv[i];
            lit.pixels.push_back(scaled(wl.z, samples_.colour[i]));
            fitted.pixels.push_back(scaled(wl.z, value(model, wl, wv)));
        }
        const float exposure = exposure_to(lit, k_exposed_value);
        double sum = 0;
        for (std::size_t i = 0; i < lit.pixels.size(); ++i)
            sum += delta_e_itp(exposed(lit.pixels[i], exposure), exposed(fitted.pixels[i], exposure));
        return sum / double(lit.pixels.size());
    }
    /// The cross-validated errors of Lambert and at most one lobe of GGX; none unless they fill gaps, or of spectra.
    std::optional<Measures> errors_of_ggx() const {
        if (!observed_ || observed_->without_fold.empty() || request_.spectral) return {};
        std::vector<Rgb> f;
        for (std::size_t i = 0; i < fold_.size(); ++i) {
            const GapFilledSamples& others = observed_->without_fold[std::size_t(fold_[i])];
            f.push_back(value(others.priors[k_one_lobe], samples_.wl[i], samples_.wv[i]));
        }
        return measure_samples(samples_.wl, samples_.wv, samples_.colour, f, request_.theta());
    }
    Measures measured_against(std::span<const float> f) const {
        if (request_.spectral) return measure_samples(samples_.wl, samples_.wv, samples_.spectrum, f, request_.theta());
        std::vector<float> colours;
        for (const Rgb& c : samples_.colour) colours.insert(colours.end(), {c.r, c.g, c.b});
        return measure_samples(samples_.wl, samples_.wv, colours, f, request_.theta());
    }

    /// The smallest outcome whose error is almost the least.
    Result<FitOutcome> chosen(std::vector<FitOutcome>& all) const {
        const auto best = std::ranges::min_element(all, {}, [&](const FitOutcome& one) { return error(one); });
        const auto is_as_good = [&](const FitOutcome& one) { return error(one) <= k_as_good * error(*best); };
        const auto taken = std::find_if(all.begin(), best, is_as_good);
        std::vector<Trial> path;
        if (all.size() > 1)
            for (const FitOutcome& one : all)
                path.push_back({std::get<PmModel>(one.model.model).lobes, payload_bytes(one.model), error(one)});
        FitOutcome outcome = std::move(*taken);
        outcome.path = std::move(path);
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

bool fills_gaps(const FitRequest& request) {
    return std::holds_alternative<PmRequest>(request.model) && traits(request.objective).of_pictures;
}

ObserveSamplesOptions observe_options(const FitRequest& request) {
    return {request.objective, request.theta(), request.seed, request.spectral, fills_gaps(request), request.threads};
}

Result<FitOutcome> fit_to_samples(const ScatteredSamples& samples, const SampleObservations* observed,
                                  const FitRequest& request, const ProgressToken& progress) {
    const auto of_incidences =
        traits(request.objective).of_scatter ? incidence_folds(samples) : std::optional<IncidenceFolds>{};
    auto fold = of_incidences ? Result(of_incidences->fold_of) : assign_folds(samples, request.theta(), request.seed);
    if (!fold) return fold.error();
    auto outcome = SampleFits(samples, observed, request, *std::move(fold), progress).run();
    if (outcome && of_incidences) outcome->incidences = of_incidences->incidences;
    return outcome;
}

Result<FitOutcome> draft_of_samples(const ScatteredSamples& samples, const SampleObservations& observed,
                                    const FitRequest& request, const ProgressToken& progress) {
    auto pm = fit_pm(observed, {sample_options(samples, request, {}), true}, progress);
    if (!pm) return pm.error();
    FitOutcome outcome = outcome_of(*std::move(pm));
    outcome.filled = true;
    return outcome;
}

Result<std::vector<std::vector<float>>> cross_validate(const ScatteredSamples& samples, std::span<const int> fold,
                                                       const FitToSamples& fit) {
    std::array<std::optional<Result<std::vector<Model>>>, k_folds> models;
    const StandardArithmetic mode;
    // There may be fewer than five incidences.
    const int folds = 1 + *std::ranges::max_element(fold);
    parallel_for(std::size_t(folds), [&](std::size_t left_out) {
        models[left_out] = fit(without_fold(samples, fold, int(left_out)), left_out);
    });
    std::vector<std::vector<float>> predicted;
    for (int left_out = 0; left_out < folds; ++left_out) {
        const auto& of_fold = *models[std::size_t(left_out)];
        if (!of_fold) return of_fold.error();
        predicted.resize(of_fold->size());
        for (std::size_t k = 0; k < predicted.size(); ++k) {
            // Colours come from `value`, which is the same on any machine.
            const Model& fitted = (*of_fold)[k];
            const Channels model =
                wavelengths(fitted).empty() ? rgb_channels(evaluator<Model>(fitted)) : channels(fitted);
            const std::size_t C = model.count();
            std::vector<float> f(C * samples.wl.size());
            model.evaluate(samples.wl, samples.wv, f);
            predicted[k].resize(f.size());
            for (std::size_t i = 0; i < fold.size(); ++i)
                if (fold[i] == left_out) std::copy_n(&f[i * C], C, &predicted[k][i * C]);
        }
    }
    return predicted;
}

}  // namespace srbf
