// What `srbf fit` does with a measurement, by the kind of model and of input.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <mutex>

#include "app/fit.h"
#include "render/preview.h"
#include "srbf/directions.h"

namespace srbf {
namespace {

/// Bytes of f at all pairs of n directions in floats.
constexpr std::uint64_t raw_bytes(std::uint64_t n, std::uint64_t channels = 3) {
    return n * n * channels * sizeof(float);
}

/// What is fitted of a measurement, and measured against.
Channels channels_of(const FitRequest& request, const Measured& measured) {
    return request.spectral() ? spectra(measured) : rgb_channels(evaluator(measured));
}

/// Lobes that cross-validation chooses from.
constexpr int k_tried_lobes[] = {2, 3, 4, 6, 9, 12};
/// That many tell whether to fill the gaps between samples.
constexpr int k_first_tried = 6;
/// Of models that err no more than this times the least the smallest is taken.
constexpr double k_as_good = 1.03;
/// A few thousand samples need a shorter search than a table, and are searched a dozen times.
constexpr int k_sample_starts = 6, k_sample_kicks = 14;
constexpr std::uint64_t k_pairs_in_short = 20000;

FitOptions pm_options(const FitRequest& request, bool axial) {
    FitOptions options;
    options.form = *form_named(request.form);
    options.axial = axial;
    options.reciprocal = request.reciprocal;
    if (request.lobes > 0) options.lobes = request.lobes;
    options.variates = request.variates;
    options.log_scale = !request.no_scale;
    options.seed = request.seed;
    options.threads = request.threads;
    return options;
}

/// A model, and the same before rounding.
template <typename Fit> void take(Outcome& outcome, Fit&& fit) {
    outcome.model.model = std::move(fit.model);
    outcome.unrounded.model = std::move(fit.unrounded);
}

// ---- Tables ----

Result<Outcome> fit_pm(const FitRequest& request, const Measured& measured, const Observations& observations,
                       const ProgressCallback& progress) {
    const double theta_max = request.theta() * k_degree;
    const FitOptions options =
        pm_options(request, request.axial > 0 || (request.axial == 0 && is_isotropic(evaluator(measured), theta_max)));
    const Channels f = channels_of(request, measured);
    const auto judge = [&](const PmModel& model, bool in_short) {
        const Channels others[] = {request.spectral() ? spectra(model) : rgb_channels(evaluator(model))};
        const std::uint64_t pairs = in_short ? k_pairs_in_short : k_heldout_pairs;
        return error_of(measure_heldout(f, others, {theta_max, request.threads}, pairs)[0], request.objective());
    };
    Outcome outcome;
    if (request.budget == 0 && !(request.target_error > 0)) {
        // The number of lobes that is asked for, or of several the best trade of bytes and error.
        double least = std::numeric_limits<double>::infinity();
        for (const int lobes : request.lobes_auto ? std::vector<int>(std::begin(k_tried_lobes), std::end(k_tried_lobes))
                                                  : std::vector<int>{options.lobes}) {
            FitOptions of_this = options;
            of_this.lobes = lobes;
            auto fitted = srbf::fit_pm(observations, of_this, progress);
            if (!fitted) return fitted.error();
            double trade = 0;
            if (request.lobes_auto) {
                const Step step{of_this.form,
                                of_this.axial,
                                lobes,
                                of_this.variates,
                                payload_bytes(fitted->model),
                                judge(fitted->model, false),
                                true};
                outcome.path.push_back(step);
                trade = double(step.bytes) * step.error;
            }
            if (!(trade < least)) continue;
            least = trade;
            outcome.stop = fitted->stop;
            take(outcome, *std::move(fitted));
        }
        return outcome;
    }
    auto chosen = choose_pm(observations, options, {request.budget, request.target_error}, judge, progress);
    if (!chosen) return chosen.error();
    outcome.path = std::move(chosen->path);
    outcome.reached = chosen->reached;
    outcome.stop = chosen->fit.stop;
    take(outcome, std::move(chosen->fit));
    return outcome;
}

Result<Outcome> fit_su(const FitRequest& request, const Evaluate& f, const ProgressCallback& progress) {
    const auto matrix = tabulate(f, {.directions = request.directions,
                                     .between = request.between,
                                     .discretise = *discretise_named(request.discretise),
                                     .threads = request.threads});
    if (!matrix) return matrix.error();
    SuFitOptions options;
    if (request.lobes > 0) options.lobes = request.lobes;
    options.objective = request.objective();
    options.max_theta = request.theta() * k_degree;
    options.interpolation = *interpolation_named(request.interpolation);
    options.neighbours = request.neighbours;
    options.seed = request.seed;
    options.threads = request.threads;
    auto fitted = srbf::fit_su(*matrix, options, progress);
    if (!fitted) return fitted.error();
    if (fitted->empty == request.directions) return Error{"fit", {}, "values", "some above 0", "none"};
    if (!request.with_index.empty()) fitted->model.index = index_texture(fitted->model, *map_named(request.with_index));
    Outcome outcome;
    outcome.masked = matrix->masked;
    outcome.clamped = matrix->clamped;
    outcome.raw_bytes = raw_bytes(std::uint64_t(request.directions));
    outcome.empty = fitted->empty;
    outcome.stop = fitted->stop;
    take(outcome, *std::move(fitted));
    return outcome;
}

Result<Outcome> fit_ggx(const FitRequest& request, const Observations& observations) {
    auto fitted = srbf::fit_ggx(observations, {std::max(request.lobes, 1), request.threads});
    if (!fitted) return fitted.error();
    Outcome outcome;
    take(outcome, *std::move(fitted));
    return outcome;
}

Result<Outcome> fit_table(const FitRequest& request, const Measured& measured, const ProgressCallback& progress) {
    const Evaluate f = signed_evaluator(measured);
    if (request.model == "su") return fit_su(request, f, progress);
    auto observations = observe(f, {.objective = request.objective(),
                                    .max_theta = request.theta() * k_degree,
                                    .seed = request.seed,
                                    .threads = request.threads});
    if (!observations) return observations.error();
    if (request.spectral()) observe_spectra(*observations, signed_spectra(measured));
    auto outcome =
        request.model == "ggx" ? fit_ggx(request, *observations) : fit_pm(request, measured, *observations, progress);
    if (!outcome) return outcome;
    outcome->masked = observations->masked;
    outcome->clamped = observations->clamped;
    outcome->raw_bytes = raw_bytes(k_matrix_directions, channels(outcome->model).count());
    return outcome;
}

void judge_table(const FitRequest& request, const Measured& measured, Outcome& outcome) {
    const Channels f = channels_of(request, measured);
    const Channels others[] = {channels(outcome.model), channels(outcome.unrounded)};
    const MeasureOptions options{request.theta() * k_degree, request.threads};
    const auto matrix = measure_matrix(f, others, options, matrix_directions(outcome.model, options.max_theta)),
               heldout = measure_heldout(f, others, options);
    outcome.rounded = {matrix[0], heldout[0], 0};
    outcome.unrounded_too = {matrix[1], heldout[1], 0};
}

// ---- Samples ----

/// Fits of one measurement's samples: of all of them, and of each fold's rest.
class SampleFits {
  public:
    SampleFits(const FitRequest& request, const Scattered& samples, std::vector<int> fold,
               const ProgressCallback& progress)
        : request_(request), samples_(samples), fold_(std::move(fold)), progress_(progress) {}

