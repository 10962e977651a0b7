// All stages of `srbf fit` between reading a measurement and writing a model.

#include <tuple>

#include "base/errors.h"
#include "base/files.h"
#include "base/floating_point.h"
#include "brdf/directions.h"
#include "brdf/values.h"
#include "errors/measures.h"
#include "errors/picture_errors.h"
#include "fit/cross_validated_fits.h"
#include "fit/noise.h"
#include "fit/request_traits.h"
#include "fit/requests.h"
#include "measured/tables.h"
#include "models/kind/parameters.h"
#include "models/kinds.h"
#include "models/model_files.h"
#include "models/pm/pm_functions.h"
#include "models/su/su_functions.h"
#include "observe/albedo_bound.h"
#include "observe/observations.h"
#include "observe/pair_weights.h"
#include "samples/fit_pm_to_samples.h"
#include "samples/folds.h"
#include "samples/observe_samples.h"
#include "srbf/fit.h"

namespace SRBF_NAMESPACE {
namespace {

/// The draft of a table uses the first observations, and is not perturbed.
constexpr std::size_t k_draft_pairs = 4096;
constexpr int k_draft_starts = 3;

/// Approximate shares of the time of a fit until something is observed or fitted.
constexpr double k_smoothed = 0.5, k_observed = 0.1, k_samples_observed = 0.05, k_drafts_observed = 0.3,
                 k_fitted = 0.75;
/// Approximate shares of the time of measuring the errors.
constexpr double k_matrix_measured = 0.75, k_heldout_measured = 0.9, k_albedo_measured = 0.95;

/// Writes the main errors into the model's provenance.
void record(const Comparison& errors, Model& model) {
    const auto set = [&](const char* name, double value) { model.provenance[name] = fmt::format("{:.4g}", value); };
    set("squared_error_ratio", errors.matrix.squared_error_ratio);
    set("heldout_squared_error_ratio", errors.heldout.squared_error_ratio);
    set("heldout_squared_error_ratio_cosine", errors.heldout.squared_error_ratio_cosine);
    set("albedo_error", errors.albedo_error);
    for (const PictureErrorName& error : k_picture_errors) set(error.name, errors.appearance.mean.*error.member);
    if (errors.heldout_appearance) set("heldout_delta_e_itp", errors.heldout_appearance->mean.delta_e);
}

Result<FitOutcome> fit_and_measure(Fitter fitter, const FitRequest& request, const ProgressToken& progress) {
    auto outcome = fitter.fit(request, progress.part(0, k_fitted));
    if (!outcome) return outcome;
    if (const auto within = check_range(outcome->model, "fit"); !within) return within.error();
    const auto measured = fitter.measure(*outcome, request, progress.part(k_fitted, 1));
    return measured ? std::move(outcome) : measured.error();
}

}  // namespace

// ---- Stages common to tables and samples ----

Result<FitOutcome> fit_view_by_view(const Evaluate& f, const FitRequest& request, const ProgressToken& progress) {
    const SuRequest& su = std::get<SuRequest>(request.model);
    const auto matrix =
        tabulate(f, {.directions = su.directions, .discretise = su.discretise, .threads = request.threads},
                 progress.part(0, k_observed));
    if (!matrix) return matrix.error();
    const SuFitOptions options{.lobes = su.lobes,
                               .objective = request.objective,
                               .max_theta = request.theta(),
                               .interpolation = su.interpolation,
                               .neighbours = su.neighbours,
                               .seed = request.seed,
                               .threads = request.threads};
    auto fitted = fit_su(*matrix, options, progress.part(k_observed, 1));
    if (!fitted) return fitted.error();
    if (progress.cancelled()) return cancelled_error("fit");
    if (fitted->empty == su.directions) return no_data_error("fit", "values", "some above 0");
    if (su.index) fitted->model.index = index_texture(fitted->model, *su.index);
    const int empty = fitted->empty;
    FitOutcome outcome = outcome_of(*std::move(fitted));
    outcome.masked = matrix->masked;
    outcome.clamped = matrix->clamped;
    outcome.raw_bytes = raw_bytes(std::uint64_t(su.directions));
    outcome.empty_directions = empty;
    return outcome;
}

Result<FitOutcome> fit_by_kind(const FitRequest& request, const Observations& observations, bool is_isotropic,
                               const ProgressToken& progress) {
    return std::visit(
        [&]<typename R>(const R& kind) -> Result<FitOutcome> {
            if constexpr (std::same_as<R, PmRequest> || std::same_as<R, SuRequest>) {
                misused("a fit to observations alone");
            } else {
                auto fit = Kind<typename R::Model>::fit(observations, kind, {is_isotropic, request.threads}, progress);
                if (!fit) return fit.error();
                return outcome_of(*std::move(fit));
            }
        },
        request.model);
}

// ---- The fitter ----

struct Fitter::State {
    explicit State(Evaluate f, const Measured* measured = nullptr)
        : measured_(measured), signed_(std::move(f)), clamped_(non_negative(signed_)) {}

