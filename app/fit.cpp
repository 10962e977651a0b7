#include <fmt/format.h>

#include <algorithm>
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
    Model model;
    std::variant<PmModel, SuModel> unrounded;
    StopReason stop = StopReason::converged;
    double load_seconds = 0, fit_seconds = 0, max_theta = 0;  // [s], [s], [degrees]
    std::uint64_t masked = 0, clamped = 0, raw_bytes = 0;
    int empty = 0;  // sampled directions without data
    Comparison rounded, unrounded_too;
    std::optional<Measures>
        of_samples;  // of scattered input, by the samples themselves; the others by what is interpolated
    Image8 picture;  // empty: none was asked for
};

struct FitCommand {
    std::string input, output, preview, json;
    std::string model = "pm", form = std::string(name(FitOptions{}.form)), objective = "cosine";
    std::string discretise = std::string(name(Discretise{})), interpolation = std::string(name(SuInterpolation{})),
                with_index;
    int axial = 0;  // 1: axial lobes, -1: general ones, 0: as the measurement asks for
    bool no_scale = false, reciprocal = false;
    double max_theta = 0;  // [degrees], 0: the objective's default
    int lobes = FitOptions{}.lobes, variates = FitOptions{}.variates, threads = 0;
    int directions = TabulateOptions{}.directions, between = TabulateOptions{}.between;
    int neighbours = SuFitOptions{}.neighbours;
    std::uint64_t seed = 0;

    int run();
    Result<Outcome> fit(const Measured& measured) const;
    Result<Outcome> fit_pm(const Evaluate& f, const ProgressCallback& progress) const;
    Result<Outcome> fit_su(const Evaluate& f, const ProgressCallback& progress) const;
    Result<Done> write(const Measured& measured, const Outcome& outcome) const;
    double theta() const {
        return max_theta > 0 ? max_theta : default_max_theta(*objective_named(objective)) / k_degree;
    }
};

/// Bytes of f at all pairs of n directions, RGB in floats.
constexpr std::uint64_t raw_bytes(std::uint64_t n) { return n * n * 3 * sizeof(float); }

/// What is to be said of a model by its kind, in JSON and in words.
void describe(Json& json, const PmModel& model) {
    json["form"] = name(model.form);
    json["lobes"] = model.lobes;
    json["variates"] = model.variates;
    json["axial"] = model.axial;
    json["reciprocal"] = is_reciprocal(model);
}
void describe(Json& json, const SuModel& model) {
    json["form"] = name(PmForm::source);
    json["lobes"] = model.lobes;
    json["variates"] = 1;
    json["axial"] = false;
    json["discretise"] = name(model.discretise);
    json["directions"] = model.direction.size();
    json["interpolation"] = name(model.interpolation);
    json["index"] = model.index ? Json(name(model.index->map)) : Json();
}
std::string words(const PmModel& model) {
    return fmt::format("pm, form {}, {} lobes, {} variates, {}", name(model.form), model.lobes, model.variates,
                       model.axial ? "axial" : "general");
}
std::string words(const SuModel& model) {
    return fmt::format("su, {} lobes for each of {} directions to the {}, interpolation {}", model.lobes,
                       model.direction.size(), model.discretise == Discretise::view ? "viewer" : "light",
                       name(model.interpolation));
}

