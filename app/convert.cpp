#include "srbf/convert.h"

#include "api/table_file.h"
#include "app/commands.h"
#include "app/fit_options.h"
#include "app/output.h"
#include "base/errors.h"
#include "base/paths.h"
#include "srbf/file.h"
#include "srbf/fit.h"

namespace srbf {
namespace {

struct ConvertCommand {
    std::string input, output, choice;
    ReadOptions read;
    int directions = 64, threads = 0;
    double max_theta = 89;  // [degrees], for CSV
    bool exchange = false, smooth = false, rgb_alone = false, chooses_directions = false;

    int run() const;
    Result<Measured> smoothed(const LoadedFile& subject) const;
    Result<std::vector<std::byte>> converted(const LoadedFile& subject) const;
};

std::string description_of(const LoadedFile& subject) {
    if (const auto* measured = std::get_if<Measured>(&subject.content)) {
        if (const auto* samples = std::get_if<ScatteredSamples>(&measured->table)) return samples->description;
        const auto* bsdf = std::get_if<BsdfTable>(&measured->table);
        if (bsdf && !bsdf->description.empty()) return bsdf->description;
    }
    return system_files::stem(subject.path);
}

/// The table without its noise, as fits see it, in the layout of MBSDF, which holds values below 0.
Result<Measured> ConvertCommand::smoothed(const LoadedFile& subject) const {
    const auto* measured = std::get_if<Measured>(&subject.content);
    if (!measured || !is_isotropic(*measured))
        return Error{
            input, {}, "input", "an isotropic table for --smooth", measured ? "an anisotropic one" : "a model"};
    ProgressLine line;
    const auto quiet = smoothed_to_noise(*measured, threads, line.shown_progress("smoothing"));
    if (!quiet) return with_source(quiet.error(), input);
    MbsdfOptions options;
    options.threads = threads;
    if (const auto* mbsdf = std::get_if<MbsdfTable>(&measured->table)) {
        options.polar = mbsdf->polar;
        options.azimuths = mbsdf->azimuths;
    }
    return Measured{measured->source, "smoothed", 0, to_mbsdf(*quiet, options)};
}

Result<std::vector<std::byte>> ConvertCommand::converted(const LoadedFile& subject) const {
    const auto* measured = std::get_if<Measured>(&subject.content);
    const Format& format = *format_written_to(output);
    if (chooses_directions && measured && std::holds_alternative<ScatteredSamples>(measured->table))
        return input_error(input, "input", "a table or a model for --directions and --max-theta",
                           "samples, which are written as they are");
    // A file that already has the format is copied unchanged, after it was read successfully and nothing was assumed.
    if (measured && measured->format == format.name && notes(*measured).empty() && !exchange && !rgb_alone &&
        choice.empty() && !read.any())
        return read_file(input);
    auto bytes = table_file(subject.content, format,
                            {description_of(subject) + (smooth ? ", smoothed to its noise" : ""), directions,
                             max_theta * k_degree, choice, !rgb_alone, threads});
    if (bytes) return bytes;
    Error error = with_source(bytes.error(), input);
    error.expected += fmt::format(", as {} tables are", format.name);
    return error;
}

int ConvertCommand::run() const {
    auto subject = load_file(input, read);
    if (!subject) return complain(subject.error());
    if (exchange) std::visit([](auto& content) { srbf::exchange(content); }, subject->content);
    if (const auto writable = check_outputs({input}, {output}); !writable) return complain(writable.error());
    if (smooth) {
        auto made = smoothed(*subject);
        if (!made) return complain(made.error());
        subject->content = *std::move(made);
    }
    const auto bytes = converted(*subject);
    if (!bytes) return complain(bytes.error());
    return status_of(write_file(output, *bytes));
}

/// ".bsdf (RGL), .mbsdf (MDL), ..".
std::string written_formats() {
    std::string text;
    for (const Format& format : formats()) {
        if (!format.write) continue;
        text += fmt::format("{}{}", text.empty() ? "" : ", ", format.extension);
        if (!format.used_by.empty()) text += fmt::format(" ({})", format.used_by);
    }
    return text;
}

using Command = std::shared_ptr<ConvertCommand>;

/// Adds the options that a single writer reads, with the conditions under which they are read.
std::vector<AllowedWhen> add_writer_options(const Subcommand& sub, const Command& command) {
    std::vector<AllowedWhen> allowed;
    for (const Format& format : formats()) {
        if (!format.option) continue;
        const auto& [name, help, values] = *format.option;
        const Option choice = sub.add_option(
            std::string(name), [command](const std::string& value) { command->choice = value; }, std::string(help));
        choice.type_name(fmt::format("NAME={}", values.front())).one_of({values.begin(), values.end()});
        allowed.push_back({{choice}, fmt::format("only with an output {}", format.extension), [command, &format] {
                               return format_written_to(command->output) == &format;
                           }});
    }
    return allowed;
}

}  // namespace

void add_convert(CommandLine& app, int& status) {
    const auto command = std::make_shared<ConvertCommand>();
    const Subcommand sub = app.add_subcommand("convert", "Convert a measurement or a model to another format");
    sub.add_option("INPUT", command->input, "A measurement or a model").type_name("").required();
    sub.add_option("-o,--output", command->output,
                   "The file to write; its extension determines the format: " + written_formats())
        .type_name("FILE")
        .required()
        .check([](std::string& name) -> std::string {
            return format_written_to(name)
                       ? ""
                       : fmt::format("expected a name that ends in {}, found {}", extensions_of_formats(), name);
        });
    const Option directions =
        sub.add_option("--directions", command->directions,
                       "Write CSV of a table or a model at all pairs of this many directions, 1 to 1536")
            .type_name("N")
            .check(within(1, 1536))
            .capture_default_str();
    const Option max_theta =
        sub.add_option("--max-theta", command->max_theta,
                       "Write CSV of a table or a model up to this angle from the normal, 1 to 90 degrees")
            .type_name("DEG")
            .check(within(1.0, 90.0))
            .capture_default_str();
    std::vector<AllowedWhen> allowed = add_writer_options(sub, command);
    const Option rgb_alone =
        sub.add_flag("--rgb-alone", command->rgb_alone,
                     "Write RGL without the spectra of the same material, as the RGB variants of Mitsuba 3 need it;\n"
                     "its spectral variants and pbrt-v4 need the spectra");
    sub.add_flag("--exchange", command->exchange, "Exchange light and viewer");
    sub.add_flag("--smooth", command->smooth, "Write a noisy isotropic table without its noise, as a fit uses it");
    add_read_options(sub, command->read);
    const Option threads = add_threads(
        sub, command->threads,
        "Number of threads for all formats but CSV; 0: all of the machine. The output does not depend on it");
    sub.footer(
        "A file that already has the format is copied byte for byte if nothing was assumed about it, unless\n"
        "--exchange, --smooth, --rgb-alone or an option of the format is given.\n\n"
        "Examples:\n  srbf convert nickel.binary -o nickel.bsdf\n  srbf convert paper_white_rgb.srbf -o paper.binary");
    const auto writes = [command](std::string_view extension) {
        return format_written_to(command->output)->extension == extension;
    };
    allowed.push_back({{directions, max_theta}, "only with an output .csv", [=] { return writes(".csv"); }});
    allowed.push_back({{rgb_alone}, "only with an output .bsdf", [=] { return writes(".bsdf"); }});
    allowed.push_back({{threads}, "not with an output .csv", [=] { return !writes(".csv"); }});
    sub.callback(
        [command, directions = directions, max_theta = max_theta, &status] {
            command->chooses_directions = directions.given() || max_theta.given();
            status = command->run();
        },
        std::move(allowed));
}

}  // namespace srbf