    const ScatteredSamples* samples() const {
        return measured_ ? std::get_if<ScatteredSamples>(&measured_->table) : nullptr;
    }
    Result<Done> validate(const FitRequest& request, bool is_draft) const {
        if (measured_ && std::holds_alternative<BsdfTable>(measured_->table))
            return argument_error("fit", "measurement", "a BRDF", "reflection and transmission, for fit_bsdf");
        const auto refused = [](const char* expected, std::string_view found) {
            return argument_error("fit", "spectral channels", expected, std::string(found));
        };
        if (request.spectral && (!measured_ || wavelengths(*measured_).empty()))
            return refused("a measurement at wavelengths", "one of colours");
        if (request.spectral && !std::holds_alternative<PmRequest>(request.model))
            return refused("the model pm", model_name(request));
        if (is_draft && !std::holds_alternative<PmRequest>(request.model))
            return argument_error("fit", "draft", "the model pm", std::string(model_name(request)));
        const auto target = target_of(request);
        if (target && samples())
            return argument_error("fit", "target delta E", "a measured table", "scattered samples");
        if (target && !(*target > 0 && *target <= k_most_delta_e))
            return argument_error("fit", "target delta E", fmt::format("above 0, at most {}", k_most_delta_e),
                                  fmt::format("{}", *target));
        return Done{};
    }

    /// Measures the errors of `outcome`. A fit to samples is compared with these, gaps filled.
    Result<Done> measure(FitOutcome& outcome, const FitRequest& request, const ProgressToken& progress) const {
        Evaluate reference = clamped_;
        if (samples()) {
            const auto at = sample_observations_.find(key(request));
            if (at != sample_observations_.end() && at->second.gap_filled) {
                reference = evaluator(*at->second.gap_filled);
            } else {
                auto made = fill_gaps(*samples(), request.theta(), request.threads);
                if (!made) return made.error();
                reference = evaluator(*std::move(made));
            }
        } else {
            measure_pairs(outcome, request, progress);
        }
        if (outcome.errors && !progress.cancelled()) measure_appearance(outcome, reference, request, progress);
        return Done{};
    }
    /// The errors over pairs of directions of a fit to a table.
    void measure_pairs(FitOutcome& outcome, const FitRequest& request, const ProgressToken& progress) const {
        const Channels f = channels_of(request);
        const Channels others[] = {channels(outcome.model)};
        const auto options = [&](double begin, double end) {
            return MeasureOptions{request.theta(), request.threads, progress.part(begin, end)};
        };
        const auto matrix =
            measure_matrix(f, others, options(0, k_matrix_measured), matrix_directions(outcome.model, request.theta()));
        const auto heldout = measure_heldout(f, others, options(k_matrix_measured, k_heldout_measured));
        outcome.errors = {matrix[0], heldout[0], 0};
    }
    void measure_appearance(FitOutcome& outcome, const Evaluate& reference, const FitRequest& request,
                            const ProgressToken& progress) const {
        const Evaluate fitted = evaluator(outcome.model);
        outcome.errors->albedo_error =
            albedo_errors(reference, {&fitted, 1}, {request.theta(), request.threads, progress})[0];
        std::vector<Evaluate> brdfs{reference, fitted};
        std::vector<ComparedPair> pairs{{0, 1}};
        const auto compared = [&](Evaluate brdf, bool is_reference) {
            pairs.push_back(is_reference ? ComparedPair{brdfs.size(), 1} : ComparedPair{0, brdfs.size()});
            brdfs.push_back(std::move(brdf));
            return pairs.size() - 1;
        };
        const std::size_t against_exchanged = samples() ? 0 : compared(exchanged(reference), false),
                          against_smoothed = smoothed_ ? compared(smoothed_, true) : 0,
                          against_mean =
                              !samples() && is_reciprocal(request) ? compared(reciprocal_mean(reference), true) : 0,
                          folds = pairs.size();
        for (const Model& without_fold : outcome.without_fold) compared(evaluator(without_fold), false);
        const auto appearance = compare_pictures(brdfs, pairs,
                                                 {.threads = request.threads,
                                                  .is_isotropic = are_isotropic(outcome),
                                                  .progress = progress.part(k_albedo_measured, 1)});
        outcome.errors->appearance = appearance[0];
        if (folds < pairs.size()) outcome.errors->heldout_appearance = mean_of(std::span(appearance).subspan(folds));
        if (appearance[against_exchanged].mean.delta_e > 0 && against_exchanged > 0)
            outcome.exchanged = appearance[against_exchanged];
        if (against_smoothed > 0) outcome.against_smoothed = appearance[against_smoothed];
        if (against_mean > 0) outcome.against_mean = appearance[against_mean];
    }
    /// True if the measurement and the fit to it do not change when light and viewer turn together.
    bool are_isotropic(const FitOutcome& outcome) const {
        return measured_ && is_isotropic(*measured_) && is_isotropic(outcome.model);
    }
    /// The channels that are fitted, and that errors are measured against.
    Channels channels_of(const FitRequest& request) const {
        return request.spectral ? spectra(*measured_) : rgb_channels(clamped_);
    }