Json report_of(const FitCommand& command, const Measured& measured, const Outcome& outcome) {
    Json json{
        {"source", command.input},  {"source_format", measured.format}, {"source_bytes", measured.bytes},
        {"output", command.output}, {"version", SRBF_VERSION},          {"model", command.model},
    };
    std::visit([&](const auto& model) { describe(json, model); }, outcome.model.model);
    json.update(Json{
        {"channels", 3},
        {"objective", command.objective},
        {"max_theta", outcome.max_theta},
        {"raw_bytes", outcome.raw_bytes},
        {"payload_bytes", payload_bytes(outcome.model)},
        {"auxiliary_bytes", auxiliary_bytes(outcome.model)},
        {"fit_seconds", outcome.fit_seconds},
        {"load_seconds", outcome.load_seconds},
        {"seed", command.seed},
        {"threads", command.threads > 0 ? command.threads : int(std::thread::hardware_concurrency())},
        {"stop_reason", name(outcome.stop)},
        {"masked_samples", outcome.masked},
        {"clamped_samples", outcome.clamped},
    });
    if (std::holds_alternative<SuModel>(outcome.model.model)) json["empty_directions"] = outcome.empty;
    add_measures(json, outcome.rounded, "");
    add_measures(json, outcome.unrounded_too, "unrounded_");
    if (outcome.of_samples) add_measures(json, *outcome.of_samples, "samples_");
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
    fmt::print("{}  ({}, {} bytes)\n", command.input, measured.format, grouped(measured.bytes));
    fmt::print("  model     {}\n", std::visit([](const auto& model) { return words(model); }, outcome.model.model));
    fmt::print("  fitted    objective {}, directions within {:g}° of the normal, in {:.2f} s ({})\n", command.objective,
               outcome.max_theta, outcome.fit_seconds, name(outcome.stop));
    const std::size_t payload = payload_bytes(outcome.model), auxiliary = auxiliary_bytes(outcome.model);
    fmt::print("  stored    {} bytes for a matrix of {}: 1 : {}\n", grouped(payload), grouped(outcome.raw_bytes),
               grouped(outcome.raw_bytes / payload));
    if (auxiliary > 0) fmt::print("  run time  {} bytes of index texture and direction table\n", grouped(auxiliary));
    if (outcome.empty > 0) fmt::print("  empty     {} directions without data\n", outcome.empty);
    if (outcome.masked > 0) fmt::print("  masked    {} samples that were not measured\n", grouped(outcome.masked));
    if (outcome.clamped > 0) fmt::print("  clamped   {} negative values, set to 0\n", grouped(outcome.clamped));
    fmt::print("\n");
    print_measures({{"as stored", &outcome.rounded}, {"before rounding", &outcome.unrounded_too}});
    if (outcome.of_samples)
        fmt::print(
            "  The matrix is interpolated. At the {} samples within {:g}° themselves: {:.3g} %, of f cosθl {:.3g} %\n",
            grouped(outcome.of_samples->pairs), outcome.max_theta, 100 * outcome.of_samples->squared_error_ratio,
            100 * outcome.of_samples->squared_error_ratio_cosine);
    fmt::print("\n  model     {}\n", command.output);
    if (!command.preview.empty()) fmt::print("  picture   {}\n", command.preview);
    if (!command.json.empty()) fmt::print("  report    {}\n", command.json);
    return flush_standard_output();
}

Result<Outcome> FitCommand::fit_pm(const Evaluate& f, const ProgressCallback& progress) const {
    const auto observations =
        observe(f, {.objective = *objective_named(objective), .max_theta = theta() * k_degree, .seed = seed});
    if (!observations) return observations.error();
    FitOptions options;
    options.form = *form_named(form);
    options.axial = axial > 0 || (axial == 0 && is_isotropic(f, theta() * k_degree));
    options.reciprocal = reciprocal;
    options.lobes = lobes;
    options.variates = variates;
    options.log_scale = !no_scale;
    options.seed = seed;
    options.threads = threads;
    auto fitted = srbf::fit_pm(*observations, options, progress);
    if (!fitted) return fitted.error();
    Outcome outcome;
    outcome.masked = observations->masked;
    outcome.clamped = observations->clamped;
    outcome.raw_bytes = raw_bytes(k_matrix_directions);
    outcome.model.model = std::move(fitted->model);
    outcome.unrounded = std::move(fitted->unrounded);
    outcome.stop = fitted->stop;
    return outcome;
}

