#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>

#include "app/commands.h"
#include "app/fit.h"
#include "app/read_options.h"
#include "render/preview.h"
#include "srbf/directions.h"
#include "srbf/file.h"
#include "srbf/fit_batch.h"
#include "srbf/text.h"

namespace srbf {
namespace {

/// The parsed command line.
struct FitCommand {
    int run() const;

    std::vector<std::string> inputs, given;
    std::string output, preview, json;
    std::string pairs;  // of texels; empty: none
    std::string basis;  // a number of shared lobes, or the library whose lobes are used; empty: none
    int active = 0;     // 0: all
    std::size_t width = 0;
    ReadOptions read;
    std::size_t first = 0, last = 0, slab = TexelFits{}.slab;
    std::string model = "pm", surface = std::string(name(PbrRequest{}.surface)),
                form = std::string(name(PmRequest{}.form)), objective = std::string(name(FitRequest{}.objective)),
                discretise = std::string(name(SuRequest{}.discretise)),
                interpolation = std::string(name(SuRequest{}.interpolation)), with_index, channels = "rgb", band;
    int axial = 0;  // 1: axial lobes, -1: general lobes, 0: depends on the measurement
    bool no_scale = false, reciprocal = false, lobes_auto = false, exchange = false, resume = false, explain = false;
    double max_theta = 0;  // [degrees], 0: the objective's default
    int lobes = 0;         // 0: not given
    int variates = PmRequest{}.variates, threads = 0;
    int directions = SuRequest{}.directions, between = SuRequest{}.between, neighbours = SuRequest{}.neighbours;
    std::uint64_t seed = 0;
    double target_error = 0, target_delta_e = 0;  // 0: none
    std::size_t budget = 0;                       // 0: none

