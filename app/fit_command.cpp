// The command line of `srbf fit`.
#include <fmt/ranges.h>

#include <memory>

#include "app/commands.h"
#include "app/fit.h"
#include "app/fit_options.h"
#include "base/paths.h"

namespace srbf {
namespace {

struct FitCommand {
    std::vector<std::string> inputs;
    FitJob fit;
    bool resume = false, as_one = false;

    /// Several inputs go into a folder. A single input does if the output is a folder, as with `cp`.
    bool into_folder() const { return (inputs.size() > 1 && !as_one) || resume || is_folder(fit.output); }
};

/// The options that the command checks for presence.
struct GivenOptions {
    Option input, output, as_one, resume, picture, json;
};

void add_files(const Subcommand& sub, FitCommand& command, GivenOptions& options) {
    options.input =
        sub.add_option("INPUT", command.inputs,
                       "The measurement, in a format that srbf --help names; several of them with a folder for the\n"
                       "models or --as-one")
            .type_name("")
            .required();
    options.output =
        sub.add_option("-o,--output", command.fit.output,
                       "The model; default: INPUT's stem + .srbf in the working directory. Or a folder, for STEM.srbf\n"
                       "and the report STEM.json of each INPUT")
            .type_name("FILE|DIR");
    options.as_one =
        sub.add_flag("--as-one", command.as_one, "Fit one model to all INPUTs, files of samples of one material");
    options.resume =
        sub.add_flag("--resume", command.resume,
                     "Keep models in the folder that the same version made from the same file with the same options");
    options.picture = sub.add_option("--preview", command.fit.preview,
                                     "Write a picture of the measurement, the fit and 10 x their difference")
                          .type_name("FILE.png")
                          .check(png_name());
    options.json = sub.add_option("--json", command.fit.json, "Write the report to this file; - is standard output")
                       .type_name("FILE");
}

/// Adds the options for reading the measurement.
void add_data(const Subcommand& sub, FitCommand& command) {
    sub.add_flag("--exchange", command.fit.exchange,
                 "Exchange light and viewer of the measurement, as renderers do that use the first\n"
                 "direction of an RGL file as the viewer");
    add_read_options(sub, command.fit.read);
    sub.add_option("--band", command.fit.band,
                   "BSDF XML only: the band of wavelengths, Visible or Solar; default: Visible, or the first")
        .type_name("NAME");
}

}  // namespace

void add_fit(CommandLine& app, int& status) {
    const auto command = std::make_shared<FitCommand>();
    GivenOptions options;
    const Subcommand sub =
        app.add_subcommand("fit", "Fit a model to a measurement, or to each of many, and report its errors");
    add_files(sub, *command, options);
    const Option threads = add_fit_options(sub, command->fit.texts).at("threads");
    add_data(sub, *command);
    sub.footer(
        "Examples:\n  srbf fit paper_white_rgb.bsdf\n"
        "  srbf fit nickel.binary --lobes 6 --variates 3 --objective raw --preview nickel.png --json -\n"
        "  srbf fit paper_white_rgb.bsdf --model su --lobes 5 --with-index cube\n"
        "  srbf fit materials/*.binary -o models --resume\n"
        "  srbf fit paper_white_rgb.bsdf --target-delta-e 2\n  srbf fit krylon_blue.brdf --objective cube-root");
    sub.callback(
        [=, &status] {
            if (command->into_folder() && !options.output.given())
                options.output.fail("a folder is required for several inputs and --resume");
            command->fit.request = parse_request_or_exit(sub, command->fit.texts);
            if (command->into_folder()) {
                // The inputs' content is in the key of a result.
                const std::string settings = sub.settings({options.input, options.output, options.resume, threads});
                status = fit_files({command->inputs, command->fit.output, command->fit, settings, command->resume});
            } else {
                command->fit.input = fmt::format("{}", fmt::join(command->inputs, ", "));
                command->fit.files = command->inputs;
                if (command->fit.output.empty()) command->fit.output = system_files::stem(command->inputs[0]) + ".srbf";
                status = fit_file(command->fit);
            }
        },
        {{{options.picture, options.json},
          "needs a single input, without --resume; a folder of models has a report of each fit",
          [command] { return !command->into_folder(); }},
         {{options.as_one},
          "needs several inputs, of which it makes one model, and no --resume",
          [command] { return command->inputs.size() > 1 && !command->into_folder(); }},
         {{options.output}, "must be a folder for --resume, and for several inputs without --as-one", [command] {
              const std::string& output = command->fit.output;
              return !command->into_folder() || is_folder(output) || !output.ends_with(".srbf");
          }}});
}

}  // namespace srbf
