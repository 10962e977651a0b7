// The options of `srbf fit`, by what they are of, and the table of those that go together.
#include <algorithm>
#include <limits>
#include <memory>

#include "app/commands.h"
#include "app/fit_command.h"
#include "srbf/directions.h"
#include "srbf/fit_batch.h"
#include "srbf/text.h"

namespace srbf {
namespace {

/// The options of the command line, of which it is asked whether they are given.
struct GivenOptions {
    Option input, output, resume, picture, json;
    Option surface, form, lobes, variates, axial, reciprocal, no_scale;
    Option exchanged, band, channels;
    std::vector<Option> of_samples;
    Option objective, target_delta_e, budget;
    Option discretise, directions, interpolation, neighbours, with_index;
    Option pairs, texels, slab, basis, active, width;
    Option seed, explained, threads;
};

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

void add_files(const Subcommand& sub, FitCommand& to, GivenOptions& of) {
    of.input = sub.add_option("INPUT", to.inputs,
                              "The measurement: a table of MERL's, RGL's, UTIA's or MDL's layout, scattered samples,\n"
                              "or BSDF XML of WINDOW and Radiance; several of them with a folder for the models")
                   .type_name("")
                   .required();
    of.output =
        sub.add_option("-o,--output", to.output,
                       "The model; default: INPUT's stem + .srbf in the working directory. Or a folder, for STEM.srbf\n"
                       "and the report STEM.json of each INPUT")
            .type_name("FILE|DIR");
    of.resume = sub.add_flag(
        "--resume", [&to] { to.resume = true; },
        "Keep the models of the folder that were made of the same file by the same options and version");
}

void add_model(const Subcommand& sub, FitCommand& to, GivenOptions& of) {
    sub.add_option("--model", to.model,
                   "pm: parameterized multivariate SRBFs, one sum of lobes for the whole BRDF;\n"
                   "su: scattered univariate SRBFs, a sum of lobes for each of many view directions;\n"
                   "ggx: Lambert and GGX, the baseline;\n"
                   "openpbr: a surface by the parameters of OpenPBR, which renderers share")
        .type_name("NAME")
        .one_of({"pm", "su", "ggx", "openpbr"})
        .capture_default_str();
    of.surface = sub.add_option("--surface", to.surface,
                                "Whose parameters are fitted: of OpenPBR, of glTF with its extensions, or of "
                                "Blender's\nPrincipled BSDF")
                     .type_name("NAME")
                     .one_of({k_openpbr_surfaces.begin(), k_openpbr_surfaces.end()})
                     .capture_default_str();
}

void add_lobes(const Subcommand& sub, FitCommand& to, GivenOptions& of) {
    std::vector<std::string> forms, form_summaries;
    for (const FormRow& row : k_form_rows) {
        forms.emplace_back(row.name);
        form_summaries.push_back(fmt::format("{}: {}", row.name, row.summary));
    }
    of.form =
        sub.add_option("--form", to.form, fmt::format("{}", fmt::join(form_summaries, "; ")))
            .type_name("NAME")
            .check(
                [is_one = one_of(forms)](std::string& text) { return form_named(text) ? std::string() : is_one(text); },
                forms)
            .capture_default_str();
    of.lobes = sub.add_option(
                      "--lobes",
                      [&to](const std::string& text) {
                          to.lobes_auto = text == "auto";
                          to.lobes = to.lobes_auto ? 0 : std::stoi(text);
                      },
                      fmt::format("Number of lobes, 1 to {}; for su per sampled direction; for ggx 1 or 2. "
                                  "auto: for a table the best\n"
                                  "compromise between bytes and error; for samples by cross-validation, or the most. "
                                  "Default: {}; for samples auto; "
                                  "for ggx 1",
                                  k_most_fitted_lobes, LobeCount{}.lobes))
                   .type_name("J|auto")
                   .check(lobes_or_auto());
    of.variates = sub.add_option("--variates", to.variates,
                                 fmt::format("Number of variates, the factors of a lobe, 1 to {}", k_most_variates))
                      .type_name("N")
                      .check(within<int>(fit_option("variates")))
                      .capture_default_str();
    of.axial = sub.add_flag("--axial{1},--no-axial{-1}", to.axial,
                            "Centres only at +z or -z; or general centres, which take 4 J N more bytes.\n"
                            "Default: general for anisotropic measurements");
    of.reciprocal =
        sub.add_flag("--reciprocal", to.reciprocal,
                     "f(wl, wv) = f(wv, wl): pairs of variates share bandwidths; N must be even. Larger errors");
    of.no_scale =
        sub.add_flag("--no-scale", to.no_scale,
                     "Store no log scales: bounds the coefficients in the fit.\nSaves 2 J bytes; larger errors");
}

void add_data(const Subcommand& sub, FitCommand& to, GivenOptions& of) {
    of.exchanged = sub.add_flag("--exchange", to.exchange,
                                "Exchange light and viewer of the measurement, as renderers do that take the first\n"
                                "direction of an RGL file for the viewer");
    of.of_samples = add_read_options(sub, to.read);
}

void add_objective(const Subcommand& sub, FitCommand& to, GivenOptions& of) {
    of.objective = sub.add_option("--objective", to.objective, "What the fit minimises:" + summaries_of_objectives())
                       .type_name("NAME")
                       .one_of(names_of_objectives())
                       .capture_default_str();
    sub.add_option(
           "--max-theta", to.max_theta,
           fmt::format("Largest angle from the normal in the fit and in all errors,\n1 to 89.9 degrees; default: {}",
                       fmt::join(default_angles(), ", ")))
        .type_name("DEG")
        .check(within<double>(fit_option("max_theta")));
}

void add_views(const Subcommand& sub, FitCommand& to, GivenOptions& of) {
    of.discretise =
        sub.add_option("--discretise", to.discretise, "su: the sampled direction; lobes are functions of the other one")
            .type_name("view|light")
            .one_of({"view", "light"})
            .capture_default_str();
    of.directions =
        sub.add_option("--directions", to.directions,
                       fmt::format("su: number of sampled directions, {} to {}", k_least_views, k_most_views))
            .type_name("N")
            .check(within(k_least_views, k_most_views))
            .capture_default_str();
    of.interpolation =
        sub.add_option("--interpolation", to.interpolation,
                       "su: rotated: between the two samples adjacent in elevation, rotated to the azimuth of the\n"
                       "direction, for isotropic measurements; plain: between the nearest samples")
            .type_name("NAME")
            .one_of({"rotated", "plain"})
            .capture_default_str();
    of.neighbours =
        sub.add_option("--neighbours", to.neighbours,
                       fmt::format("su: number of samples of the plain interpolation, 1 to {}", k_most_neighbours))
            .type_name("K")
            .check(within(1, k_most_neighbours))
            .capture_default_str();
    sub.add_former("--between", "512 directions in every fit");
    of.with_index = sub.add_option("--with-index", to.with_index,
                                   "su: store an index texture, the samples nearest to each direction")
                        .type_name("cube|parabolic")
                        .one_of({"cube", "parabolic"});
}

void add_channels(const Subcommand& sub, FitCommand& to, GivenOptions& of) {
    of.band = sub.add_option("--band", to.band,
                             "Of BSDF XML: the band of wavelengths, Visible or Solar; default: Visible, or the first")
                  .type_name("NAME");
    of.channels =
        sub.add_option("--channels", to.channels,
                       "rgb: colours; spectral: lobes with a coefficient for each wavelength of the measurement")
            .type_name("NAME")
            .one_of({"rgb", "spectral"})
            .capture_default_str();
}

void add_goals(const Subcommand& sub, FitCommand& to, GivenOptions& of) {
    of.target_delta_e =
        sub.add_option("--target-delta-e", to.target_delta_e,
                       "pm: the smallest model of all forms and sizes with at most this visible error, the mean\n"
                       "Delta E (ITP) of pictures of a sphere, where 1 is just noticeable")
            .type_name("E")
            .check(within<double>(fit_option("target_delta_e")));
    of.budget =
        sub.add_option("--budget", to.budget, "pm: the best model of all forms and sizes with at most this many bytes")
            .type_name("BYTES")
            .check(within<std::size_t>(fit_option("budget")));
    sub.add_former("--target-error", "--target-delta-e, the visible error, or --budget");
}

void add_reports(const Subcommand& sub, FitCommand& to, GivenOptions& of) {
    of.picture =
        sub.add_option("--preview", to.preview, "Write a picture of the measurement, the fit and 10 x their difference")
            .type_name("FILE.png")
            .check(png_name());
    of.json =
        sub.add_option("--json", to.json, "Write the report to this file; - is standard output").type_name("FILE");
}

void add_texels(const Subcommand& sub, FitCommand& to, GivenOptions& of) {
    of.pairs =
        sub.add_option(
               "--pairs", to.pairs,
               "INPUT is a .npy file of texels, float32 [T, M, 3], [T, M, 1] or [T, M]: f_r at the M pairs of\n"
               "directions of this CSV file, columns wl_x to wv_z. Writes DIR/STEM-FIRST.srbf, stacks of models;\n"
               "4 lobes by default, a short search")
            .type_name("P.csv");
    of.texels = sub.add_option(
                       "--texels",
                       [&to](const std::string& text) {
                           const auto at = text.find(':');
                           to.first = std::stoull(text.substr(0, at));
                           to.last = std::stoull(text.substr(at + 1));
                       },
                       "With --pairs: only texels FIRST to END - 1, for one of several machines")
                    .type_name("FIRST:END")
                    .check(texel_range());
    of.slab = sub.add_option("--slab", to.slab, "With --pairs: number of texels in memory and in a file")
                  .type_name("T")
                  .check(within(std::size_t(1), k_most_texels_of_a_slab))
                  .capture_default_str();
}

void add_basis(const Subcommand& sub, FitCommand& to, GivenOptions& of) {
    of.basis =
        sub.add_option("--basis", to.basis,
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
    of.active = sub.add_option("--active", to.active,
                               "With --basis: each material is a sum of at most K of the lobes; default: of all")
                    .type_name("K")
                    .check(within(1, k_most_basis_lobes));
    of.width =
        sub.add_option("--width", to.width, "With --basis and --pairs: texels in a row of the map, for FILE.srbf#X,Y")
            .type_name("W")
            .check(within(std::size_t(1), std::size_t(1) << 20));
}

void add_running(const Subcommand& sub, FitCommand& to, GivenOptions& of) {
    of.seed = sub.add_option("--seed", to.seed, "Seed of the random numbers")
                  .type_name("SEED")
                  .check(within(std::uint64_t(0), std::numeric_limits<std::uint64_t>::max()))
                  .capture_default_str();
    of.explained = sub.add_flag("--explain", to.explain,
                                "pm: print the terms that a fit minimises and its stages, and fit nothing");
    of.threads = sub.add_option("--threads", to.threads,
                                "Number of threads; 0: all of the machine. The model does not depend on it")
                     .type_name("T")
                     .check(within<int>(fit_option("threads")))
                     .capture_default_str();
}

/// Of the model and the size that is asked for.
std::vector<Reading> of_model(const GivenOptions& of, const FitCommand& fit) {
    return {
        {{of.form, of.variates, of.axial, of.reciprocal, of.no_scale, of.target_delta_e, of.budget, of.explained},
         "only with --model pm",
         [&] { return fit.model == "pm"; }},
        {{of.discretise, of.directions, of.interpolation, of.neighbours, of.with_index},
         "only with --model su",
         [&] { return fit.model == "su"; }},
        {{of.surface}, "only with --model openpbr", [&] { return fit.model == "openpbr"; }},
        {{of.lobes}, "not with --model openpbr", [&] { return fit.model != "openpbr"; }},
        {{of.neighbours},
         "only with --interpolation plain or --with-index",
         [&] { return fit.interpolation == "plain" || of.with_index.given(); }},
        {{of.no_scale},
         "only with --form gaussian; other forms always store log scales",
         [&] { return form_named(fit.form) == PmForm::gaussian; }},
        {{of.variates}, "an even number with --reciprocal", [&] { return !fit.reciprocal || fit.variates % 2 == 0; }},
        {{of.channels}, "spectral only with --model pm", [&] { return !fit.is_spectral() || fit.model == "pm"; }},
        {{of.lobes}, "auto only with --model pm", [&] { return !fit.lobes_auto || fit.model == "pm"; }},
        {{of.lobes}, "of ggx 1 or 2", [&] { return fit.model != "ggx" || fit.lobes <= k_most_ggx_lobes; }},
    };
}

/// Of goals of the size.
std::vector<Reading> of_goals(const GivenOptions& of, const FitCommand& fit) {
    return {
        {{of.target_delta_e, of.budget},
         "not together with another goal of the size",
         [&] { return !of.target_delta_e.given() || !of.budget.given(); }},
        {{of.target_delta_e, of.budget}, "only with --channels rgb", [&] { return !fit.is_spectral(); }},
        {{of.target_delta_e, of.budget},
         "chooses the number of lobes; not together with --lobes",
         [&] { return !of.lobes.given(); }},
    };
}

/// With --explain.
std::vector<Reading> of_explained(const GivenOptions& of, const FitCommand& fit) {
    return {
        {{of.form, of.axial, of.reciprocal, of.no_scale, of.target_delta_e, of.budget, of.picture, of.json, of.output,
          of.resume, of.pairs, of.texels, of.slab, of.exchanged, of.band, of.channels, of.seed, of.threads},
         "not with --explain, which fits nothing",
         [&] { return !fit.explain; }},
        {{of.lobes},
         "a number with --explain and --pairs",
         [&] { return !fit.lobes_auto || !(fit.explain || of.pairs.given()); }},
        {of.of_samples, "not with --explain and --pairs", [&] { return !fit.explain && !of.pairs.given(); }},
    };
}

/// Of libraries of shared lobes.
std::vector<Reading> of_basis(const GivenOptions& of, const FitCommand& fit) {
    return {
        {{of.width}, "only with --basis and --pairs", [&] { return of.basis.given() && of.pairs.given(); }},
        {{of.active}, "not with --pairs, whose libraries are dense", [&] { return !of.pairs.given(); }},
        {{of.texels, of.slab}, "not with --basis", [&] { return !of.basis.given(); }},
        {{of.resume}, "with --basis only with --pairs", [&] { return !of.basis.given() || of.pairs.given(); }},
        {{of.basis},
         "a number of lobes with --pairs",
         [&] { return !of.pairs.given() || !of.basis.given() || to_number<int>(fit.basis).has_value(); }},
        {{of.active}, "only with --basis", [&] { return of.basis.given(); }},
        {{of.active},
         "at most the number of shared lobes",
         [&] { return fit.active <= to_number<int>(fit.basis).value_or(k_most_basis_lobes); }},
        {{of.lobes, of.reciprocal, of.no_scale, of.budget, of.picture, of.json, of.exchanged, of.band, of.channels,
          of.explained, of.objective},
         "not with --basis",
         [&] { return !of.basis.given(); }},
        {{of.target_delta_e},
         "with --basis only with a number of lobes, and not with --pairs",
         [&] { return !of.basis.given() || (to_number<int>(fit.basis).has_value() && !of.pairs.given()); }},
        {of.of_samples, "not with --basis", [&] { return !of.basis.given(); }},
        {{of.basis}, "only with --model pm", [&] { return fit.model == "pm"; }},
    };
}

/// Of texels.
std::vector<Reading> of_texels(const GivenOptions& of, const FitCommand& fit) {
    return {
        {{of.texels, of.slab}, "only with --pairs", [&] { return of.pairs.given(); }},
        {{of.pairs}, "with one INPUT", [&] { return fit.inputs.size() == 1; }},
        {{of.pairs}, "only with --model pm in colours", [&] { return fit.model == "pm" && !fit.is_spectral(); }},
        {{of.target_delta_e, of.budget, of.exchanged, of.band}, "not with --pairs", [&] { return !of.pairs.given(); }},
    };
}

/// Of what is written.
std::vector<Reading> of_files(const GivenOptions& of, const FitCommand& fit) {
    return {
        {{of.picture, of.json},
         "not with a folder, which has a report of each fit",
         [&] { return !fit.into_folder(); }},
        {{of.output},
         "a folder, for several inputs, --resume and --pairs, not the name of a model",
         [&] { return !fit.into_folder() || fit.output_is_folder() || !fit.output.ends_with(".srbf"); }},
    };
}

}  // namespace

void add_fit(CommandLine& app, int& status) {
    struct State {
        FitCommand fit;
        GivenOptions of;
    };
    const auto state = std::make_shared<State>();
    const Subcommand sub =
        app.add_subcommand("fit", "Fit a model to a measurement, or to each of many, and report its errors");
    for (const auto add : {add_files, add_model, add_lobes, add_data, add_objective, add_views, add_channels, add_goals,
                           add_reports, add_texels, add_basis, add_running})
        add(sub, state->fit, state->of);
    sub.footer(
        "Examples:\n  srbf fit paper_white_rgb.bsdf\n"
        "  srbf fit nickel.binary --lobes 6 --variates 3 --objective raw --preview nickel.png --json -\n"
        "  srbf fit paper_white_rgb.bsdf --model su --lobes 5 --with-index cube\n"
        "  srbf fit materials/*.binary -o models --resume\n"
        "  srbf fit paper_white_rgb.bsdf --target-delta-e 2\n  srbf fit krylon_blue.brdf --objective cube-root");
    std::vector<Reading> readings;
    for (const auto rows : {of_model, of_goals, of_explained, of_basis, of_texels, of_files})
        std::ranges::copy(rows(state->of, state->fit), std::back_inserter(readings));
    sub.callback(
        [sub, state, &status] {
            auto& [fit, of] = *state;
            if (of.basis.given() && !of.output.given()) of.output.fail("a file is required for a library");
            if (fit.into_folder() && !of.output.given())
                of.output.fail("a folder is required for several inputs, --resume and --pairs");
            fit.given = sub.given();
            // The key has the content of inputs; texels and the width only tell where coefficients stand.
            fit.settings = sub.settings({of.input, of.pairs, of.output, of.resume, of.texels, of.width, of.threads});
            status = fit.run();
        },
        readings);
}

}  // namespace srbf