    PmRequest pm() const {
        PmRequest pm;
        pm.form = *form_named(form);
        pm.variates = variates;
        if (axial != 0) pm.axial = axial > 0;
        pm.reciprocal = reciprocal;
        pm.log_scale = !no_scale;
        if (lobes > 0) pm.size = LobeCount{lobes};
        if (lobes_auto) pm.size = AutomaticLobes{};
        if (budget > 0) pm.size = ByteBudget{budget};
        if (target_error > 0) pm.size = TargetError{target_error};
        if (target_delta_e > 0) pm.size = TargetDeltaE{target_delta_e};
        return pm;
    }
    SuRequest su() const {
        SuRequest su;
        if (lobes > 0) su.lobes = lobes;
        su.discretise = *discretise_named(discretise);
        su.directions = directions, su.between = between;
        su.interpolation = *interpolation_named(interpolation), su.neighbours = neighbours;
        if (!with_index.empty()) su.index = map_named(with_index);
        return su;
    }
    FitRequest request() const {
        FitRequest request;
        if (model == "pm") request.model = pm();
        if (model == "su") request.model = su();
        if (model == "ggx") request.model = GgxRequest{std::max(lobes, 1)};
        if (model == "pbr") request.model = PbrRequest{*pbr_surface_named(surface)};
        request.objective = *objective_named(objective);
        if (max_theta > 0) request.max_theta = max_theta * k_degree;
        request.spectral = is_spectral();
        request.seed = seed, request.threads = threads;
        return request;
    }
    bool is_spectral() const { return channels == "spectral"; }
    bool output_is_folder() const {
        std::error_code ignored;
        return output.ends_with('/') || std::filesystem::is_directory(output, ignored);
    }
    /// Texels and several inputs go into a folder, and one does if the output is a folder, as with `cp`.
    bool into_folder() const { return basis.empty() && several(); }
    bool several() const { return inputs.size() > 1 || resume || !pairs.empty() || output_is_folder(); }
    FileFit file_fit() const {
        const std::string beside = std::filesystem::path(inputs[0]).stem().string() + ".srbf";
        return {inputs[0], output.empty() ? beside : output, preview, json, request(), exchange, read, band, given};
    }
    FolderFit folder_fit() const {
        return {inputs, output, {{}, {}, {}, {}, request(), exchange, read, band, given}, options_text(), resume};
    }
    TexelFits texel_fits() const {
        TexelFits fit{inputs[0], pairs, output, request(), first, last, slab, axial < 0, options_text(), resume};
        auto& pm = std::get<PmRequest>(fit.request.model);
        if (!pm.size) pm.size = std::get<PmRequest>(BatchOptions{}.request.model).size;
        return fit;
    }
    BasisFit basis_fit() const {
        BasisFit fit;
        fit.inputs = inputs, fit.output = output, fit.pairs = pairs, fit.width = width, fit.resume = resume;
        fit.key = options_text();
        const auto lobes_shared = to_number<int>(basis);
        if (!lobes_shared) fit.basis = basis;
        fit.options.form = *form_named(form), fit.options.variates = variates, fit.options.axial = axial >= 0;
        fit.options.lobes = lobes_shared.value_or(fit.options.lobes), fit.options.active = active;
        fit.options.max_theta = max_theta * k_degree, fit.options.seed = seed, fit.options.threads = threads;
        return fit;
    }
    /// All options that a model depends on.
    std::string options_text() const {
        return fmt::format("{} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {}",
                           model == "pbr" ? "pbr " + surface : model, form, objective, discretise, interpolation,
                           with_index, channels, axial, no_scale, reciprocal, lobes_auto, exchange, max_theta, lobes,
                           variates, directions, between, neighbours, seed, target_error, target_delta_e, budget,
                           band) +
               text_of(read);
    }
};

int fit_file(FileFit fit) {
    const auto measured = load_measured(fit);
    if (!measured) return complain(measured.error());
    const auto writable = check_outputs({fit.input}, {fit.output, fit.preview, fit.json == "-" ? "" : fit.json});
    if (!writable) return complain(writable.error());

    if (std::holds_alternative<BsdfTable>(measured->table)) return fit_both_sides(fit, *measured);

    ProgressLine line;
    auto outcome =
        fit_measured(*measured, fit, [&](const Progress& now) { return line.show(now.stage, now.fraction), true; });
    if (!outcome) return line.clear(), complain(outcome.error());
    Image8 picture;
    if (!fit.preview.empty()) {
        line.show("drawing", 1);
        picture = preview_of(fit, *measured, outcome->model);
    }
    line.clear();
    const auto written = write_fit(fit, outcome->model, picture, report_of(fit, *measured, *outcome),
                                   [&] { return print_report(fit, *measured, *outcome); });
    return written ? k_done : complain(written.error());
}

/// Each objective with its θmax.
std::vector<std::string> default_angles() {
    std::vector<std::string> angles;
    for (const Objective objective : objectives())
        angles.push_back(fmt::format("{} {:g}", name(objective), default_max_theta(objective) / k_degree));
    return angles;
}

std::vector<std::string> names_of_objectives() {
    std::vector<std::string> names;
    for (const Objective objective : objectives()) names.emplace_back(name(objective));
    return names;
}

/// A line for each.
std::string summaries_of_objectives() {
    std::string lines;
    for (const Objective objective : objectives())
        lines += fmt::format("\n{}: {}", name(objective), summary(objective));
    return lines;
}

constexpr std::size_t k_most_texels_of_a_slab = std::size_t(1) << 20;

/// FIRST:END, FIRST < END.
Check texel_range() {
    return [](const std::string& text) -> std::string {
        const auto at = text.find(':');
        const auto first = to_number<std::uint64_t>(std::string_view(text).substr(0, at)),
                   end = at == text.npos ? std::nullopt : to_number<std::uint64_t>(text.substr(at + 1));
        return first && end && *first < *end ? "" : fmt::format("expected FIRST:END, found {}", text);
    };
}

/// A number of lobes, or "auto".
Check lobes_or_auto() {
    return [](std::string& text) { return text == "auto" ? "" : within<int>(fit_option("lobes"))(text); };
}

int FitCommand::run() const {
    if (explain) {
        fmt::print("{}", srbf::explain(request()));
        return k_done;
    }
    if (!basis.empty()) return pairs.empty() ? fit_basis(basis_fit()) : fit_texel_maps(basis_fit());
    if (!pairs.empty()) return fit_texels(texel_fits());
    return into_folder() ? fit_files(folder_fit()) : fit_file(file_fit());
}

/// Which measurements an option is read for. The table of `add_fit` is of what depends on the command line alone.
struct ReadFor {
    std::vector<std::string_view> options;
    bool are_read;
    std::string_view expected, found;
};

/// An error if an option was given that the fit of such a measurement does not read.
Result<Done> check_read(const Measured& measured, const FileFit& fit) {
    const auto* bsdf = std::get_if<BsdfTable>(&measured.table);
    const bool of_patches = bsdf && std::ranges::any_of(bsdf->band().part, [](const auto& part) {
                                return part && std::holds_alternative<KlemsTable>(part->table);
                            });
    const auto* pm = std::get_if<PmRequest>(&fit.request.model);
    const bool of_views = std::holds_alternative<SuRequest>(fit.request.model);
    const bool tries_kinds =
        goal_of(fit.request) && pm->log_scale && !std::holds_alternative<ScatteredSamples>(measured.table);
    const ReadFor rows[] = {
        {{"--form", "--variates"}, !tries_kinds, "samples", "a table, of which all forms and variates are tried"},
        {{"--variates"},
         !(of_patches && pm && !pm->size),
         "a number of lobes too",
         "none, so that sizes of patches are tried"},
        {{"--target-error", "--target-delta-e", "--budget"}, !of_patches, "a table or samples", "patches"},
        {{"--objective", "--max-theta"}, !of_patches || of_views, "a table or samples", "patches"},
        {{"--channels"}, !(of_patches && fit.request.spectral), "rgb", "spectral, of patches"},
    };
    for (const ReadFor& row : rows)
        for (const std::string_view option : row.options)
            if (!row.are_read && std::ranges::count(fit.given, option) > 0)
                return Error{fit.input, {}, std::string(option), std::string(row.expected), std::string(row.found)};
    return Done{};
}

}  // namespace

Result<Measured> load_measured(FileFit& fit) {
    const Stopwatch loading;
    auto subject = load(fit.input, fit.read);
    if (!subject) return subject.error();
    auto* measured = std::get_if<Measured>(&subject->content);
    if (!measured) return Error{fit.input, {}, "input", "a measurement", "a fitted model", ErrorCode::wrong_kind};
    if (fit.exchange) exchange(*measured);
    if (!fit.band.empty())
        if (const auto chosen = choose_band(*measured, fit.band); !chosen) return chosen.error();
    if (const auto read = check_read(*measured, fit); !read) return read.error();
    fit.load_seconds = loading.seconds();
    return std::move(*measured);
}

Image8 preview_of(const FileFit& fit, const Measured& measured, const Model& model) {
    PreviewOptions options;
    options.threads = fit.request.threads;
    options.captions[1] = fmt::format("fit, {} bytes", payload_bytes(model));
    return preview(evaluator(measured), evaluator(model), options);
}

Result<Done> write_fit(const FileFit& fit, const Model& model, const Image8& picture, const Json& report,
                       const std::function<Result<Done>()>& print) {
    std::vector<NewFile> files{{fit.output, write_model(model)}};
    if (!fit.preview.empty()) {
        auto bytes = png(picture, fit.preview);
        if (!bytes) return bytes.error();
        files.push_back({fit.preview, *std::move(bytes)});
    }
    if (!fit.json.empty() && fit.json != "-") files.push_back({fit.json, json_bytes(report)});
    return write_files(files, [&] { return fit.json == "-" ? write_json(report, "-") : print(); });
}

Result<FitOutcome> fit_measured(const Measured& measured, const FileFit& fit, const ProgressToken& progress) {
    auto outcome = within_memory(fit.input, [&] { return srbf::fit(measured, fit.request, progress); });
    if (!outcome) {
        Error error = outcome.error();
        error.source = fit.input;
        return error;
    }
    outcome->model.provenance["source"] = std::filesystem::path(fit.input).filename().string();
    if (fit.exchange) outcome->model.provenance["exchanged"] = k_exchanged;
    return outcome;
}

void add_fit(CommandLine& app, int& status) {
    const auto command = std::make_shared<FitCommand>();
    const Subcommand sub =
        app.add_subcommand("fit", "Fit a model to a measurement, or to each of many, and report its errors");
    sub.add_option("INPUT", command->inputs,
                   "The measurement: a table of MERL's, RGL's, UTIA's or MDL's layout, scattered samples,\n"
                   "or BSDF XML of WINDOW and Radiance; several of them with a folder for the models")
        .type_name("")
        .required();
    const Option output =
        sub.add_option("-o,--output", command->output,
                       "The model; default: INPUT's stem + .srbf in the working directory. Or a folder, for STEM.srbf\n"
                       "and the report STEM.json of each INPUT")
            .type_name("FILE|DIR");
    const Option resume = sub.add_flag(
        "--resume", [command] { command->resume = true; },
        "Keep the models of the folder that were made of the same file by the same options and version");
    sub.add_option("--model", command->model,
                   "pm: parameterized multivariate SRBFs, one sum of lobes for the whole BRDF;\n"
                   "su: scattered univariate SRBFs, a sum of lobes for each of many view directions;\n"
                   "ggx: Lambert and GGX, the baseline;\n"
                   "pbr: a surface by the parameters of OpenPBR, which renderers share")
        .type_name("NAME")
        .one_of({"pm", "su", "ggx", "pbr"})
        .capture_default_str();
    const Option surface = sub.add_option("--surface", command->surface,
                                          "Whose parameters are fitted: of OpenPBR, of glTF with its extensions, or of "
                                          "Blender's\nPrincipled BSDF")
                               .type_name("NAME")
                               .one_of({k_pbr_surfaces.begin(), k_pbr_surfaces.end()})
                               .capture_default_str();
    std::vector<std::string> forms, form_summaries;
    for (const FormRow& row : k_form_rows) {
        forms.emplace_back(row.name);
        form_summaries.push_back(fmt::format("{}: {}", row.name, row.summary));
    }
    const Option form =
        sub.add_option("--form", command->form, fmt::format("{}", fmt::join(form_summaries, "; ")))
            .type_name("NAME")
            .check(
                [is_one = one_of(forms)](std::string& text) { return form_named(text) ? std::string() : is_one(text); },
                forms)
            .capture_default_str();
    const Option lobes =
        sub.add_option(
               "--lobes",
               [command](const std::string& text) {
                   command->lobes_auto = text == "auto";
                   command->lobes = command->lobes_auto ? 0 : std::stoi(text);
               },
               fmt::format("Number of lobes, 1 to {}; for su per sampled direction; for ggx 1 or 2. "
                           "auto: for a table the best\n"
                           "compromise between bytes and error; for samples by cross-validation, or the most. "
                           "Default: {}; for samples auto; "
                           "for ggx 1",
                           k_most_fitted_lobes, LobeCount{}.lobes))
            .type_name("J|auto")
            .check(lobes_or_auto());
    const Option variates =
        sub.add_option("--variates", command->variates,
                       fmt::format("Number of variates, the factors of a lobe, 1 to {}", k_most_variates))
            .type_name("N")
            .check(within<int>(fit_option("variates")))
            .capture_default_str();
    const Option axial = sub.add_flag("--axial{1},--no-axial{-1}", command->axial,
                                      "Centres only at +z or -z; or general centres, which take 4 J N more bytes.\n"
                                      "Default: general for anisotropic measurements");
    const Option reciprocal =
        sub.add_flag("--reciprocal", command->reciprocal,
                     "f(wl, wv) = f(wv, wl): pairs of variates share bandwidths; N must be even. Larger errors");
    const Option no_scale =
        sub.add_flag("--no-scale", command->no_scale,
                     "Store no log scales: bounds the coefficients in the fit.\nSaves 2 J bytes; larger errors");
    const Option exchanged =
        sub.add_flag("--exchange", command->exchange,
                     "Exchange light and viewer of the measurement, as renderers do that take the first\n"
                     "direction of an RGL file for the viewer");
    const std::vector<Option> of_samples = add_read_options(sub, command->read);
    const Option objective =
        sub.add_option("--objective", command->objective, "What the fit minimises:" + summaries_of_objectives())
            .type_name("NAME")
            .one_of(names_of_objectives())
            .capture_default_str();
    sub.add_option(
           "--max-theta", command->max_theta,
           fmt::format("Largest angle from the normal in the fit and in all errors,\n1 to 89.9 degrees; default: {}",
                       fmt::join(default_angles(), ", ")))
        .type_name("DEG")
        .check(within<double>(fit_option("max_theta")));
    const Option discretise = sub.add_option("--discretise", command->discretise,
                                             "su: the sampled direction; lobes are functions of the other one")
                                  .type_name("view|light")
                                  .one_of({"view", "light"})
                                  .capture_default_str();
    const Option directions =
        sub.add_option("--directions", command->directions,
                       fmt::format("su: number of sampled directions, {} to {}", k_least_views, k_most_views))
            .type_name("N")
            .check(within(k_least_views, k_most_views))
            .capture_default_str();
    const Option interpolation =
        sub.add_option("--interpolation", command->interpolation,
                       "su: rotated: between the two samples adjacent in elevation, rotated to the azimuth of the\n"
                       "direction, for isotropic measurements; plain: between the nearest samples")
            .type_name("NAME")
            .one_of({"rotated", "plain"})
            .capture_default_str();
    const Option neighbours =
        sub.add_option("--neighbours", command->neighbours,
                       fmt::format("su: number of samples of the plain interpolation, 1 to {}", k_most_neighbours))
            .type_name("K")
            .check(within(1, k_most_neighbours))
            .capture_default_str();
    const Option between =
        sub.add_option("--between", command->between,
                       fmt::format("su: number of further directions per sampled one in the fit, 0 to {};\n"
                                   "0: only the raw matrix",
                                   k_most_between))
            .type_name("M")
            .check(within(0, int(k_most_between)))
            .capture_default_str();
    const Option with_index = sub.add_option("--with-index", command->with_index,
                                             "su: store an index texture, the samples nearest to each direction")
                                  .type_name("cube|parabolic")
                                  .one_of({"cube", "parabolic"});
    const Option band =
        sub.add_option("--band", command->band,
                       "Of BSDF XML: the band of wavelengths, Visible or Solar; default: Visible, or the first")
            .type_name("NAME");
    const Option channels =
        sub.add_option("--channels", command->channels,
                       "rgb: colours; spectral: lobes with a coefficient for each wavelength of the measurement")
            .type_name("NAME")
            .one_of({"rgb", "spectral"})
            .capture_default_str();
    const Option target_error =
        sub.add_option("--target-error", command->target_error,
                       "pm: the smallest model of all forms and sizes with at most this held-out error,\n"
                       "by the objective's own measure, as a ratio: 0.005 is half a per cent")
            .type_name("E")
            .check(within<double>(fit_option("target_error")));
    const Option target_delta_e =
        sub.add_option("--target-delta-e", command->target_delta_e,
                       "pm: the smallest model of all forms and sizes that looks the same: mean Delta E (ITP)\n"
                       "of pictures of a sphere, where 1 is just noticeable")
            .type_name("E")
            .check(within<double>(fit_option("target_delta_e")));
    const Option budget = sub.add_option("--budget", command->budget,
                                         "pm: the best model of all forms and sizes with at most this many bytes")
                              .type_name("BYTES")
                              .check(within<std::size_t>(fit_option("budget")));
    const Option picture = sub.add_option("--preview", command->preview,
                                          "Write a picture of the measurement, the fit and 10 x their difference")
                               .type_name("FILE.png")
                               .check(png_name());
    const Option json = sub.add_option("--json", command->json, "Write the report to this file; - is standard output")
                            .type_name("FILE");
    const Option pairs =
        sub.add_option(
               "--pairs", command->pairs,
               "INPUT is a .npy file of texels, float32 [T, M, 3], [T, M, 1] or [T, M]: f_r at the M pairs of\n"
               "directions of this CSV file, columns wl_x to wv_z. Writes DIR/STEM-FIRST.srbf, stacks of models;\n"
               "4 lobes by default, a short search")
            .type_name("P.csv");
    const Option texels = sub.add_option(
                                 "--texels",
                                 [command](const std::string& text) {
                                     const auto at = text.find(':');
                                     command->first = std::stoull(text.substr(0, at));
                                     command->last = std::stoull(text.substr(at + 1));
                                 },
                                 "With --pairs: only texels FIRST to END - 1, for one of several machines")
                              .type_name("FIRST:END")
                              .check(texel_range());
    const Option slab =
        sub.add_option("--slab", command->slab, "With --pairs: number of texels in memory and in a file")
            .type_name("T")
            .check(within(std::size_t(1), k_most_texels_of_a_slab))
            .capture_default_str();
    const Option basis =
        sub.add_option("--basis", command->basis,
                       fmt::format("One library of all INPUTs, which share J lobes, 1 to {}; or of the lobes of an\n"
                                   "earlier library, without a search. Materials are FILE.srbf#STEM afterwards",
                                   k_most_basis_lobes))
            .type_name("J|LIBRARY")
            .check([](std::string& text) -> std::string {
                const auto count = to_number<int>(text);
                return !count || (*count >= 1 && *count <= k_most_basis_lobes)
                           ? ""
                           : fmt::format("expected 1 to {}, found {}", k_most_basis_lobes, text);
            });
    const Option active =
        sub.add_option("--active", command->active,
                       "With --basis: each material is a sum of at most K of the lobes; default: of all")
            .type_name("K")
            .check(within(1, k_most_basis_lobes));
    const Option width = sub.add_option("--width", command->width,
                                        "With --basis and --pairs: texels in a row of the map, for FILE.srbf#X,Y")
                             .type_name("W")
                             .check(within(std::size_t(1), std::size_t(1) << 20));
    const Option seed = sub.add_option("--seed", command->seed, "Seed of the random numbers")
                            .type_name("SEED")
                            .check(within(std::uint64_t(0), std::numeric_limits<std::uint64_t>::max()))
                            .capture_default_str();
    const Option explained = sub.add_flag("--explain", command->explain,
                                          "pm: print the terms that a fit minimises and its stages, and fit nothing");
    const Option threads = sub.add_option("--threads", command->threads,
                                          "Number of threads; 0: all of the machine. The model does not depend on it")
                               .type_name("T")
                               .check(within<int>(fit_option("threads")))
                               .capture_default_str();
    sub.footer(
        "Examples:\n  srbf fit paper_white_rgb.bsdf\n"
        "  srbf fit nickel.binary --lobes 6 --variates 3 --objective raw --preview nickel.png --json -\n"
        "  srbf fit paper_white_rgb.bsdf --model su --lobes 5 --with-index cube\n"
        "  srbf fit materials/*.binary -o models --resume\n"
        "  srbf fit paper_white_rgb.bsdf --target-delta-e 2\n  srbf fit krylon_blue.brdf --objective cube-root");
    const auto one_goal = [goals = std::vector{target_error, target_delta_e, budget}] {
        return std::ranges::count_if(goals, &Option::given) <= 1;
    };
    sub.callback(
        [=, &status] {
            if (basis.given() && !output.given()) output.fail("a file is required for a library");
            if (command->into_folder() && !output.given())
                output.fail("a folder is required for several inputs, --resume and --pairs");
            command->given = sub.given();
            status = command->run();
        },
        {
            {{form, variates, axial, reciprocal, no_scale, target_error, target_delta_e, budget, explained},
             "only with --model pm",
             [=] { return command->model == "pm"; }},
            {{discretise, directions, interpolation, neighbours, between, with_index},
             "only with --model su",
             [=] { return command->model == "su"; }},
            {{surface}, "only with --model pbr", [=] { return command->model == "pbr"; }},
            {{lobes}, "not with --model pbr", [=] { return command->model != "pbr"; }},
            {{neighbours},
             "only with --interpolation plain or --with-index",
             [=] { return command->interpolation == "plain" || with_index.given(); }},
            {{no_scale},
             "only with --form gaussian; other forms always store log scales",
             [=] { return form_named(command->form) == PmForm::gaussian; }},
            {{variates},
             "an even number with --reciprocal",
             [=] { return !command->reciprocal || command->variates % 2 == 0; }},
            {{target_error, target_delta_e, budget}, "not together with another goal of the size", one_goal},
            {{channels},
             "spectral only with --model pm",
             [=] { return !command->is_spectral() || command->model == "pm"; }},
            {{target_error, target_delta_e, budget},
             "only with --channels rgb",
             [=] { return !command->is_spectral(); }},
            {{target_error, target_delta_e, budget},
             "chooses the number of lobes; not together with --lobes",
             [=] { return !lobes.given(); }},
            {{lobes}, "auto only with --model pm", [=] { return !command->lobes_auto || command->model == "pm"; }},
            {{lobes}, "of ggx 1 or 2", [=] { return command->model != "ggx" || command->lobes <= k_most_ggx_lobes; }},
            {{form, axial, reciprocal, no_scale, target_error, target_delta_e, budget, picture, json, output, resume,
              pairs, texels, slab, exchanged, band, channels, seed, threads},
             "not with --explain, which fits nothing",
             [=] { return !command->explain; }},
            {{lobes},
             "a number with --explain and --pairs",
             [=] { return !command->lobes_auto || !(command->explain || pairs.given()); }},
            {of_samples, "not with --explain and --pairs", [=] { return !command->explain && !pairs.given(); }},
            {{width}, "only with --basis and --pairs", [=] { return basis.given() && pairs.given(); }},
            {{active}, "not with --pairs, whose libraries are dense", [=] { return !pairs.given(); }},
            {{texels, slab}, "not with --basis", [=] { return !basis.given(); }},
            {{resume}, "with --basis only with --pairs", [=] { return !basis.given() || pairs.given(); }},
            {{basis},
             "a number of lobes with --pairs",
             [=] { return !pairs.given() || !basis.given() || to_number<int>(command->basis).has_value(); }},
            {{active}, "only with --basis", [=] { return basis.given(); }},
            {{active},
             "at most the number of shared lobes",
             [=] { return command->active <= to_number<int>(command->basis).value_or(k_most_basis_lobes); }},
            {{lobes, reciprocal, no_scale, target_error, target_delta_e, budget, picture, json, exchanged, band,
              channels, explained, objective},
             "not with --basis",
             [=] { return !basis.given(); }},
            {of_samples, "not with --basis", [=] { return !basis.given(); }},
            {{basis}, "only with --model pm", [=] { return command->model == "pm"; }},
            {{texels, slab}, "only with --pairs", [=] { return pairs.given(); }},
            {{pairs}, "with one INPUT", [=] { return command->inputs.size() == 1; }},
            {{pairs},
             "only with --model pm in colours",
             [=] { return command->model == "pm" && !command->is_spectral(); }},
            {{target_error, target_delta_e, budget, exchanged, band},
             "not with --pairs",
             [=] { return !pairs.given(); }},
            {{picture, json},
             "not with a folder, which has a report of each fit",
             [=] { return !command->into_folder(); }},
            {{output},
             "a folder, for several inputs, --resume and --pairs, not the name of a model",
             [=] {
                 return !command->into_folder() || command->output_is_folder() || !command->output.ends_with(".srbf");
             }},
        });
}

}  // namespace srbf
