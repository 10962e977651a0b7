#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <thread>

#include "app/commands.h"
#include "app/report.h"
#include "render/preview.h"
#include "srbf/fit.h"

namespace srbf {
namespace {

/// What the fit and its judgement found.
struct Outcome {
    PmFit fit;
    double load_seconds = 0, fit_seconds = 0, max_theta = 0;  // [s], [s], [degrees]
    std::uint64_t masked = 0, clamped = 0;
    Comparison rounded, unrounded;
    Image8 picture;  // empty: none was asked for
};

struct FitCommand {
    std::string input, output, preview, json;
    std::string model = "pm", form = std::string(name(FitOptions{}.form)), objective = "cosine";
    bool axial = true, no_scale = false;
    double max_theta = 0;  // [degrees], 0: the objective's default
    int lobes = FitOptions{}.lobes, variates = FitOptions{}.variates, threads = 0;
    std::uint64_t seed = 0;

    int run();
    Result<Outcome> fit(const Measured& measured) const;
    Result<Done> write(const Measured& measured, const Outcome& outcome) const;
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
        {"max_theta", fmt::format("{}", outcome.max_theta)},
        {"seed", fmt::format("{}", command.seed)},
        {"squared_error_ratio", fmt::format("{:.4g}", outcome.rounded.matrix.squared_error_ratio)},
        {"heldout_squared_error_ratio", fmt::format("{:.4g}", outcome.rounded.heldout.squared_error_ratio)},
        {"heldout_squared_error_ratio_cosine",
         fmt::format("{:.4g}", outcome.rounded.heldout.squared_error_ratio_cosine)},
        {"albedo_error", fmt::format("{:.4g}", outcome.rounded.albedo_error)},
    };
}

Result<Done> print_report(const FitCommand& command, const Measured& measured, const Outcome& outcome) {
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
    return flush_standard_output();
}

Result<Outcome> FitCommand::fit(const Measured& measured) const {
    ProgressLine line;
    const Stopwatch fitting;
    Outcome outcome;
    ObserveOptions observing;
    observing.objective = *objective_named(objective);
    outcome.max_theta = max_theta > 0 ? max_theta : default_max_theta(observing.objective) / k_degree;
    observing.max_theta = outcome.max_theta * k_degree;
    observing.seed = seed;
    const auto observations = observe(signed_evaluator(measured), observing);
    if (!observations) return observations.error();
    outcome.masked = observations->masked;
    outcome.clamped = observations->clamped;

    FitOptions options;
    options.form = *form_named(form);
    options.lobes = lobes;
    options.variates = variates;
    options.log_scale = !no_scale;
    options.seed = seed;
    options.threads = threads;
    auto fitted = fit_pm(*observations, options, [&](const Progress& progress) {
        line.show(progress.stage, 0.7 * progress.fraction);  // measuring takes the rest
        return true;
    });
    if (!fitted) return fitted.error();
    outcome.fit = *std::move(fitted);
    outcome.fit_seconds = fitting.seconds();

    line.show("measuring the error", 0.7);
    const Evaluate others[] = {evaluator(outcome.fit.model), evaluator(outcome.fit.unrounded)};
    const auto comparisons = compare(evaluator(measured), others, {observing.max_theta, threads});
    outcome.rounded = comparisons[0];
    outcome.unrounded = comparisons[1];

    if (!preview.empty()) {
        line.show("drawing", 0.95);
        PreviewOptions picture;
        picture.threads = threads;
        picture.captions[1] = fmt::format("fit, {} bytes", payload_bytes(outcome.fit.model));
        outcome.picture = srbf::preview(evaluator(measured), evaluator(outcome.fit.model), picture);
    }
    return outcome;
}

/// What goes to standard output, a device or a pipe is written first, so that a full one leaves no file behind.
Result<Done> FitCommand::write(const Measured& measured, const Outcome& outcome) const {
    struct Output {
        std::string path;
        std::function<Result<Done>()> write;
    };
    std::vector<Output> outputs;
    outputs.push_back({output, [&] { return save_model({outcome.fit.model, provenance_of(*this, outcome)}, output); }});
    if (!preview.empty()) outputs.push_back({preview, [&] { return write_png(outcome.picture, preview); }});
    if (!json.empty()) outputs.push_back({json, [&] { return write_json(report_of(*this, measured, outcome), json); }});
    if (json != "-") outputs.push_back({"-", [&] { return print_report(*this, measured, outcome); }});
    std::stable_partition(outputs.begin(), outputs.end(), [](const Output& one) {
        std::error_code ignored;
        return one.path == "-" || std::filesystem::is_other(one.path, ignored);
    });
    for (const Output& one : outputs)
        if (const auto written = one.write(); !written) return written.error();
    return Done{};
}

/// Why a measurement cannot be fitted yet; none: it can.
std::optional<std::string> unfit(const Measured& measured) {
    if (std::holds_alternative<Scattered>(measured.table)) return "scattered samples, which cannot be fitted yet";
    if (!is_isotropic(measured)) return "an anisotropic one, which cannot be fitted yet";
    return {};
}

int FitCommand::run() {
    const Stopwatch loading;
    const auto subject = load(input);
    if (!subject) return complain(subject.error());
    const double load_seconds = loading.seconds();
    const auto* measured = std::get_if<Measured>(&subject->content);
    if (!measured) return complain({input, {}, "input", "a measurement", "a fitted model"});
    if (const auto why = unfit(*measured)) return complain({input, {}, "input", "an isotropic table", *why});

    if (output.empty()) output = std::filesystem::path(input).stem().string() + ".srbf";
    const auto writable = check_outputs({input}, {output, preview, json == "-" ? "" : json});
    if (!writable) return complain(writable.error());

    auto outcome = fit(*measured);
    if (!outcome) {
        Error error = outcome.error();
        error.source = input;
        return complain(error);
    }
    outcome->load_seconds = load_seconds;
    const auto written = write(*measured, *outcome);
    return written ? k_done : complain(written.error());
}

/// Takes "x.png", "x.PNG" and names without an extension, such as a pipe's.
CLI::Validator png_name() {
    return {[](std::string& name) {
                std::string ending = std::filesystem::path(name).extension().string();
                std::transform(ending.begin(), ending.end(), ending.begin(),
                               [](unsigned char c) { return std::tolower(c); });
                return ending.empty() || ending == ".png"
                           ? ""
                           : fmt::format("expected a name that ends in .png, found {}", name);
            },
            ""};
}

}  // namespace

