#include "srbf/fit_batch.h"

#include "base/errors.h"
#include "base/half.h"
#include "base/parallel.h"
#include "base/reporter.h"
#include "errors/measures.h"
#include "fit/example_lobes.h"
#include "fit/requests.h"
#include "fit/texel_stream.h"
#include "models/ggx/ggx_kind.h"
#include "observe/bound.h"
#include "observe/pair_weights.h"
#include "observe/pairs.h"
#include "samples/fit_pm_to_samples.h"
#include "samples/gap_filled_samples.h"
#include "samples/observe_samples.h"
#include "srbf/convert.h"
#include "srbf/sampling.h"

namespace SRBF_NAMESPACE {
namespace {

Error refused(const char* what, const char* expected, std::string found) {
    return argument_error("fit_batch", what, expected, std::move(found));
}

/// With fewer pairs than 4096, lobes are found that the samples do not show; with more the error falls by little.
constexpr std::size_t k_texel_pairs = 4096;

/// Everything that all texels have in common.
struct Batch {
    const SharedPairs& pairs;
    FitRequest request;
    PmFitOptions options;
    bool all_above;            // the horizon
    ScatteredSamples samples;  // if so, of a texel that was measured at all pairs, without its values
    ExampleLobes examples;     // from which fits start
    Observations between;      // with examples: further pairs, without values
};

/// Pairs that are drawn as those of tables are. With 1024 the errors of 64 GGX materials are the same.
constexpr std::size_t k_between_pairs = 256;
Observations pairs_between(const FitRequest& request) {
    const PairDraws draws(request.theta(), false, 0, std::mt19937_64(request.seed));
    Observations between;
    for (std::size_t i = 0; between.f.size() < k_between_pairs; ++i)
        if (const auto drawn = draws.fitted(i)) between.add(drawn->pair.wl, drawn->pair.wv, {}, drawn->weight);
    return between;
}

Result<Batch> batch_of(const SharedPairs& pairs, const BatchOptions& options) {
    const auto* pm = std::get_if<PmRequest>(&options.request.model);
    if (!pm || !lobes_of(*pm)) return refused("model", "multivariate lobes, a number of them", "another request");
    if (options.request.spectral) return refused("channels", "colours", "spectra");
    if (pairs.wl.empty() || pairs.wl.size() != pairs.wv.size())
        return refused("pairs of directions", "as many to the light as to the viewer, at least 1",
                       fmt::format("{} and {}", pairs.wl.size(), pairs.wv.size()));
    const PmFitOptions lobes = pm_options(options.request, pm->axial.value_or(pairs.isotropic), PmForm::extended);
    for (const PmModel& example : options.examples)
        if (example.form != lobes.form || example.lobes != lobes.lobes || example.variates != lobes.variates ||
            example.axial != lobes.axial)
            return refused("examples", "of the form and size of the fits", "others");
    Batch batch{pairs, options.request, lobes, true, {}, {options.examples, lobes}, {}};
    if (!batch.examples.empty()) batch.between = pairs_between(options.request);
    for (std::size_t i = 0; i < pairs.wl.size(); ++i)
        batch.all_above = batch.all_above && above_horizon(pairs.wl[i], pairs.wv[i]);
    batch.request.threads = 1;
    batch.options.threads = 1;
    batch.options.starts = options.starts, batch.options.perturbations = options.perturbations;
    batch.samples.isotropic = pairs.isotropic;
    batch.samples.wl = pairs.wl, batch.samples.wv = pairs.wv;
    if (batch.all_above) make_index(batch.samples);
    return batch;
}

/// A model of the batch's form and size that is 0 everywhere.
PmModel black_model(const PmFitOptions& of) {
    const auto J = std::size_t(of.lobes), N = std::size_t(of.variates);
    PmModel model;
    model.form = of.form, model.axial = of.axial, model.lobes = of.lobes, model.variates = of.variates;
    model.coefficient.assign(J, {});
    model.log_scale.assign(J, 0);
    model.centre.assign(J * N, {0, 0, 1});
    model.bandwidth.assign(J * N, 0);
    model.parameterization.assign(N, {});
    model.exponent.assign(J * std::size_t(features(of.form)), 0);
    return model;
}

ScatteredSamples samples_of(const Batch& batch, std::span<const Rgb> f) {
    ScatteredSamples samples = valid_samples(batch.pairs.wl, batch.pairs.wv, f, batch.pairs.isotropic);
    if (batch.all_above && samples.masked == 0)
        samples.index = batch.samples.index;
    else if (!samples.wl.empty())
        make_index(samples);
    return samples;
}

TexelFit without(const Batch& batch, TexelState state, std::optional<Error> failure) {
    return {black_model(batch.options), state, {}, {}, std::move(failure)};
}

/// The constant f that is nearest to the samples, as a model of the batch's form and size.
PmModel matte_model(const PmFitOptions& of, const Observations& samples) {
    PmModel model = black_model(of);
    const auto mean = mean_value(samples);
    for (int c = 0; c < 3; ++c) model.coefficient[0][c] = round_to_half(float(mean[std::size_t(c)]));
    return model;
}

/// The squares of noise fall by a share of P / n in the mean where P numbers are fitted to n samples. Lobes that lower those
/// about a simpler model by no more than so many times that follow noise, and may rise where nothing is measured.
constexpr double k_noise_of_lobes = 3;

bool explains_as_much(const Evaluate& simpler, const PmModel& fitted, const Observations& samples, std::size_t values) {
    const double share = k_noise_of_lobes * double(payload_bytes(fitted)) / 2 / double(values);
    return loss_of(samples, simpler) <= (1 + share) * loss_of(samples, evaluator(fitted));
}

/// The fit of samples with these observations: the model, or a constant in its place.
TexelFit fitted_texel(const Batch& batch, const ScatteredSamples& samples, const Observations& observed, PmModel model,
                      StopReason stop) {
    TexelFit fit{std::move(model), TexelState::fitted, {}, stop, {}};
    PmModel matte = matte_model(batch.options, observed);
    if (explains_as_much(evaluator(matte), fit.model, observed, 3 * samples.wl.size())) fit.model = std::move(matte);
    fit.errors = measure_samples(samples.wl, samples.wv, samples.colour, evaluator(fit.model), batch.request.theta());
    return fit;
}

/// Returns the values of Lambert and one lobe of GGX between the samples if they are as good at the samples as `lobes`.
/// They weigh as much as the samples. Lobes that follow both follow less of the samples' noise.
std::optional<Observations> expected_between(const Batch& batch, const Observations& samples, const PmModel& lobes) {
    const auto ggx = Kind<GgxModel>::fit(samples, {1}, {.threads = 1});
    if (!ggx) return {};
    const Evaluate values = evaluator(ggx->unrounded);
    if (!explains_as_much(values, lobes, samples, 3 * samples.f.size())) return {};
    Observations between = batch.between;
    between.objective = samples.objective, between.typical = samples.typical;
    values(between.wl, between.wv, between.f);
    const double most = k_most_excess * largest_measured(samples);
    for (std::size_t i = 0; i < between.f.size(); ++i) {
        const double bright = double(largest_of(between.f[i])) * bound_cosines(between.wl[i], between.wv[i]);
        for (int c = 0; c < 3 && bright > most; ++c) between.f[i][c] *= float(most / bright);
    }
    weigh_all(between, 1);
    return between;
}

TexelFit fit_from_examples(const Batch& batch, const ScatteredSamples& samples) {
    const Objective objective = batch.request.objective;
    Observations observed = observations_of(samples, samples_within(samples, batch.request.theta()), false, false);
    observed.objective = objective;
    observed.typical = typical_value(objective, observed.wl, observed.wv, observed.f, observed.weight);
    if (!(observed.typical > 0))
        return without(batch, TexelState::failed, no_data_error("samples", "values", "some above 0"));
    weigh_all(observed, 1);
    ExampleLobes::Fit fit = batch.examples.fit(observed);
    if (const auto between = expected_between(batch, observed, fit.model)) fit = batch.examples.fit(observed, *between);
    return fitted_texel(batch, samples, observed, std::move(fit.model), fit.stop);
}

TexelFit fit_texel(const Batch& batch, std::span<const Rgb> f, const ProgressToken& progress) {
    const ScatteredSamples samples = samples_of(batch, f);
    if (samples.wl.empty()) return without(batch, TexelState::failed, no_data_error("texel", "values"));
    if (std::ranges::all_of(samples.colour, [](const Rgb& of) { return !(largest_of(of) > 0); }))
        return without(batch, TexelState::black, {});
    if (!batch.examples.empty()) return fit_from_examples(batch, samples);
    ObserveSamplesOptions observing{batch.request.objective, batch.request.theta(), batch.request.seed};
    observing.threads = 1, observing.only_gap_filled = k_texel_pairs;
    const auto observed = observe(samples, observing, progress);
    if (!observed) return without(batch, TexelState::failed, observed.error());
    auto fitted = fit_pm(*observed, {batch.options, false}, progress);
    if (!fitted) return without(batch, TexelState::failed, fitted.error());
    return fitted_texel(batch, samples, observed->samples, std::move(fitted->model), fitted->stop);
}

Result<std::vector<TexelFit>> fit_batch(const Batch& batch, std::span<const Rgb> f, int threads, Reporter& reporter) {
    const StandardArithmetic mode;
    const std::size_t M = batch.pairs.wl.size();
    std::vector<TexelFit> fits(f.size() / M);
    parallel_for(fits.size(), threads, [&](std::size_t i) {
        if (reporter.cancelled()) return;
        // Each stops when all do.
        const ProgressToken progress([&](const Progress&) { return !reporter.cancelled(); });
        fits[i] = fit_texel(batch, f.subspan(i * M, M), progress);
        reporter.advance("fitting texels", 1);
    });
    if (reporter.cancelled()) return cancelled_error("fit_batch");
    return fits;
}

}  // namespace

Result<std::vector<TexelFit>> fit_batch(const SharedPairs& pairs, std::span<const Rgb> f, const BatchOptions& options,
                                        const ProgressToken& progress) {
    const auto batch = batch_of(pairs, options);
    if (!batch) return batch.error();
    if (f.size() % pairs.wl.size() != 0)
        return refused("values", "as many for each texel as there are pairs", fmt::format("{}", f.size()));
    Reporter reporter(progress, double(std::max<std::size_t>(f.size() / pairs.wl.size(), 1)));
    return fit_batch(*batch, f, options.request.threads, reporter);
}

Result<Done> fit_batch(const SharedPairs& pairs, const TexelStream& texels, const BatchOptions& options,
                       const ProgressToken& progress) {
    const auto batch = batch_of(pairs, options);
    if (!batch) return batch.error();
    if (texels.slab == 0) return refused("texels of a slab", "at least 1", "0");
    const std::size_t all = texels.end > texels.begin ? texels.end - texels.begin : 0;
    Reporter reporter(progress, double(std::max<std::size_t>(all, 1)));
    std::vector<Rgb> f;
    for (std::size_t first = texels.begin; first < texels.end; first += texels.slab) {
        const std::size_t count = std::min(texels.slab, texels.end - first);
        if (texels.is_done && texels.is_done(first, count)) {
            reporter.advance("fitting texels", double(count));
            continue;
        }
        f.resize(count * pairs.wl.size());
        if (const auto read = texels.read(first, f); !read) return read.error();
        const auto fits = fit_batch(*batch, f, options.request.threads, reporter);
        if (!fits) return fits.error();
        if (const auto taken = texels.take(first, *fits); !taken) return taken.error();
    }
    return Done{};
}

}  // namespace srbf
