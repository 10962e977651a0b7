#include <memory>

#include "app/commands.h"
#include "app/fit_options.h"
#include "app/load.h"
#include "app/pairs.h"
#include "brdf/values.h"

namespace srbf {
namespace {

/// Pairs in a block. The values of a block are printed before the next block is read.
constexpr std::size_t k_block = 1 << 16;

std::string header_of(const Channels& brdf) {
    std::string header = fmt::format("{}", fmt::join(k_pair_columns, ","));
    if (brdf.wavelengths.empty()) header += ",r,g,b";
    for (const float nm : brdf.wavelengths) header += fmt::format(",{}nm", nm);
    return header + '\n';
}

/// The rows of CSV with the pairs and their values.
std::string csv_rows(const Channels& brdf, const DirectionPairs& pairs) {
    const std::size_t C = brdf.count();
    std::vector<float> f(C * pairs.wl.size());
    brdf.evaluate(pairs.wl, pairs.wv, f);
    std::string rows;
    for (std::size_t i = 0; i < pairs.wl.size(); ++i) {
        rows += fmt::format("{}", fmt::join(pairs.text[i], ","));
        for (std::size_t c = 0; c < C; ++c) rows += fmt::format(",{:.9g}", f[i * C + c]);
        rows += '\n';
    }
    return rows;
}

int run(const std::string& file, const ReadOptions& read, const std::string& pairs_file,
        const std::string& requested_channels, bool is_exchanged) {
    auto subject = load_file(file, read);
    if (!subject) return complain(subject.error());
    if (is_exchanged) std::visit([](auto& brdf) { exchange(brdf); }, subject->content);
    if (requested_channels == "spectral" && wavelengths(*subject).empty())
        return complain({file, {}, "spectral channels", "a measurement or a model at wavelengths", "one of colours"});
    const bool spectral = requested_channels == "spectral" || (requested_channels.empty() && subject->is_model());
    const Channels brdf = spectral ? channels(*subject) : rgb_channels(evaluator(*subject));

    auto reader = PairReader::open(pairs_file);
    if (!reader) return complain(reader.error());
    bool has_header = false;
    for (;;) {
        const auto pairs = reader->next(k_block);
        if (!pairs) return complain(pairs.error());
        if (!has_header) fmt::print("{}", header_of(brdf));
        has_header = true;
        if (pairs->wl.empty()) return k_done;
        fmt::print("{}", csv_rows(brdf, *pairs));
    }
}

}  // namespace

void add_eval(CommandLine& app, int& status) {
    struct EvalCommand {
        std::string file, pairs, channels;
        ReadOptions read;
        bool exchange = false;
    };
    const auto command = std::make_shared<EvalCommand>();
    const Subcommand sub = app.add_subcommand("eval", "Evaluate a BRDF at given pairs of directions, as CSV");
    sub.add_option("FILE", command->file, "A measurement or a model").type_name("").required();
    sub.add_flag("--exchange", command->exchange, "Exchange light and viewer of FILE");
    sub.add_option("--pairs", command->pairs,
                   "CSV whose first line names its columns: wl_x, wl_y, wl_z to the light\n"
                   "and wv_x, wv_y, wv_z to the viewer, unit vectors with normal +z.\n"
                   "Other columns are ignored")
        .type_name("FILE")
        .required();
    sub.add_option("--channels", command->channels,
                   "rgb: columns r,g,b; spectral: a column for each wavelength, such as 450nm;\n"
                   "default: spectral for a spectral model, otherwise rgb")
        .type_name("NAME")
        .one_of({"rgb", "spectral"});
    add_read_options(sub, command->read);
    sub.footer(
        "Writes the directions and f_r [1/sr] of each channel, without the cosine: 0 below the horizon\n"
        "unless FILE has transmission, nan where nothing was measured.\n\n"
        "Example:\n  srbf eval paper_white_rgb.srbf --pairs pairs.csv > values.csv");
    sub.callback([command, &status] {
        status = run(command->file, command->read, command->pairs, command->channels, command->exchange);
    });
}

}  // namespace srbf