    /// What is asked for: of pm the number of lobes may be chosen, and whether to fill between the samples is.
    Result<Outcome> run() {
        if (request_.model != "pm") return judged(0, false);
        std::vector<int> lobes;
        if (request_.lobes > 0)
            lobes = {request_.lobes};
        else
            for (const int j : k_tried_lobes)
                if (enough_samples(j) && (request_.budget == 0 || bytes(j) <= request_.budget)) lobes.push_back(j);
        if (lobes.empty()) lobes = {1};
        validations_ = double(lobes.size()) + 2;
        const int first = request_.lobes > 0 ? request_.lobes : std::min(lobes.back(), k_first_tried);
        auto alone = judged(first, false), filled = judged(first, true);
        if (!alone || !filled) return !alone ? alone : filled;
        const bool fill = error(*filled) < error(*alone);
        std::vector<Outcome> all;
        for (const int j : lobes) {
            auto one = j == first ? (fill ? filled : alone) : judged(j, fill);
            if (!one) return one;
            all.push_back(*std::move(one));
        }
        return chosen(all);
    }

  private:
    double error(const Outcome& outcome) const { return error_of(outcome.rounded.heldout, request_.objective()); }
    std::size_t bytes(int lobes) const {
        const FitOptions options = pm_options_of(lobes);
        return payload_bytes(options.form, options.axial, options.log_scale, lobes, options.variates);
    }
    /// Three values of four fifths of the samples are at least twice as many as the numbers to find.
    bool enough_samples(int lobes) const { return bytes(lobes) <= samples_.wl.size() * 12 / 5; }
    FitOptions pm_options_of(int lobes) const {
        FitOptions options = pm_options(request_, request_.axial > 0 || (request_.axial == 0 && samples_.isotropic));
        if (lobes > 0) options.lobes = lobes;
        options.starts = k_sample_starts;
        options.kicks = k_sample_kicks;
        return options;
    }

    Result<Outcome> fitted(const Scattered& samples, int lobes, bool fill) const {
        if (request_.model == "su") {
            const Measured measured{"", "", 0, samples};
            return fit_su(request_, signed_evaluator(measured), {});
        }
        const auto observations =
            observe(samples, ObserveSamplesOptions{request_.objective(), request_.theta() * k_degree, request_.seed,
                                                   request_.spectral()});
        if (!observations) return observations.error();
        Outcome outcome;
        if (request_.model == "ggx") {
            auto ggx = fit_ggx(request_, observations->samples);
            if (!ggx) return ggx;
            outcome = *std::move(ggx);
        } else {
            auto pm = srbf::fit_pm(*observations, {pm_options_of(lobes), fill}, [&](const Progress&) {
                return !progress_ || progress_({"fitting the samples", fraction()});
            });
            if (!pm) return pm.error();
            outcome.stop = pm->stop;
            outcome.filled = fill;
            take(outcome, *std::move(pm));
        }
        outcome.masked = observations->samples.masked;
        outcome.clamped = observations->samples.clamped;
        return outcome;
    }