Result<Outcome> FitCommand::fit_su(const Evaluate& f, const ProgressCallback& progress) const {
    const auto matrix = tabulate(f, {.directions = directions,
                                     .between = between,
                                     .discretise = *discretise_named(discretise),
                                     .threads = threads});
    if (!matrix) return matrix.error();
    SuFitOptions options;
    options.lobes = lobes;
    options.objective = *objective_named(objective);
    options.max_theta = theta() * k_degree;
    options.interpolation = *interpolation_named(interpolation);
    options.neighbours = neighbours;
    options.seed = seed;
    options.threads = threads;
    auto fitted = srbf::fit_su(*matrix, options, progress);
    if (!fitted) return fitted.error();
    if (fitted->empty == directions) return Error{"fit", {}, "values", "some above 0", "none"};
    if (!with_index.empty()) fitted->model.index = index_texture(fitted->model, *map_named(with_index));
    Outcome outcome;
    outcome.masked = matrix->masked;
    outcome.clamped = matrix->clamped;
    outcome.raw_bytes = raw_bytes(std::uint64_t(directions));
    outcome.empty = fitted->empty;
    outcome.model.model = std::move(fitted->model);
    outcome.unrounded = std::move(fitted->unrounded);
    outcome.stop = fitted->stop;
    return outcome;
}