    Result<FitOutcome> finished(Result<FitOutcome> outcome, const FitRequest& request,
                                std::chrono::steady_clock::time_point start, const ProgressToken& progress) const {
        if (progress.cancelled()) return cancelled_error("fit");
        if (!outcome) return outcome;
        outcome->fit_seconds = seconds_since(start);
        outcome->max_theta = request.theta();
        outcome->noise = noise_;
        outcome->model.provenance = {{"generator", "srbf " SRBF_VERSION},
                                     {"objective", std::string(name(request.objective))},
                                     {"max_theta", fmt::format("{:.6g}", request.theta() / k_degree)},
                                     {"seed", fmt::format("{}", request.seed)}};
        if (const auto* openpbr = std::get_if<OpenPbrRequest>(&request.model))
            outcome->model.provenance["surface"] = name(openpbr->surface);
        if (const auto* pm = std::get_if<PmRequest>(&request.model); pm && pm->effort != 1)
            outcome->model.provenance["effort"] = fmt::format("{:.6g}", pm->effort);
        if (measured_) name_source(outcome->model, *measured_);
        return outcome;
    }

    // The key of kept observations: everything in a request that they depend on. These are the objective, θmax, the
    // seed, and whether they are spectral, of gap-filled samples, and of the reciprocal mean.
    using Key = std::tuple<Objective, double, std::uint64_t, bool, bool, bool>;
    Key key(const FitRequest& request) const {
        return {request.objective,
                request.theta(),
                request.seed,
                request.spectral,
                samples() && std::holds_alternative<PmRequest>(request.model),
                is_reciprocal(request)};
    }