    /// The fit of all samples, measured at them, and held out by cross-validation.
    Result<Outcome> judged(int lobes, bool fill) {
        auto outcome = fitted(samples_, lobes, fill);
        if (!outcome) return outcome;
        const auto predicted =
            cross_validate(samples_, fold_, [&](const Scattered& training) -> Result<std::vector<Model>> {
                auto of_fold = fitted(training, lobes, fill);
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
        outcome->rounded = measured_with(outcome->model, (*predicted)[0]);
        outcome->unrounded_too = measured_with(outcome->unrounded, (*predicted)[1]);
        outcome->samples = outcome->rounded.matrix.pairs;
        outcome->raw_bytes = (*predicted)[0].size() * sizeof(float);
        done_ += 1;
        return outcome;
    }

    Measures measured_against(std::span<const float> f) const {
        const double theta_max = request_.theta() * k_degree;
        if (request_.spectral()) return measure_samples(samples_.wl, samples_.wv, samples_.spectrum, f, theta_max);
        std::vector<float> colours;
        for (const Rgb& c : samples_.colour) colours.insert(colours.end(), {c.r, c.g, c.b});
        return measure_samples(samples_.wl, samples_.wv, colours, f, theta_max);
    }

    Result<Outcome> chosen(std::vector<Outcome>& all) const {
        const auto by_error = [&](const Outcome& a, const Outcome& b) { return error(a) < error(b); };
        const double least = error(*std::min_element(all.begin(), all.end(), by_error));
        const double enough = request_.target_error > 0 ? request_.target_error
                              : request_.budget > 0     ? least
                                                        : k_as_good * least;
        auto taken = std::find_if(all.begin(), all.end(), [&](const Outcome& one) { return error(one) <= enough; });
        Outcome outcome;
        const bool reached = taken != all.end();
        if (!reached) taken = std::min_element(all.begin(), all.end(), by_error);
        std::vector<Step> path;
        if (all.size() > 1)
            for (const Outcome& one : all) {
                const PmModel& model = std::get<PmModel>(one.model.model);
                path.push_back(
                    {model.form, model.axial, model.lobes, model.variates, payload_bytes(model), error(one), true});
            }
        outcome = std::move(*taken);
        outcome.path = std::move(path);
        outcome.reached = reached && (request_.budget == 0 || payload_bytes(outcome.model) <= request_.budget);
        return outcome;
    }
    double fraction() const { return std::min(done_.load() / validations_, 1.0); }

    const FitRequest& request_;
    const Scattered& samples_;
    std::vector<int> fold_;
    const ProgressCallback& progress_;
    std::atomic<double> done_ = 0;
    double validations_ = 1;
};

Result<Outcome> fit_samples(const FitRequest& request, const Measured& measured, const ProgressCallback& progress) {
    const Scattered& samples = std::get<Scattered>(measured.table);
    auto fold = draw_folds(samples, request.theta() * k_degree, request.seed);
    if (!fold) return fold.error();
    return SampleFits(request, samples, *std::move(fold), progress).run();
}

}  // namespace

Result<Outcome> fit(const FitRequest& request, const Measured& measured, const ProgressCallback& whole) {
    if (request.spectral() && wavelengths(measured).empty())
        return Error{"fit", {}, "spectral channels", "a measurement at wavelengths", "one of colours"};
    std::mutex one_at_a_time;
    const Stopwatch fitting;
    const bool of_samples = std::holds_alternative<Scattered>(measured.table);
    const double fitted = of_samples ? 0.95 : 0.7;  // measuring takes the rest
    const auto show = [&](std::string_view stage, double fraction) {
        const std::scoped_lock lock(one_at_a_time);
        return !whole || whole({stage, fraction});
    };
    const ProgressCallback progress = [&](const Progress& now) { return show(now.stage, fitted * now.fraction); };
    auto outcome = of_samples ? fit_samples(request, measured, progress) : fit_table(request, measured, progress);
    if (!outcome) return outcome;
    outcome->fit_seconds = fitting.seconds();
    outcome->max_theta = request.theta();

    show("measuring the error", fitted);
    const auto albedo_error_of = [&](const Model& model) {
        return albedo_error(evaluator(measured), evaluator(model), request.theta() * k_degree);
    };
    if (!of_samples) judge_table(request, measured, *outcome);
    outcome->rounded.albedo_error = albedo_error_of(outcome->model);
    outcome->unrounded_too.albedo_error = albedo_error_of(outcome->unrounded);

    if (!request.preview.empty()) {
        show("drawing", 0.95);
        PreviewOptions picture;
        picture.threads = request.threads;
        picture.captions[1] = fmt::format("fit, {} bytes", payload_bytes(outcome->model));
        outcome->picture = preview(evaluator(measured), evaluator(outcome->model), picture);
    }
    return outcome;
}

}  // namespace srbf
