// `srbf map`: texels that share their lobes.
#include <fmt/ranges.h>

#include <cmath>
#include <memory>

#include "app/commands.h"
#include "app/fit_options.h"
#include "app/output.h"
#include "app/pairs.h"
#include "base/errors.h"
#include "base/half.h"
#include "base/printable.h"
#include "extras/maps/app/texels.h"
#include "generated/app/extra_subcommands.h"
#include "models/model_files.h"

namespace SRBF_NAMESPACE {
namespace {

/// Number of values in memory. It determines the number of texels that are solved together, at least 64.
constexpr std::size_t k_values_of_part = std::size_t(1) << 22;
std::size_t texels_of_part(std::size_t values) {
    constexpr std::size_t multiple = 64;
    return std::max(k_values_of_part / values / multiple, std::size_t(1)) * multiple;
}
/// Number of texels in which lobes are found.
constexpr std::size_t k_spanning_texels = 48;

struct MapCommand {
    std::vector<std::string> inputs;
    std::string pairs, masks, output;
    FitTexts texts;
    MapOptions options;
    std::size_t width = 0;
};

/// A map whose texels are solved in parts while it is written.
struct MapInParts {
    TexelMap lobes;  ///< the map without coefficients, with width and provenance
    std::size_t texels = 0, part = 0;
    std::function<Result<TexelCoefficients>(std::size_t first, std::size_t count)> solve;
};

struct TexelTotals {
    std::size_t black = 0, failed = 0, left_out = 0;
    double error = 0;
};

std::vector<std::byte> bytes_of(const std::vector<std::uint16_t>& halves) {
    const auto bytes = std::as_bytes(std::span(halves));
    return {bytes.begin(), bytes.end()};
}

/// Writes the map. One part of the texels is in memory, and the errors of all.
Result<TexelTotals> write_in_parts(const std::string& path, const MapInParts& map) {
    TexelTotals total;
    ProgressLine line;
    std::vector<std::uint16_t> errors;
    bool has_begun = false;
    std::size_t first = 0;  // texel of the next part
    const auto written = write_file(path, [&]() -> Result<std::vector<std::byte>> {
        if (!std::exchange(has_begun, true)) return beginning_of_map(map.lobes, map.texels);
        if (first == map.texels) return bytes_of(std::exchange(errors, {}));
        const auto texels = map.solve(first, std::min(map.part, map.texels - first));
        if (!texels) return texels.error();
        for (std::size_t t = 0; t < texels->error.size(); ++t) {
            total.black += texels->state[t] == TexelState::black,
                total.failed += texels->state[t] == TexelState::failed;
            total.left_out += texels->left_out[t], total.error += double(texels->error[t]);
            errors.push_back(to_half(std::min(texels->error[t], k_half_max)));
        }
        std::vector<std::uint16_t> coefficients;
        for (const Rgb& beta : texels->coefficient)
            for (int c = 0; c < 3; ++c) coefficients.push_back(to_half(beta[c]));
        first += texels->error.size();
        line.show("solving for coefficients", double(first) / double(map.texels));
        return bytes_of(coefficients);
    });
    if (!written) return written.error();
    return total;
}

/// A map of the lobes of `fitted`, without texels.
TexelMap lobes_of(const TexelMap& fitted, std::size_t width) {
    TexelMap map;
    map.basis = fitted.basis;
    map.width = width;
    map.provenance = {{"generator", "srbf " SRBF_VERSION}, {"objective", "appearance"}};
    return map;
}

Result<Done> fit_texels(const MapCommand& fit) {
    if (fit.inputs.size() != 1)
        return argument_error(fit.output, "inputs", "one file of texels", std::to_string(fit.inputs.size()));
    const auto read = load_pairs(fit.pairs);
    if (!read) return read.error();
    const SharedPairs pairs{read->wl, read->wv, fit.options.axial};
    const auto texels = Texels::open(fit.inputs[0], pairs.wl.size());
    if (!texels) return texels.error();
    if (fit.width > 0 && texels->count() % fit.width != 0)
        return argument_error(fit.inputs[0], "texels", fmt::format("a multiple of the width, {}", fit.width),
                              fmt::format("{}", texels->count()));
    if (const auto writable = check_outputs({fit.inputs[0], fit.pairs}, {fit.output}); !writable) return writable;
    Stopwatch watch;
    ProgressLine line;
    const auto spanning = texels->spanning(pairs, k_spanning_texels);
    if (!spanning) return spanning.error();
    const auto basis = fit_map(pairs, *spanning, fit.options, line.shown_progress());
    line.clear();
    if (!basis) return basis.error();
    const double basis_seconds = watch.seconds();
    MapInParts map{lobes_of(*basis, fit.width > 0 ? fit.width : texels->count()), texels->count(),
                   texels_of_part(pairs.wl.size()),
                   [&](std::size_t first, std::size_t count) -> Result<TexelCoefficients> {
                       std::vector<Rgb> f(count * pairs.wl.size());
                       if (const auto done = texels->read(first, f); !done) return done.error();
                       return coefficients_of_texels(*basis, pairs, f, fit.options.threads);
                   }};
    const auto total = write_in_parts(fit.output, map);
    if (!total) return total.error();
    const double seconds = watch.seconds() - basis_seconds;
    fmt::print("{} texels of {} shared lobes, found in {:.1f} s; coefficients in {:.1f} s, {:.4g} a second\n",
               grouped(map.texels), fit.options.lobes, basis_seconds, seconds, double(map.texels) / seconds);
    fmt::print("  {} black, {} failed; {} values left out\n", grouped(total->black), grouped(total->failed),
               grouped(total->left_out));
    fmt::print("  weighted RMS  mean {}\n", percent(total->error / double(map.texels)));
    if (!texels->note().empty())
        fmt::print(stderr, "srbf: {}: {}\n", printable(fit.inputs[0]), printable(texels->note()));
    return Done{};
}

Result<Done> paint(const MapCommand& fit) {
    const auto masks = NpyFile::open(fit.masks);
    if (!masks) return masks.error();
    const auto& shape = masks->shape();
    const std::size_t K = fit.inputs.size();
    if (shape.size() != 3 || shape[2] != K)
        return Error{fit.masks, 10, "shape", fmt::format("[height, width, {}]", K),
                     fmt::format("[{}]", fmt::join(shape, ", "))};
    std::vector<std::string> inputs = fit.inputs;
    inputs.push_back(fit.masks);
    if (const auto writable = check_outputs(inputs, {fit.output}); !writable) return writable;
    std::vector<Measured> materials;
    for (const std::string& input : fit.inputs) {
        auto measured = load_measured(input);
        if (!measured) return measured.error();
        materials.push_back(*std::move(measured));
    }
    const Stopwatch watch;
    ProgressLine line;
    auto basis = fit_map(materials, fit.options, line.shown_progress());
    line.clear();
    if (!basis) return basis.error();
    const double seconds = watch.seconds();
    MapInParts map{lobes_of(*basis, std::size_t(shape[1])), std::size_t(shape[0] * shape[1]), texels_of_part(K),
                   [&](std::size_t first, std::size_t count) -> Result<TexelCoefficients> {
                       std::vector<float> fractions(count * K);
                       if (const auto done = masks->read(first * K, fractions); !done) return done.error();
                       for (std::size_t i = 0; i < fractions.size(); ++i)
                           if (!(fractions[i] >= 0 && std::isfinite(fractions[i])))
                               return Error{fit.masks,
                                            {},
                                            fmt::format("share of texel {}", first + i / K),
                                            "a number of at least 0",
                                            fmt::format("{}", fractions[i])};
                       return painted_texels(*basis, fractions);
                   }};
    const auto total = write_in_parts(fit.output, map);
    if (!total) return total.error();
    fmt::print("{} × {} texels of {} materials, with {} shared lobes, found in {:.1f} s\n", shape[1], shape[0], K,
               fit.options.lobes, seconds);
    for (std::size_t k = 0; k < K; ++k)
        fmt::print("  {:<28}ΔE_ITP {:.3g}\n", printable(stem_of(fit.inputs[k])), basis->error[k]);
    return Done{};
}

}  // namespace

void add_map(CommandLine& app, int& status) {
    const auto fit = std::make_shared<MapCommand>();
    const Subcommand sub =
        app.add_subcommand("map", "Fit the texels of a surface, or paint materials, with lobes that all texels share");
    sub.add_option("INPUT", fit->inputs,
                   "With --pairs: a .npy file, float32 [T, M, 3], [T, M, 1] or [T, M], f_r of T texels at M pairs of\n"
                   "directions. With --masks: measurements, tables of BRDFs")
        .type_name("")
        .required();
    sub.add_option("--pairs", fit->pairs, "The pairs, a CSV file with columns wl_x to wv_z").type_name("P.csv");
    sub.add_option("--masks", fit->masks,
                   "A .npy file, float32 [height, width, materials]: the share of each in each\n"
                   "texel")
        .type_name("M.npy");
    sub.add_option("-o,--output", fit->output, "The map to write. Its texels are FILE#X,Y")
        .type_name("FILE")
        .required();
    sub.add_option("--lobes", fit->options.lobes, fmt::format("Number of shared lobes, 1 to {}", k_max_map_lobes))
        .type_name("J")
        .check(within(1, k_max_map_lobes))
        .capture_default_str();
    const Option width = sub.add_option("--width", fit->width, "Texels in a row of the map; default: all")
                             .type_name("W")
                             .check(within(std::size_t(1), std::size_t(1) << 20));
    add_fit_options(sub, fit->texts, {"form", "variates", "axial", "max_theta", "seed", "threads"});
    sub.footer(
        "Examples:\n  srbf map texels.npy --pairs pairs.csv --width 512 -o map.srbf\n"
        "  srbf map paper.bsdf gold.bsdf --masks masks.npy -o map.srbf");
    sub.callback(
        [sub, fit, &status] {
            if (fit->pairs.empty() == fit->masks.empty()) sub.fail("map: expected either --pairs or --masks");
            const FitRequest request = parse_request_or_exit(sub, fit->texts);
            const auto& lobe = std::get<PmRequest>(request.model);
            MapOptions& options = fit->options;
            options.form = lobe.form.value_or(options.form), options.axial = lobe.axial.value_or(options.axial);
            options.variates = lobe.variates.value_or(options.variates);
            options.max_theta = request.max_theta.value_or(0);
            options.seed = request.seed, options.threads = request.threads;
            const auto done = fit->masks.empty() ? fit_texels(*fit) : paint(*fit);
            status = done ? int(k_done) : complain(done.error());
        },
        {{{width}, "only with --pairs", [fit] { return fit->masks.empty(); }}});
}

}  // namespace