    Result<const Observations*> observed(const FitRequest& request, const ProgressToken& progress) {
        if (const auto at = observations_.find(key(request)); at != observations_.end()) return &at->second;
        const auto fitted = [&](const Evaluate& f) { return f && is_reciprocal(request) ? reciprocal_mean(f) : f; };
        auto made = observe(fitted(signed_),
                            {.objective = request.objective,
                             .max_theta = request.theta(),
                             .seed = request.seed,
                             .threads = request.threads,
                             .smoothed = fitted(smoothed_),
                             .noise = noise_ ? largest_share(*noise_) : 0},
                            progress);
        if (!made) return made.error();
        if (request.spectral) {
            Channels spectra = signed_spectra(*measured_);
            observe_spectra(*made, is_reciprocal(request) ? reciprocal_mean(std::move(spectra)) : spectra);
        }
        return &observations_.emplace(key(request), *std::move(made)).first->second;
    }
    Result<const SampleObservations*> observed_samples(const FitRequest& request, const ProgressToken& progress) {
        if (const auto at = sample_observations_.find(key(request)); at != sample_observations_.end())
            return &at->second;
        auto made = observe(*samples(), observe_options(request), progress);
        if (!made) return made.error();
        return &sample_observations_.emplace(key(request), *std::move(made)).first->second;
    }
    /// Determines the noise of the table, and smooths it if it is noisy. Returns the token for the rest of the
    /// progress.
    Result<ProgressToken> smooth(const FitRequest& request, const ProgressToken& progress) {
        if (!noise_) noise_ = noise_of(signed_);
        if (!is_noisy(*noise_) || smoothed_) return progress;
        auto made = smoothed(signed_, *noise_, looks_isotropic(request), request.threads, progress.part(0, k_smoothed));
        if (!made) return made.error();
        smoothed_ = *std::move(made);
        return progress.part(k_smoothed, 1);
    }
    bool looks_isotropic(const FitRequest& request) {
        const auto [at, is_new] = isotropic_.try_emplace(request.theta());
        if (is_new) at->second = is_isotropic(signed_, request.theta(), noise_ ? noise_->deviation : Rgb{});
        return at->second;
    }
    /// True if a reciprocal model is fitted, to the mean of a table.
    bool is_reciprocal(const FitRequest& request) const {
        const auto* pm = std::get_if<PmRequest>(&request.model);
        return pm && srbf::is_reciprocal(pm->form.value_or(samples() ? PmForm::extended : k_default_form));
    }
    bool axial(const FitRequest& request) {
        const PmRequest& pm = std::get<PmRequest>(request.model);
        if (pm.axial) return *pm.axial;
        return looks_isotropic(request);
    }

    Result<FitOutcome> fit_samples(const FitRequest& request, bool is_draft, const ProgressToken& progress) {
        Result<std::vector<int>> fold = std::vector<int>{};
        if (!is_draft) fold = assign_folds(*samples(), request.theta(), request.seed);
        if (!fold) return fold.error();
        if (std::holds_alternative<SuRequest>(request.model))
            return fit_to_samples(*samples(), *fold, nullptr, request, progress);
        const double share = is_draft ? k_drafts_observed : k_samples_observed;
        const auto observations = observed_samples(request, progress.part(0, share));
        if (!observations) return observations.error();
        const ProgressToken fitting = progress.part(share, 1);
        return is_draft ? draft_of_samples(*samples(), **observations, request, fitting)
                        : fit_to_samples(*samples(), *fold, *observations, request, fitting);
    }

    Result<FitOutcome> fit_table(const FitRequest& request, bool is_draft, const ProgressToken& progress) {
        const auto quiet = smooth(request, progress);
        if (!quiet) return quiet.error();
        if (std::holds_alternative<SuRequest>(request.model))
            return fit_view_by_view(smoothed_ ? smoothed_ : signed_, request, *quiet);  // tabulates f itself
        const double share = is_draft ? k_drafts_observed : k_observed;
        const auto found = observed(request, quiet->part(0, share));
        if (!found) return found.error();
        const Observations& observations = **found;
        const ProgressToken fitting = quiet->part(share, 1);
        auto outcome = std::holds_alternative<PmRequest>(request.model)
                           ? fit_lobes(observations, request, is_draft, fitting)
                           : fit_by_kind(request, observations, looks_isotropic(request), fitting);
        if (!outcome) return outcome;
        outcome->masked = observations.masked;
        outcome->largest_albedo = std::max(1.0, most_measured_albedo(observations));
        outcome->clamped = observations.clamped;
        outcome->raw_bytes = raw_bytes(k_matrix_directions, channels(outcome->model).count());
        return outcome;
    }

    Result<FitOutcome> fit_lobes(const Observations& observations, const FitRequest& request, bool is_draft,
                                 const ProgressToken& progress) {
        const PmRequest& pm = std::get<PmRequest>(request.model);
        PmFitOptions options = pm_options(request, axial(request), k_default_form);
        if (is_draft)
            options.starts = k_draft_starts, options.perturbations = 0;
        else if (pm.size && std::holds_alternative<AutomaticLobes>(*pm.size))
            return fit_first_size(observations, options, request, progress);
        auto fitted = is_draft ? fit_pm(first_pairs(observations, k_draft_pairs), options, progress)
                               : fit_pm(observations, options, progress);
        if (!fitted) return fitted.error();
        return outcome_of(*std::move(fitted));
    }

