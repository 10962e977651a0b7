#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <thread>

#include "app/commands.h"
#include "app/report.h"
#include "render/preview.h"
#include "srbf/fit.h"

namespace srbf {
namespace {

struct FitCommand {
    std::string input, output, preview, json;
    std::string model = "pm", form = "source", objective = "cosine";
    bool axial = true, no_scale = false;
    double max_theta = 0;  // [degrees], 0: the objective's default
    int lobes = FitOptions{}.lobes, variates = FitOptions{}.variates, threads = 0;
    std::uint64_t seed = 0;

    int run();
};

/// What the fit and its judgement found.
struct Outcome {
    PmFit fit;
    double load_seconds = 0, fit_seconds = 0, max_theta = 0;  // [s], [s], [degrees]
    std::uint64_t masked = 0, clamped = 0;
    Comparison rounded, unrounded;
};

constexpr std::uint64_t k_raw_bytes = std::uint64_t(k_matrix_directions) * k_matrix_directions * 3 * sizeof(float);

Json report_of(const FitCommand& command, const Measured& measured, const Outcome& outcome) {
    const PmModel& model = outcome.fit.model;
    Json json{
        {"source", command.input},
        {"source_format", measured.format},
        {"source_bytes", measured.bytes},
        {"output", command.output},
        {"version", SRBF_VERSION},
        {"model", command.model},
        {"form", name(model.form)},
        {"lobes", model.lobes},
        {"variates", model.variates},
        {"axial", model.axial},
        {"channels", 3},
        {"objective", command.objective},
        {"max_theta", outcome.max_theta},
        {"raw_bytes", k_raw_bytes},
        {"payload_bytes", payload_bytes(model)},
        {"auxiliary_bytes", 0},
        {"fit_seconds", outcome.fit_seconds},
        {"load_seconds", outcome.load_seconds},
        {"seed", command.seed},
        {"threads", command.threads > 0 ? command.threads : int(std::thread::hardware_concurrency())},
        {"stop_reason", name(outcome.fit.stop)},
        {"masked_samples", outcome.masked},
        {"clamped_samples", outcome.clamped},
    };
    add_measures(json, outcome.rounded, "");
    add_measures(json, outcome.unrounded, "unrounded_");
    return json;
}

/// The story that travels with the model: nothing in it depends on the machine or the time.
std::map<std::string, std::string> provenance_of(const FitCommand& command, const Outcome& outcome) {
    return {
        {"source", std::filesystem::path(command.input).filename().string()},
        {"generator", "srbf " SRBF_VERSION},
        {"objective", command.objective},
        {"max_theta", fmt::format("{:g}", outcome.max_theta)},
        {"seed", fmt::format("{}", command.seed)},
        {"squared_error_ratio", fmt::format("{:.4g}", outcome.rounded.matrix.squared_error_ratio)},
        {"heldout_squared_error_ratio", fmt::format("{:.4g}", outcome.rounded.heldout.squared_error_ratio)},
        {"heldout_squared_error_ratio_cosine",
         fmt::format("{:.4g}", outcome.rounded.heldout.squared_error_ratio_cosine)},
        {"albedo_error", fmt::format("{:.4g}", outcome.rounded.albedo_error)},
    };
}

void print_report(const FitCommand& command, const Measured& measured, const Outcome& outcome) {
    const PmModel& model = outcome.fit.model;
    fmt::print("{}  ({}, {} bytes)\n", command.input, measured.format, grouped(measured.bytes));
    fmt::print("  model     {}, form {}, {} lobes, {} variates, {}\n", command.model, name(model.form), model.lobes,
               model.variates, model.axial ? "axial" : "general");
    fmt::print("  fitted    objective {}, directions within {:g}° of the normal, in {:.2f} s ({})\n", command.objective,
               outcome.max_theta, outcome.fit_seconds, name(outcome.fit.stop));
    fmt::print("  stored    {} bytes for a matrix of {}: 1 : {}\n", payload_bytes(model), grouped(k_raw_bytes),
               grouped(k_raw_bytes / payload_bytes(model)));
    if (outcome.masked > 0) fmt::print("  masked    {} samples that were not measured\n", grouped(outcome.masked));
    if (outcome.clamped > 0) fmt::print("  clamped   {} negative values, set to 0\n", grouped(outcome.clamped));
    fmt::print("\n");
    print_measures({{"as stored", &outcome.rounded}, {"before rounding", &outcome.unrounded}});
    fmt::print("\n  model     {}\n", command.output);
    if (!command.preview.empty()) fmt::print("  picture   {}\n", command.preview);
    if (!command.json.empty()) fmt::print("  report    {}\n", command.json);
}

int FitCommand::run() {
    if (output.empty()) output = std::filesystem::path(input).stem().string() + ".srbf";
    for (const std::string& path : {output, preview, json == "-" ? std::string() : json}) {
        if (path.empty()) continue;
        std::error_code ignored;
        if (std::filesystem::equivalent(path, input, ignored))
            return complain({path, {}, "output", "another file than the input", "the input"});
        if (const auto writable = check_output(path); !writable) return complain(writable.error());
    }

    const Stopwatch loading;
    const auto measured = load_measured(input);
    if (!measured) return complain(measured.error());
    Outcome outcome;
    outcome.load_seconds = loading.seconds();

    ProgressLine line;
    const Stopwatch fitting;
    ObserveOptions observing;
    observing.objective = objective == "raw" ? Objective::raw : Objective::cosine;
    observing.max_theta = max_theta > 0 ? max_theta * k_degree : default_max_theta(observing.objective);
    observing.seed = seed;
    outcome.max_theta = observing.max_theta / k_degree;
    auto observations = observe(
        [&](auto wl, auto wv, auto f) {
            for (std::size_t i = 0; i < wl.size(); ++i) f[i] = signed_value(*measured, wl[i], wv[i]);
        },
        observing);
    if (!observations) {
        Error error = observations.error();
        error.source = input;
        return complain(error);
    }
    outcome.masked = observations->masked;
    outcome.clamped = observations->clamped;

    FitOptions options;
    options.lobes = lobes;
    options.variates = variates;
    options.log_scale = !no_scale;
    options.seed = seed;
    options.threads = threads;
    auto fit = fit_pm(*observations, options, [&](const Progress& progress) {
        line.show(progress.stage, 0.7 * progress.fraction);  // measuring takes the rest
        return true;
    });
    if (!fit) {
        Error error = fit.error();
        error.source = input;
        return complain(error);
    }
    outcome.fit = *std::move(fit);
    outcome.fit_seconds = fitting.seconds();

    line.show("measuring the error", 0.7);
    const Evaluate others[] = {evaluator(outcome.fit.model), evaluator(outcome.fit.unrounded)};
    const auto comparisons = compare(evaluator(*measured), others, {observing.max_theta, threads});
    outcome.rounded = comparisons[0];
    outcome.unrounded = comparisons[1];

    if (!preview.empty()) {
        line.show("drawing", 0.95);
        PreviewOptions picture;
        picture.threads = threads;
        picture.captions[1] = fmt::format("fit, {} bytes", payload_bytes(outcome.fit.model));
        const Image8 image = srbf::preview(evaluator(*measured), evaluator(outcome.fit.model), picture);
        if (const auto written = write_png(image, preview); !written) return complain(written.error());
    }
    line.clear();
    const Json report = report_of(*this, *measured, outcome);
    const auto saved = save_model({outcome.fit.model, provenance_of(*this, outcome)}, output);
    if (!saved) return complain(saved.error());
    if (!json.empty())
        if (const auto written = write_json(report, json); !written) return complain(written.error());
    if (json != "-") print_report(*this, *measured, outcome);
    return k_done;
}

}  // namespace

void add_fit(CLI::App& app, int& status) {
    const auto command = std::make_shared<FitCommand>();
    CLI::App* sub = app.add_subcommand("fit", "Fit a model to a measurement and report its errors");
    sub->add_option("INPUT", command->input, "The measurement: MERL .binary or RGL .bsdf")->required();
    sub->add_option("-o,--output", command->output, "The model; default: INPUT's stem + .srbf in this folder");
    sub->add_option("--model", command->model, "pm: parameterized multivariate SRBFs")
        ->check(CLI::IsMember({"pm"}))
        ->capture_default_str();
    sub->add_option("--form", command->form, "source: as Tsai 2009 defines them")
        ->check(CLI::IsMember({"source"}))
        ->capture_default_str();
    sub->add_option("--lobes", command->lobes, "J")->check(CLI::Range(1, k_most_fitted_lobes))->capture_default_str();
    sub->add_option("--variates", command->variates, "N")->check(CLI::Range(1, k_most_variates))->capture_default_str();
    sub->add_flag("--axial", command->axial, "Centres at +z or -z, for isotropic measurements (always on so far)");
    sub->add_flag("--no-scale", command->no_scale,
                  "Store no log scale: bounds the coefficients in the fit, 2 J bytes fewer, larger errors");
    sub->add_option("--objective", command->objective,
                    "What is minimised: raw, squared error of f; cosine, of f cos(theta_l) seen under cos(theta_v)")
        ->check(CLI::IsMember({"raw", "cosine"}))
        ->capture_default_str();
    sub->add_option("--max-theta", command->max_theta,
                    "Fit and measure directions up to here from the normal [degrees]; default: raw 80, cosine 89")
        ->check(CLI::Range(1.0, 89.9));
    sub->add_option("--preview", command->preview, "Write a picture (PNG): measured, fit, 10 x difference");
    sub->add_option("--json", command->json, "Write the report to this file; - is standard output");
    sub->add_option("--seed", command->seed, "Of the random choices")->capture_default_str();
    sub->add_option("--threads", command->threads, "0: as many as the machine has; the model does not depend on it")
        ->check(CLI::Range(0, 1024))
        ->capture_default_str();
    sub->footer(
        "Examples:\n  srbf fit paper_white_rgb.bsdf\n"
        "  srbf fit nickel.binary --lobes 6 --variates 3 --objective raw --preview nickel.png --json -");
    sub->callback([command, &status] { status = command->run(); });
}

}  // namespace srbf
