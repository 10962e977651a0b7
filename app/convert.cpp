#include "srbf/convert.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "app/commands.h"
#include "app/output.h"
#include "app/read_options.h"
#include "srbf/file.h"
#include "srbf/fit.h"

namespace srbf {
namespace {

/// In the order of `KlemsBasis`.
const std::vector<std::string> k_bases{"full", "half", "quarter"};

struct ConvertCommand {
    std::string input, output, basis = "full";
    ReadOptions read;
    int directions = 64, threads = 0;
    double max_theta = 89;  // [degrees], for CSV
    bool exchange = false, smooth = false, rgb_alone = false, chooses_directions = false, chooses_basis = false;

    int run() const;
    Result<Measured> smoothed(const Subject& subject) const;
    Result<std::vector<std::byte>> converted(const Subject& subject) const;
};

std::string description_of(const Subject& subject) {
    const auto* measured = std::get_if<Measured>(&subject.content);
    if (measured && std::holds_alternative<ScatteredSamples>(measured->table))
        return std::get<ScatteredSamples>(measured->table).description;
    if (measured && std::holds_alternative<BsdfTable>(measured->table))
        if (const auto& name = std::get<BsdfTable>(measured->table).description; !name.empty()) return name;
    return std::filesystem::path(subject.path).stem().string();
}

/// The table without its noise, as fits see it, in the layout of MBSDF, which holds values below 0.
Result<Measured> ConvertCommand::smoothed(const Subject& subject) const {
    const auto* measured = std::get_if<Measured>(&subject.content);
    if (!measured || !is_isotropic(*measured))
        return Error{
            input, {}, "input", "an isotropic table for --smooth", measured ? "an anisotropic one" : "a model"};
    ProgressLine line;
    const auto quiet = smoothed_to_noise(
        *measured, threads, [&](const Progress& now) { return line.show("smoothing", now.fraction), true; });
    if (!quiet) {
        Error error = quiet.error();
        return error.source = input, error;
    }
    MbsdfOptions options;
    options.threads = threads;
    if (const auto* own = std::get_if<MbsdfTable>(&measured->table))
        options.polar = own->polar, options.azimuths = own->azimuths;
    return Measured{measured->source, "smoothed", 0, to_mbsdf(*quiet, options)};
}

Result<std::vector<std::byte>> ConvertCommand::converted(const Subject& subject) const {
    const auto* measured = std::get_if<Measured>(&subject.content);
    const TableFormatRow& format = *table_format(output);
    if (chooses_directions && measured && std::holds_alternative<ScatteredSamples>(measured->table))
        return Error{input,
                     {},
                     "input",
                     "a table or a model for --directions and --max-theta",
                     "samples, which are written as they are"};
    // A file that already has the format is copied unchanged, after it was read successfully and nothing was assumed.
    if (measured && measured->format == format.name && notes(*measured).empty() && !exchange && !rgb_alone &&
        !chooses_basis && !read.any())
        return read_file(input);
    auto bytes = table_file(
        subject.content, format.format,
        {description_of(subject) + (smooth ? ", smoothed to its noise" : ""), directions, max_theta * k_degree,
         KlemsBasis(std::ranges::find(k_bases, basis) - k_bases.begin()), !rgb_alone, threads});
    if (bytes) return bytes;
    Error error = bytes.error();
    error.source = input, error.expected += fmt::format(", as {} tables are", format.name);
    return error;
}

int ConvertCommand::run() const {
    auto subject = load_subject(input, read);
    if (!subject) return complain(subject.error());
    if (exchange) std::visit([](auto& of) { srbf::exchange(of); }, subject->content);
    if (const auto writable = check_outputs({input}, {output}); !writable) return complain(writable.error());
    if (smooth) {
        auto made = smoothed(*subject);
        if (!made) return complain(made.error());
        subject->content = *std::move(made);
    }
    const auto bytes = converted(*subject);
    if (!bytes) return complain(bytes.error());
    const auto written = write_file(output, *bytes);
    return written ? k_done : complain(written.error());
}

}  // namespace

void add_convert(CommandLine& app, int& status) {
    const auto command = std::make_shared<ConvertCommand>();
    const Subcommand sub = app.add_subcommand("convert", "Convert a measurement or a model to another format");
    sub.add_option("INPUT", command->input, "A measurement or a model").type_name("").required();
    sub.add_option("-o,--output", command->output,
                   "The file to write; its extension determines the format: .binary (MERL), .bsdf (RGL), .mbsdf (MDL), "
                   ".csv, .xml (WINDOW and Radiance), .zemax.bsdf, .anisotropicbsdf (Speos), .xompt (OpenMATERIAL)")
        .type_name("FILE")
        .required()
        .check([](std::string& name) -> std::string {
            return table_format(name) == nullptr
                       ? fmt::format(
                             "expected a name that ends in .binary, .bsdf, .mbsdf, .csv, .xml, .zemax.bsdf, "
                             ".anisotropicbsdf or .xompt, found {}",
                             name)
                       : "";
        });
    const Option directions = sub.add_option("--directions", command->directions,
                                             "CSV of tables and models: all pairs of this many directions, 1 to 1536")
                                  .type_name("N")
                                  .check(within(1, 1536))
                                  .capture_default_str();
    const Option max_theta = sub.add_option("--max-theta", command->max_theta,
                                            "CSV of tables and models: largest angle from the normal, 1 to 90 degrees")
                                 .type_name("DEG")
                                 .check(within(1.0, 90.0))
                                 .capture_default_str();
    const Option basis = sub.add_option("--basis", command->basis,
                                        "XML: Klems' patches, of which there are 145 (full), 77 (half) or 41 (quarter)")
                             .type_name("NAME")
                             .one_of(k_bases)
                             .capture_default_str();
    const Option rgb_alone =
        sub.add_flag("--rgb-alone", command->rgb_alone,
                     "RGL: colours without the spectra of the same material, as Mitsuba 3 needs them in its\n"
                     "RGB variants; its spectral variants and pbrt-v4 need the spectra");
    sub.add_flag("--exchange", command->exchange, "Exchange light and viewer");
    sub.add_flag("--smooth", command->smooth,
                 "A noisy isotropic table without its noise, as fits see it: to look at beside them");
    add_read_options(sub, command->read);
    const Option threads =
        sub.add_option("--threads", command->threads,
                       "All but CSV: number of threads; 0: all of the machine. The output does not depend on it")
            .type_name("T")
            .check(within(0, k_most_threads))
            .capture_default_str();
    sub.footer(
        "A file that already has the format, of which nothing was assumed, is copied byte for byte, unless --exchange, "
        "--smooth, --basis or "
        "--rgb-alone is given.\n\n"
        "Examples:\n  srbf convert nickel.binary -o nickel.bsdf\n  srbf convert paper_white_rgb.srbf -o paper.binary");
    const auto writes = [command](TableFormat format) { return table_format(command->output)->format == format; };
    sub.callback(
        [command, directions, max_theta, basis, &status] {
            command->chooses_basis = basis.given();
            command->chooses_directions = directions.given() || max_theta.given();
            status = command->run();
        },
        {{{directions, max_theta}, "only with an output .csv", [=] { return writes(TableFormat::csv); }},
         {{basis}, "only with an output .xml", [=] { return writes(TableFormat::bsdf_xml); }},
         {{rgb_alone}, "only with an output .bsdf", [=] { return writes(TableFormat::rgl); }},
         {{threads}, "not with an output .csv", [=] { return !writes(TableFormat::csv); }}});
}

}  // namespace srbf