void add_fit(CLI::App& app, int& status) {
    const auto command = std::make_shared<FitCommand>();
    CLI::App* sub = app.add_subcommand("fit", "Fit a model to a measurement and report its errors");
    sub->add_option("INPUT", command->input, "The measurement: MERL .binary or RGL .bsdf")->type_name("")->required();
    sub->add_option("-o,--output", command->output, "The model; default: INPUT's stem + .srbf in the working directory")
        ->type_name("FILE");
    sub->add_option("--model", command->model, "pm: parameterized multivariate SRBFs")
        ->type_name("NAME")
        ->check(one_of({"pm"}))
        ->capture_default_str();
    sub->add_option(
           "--form", command->form,
           "source: as Tsai 2009 defines them; horizon: and an exponent of cos(theta_l) cos(theta_v); extended: and "
           "two more")
        ->type_name("NAME")
        ->check(one_of({"source", "horizon", "extended"}))
        ->capture_default_str();
    sub->add_option("--lobes", command->lobes, fmt::format("Lobes of the model, 1 to {}", k_most_fitted_lobes))
        ->type_name("J")
        ->check(within(1, k_most_fitted_lobes))
        ->capture_default_str();
    sub->add_option("--variates", command->variates, fmt::format("Factors of each lobe, 1 to {}", k_most_variates))
        ->type_name("N")
        ->check(within(1, k_most_variates))
        ->capture_default_str();
    sub->add_flag("--axial", command->axial, "Centres at +z or -z, for isotropic measurements (always on so far)");
    sub->add_flag("--no-scale", command->no_scale,
                  "Store no log scale: bounds the coefficients in the fit,\n2 J bytes fewer, larger errors");
    sub->add_option(
           "--objective", command->objective,
           "What is minimised, the squared error\nraw: of f; cosine: of f cos(theta_l) seen under cos(theta_v);\n"
           "log: of log(1 + f cos(theta_l)), likewise; cube-root: of the cube root of f")
        ->type_name("NAME")
        ->check(one_of({"raw", "cosine", "log", "cube-root"}))
        ->capture_default_str();
    sub->add_option("--max-theta", command->max_theta,
                    "Fit and measure directions up to here from the normal,\n"
                    "1 to 89.9 degrees; default: raw and cube-root 80, cosine and log 89")
        ->type_name("DEG")
        ->check(within(1.0, 89.9));
    sub->add_option("--preview", command->preview, "Write a picture: measured, fit, 10 x difference")
        ->type_name("FILE.png")
        ->check(png_name());
    sub->add_option("--json", command->json, "Write the report to this file; - is standard output")->type_name("FILE");
    sub->add_option("--seed", command->seed, "Of the random choices")
        ->type_name("SEED")
        ->check(within(std::uint64_t(0), std::numeric_limits<std::uint64_t>::max()))
        ->capture_default_str();
    sub->add_option("--threads", command->threads, "0: as many as the machine has; the model does not depend on it")
        ->type_name("T")
        ->check(within(0, k_most_threads))
        ->capture_default_str();
    sub->footer(
        "Examples:\n  srbf fit paper_white_rgb.bsdf\n"
        "  srbf fit nickel.binary --lobes 6 --variates 3 --objective raw --preview nickel.png --json -");
    sub->callback([command, &status] {
        if (command->no_scale && command->form != name(PmForm::source))
            throw CLI::ValidationError("--no-scale", "only with --form source; other forms always store log scales");
        status = command->run();
    });
}

}  // namespace srbf