Result<Outcome> FitCommand::fit(const Measured& measured) const {
    ProgressLine line;
    const Stopwatch fitting;
    const auto progress = [&](const Progress& now) {
        line.show(now.stage, 0.7 * now.fraction);  // measuring takes the rest
        return true;
    };
    const Evaluate f = signed_evaluator(measured);
    auto outcome = model == "su" ? fit_su(f, progress) : fit_pm(f, progress);
    if (!outcome) return outcome;
    outcome->fit_seconds = fitting.seconds();
    outcome->max_theta = theta();

    line.show("measuring the error", 0.7);
    const Evaluate others[] = {evaluator(outcome->model),
                               std::visit([](const auto& m) { return evaluator(m); }, outcome->unrounded)};
    const auto comparisons = compare(evaluator(measured), others, {theta() * k_degree, threads},
                                     matrix_directions(outcome->model, theta() * k_degree));
    outcome->rounded = comparisons[0];
    outcome->unrounded_too = comparisons[1];
    if (const auto* samples = std::get_if<Scattered>(&measured.table))
        outcome->of_samples = measure_samples(samples->wl, samples->wv, samples->colour, others[0], theta() * k_degree);

    if (!preview.empty()) {
        line.show("drawing", 0.95);
        PreviewOptions picture;
        picture.threads = threads;
        picture.captions[1] = fmt::format("fit, {} bytes", payload_bytes(outcome->model));
        outcome->picture = srbf::preview(evaluator(measured), evaluator(outcome->model), picture);
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
    outputs.push_back({output, [&] {
                           return save_model({outcome.model.model, provenance_of(*this, outcome)}, output);
                       }});
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

int FitCommand::run() {
    const Stopwatch loading;
    const auto subject = load(input);
    if (!subject) return complain(subject.error());
    const double load_seconds = loading.seconds();
    const auto* measured = std::get_if<Measured>(&subject->content);
    if (!measured) return complain({input, {}, "input", "a measurement", "a fitted model"});
    if (std::holds_alternative<Scattered>(measured->table) && model != "su")
        return complain(
            {input, {}, "input", "a table", "scattered samples, which only --model su can be fitted to yet"});

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

}  // namespace

void add_fit(CLI::App& app, int& status) {
    const auto command = std::make_shared<FitCommand>();
    CLI::App* sub = app.add_subcommand("fit", "Fit a model to a measurement and report its errors");
    sub->add_option("INPUT", command->input, "The measurement: a table of MERL's, RGL's or UTIA's layout")
        ->type_name("")
        ->required();
    sub->add_option("-o,--output", command->output, "The model; default: INPUT's stem + .srbf in the working directory")
        ->type_name("FILE");
    sub->add_option(
           "--model", command->model,
           "pm: parameterized multivariate SRBFs, one formula;\nsu: scattered univariate SRBFs, a sum of lobes "
           "for each of many view directions")
        ->type_name("NAME")
        ->check(one_of({"pm", "su"}))
        ->capture_default_str();
    auto* form = sub->add_option("--form", command->form,
                                 "source: as Tsai 2009 defines them; horizon: and an exponent of cos(theta_l) "
                                 "cos(theta_v); extended: and "
                                 "three more")
                     ->type_name("NAME")
                     ->check(one_of({"source", "horizon", "extended"}))
                     ->capture_default_str();
    sub->add_option("--lobes", command->lobes,
                    fmt::format("Lobes of the model, or of each direction of su, 1 to {}", k_most_fitted_lobes))
        ->type_name("J")
        ->check(within(1, k_most_fitted_lobes))
        ->capture_default_str();
    auto* variates =
        sub->add_option("--variates", command->variates, fmt::format("Factors of each lobe, 1 to {}", k_most_variates))
            ->type_name("N")
            ->check(within(1, k_most_variates))
            ->capture_default_str();
    auto* axial = sub->add_flag("--axial{1},--no-axial{-1}", command->axial,
                                "Centres at +z or -z alone, or anywhere, 4 J N bytes more;\n"
                                "default: anywhere if turning about the normal changes the measurement");
    auto* reciprocal =
        sub->add_flag("--reciprocal", command->reciprocal,
                      "f(wl, wv) = f(wv, wl): variates come in pairs that share bandwidths, N is even; larger errors");
    auto* no_scale =
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
    auto* discretise = sub->add_option("--discretise", command->discretise,
                                       "su: which direction is sampled; the lobes are functions of the other one")
                           ->type_name("view|light")
                           ->check(one_of({"view", "light"}))
                           ->capture_default_str();
    auto* directions =
        sub->add_option("--directions", command->directions,
                        fmt::format("su: how many directions are sampled, {} to {}", k_least_views, k_most_views))
            ->type_name("N")
            ->check(within(k_least_views, k_most_views))
            ->capture_default_str();
    auto* interpolation =
        sub->add_option("--interpolation", command->interpolation,
                        "su: between the samples, rotated: the two next in elevation, turned to the azimuth\n"
                        "asked for, for isotropic measurements; plain: the nearest as they are")
            ->type_name("NAME")
            ->check(one_of({"rotated", "plain"}))
            ->capture_default_str();
    auto* neighbours =
        sub->add_option("--neighbours", command->neighbours,
                        fmt::format("su: how many the plain interpolation takes, 1 to {}", k_most_neighbours))
            ->type_name("K")
            ->check(within(1, k_most_neighbours))
            ->capture_default_str();
    auto* between =
        sub->add_option("--between", command->between,
                        fmt::format("su: further directions about each sampled one that the fit looks at,\n0 to {}; "
                                    "0: the raw matrix alone",
                                    k_most_between))
            ->type_name("M")
            ->check(within(0, int(k_most_between)))
            ->capture_default_str();
    auto* with_index = sub->add_option("--with-index", command->with_index,
                                       "su: store the texture that names the samples nearest to each direction")
                           ->type_name("cube|parabolic")
                           ->check(one_of({"cube", "parabolic"}));
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
        "  srbf fit nickel.binary --lobes 6 --variates 3 --objective raw --preview nickel.png --json -\n"
        "  srbf fit paper_white_rgb.bsdf --model su --lobes 5 --with-index cube");
    const std::vector<const CLI::Option*> of_pm{form, variates, axial, reciprocal, no_scale},
        of_su{discretise, directions, interpolation, neighbours, between, with_index};
    sub->callback([command, of_pm, of_su, &status] {
        for (const CLI::Option* option : command->model == "su" ? of_pm : of_su)
            if (option->count() > 0)
                throw CLI::ValidationError(option->get_name(),
                                           fmt::format("only with --model {}", command->model == "su" ? "pm" : "su"));
        if (command->no_scale && command->form != name(PmForm::source))
            throw CLI::ValidationError("--no-scale", "only with --form source; other forms always store log scales");
        status = command->run();
    });
}

}  // namespace srbf
