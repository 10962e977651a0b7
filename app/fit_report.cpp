#include <thread>

#include "app/fit.h"
#include "app/hash.h"
#include "app/peak.h"
#include "base/printable.h"
#include "brdf/directions.h"
#include "errors/measures.h"
#include "errors/picture_errors.h"
#include "fit/noise.h"
#include "fit/request_traits.h"
#include "observe/albedo_bound.h"
#include "srbf/metrics.h"

namespace srbf {
namespace {

/// Prints the sizes that were tried.
void print_path(const FitRequest& request, const FitOutcome& outcome) {
    if (outcome.path.empty()) return;
    const bool is_delta_e = !outcome.samples;
    const bool is_ratio = !is_delta_e && measure_named_for(request.objective).is_ratio;
    fmt::print("\n  {:>9}  {:>10}   {}\n", "bytes", is_delta_e ? "Delta E" : is_ratio ? "error, %" : "error", "tried");
    for (const Trial& trial : outcome.path)
        fmt::print("  {:>9}  {:>10.4g}   {} lobes\n", trial.bytes, is_ratio ? 100 * trial.error : trial.error,
                   trial.lobes);
}

/// True if the table was smoothed to its noise level before the fit.
bool is_smoothed(const FitOutcome& outcome) { return outcome.against_smoothed.has_value(); }

/// The limit on the albedo of the fit; infinity: there is none.
double albedo_limit_of(const FitRequest& request, const FitOutcome& outcome) {
    const auto* model = std::get_if<PmModel>(&outcome.model.model);
    if (!model) return std::numeric_limits<double>::infinity();
    return std::get<PmRequest>(request.model).albedo_limit.value_or(default_albedo_limit(model->form));
}

/// Prints what limits the accuracy of the measurement: negative values, noise, and deviations from reciprocity.
void print_limits_of_measurement(const FitRequest& request, const FitOutcome& outcome) {
    if (outcome.clamped > 0)
        fmt::print("  negative  {} values, {}\n", grouped(outcome.clamped),
                   is_smoothed(outcome) ? "fitted as noise about their mean" : "set to 0");
    if (is_smoothed(outcome)) {
        fmt::print(
            "  noise     {:.0f} % of dark values; ΔE_ITP {:.3g} (worst {:.3g}) against the smoothed measurement\n",
            100 * fraction_of(*outcome.noise), outcome.against_smoothed->mean.delta_e,
            outcome.against_smoothed->worst_delta_e);
        if (outcome.clamped == 0)
            fmt::print(
                "            no value is negative: the data were cut off at 0, which makes dark values brighter\n");
    }
    if (const double limit = albedo_limit_of(request, outcome); outcome.largest_albedo > 1)
        fmt::print("  albedo    up to {:.4g} is measured at views to 80°; {}\n", outcome.largest_albedo,
                   limit < outcome.largest_albedo
                       ? fmt::format("the fit is held to {:g}, which adds to its error: see --albedo-limit", limit)
                       : "the fit may reflect as much");
    if (outcome.exchanged_errors) fmt::print("  reciprocal {}\n", reciprocity_text(*outcome.exchanged_errors));
    if (outcome.against_mean)
        fmt::print("  fitted to the mean with light and viewer exchanged: ΔE_ITP {:.3g} (worst {:.3g}) against it\n",
                   outcome.against_mean->mean.delta_e, outcome.against_mean->worst_delta_e);
}

/// An angle [rad] in degrees, without the rounding error of the conversion.
double degrees(double angle) { return std::round(angle / k_degree * 1e9) / 1e9; }

}  // namespace

Json report_of(const FitJob& fit, const Measured& measured, const FitOutcome& outcome) {
    const FitRequest& request = fit.request;
    const Peak peak = peak_of(measured);
    Json json{
        {"source", fit.input},  {"source_format", measured.format}, {"source_bytes", measured.bytes},
        {"output", fit.output}, {"version", SRBF_VERSION},          {"model", model_name(request)},
    };
    for (const Parameter& member : report_members(outcome.model)) json[member.name] = json_of(member);
    json.update(Json{
        {"channels", channels(outcome.model).count()},
        {"objective", name(request.objective)},
        {"max_theta", degrees(outcome.max_theta)},
        {"raw_bytes", outcome.raw_bytes},
        {k_model_hash, hash_of(write_model(outcome.model))},
        {"payload_bytes", payload_bytes(outcome.model)},
        {"auxiliary_bytes", auxiliary_bytes(outcome.model)},
        {"fit_seconds", outcome.fit_seconds},
        {"load_seconds", fit.load_seconds},
        {"seed", request.seed},
        {"threads", request.threads > 0 ? request.threads : int(std::thread::hardware_concurrency())},
        {"stop_reason", outcome.stop ? Json(name(*outcome.stop)) : Json()},
        {"masked_samples", outcome.masked},
        {"clamped_samples", outcome.clamped},
        {"peak", name(peak.position)},
        {"peak_ratio", peak.ratio},
    });
    if (outcome.empty_directions) json["empty_directions"] = *outcome.empty_directions;
    add_measures(json, *outcome.errors);
    json["headline"] = headline(*outcome.errors);
    if (outcome.samples) json["judged_pictures"] = json_of(headline_errors(*outcome.errors));
    if (outcome.noise) json["noise"] = fraction_of(*outcome.noise);
    if (outcome.largest_albedo > 1) json["largest_albedo"] = outcome.largest_albedo;
    if (const double limit = albedo_limit_of(request, outcome); !std::isinf(limit)) json["albedo_limit"] = limit;
    if (outcome.exchanged_errors) json["exchanged_pictures"] = json_of(*outcome.exchanged_errors);
    if (outcome.against_mean) json["mean_pictures"] = json_of(*outcome.against_mean);
    if (is_smoothed(outcome)) json["smoothed_pictures"] = json_of(*outcome.against_smoothed);
    if (outcome.samples) {
        json["samples"] = *outcome.samples;
        json["folds"] = k_folds;
    }
    if (const auto target = target_of(request)) json["target_delta_e"] = *target;
    if (!outcome.path.empty()) json["reached"] = outcome.reached;
    for (const Trial& trial : outcome.path)
        json["path"].push_back({{"bytes", trial.bytes}, {"error", trial.error}, {"lobes", trial.lobes}});
    return json;
}

Result<Done> print_report(const FitJob& fit, const Measured& measured, const FitOutcome& outcome) {
    const FitRequest& request = fit.request;
    fmt::print("{}  ({}, {} bytes)\n", printable(fit.input), measured.format, grouped(measured.bytes));
    fmt::print("  model     {}\n", summary(outcome.model));
    fmt::print("  fitted    objective {}, directions within {:g}° of the normal, in {:.2f} s ({})\n",
               name(request.objective), degrees(outcome.max_theta), outcome.fit_seconds,
               outcome.stop ? name(*outcome.stop) : "solved");
    fmt::print("  error     {}\n", headline(*outcome.errors, "\n            "));
    const std::size_t payload = payload_bytes(outcome.model), auxiliary = auxiliary_bytes(outcome.model);
    const double ratio = double(measured.bytes) / double(payload);
    fmt::print("  stored    {} bytes (file {}), source file {} bytes{}, 1 : {}\n", grouped(payload),
               grouped(write_model(outcome.model).size()), grouped(measured.bytes),
               outcome.samples ? " of " + grouped(*outcome.samples) + " samples" : "",
               ratio < 10 ? fmt::format("{:.2g}", ratio) : grouped(measured.bytes / payload));
    if (auxiliary > 0) fmt::print("  run time  {} bytes of index texture and direction table\n", grouped(auxiliary));
    if (outcome.empty_directions.value_or(0) > 0)
        fmt::print("  empty     {} directions without data\n", *outcome.empty_directions);
    if (outcome.masked > 0) fmt::print("  masked    {} samples that were not measured\n", grouped(outcome.masked));
    fmt::print("  peak      {}\n", peak_text(peak_of(measured)));
    print_limits_of_measurement(request, outcome);
    fmt::print("\n");
    print_measures(*outcome.errors);
    if (outcome.samples)
        fmt::print(
            "  Matrix: at the samples themselves. Held out: {}-fold cross-validated. Albedo and pictures: against\n"
            "  samples with gaps filled by microfacet models; held out, by fits without each fold.\n",
            k_folds);
    print_path(request, outcome);
    if (!outcome.reached)
        fmt::print("  Not reached: a Delta E of {:g}; this is the largest size that was tried.\n",
                   target_of(request).value_or(k_default_delta_e));
    fmt::print("\n  model     {}\n", printable(fit.output));
    if (!fit.preview.empty()) fmt::print("  picture   {}\n", printable(fit.preview));
    if (!fit.json.empty()) fmt::print("  report    {}\n", printable(fit.json));
    return flush_standard_output();
}

}  // namespace srbf
