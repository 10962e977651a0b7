// Edits and blends of models.
#include "srbf/edit.h"

#include <array>
#include <memory>

#include "app/commands.h"
#include "app/output.h"
#include "brdf/values.h"
#include "fit/fit_options.h"

namespace srbf {
namespace {

struct EditCommand {
    std::string input, output;
    Roughen roughen;
    Tint tint;
    double scale_highlight = 1, scale_body = 1;
    Saturate saturate;
    TurnHue hue;
    Rotate rotate;
    Coat coat;
    Reduce reduce;
    EditOptions options;
    std::vector<Option> colour_options;
    Option roughens, saturates, hues, rotates, coats, reduces;

    std::vector<Edit> edits() const;
    int run();
};

/// The edits on the command line, in the order of the help.
std::vector<Edit> EditCommand::edits() const {
    std::vector<Edit> chosen;
    if (roughens.given()) chosen.emplace_back(roughen);
    if (std::ranges::any_of(colour_options, &Option::given))
        chosen.emplace_back(Tint{scaled(float(scale_highlight), tint.highlight), scaled(float(scale_body), tint.body)});
    if (saturates.given()) chosen.emplace_back(saturate);
    if (hues.given()) chosen.emplace_back(hue);
    if (rotates.given()) chosen.emplace_back(rotate);
    if (coats.given()) chosen.emplace_back(coat);
    if (reduces.given()) chosen.emplace_back(reduce);
    return chosen;
}

/// The model in a file.
Result<Model> model_in(const std::string& path) {
    auto subject = load_file(path);
    if (!subject) return subject.error();
    if (auto* model = std::get_if<Model>(&subject->content)) return std::move(*model);
    return Error{path, {}, "input", "a model", "a measurement: fit it first", ErrorCode::wrong_kind};
}

/// Saves the model of an edit of `input`.
int write(Result<Model> model, const std::string& input, const std::string& output) {
    if (!model) return complain(with_source(model.error(), input));
    return status_of(save_model(*model, output));
}

int EditCommand::run() {
    const auto model = model_in(input);
    if (!model) return complain(model.error());
    if (const auto writable = check_outputs({input}, {output}); !writable) return complain(writable.error());
    ProgressLine line;
    options.progress = line.shown_progress("editing");
    const std::vector<Edit> wanted = edits();
    auto result = edit_model(*model, wanted, options);
    line.clear();
    if (const auto* pm = std::get_if<PmModel>(&model->model); pm && result) {
        std::string body_lobes;
        const std::vector<double> fractions = body_fractions(*pm);
        for (std::size_t j = 0; j < fractions.size(); ++j)
            if (fractions[j] > 0)
                body_lobes +=
                    fmt::format(" {}{}", j + 1, fractions[j] < 1 ? fmt::format(" ({:.0f} %)", 100 * fractions[j]) : "");
        fmt::print("body: {} of {}; the other lobes are the highlight\n",
                   body_lobes.empty() ? "none" : "lobe" + body_lobes, fractions.size());
        if (const auto entry = result->provenance.find("limited"); entry != result->provenance.end())
            fmt::print("limited: {}\n", entry->second);
    }
    return write(std::move(result), input, output);
}

/// An option for R, G, B, or one number for all three.
Option add_colour(const Subcommand& sub, const std::string& name, Rgb& colour, double max, const std::string& about) {
    const auto parsed = [](const std::string& text, Rgb& into) {
        std::array<float, 3> numbers{};
        std::size_t count = 0;
        const char *at = text.data(), *const end = at + text.size();
        for (; count < numbers.size(); ++at) {
            const auto [rest, error] = std::from_chars(at, end, numbers[count]);
            if (error != std::errc()) return false;
            ++count;
            at = rest;
            if (at == end || *at != ',') break;
        }
        if (at != end || count == 2) return false;
        into = count == 1 ? Rgb{numbers[0], numbers[0], numbers[0]} : Rgb{numbers[0], numbers[1], numbers[2]};
        return true;
    };
    return sub
        .add_option(
            name, [&colour, parsed](const std::string& text) { parsed(text, colour); }, about)
        .type_name("R,G,B")
        .check([parsed, max](std::string& text) -> std::string {
            Rgb rgb;
            const bool valid = parsed(text, rgb) && is_finite(rgb) && std::min({rgb.r, rgb.g, rgb.b}) >= 0 &&
                               double(std::max({rgb.r, rgb.g, rgb.b})) <= max;
            return valid ? "" : fmt::format("expected three numbers from 0 to {:g}, as 1,0.8,0.6, found {}", max, text);
        });
}

Option add_number(const Subcommand& sub, const std::string& name, double& value, double min, double max,
                  const std::string& about) {
    return sub.add_option(name, value, about).type_name("X").check(within(min, max));
}

}  // namespace

void add_edit(CommandLine& app, int& status) {
    const auto command = std::make_shared<EditCommand>();
    EditCommand& edit = *command;
    const Subcommand sub = app.add_subcommand("edit", "Change the roughness or the colours of a model, or add a coat");
    sub.add_option("MODEL", edit.input, "A multivariate model").type_name("").required();
    sub.add_option("-o,--output", edit.output, "The model file to write").type_name("FILE").required();
    edit.roughens = add_number(sub, "--roughen", edit.roughen.factor, 0.1, 10,
                               "Multiply the roughness of the highlight by X, 0.1 to 10, by a new fit");
    edit.colour_options = {
        add_colour(sub, "--tint-highlight", edit.tint.highlight, 10, "Multiply the highlight by this colour"),
        add_colour(sub, "--tint-body", edit.tint.body, 10, "Multiply the body by this colour"),
        add_number(sub, "--scale-highlight", edit.scale_highlight, 0, 10, "Multiply the highlight by X, 0 to 10"),
        add_number(sub, "--scale-body", edit.scale_body, 0, 10, "Multiply the body by X, 0 to 10")};
    edit.saturates =
        add_number(sub, "--saturate", edit.saturate.factor, 0, 4, "Multiply the saturation of colours by X, 0 to 4");
    edit.hues = add_number(sub, "--hue", edit.hue.degrees, -360, 360, "Turn the hue of colours by X degrees");
    edit.rotates = add_number(sub, "--rotate", edit.rotate.degrees, -360, 360,
                              "Turn the tangent by X degrees; only anisotropic models change");
    edit.coats = add_number(sub, "--coat", edit.coat.roughness, 0.02, 1,
                            "Add a clear coat of roughness alpha X, 0.02 to 1, by a new fit");
    const Option ior = add_number(sub, "--coat-ior", edit.coat.ior, 1.05, 3, "Refractive index of the coat, 1.05 to 3")
                           .capture_default_str();
    const Option tint = add_colour(sub, "--coat-tint", edit.coat.tint, 1,
                                   "Colour of white light that passes twice through the coat along the normal");
    edit.reduces = sub.add_option("--reduce", edit.reduce.lobes, "Fit this number of lobes to the result, 1 to 64")
                       .type_name("J")
                       .check(within(1, k_max_fitted_lobes));
    const Option threads = add_threads(sub, edit.options.threads,
                                       "Number of threads; 0: all of the machine. The output does not depend on it");
    sub.footer(
        "Edits are applied in the order of this list. The body consists of the lobes that reflect as far from the\n"
        "mirror direction as Lambert does, and the highlight of all others. A coat adds three lobes.\n\n"
        "Example:\n  srbf edit film.srbf --roughen 1.5 --tint-highlight 1,0.8,0.6 -o warmer.srbf");
    const auto refits = [&edit] { return edit.roughens.given() || edit.coats.given() || edit.reduces.given(); };
    sub.callback(
        [command, sub, &status] {
            if (command->edits().empty()) sub.fail("expected an edit, as --roughen 1.5, found none");
            status = command->run();
        },
        {{{ior, tint}, "only with --coat", [&edit] { return edit.coats.given(); }},
         {{threads}, "only with --roughen, --coat or --reduce", refits}});
}

void add_blend(CommandLine& app, int& status) {
    struct BlendCommand {
        std::string a, b, output;
        double mix = 0.5;
        int run() const {
            const auto first = model_in(a), second = model_in(b);
            if (!first || !second) return complain((first ? second : first).error());
            if (const auto writable = check_outputs({a, b}, {output}); !writable) return complain(writable.error());
            return write(blend_models(*first, *second, mix), fmt::format("{} and {}", a, b), output);
        }
    };
    const auto command = std::make_shared<BlendCommand>();
    const Subcommand sub = app.add_subcommand("blend", "Mix two models");
    sub.add_option("A", command->a, "A multivariate model").type_name("").required();
    sub.add_option("B", command->b, "Another multivariate model").type_name("").required();
    sub.add_option("-o,--output", command->output, "The model file to write").type_name("FILE").required();
    sub.add_option("--mix", command->mix, "Fraction of B in the mixture, 0 to 1")
        .type_name("M")
        .check(within(0.0, 1.0))
        .capture_default_str();
    sub.footer(
        "The result has the lobes of both; `srbf edit --reduce` fits fewer to it.\n\n"
        "Example:\n  srbf blend film.srbf paper_white_rgb.srbf --mix 0.3 -o worn.srbf");
    sub.callback([command, &status] { status = command->run(); });
}

}  // namespace srbf