    /// Fits one size after the other, until the mean ΔE_ITP against the fitted function reaches the target.
    Result<FitOutcome> fit_first_size(const Observations& observations, PmFitOptions options, const FitRequest& request,
                                      const ProgressToken& progress) const {
        const double target = target_of(request).value_or(k_default_delta_e);
        const Evaluate reference = is_reciprocal(request) ? reciprocal_mean(clamped_) : clamped_;
        FitOutcome outcome;
        std::vector<Trial> path;
        double done = 0;
        for (const int lobes : k_tried_lobes) {
            options.lobes = lobes;
            const double next = done + (1 - done) / 2;  // each takes about as long as all smaller ones
            auto fitted = fit_pm(observations, options, progress.part(done, next));
            if (!fitted) return fitted.error();
            if (progress.cancelled()) return cancelled_error("fit");
            done = next;
            outcome = outcome_of(*std::move(fitted));
            const Evaluate others[] = {evaluator(outcome.model)};
            const PictureOptions of_pictures{.threads = request.threads, .is_isotropic = are_isotropic(outcome)};
            const double error = compare_pictures(reference, others, of_pictures)[0].mean.delta_e;
            path.push_back({lobes, payload_bytes(outcome.model), error});
            outcome.reached = error <= target;
            if (outcome.reached) break;
        }
        outcome.path = std::move(path);
        return outcome;
    }

    Result<FitOutcome> fit(const FitRequest& request, bool is_draft, const ProgressToken& progress) {
        const auto start = std::chrono::steady_clock::now();
        if (const auto valid = validate(request, is_draft); !valid) return valid.error();
        auto outcome = samples() ? fit_samples(request, is_draft, progress) : fit_table(request, is_draft, progress);
        return finished(std::move(outcome), request, start, progress);
    }

    const Measured* measured_;  // null: a function
    Evaluate signed_, clamped_;
    std::optional<Noise> noise_;   // noise of a table that was fitted
    Evaluate smoothed_ = nullptr;  // if it is noisy
    std::map<Key, Observations> observations_;
    std::map<Key, SampleObservations> sample_observations_;
    std::map<double, bool> isotropic_;  // the keys are θmax
};

Fitter::Fitter(const Measured& measured) : state_(std::make_unique<State>(signed_evaluator(measured), &measured)) {}
Fitter::Fitter(Evaluate f) : state_(std::make_unique<State>(std::move(f))) {}
Fitter::Fitter(Fitter&&) noexcept = default;
Fitter& Fitter::operator=(Fitter&&) noexcept = default;
Fitter::~Fitter() = default;

Result<FitOutcome> Fitter::fit(const FitRequest& request, const ProgressToken& progress) {
    return state_->fit(request, false, progress);
}

Result<FitOutcome> Fitter::draft(const FitRequest& request, const ProgressToken& progress) {
    return state_->fit(request, true, progress);
}

Result<Done> Fitter::measure(FitOutcome& outcome, const FitRequest& request, const ProgressToken& progress) const {
    const StandardArithmetic mode;
    if (const auto measured = state_->measure(outcome, request, progress); !measured) return measured.error();
    if (!progress.report("measuring the error", 1)) {
        outcome.errors.reset();
        return cancelled_error("measure");
    }
    if (outcome.errors) record(*outcome.errors, outcome.model);  // a draft of a fit to samples has none
    return Done{};
}

Result<FitOutcome> fit(const Measured& measured, const FitRequest& request, const ProgressToken& progress) {
    try {
        auto outcome = fit_and_measure(Fitter(measured), request, progress);
        return outcome ? std::move(outcome) : of_source(outcome.error(), measured);
    } catch (const std::bad_alloc&) {
        return out_of_memory_error(measured.source);
    }
}
Result<FitOutcome> fit(Evaluate f, const FitRequest& request, const ProgressToken& progress) {
    return fit_and_measure(Fitter(std::move(f)), request, progress);
}

std::vector<Vec3f> matrix_directions(const Model& model, double theta_max) {
    if (const auto* su = std::get_if<SuModel>(&model.model)) return su->direction;
    return fibonacci_directions(k_matrix_directions, theta_max);
}

}  // namespace srbf
