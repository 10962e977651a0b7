#include <fmt/format.h>

#include <filesystem>
#include <thread>

#include "app/fit.h"

namespace srbf {
namespace {

/// What is to be said of a model by its kind, in JSON and in words.
void describe(Json& json, const PmModel& model) {
    json["form"] = stored_name(model.form);
    json["lobes"] = model.lobes;
    json["variates"] = model.variates;
    json["axial"] = model.axial;
    json["reciprocal"] = is_reciprocal(model);
}
void describe(Json& json, const SuModel& model) {
    json["form"] = stored_name(PmForm::gaussian);
    json["lobes"] = model.lobes;
    json["variates"] = 1;
    json["axial"] = false;
    json["discretise"] = name(model.discretise);
    json["directions"] = model.direction.size();
    json["interpolation"] = name(model.interpolation);
    json["index"] = model.index ? Json(name(model.index->map)) : Json();
}
void describe(Json& json, const GgxModel& model) {
    json["form"] = "ggx";
    json["lobes"] = model.lobes.size();
    json["variates"] = 1;
    json["axial"] = true;
}
std::string words(const PmModel& model) {
    return fmt::format("pm, form {}, {} lobes, {} variates, {}{}", name(model.form), model.lobes, model.variates,
                       model.axial ? "axial" : "general",
                       model.wavelength.empty() ? "" : fmt::format(", {} wavelengths", model.wavelength.size()));
}
std::string words(const SuModel& model) {
    return fmt::format("su, {} lobes for each of {} directions to the {}, interpolation {}", model.lobes,
                       model.direction.size(), model.discretise == Discretise::view ? "viewer" : "light",
                       name(model.interpolation));
}
std::string words(const GgxModel& model) {
    return fmt::format("ggx, {} and Lambert", model.lobes.size() == 1 ? "one lobe" : "two lobes");
}

/// What was tried: of models of one size the best, of fits in short only those that look better than all smaller ones.
void print_path(const FitRequest& request, const Outcome& outcome) {
    if (outcome.path.empty()) return;
    fmt::print("\n  {:>9}  {:>10}   {}\n", "bytes", request.objective() == Objective::log ? "error" : "error, %",
               "tried");
    double least = std::numeric_limits<double>::infinity();
    for (const Step& step : outcome.path) {
        if (!step.whole && step.error >= least) continue;
        least = std::min(least, step.error);
        fmt::print("  {:>9}  {:>10.4g}   {}, {} lobes, {} variates, {}{}\n", step.bytes,
                   request.objective() == Objective::log ? step.error : 100 * step.error, name(step.form), step.lobes,
                   step.variates, step.axial ? "axial" : "general", step.whole ? "" : ", in short");
    }
}

std::string wish_of(const FitRequest& request) {
    return request.budget > 0 ? fmt::format("{} bytes", request.budget)
                              : fmt::format("an error of {:g}", request.target_error);
}

}  // namespace

Json report_of(const FitRequest& request, const Measured& measured, const Outcome& outcome) {
    Json json{
        {"source", request.input},  {"source_format", measured.format}, {"source_bytes", measured.bytes},
        {"output", request.output}, {"version", SRBF_VERSION},          {"model", request.model},
    };
    std::visit([&](const auto& model) { describe(json, model); }, outcome.model.model);
    json.update(Json{
        {"channels", channels(outcome.model).count()},
        {"objective", request.objective_name},
        {"max_theta", outcome.max_theta},
        {"raw_bytes", outcome.raw_bytes},
        {"payload_bytes", payload_bytes(outcome.model)},
        {"auxiliary_bytes", auxiliary_bytes(outcome.model)},
        {"fit_seconds", outcome.fit_seconds},
        {"load_seconds", outcome.load_seconds},
        {"seed", request.seed},
        {"threads", request.threads > 0 ? request.threads : int(std::thread::hardware_concurrency())},
        {"stop_reason", outcome.stop ? Json(name(*outcome.stop)) : Json()},
        {"masked_samples", outcome.masked},
        {"clamped_samples", outcome.clamped},
    });
    if (std::holds_alternative<SuModel>(outcome.model.model)) json["empty_directions"] = outcome.empty;
    add_measures(json, outcome.rounded, "");
    add_measures(json, outcome.unrounded_too, "unrounded_");
    if (outcome.samples) {
        json["samples"] = *outcome.samples;
        json["folds"] = k_folds;
    }
    if (outcome.filled) json["filled_between_samples"] = *outcome.filled;
    if (request.target_error > 0) json["target_error"] = request.target_error;
    if (request.budget > 0) json["budget"] = request.budget;
    if (request.target_error > 0 || request.budget > 0) json["reached"] = outcome.reached;
    for (const Step& step : outcome.path)
        json["path"].push_back({{"bytes", step.bytes},
                                {"error", step.error},
                                {"form", stored_name(step.form)},
                                {"lobes", step.lobes},
                                {"variates", step.variates},
                                {"axial", step.axial},
                                {"whole", step.whole}});
    return json;
}

std::map<std::string, std::string> provenance_of(const FitRequest& request, const Outcome& outcome) {
    return {
        {"source", std::filesystem::path(request.input).filename().string()},
        {"generator", "srbf " SRBF_VERSION},
        {"objective", request.objective_name},
        {"max_theta", fmt::format("{}", outcome.max_theta)},
        {"seed", fmt::format("{}", request.seed)},
        {"squared_error_ratio", fmt::format("{:.4g}", outcome.rounded.matrix.squared_error_ratio)},
        {"heldout_squared_error_ratio", fmt::format("{:.4g}", outcome.rounded.heldout.squared_error_ratio)},
        {"heldout_squared_error_ratio_cosine",
         fmt::format("{:.4g}", outcome.rounded.heldout.squared_error_ratio_cosine)},
        {"albedo_error", fmt::format("{:.4g}", outcome.rounded.albedo_error)},
    };
}

Result<Done> print_report(const FitRequest& request, const Measured& measured, const Outcome& outcome) {
    fmt::print("{}  ({}, {} bytes)\n", request.input, measured.format, grouped(measured.bytes));
    fmt::print("  model     {}\n", std::visit([](const auto& model) { return words(model); }, outcome.model.model));
    fmt::print("  fitted    objective {}, directions within {:g}° of the normal, in {:.2f} s ({})\n",
               request.objective_name, outcome.max_theta, outcome.fit_seconds,
               outcome.stop ? name(*outcome.stop) : "solved");
    const std::size_t payload = payload_bytes(outcome.model), auxiliary = auxiliary_bytes(outcome.model);
    fmt::print("  stored    {} bytes for {} of {}: 1 : {}\n", grouped(payload),
               outcome.samples ? grouped(*outcome.samples) + " samples" : "a matrix", grouped(outcome.raw_bytes),
               grouped(outcome.raw_bytes / payload));
    if (auxiliary > 0) fmt::print("  run time  {} bytes of index texture and direction table\n", grouped(auxiliary));
    if (outcome.empty > 0) fmt::print("  empty     {} directions without data\n", outcome.empty);
    if (outcome.masked > 0) fmt::print("  masked    {} samples that were not measured\n", grouped(outcome.masked));
    if (outcome.clamped > 0) fmt::print("  clamped   {} negative values, set to 0\n", grouped(outcome.clamped));
    fmt::print("\n");
    print_measures({{"as stored", &outcome.rounded}, {"before rounding", &outcome.unrounded_too}});
    if (outcome.samples) {
        fmt::print(
            "  Matrix: at the samples themselves. Held out: {}-fold cross-validated. Albedo: against interpolated "
            "samples.\n",
            k_folds);
        if (outcome.filled && *outcome.filled)
            fmt::print("  Between samples the fit was held to interpolated values.\n");
    }
    print_path(request, outcome);
    if (!outcome.reached) fmt::print("  Not reached: {}; this is the best that was found.\n", wish_of(request));
    fmt::print("\n  model     {}\n", request.output);
    if (!request.preview.empty()) fmt::print("  picture   {}\n", request.preview);
    if (!request.json.empty()) fmt::print("  report    {}\n", request.json);
    return flush_standard_output();
}

}  // namespace srbf
