// The options of `srbf fit`, by what they are of, and the table of those that go together.
#include "app/fit_command.h"

#include <algorithm>
#include <array>
#include <memory>

#include "app/commands.h"
#include "srbf/directions.h"
#include "srbf/fit_batch.h"
#include "srbf/text.h"

namespace srbf {
namespace {

/// The options of the command line, of which it is asked whether they are given.
struct GivenOptions {
    Option input, output, resume, picture, json;
    Option surface, lobes;
    LobeOptions lobe;
    Option exchanged, band, channels;
    std::vector<Option> of_samples;
    Option objective, target_delta_e, budget;
    Option discretise, directions, interpolation, neighbours, with_index;
    Option threads;
};

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
    of.resume =
        sub.add_flag("--resume", to.resume,
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
    of.lobe = add_lobe_options(sub, to.lobe);
    add_single_lobe_options(sub, to.lobe, of.lobe);
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
}

void add_data(const Subcommand& sub, FitCommand& to, GivenOptions& of) {
    of.exchanged = sub.add_flag("--exchange", to.exchange,
                                "Exchange light and viewer of the measurement, as renderers do that take the first\n"
                                "direction of an RGL file for the viewer");
    of.of_samples = add_read_options(sub, to.read);
    of.objective = add_objective(sub, to.objective);
    add_max_theta(sub, to.max_theta);
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
}

void add_reports(const Subcommand& sub, FitCommand& to, GivenOptions& of) {
    of.picture =
        sub.add_option("--preview", to.preview, "Write a picture of the measurement, the fit and 10 x their difference")
            .type_name("FILE.png")
            .check(png_name());
    of.json =
        sub.add_option("--json", to.json, "Write the report to this file; - is standard output").type_name("FILE");
}

void add_running(const Subcommand& sub, FitCommand& to, GivenOptions& of) {
    add_seed(sub, to.seed);
    of.threads = add_threads(sub, to.threads);
}

/// Of the model and the size that is asked for.
std::vector<Reading> of_model(const GivenOptions& of, const FitCommand& fit) {
    return {
        {{of.lobe.form, of.lobe.variates, of.lobe.axial, of.lobe.reciprocal, of.lobe.no_scale, of.target_delta_e,
          of.budget},
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

/// Of what is written.
std::vector<Reading> of_files(const GivenOptions& of, const FitCommand& fit) {
    return {
        {{of.picture, of.json},
         "not with a folder, which has a report of each fit",
         [&] { return !fit.into_folder(); }},
        {{of.output},
         "a folder, for several inputs and --resume, not the name of a model",
         [&] { return !fit.into_folder() || is_folder(fit.output) || !fit.output.ends_with(".srbf"); }},
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
    for (const auto add :
         {add_files, add_model, add_lobes, add_data, add_views, add_channels, add_goals, add_reports, add_running})
        add(sub, state->fit, state->of);
    sub.add_former({"--pairs", "--texels", "--slab", "--width"}, "an option of srbf map TEXELS.npy --pairs P.csv");
    sub.add_former({"--basis", "--active"},
                   "srbf basis INPUT.. --lobes J --active K -o LIBRARY; of texels, srbf map --basis J");
    sub.add_former({"--explain"}, "srbf explain");
    sub.add_former({"--target-error"}, "--target-delta-e, the visible error, or --budget");
    sub.add_former({"--between"}, "512 directions in every fit");
    sub.footer(
        "Examples:\n  srbf fit paper_white_rgb.bsdf\n"
        "  srbf fit nickel.binary --lobes 6 --variates 3 --objective raw --preview nickel.png --json -\n"
        "  srbf fit paper_white_rgb.bsdf --model su --lobes 5 --with-index cube\n"
        "  srbf fit materials/*.binary -o models --resume\n"
        "  srbf fit paper_white_rgb.bsdf --target-delta-e 2\n  srbf fit krylon_blue.brdf --objective cube-root");
    std::vector<Reading> readings;
    for (const auto rows : {of_model, of_goals, of_files})
        std::ranges::copy(rows(state->of, state->fit), std::back_inserter(readings));
    std::ranges::copy(lobe_readings(state->of.lobe, state->fit.lobe), std::back_inserter(readings));
    sub.callback(
        [sub, state, &status] {
            auto& [fit, of] = *state;
            if (fit.into_folder() && !of.output.given())
                of.output.fail("a folder is required for several inputs and --resume");
            fit.given = sub.given();
            fit.settings = sub.settings({of.input, of.output, of.resume, of.threads});  // the key has inputs' content
            status = fit.run();
        },
        readings);
}

}  // namespace srbf
