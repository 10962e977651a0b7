// `srbf map`: the options.
#include "extras/maps/app/map.h"

#include <memory>

#include "app/commands.h"
#include "app/extra_subcommands.h"
#include "base/text.h"
#include "srbf/basis.h"

namespace SRBF_NAMESPACE {
namespace {

struct MapOptions {
    Option texels, pairs, output, resume, range, slab, lobes, examples, basis, width;
    OptionsByName fit;
};

constexpr std::size_t k_max_slab_texels = std::size_t(1) << 20, k_most_examples = 1024;

/// Checks for FIRST:END with FIRST < END.
Check texel_range() {
    return [](const std::string& text) -> std::string {
        const auto colon = text.find(':');
        const auto first = to_number<std::uint64_t>(std::string_view(text).substr(0, colon)),
                   end = colon == text.npos ? std::nullopt : to_number<std::uint64_t>(text.substr(colon + 1));
        return first && end && *first < *end ? "" : fmt::format("expected FIRST:END, found {}", text);
    };
}

void add_texel_files(const Subcommand& sub, MapCommand& command, MapOptions& options) {
    options.texels =
        sub.add_option("TEXELS", command.texels,
                       "A .npy file, float32 [T, M, 3], [T, M, 1] or [T, M]: f_r of T texels at M pairs of\n"
                       "directions")
            .type_name("")
            .required();
    options.pairs = sub.add_option("--pairs", command.pairs, "The pairs, a CSV file with columns wl_x to wv_z")
                        .type_name("P.csv")
                        .required();
    options.output = sub.add_option("-o,--output", command.output,
                                    "The folder, for stacks of models DIR/STEM-FIRST.srbf; with --basis the library")
                         .type_name("DIR|FILE")
                         .required();
    options.resume =
        sub.add_flag("--resume", command.resume,
                     "Keep the texels that were fitted to the same values by the same options and version");
}

void add_own_lobes(const Subcommand& sub, MapCommand& command, MapOptions& options) {
    options.lobes =
        sub.add_option("--lobes", command.lobes,
                       fmt::format("Number of lobes of each texel, 1 to {}; a short search", k_most_fitted_lobes))
            .type_name("J")
            .check(within(1, k_most_fitted_lobes))
            .capture_default_str();
    options.examples =
        sub.add_option(
               "--examples", command.examples,
               "Search for the lobes of N texels alone, which span the map. Those of all others start from the\n"
               "lobes of the most similar ones, and take a fortieth of the time")
            .type_name("N")
            .check(within(std::size_t(1), k_most_examples));
    const auto set_range = [&command](const std::string& text) {
        const auto colon = text.find(':');
        command.first = std::stoull(text.substr(0, colon));
        command.last = std::stoull(text.substr(colon + 1));
    };
    options.range = sub.add_option("--texels", set_range, "Only texels FIRST to END - 1, for one of several machines")
                        .type_name("FIRST:END")
                        .check(texel_range());
    options.slab = sub.add_option("--slab", command.slab, "Number of texels in memory and in a file")
                       .type_name("T")
                       .check(within(std::size_t(1), k_max_slab_texels))
                       .capture_default_str();
}

void add_shared_lobes(const Subcommand& sub, MapCommand& command, MapOptions& options) {
    options.basis =
        sub.add_option("--basis", command.basis,
                       fmt::format("One library of all texels, which share N lobes, 1 to {}. Texels are FILE#T",
                                   k_most_basis_lobes))
            .type_name("N")
            .check(within(1, k_most_basis_lobes));
    options.width = sub.add_option("--width", command.width, "With --basis: texels in a row of the map, for FILE#X,Y")
                        .type_name("W")
                        .check(within(std::size_t(1), std::size_t(1) << 20));
}

std::vector<AllowedWhen> map_readings(const MapOptions& options, const MapCommand& fit) {
    return {
        {{options.lobes, options.examples, options.fit.at("objective"), options.range, options.slab},
         "not with --basis",
         [&] { return fit.basis == 0; }},
        {{options.width}, "only with --basis", [&] { return fit.basis > 0; }},
        {{options.output},
         "a folder, not the name of a model",
         [&] { return fit.basis > 0 || is_folder(fit.output) || !fit.output.ends_with(".srbf"); }},
    };
}

}  // namespace

void add_map(CommandLine& app, int& status) {
    struct State {
        MapCommand fit;
        MapOptions options;
    };
    const auto state = std::make_shared<State>();
    auto& [fit, options] = *state;
    const Subcommand sub =
        app.add_subcommand("map", "Fit the texels of a surface: of their own lobes, or of lobes that they share");
    for (const auto add : {add_texel_files, add_own_lobes, add_shared_lobes}) add(sub, fit, options);
    options.fit =
        add_fit_options(sub, fit.texts, {"form", "variates", "axial", "objective", "max_theta", "seed", "threads"});
    sub.footer(
        "Examples:\n  srbf map texels.npy --pairs pairs.csv -o slabs --resume\n"
        "  srbf map texels.npy --pairs pairs.csv --examples 64 -o slabs --resume\n"
        "  srbf map texels.npy --pairs pairs.csv --basis 16 --width 512 -o map.srbf --resume");
    sub.callback(
        [sub, state, &status] {
            const MapOptions& given = state->options;
            MapCommand& map = state->fit;
            map.request = requested(sub, map.texts);
            std::get<PmRequest>(map.request.model).size = LobeCount{map.lobes};
            // The key includes the contents of the inputs; the range of texels and the width only place the
            // coefficients.
            map.settings = sub.settings({given.texels, given.pairs, given.output, given.resume, given.range,
                                         given.width, given.fit.at("threads")});
            status = map.basis > 0 ? fit_map(map) : fit_slabs(map);
        },
        map_readings(options, fit));
}

}  // namespace srbf
