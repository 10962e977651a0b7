// `srbf map`: the options.
#include "extras/maps/app/map.h"

#include <memory>

#include "app/commands.h"
#include "app/extra_subcommands.h"
#include "base/text.h"
#include "srbf/basis.h"

namespace srbf {
namespace {

struct MapOptions {
    Option texels, pairs, output, resume, range, slab, lobes, basis, width;
    OptionsByName fit;
};

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

void add_texel_files(const Subcommand& sub, MapCommand& to, MapOptions& of) {
    of.texels = sub.add_option("TEXELS", to.texels,
                               "A .npy file, float32 [T, M, 3], [T, M, 1] or [T, M]: f_r of T texels at M pairs of\n"
                               "directions")
                    .type_name("")
                    .required();
    of.pairs = sub.add_option("--pairs", to.pairs, "The pairs, a CSV file with columns wl_x to wv_z")
                   .type_name("P.csv")
                   .required();
    of.output = sub.add_option("-o,--output", to.output,
                               "The folder, for stacks of models DIR/STEM-FIRST.srbf; with --basis the library")
                    .type_name("DIR|FILE")
                    .required();
    of.resume = sub.add_flag("--resume", to.resume,
                             "Keep the texels that were fitted to the same values by the same options and version");
}

void add_own_lobes(const Subcommand& sub, MapCommand& to, MapOptions& of) {
    of.lobes =
        sub.add_option("--lobes", to.lobes,
                       fmt::format("Number of lobes of each texel, 1 to {}; a short search", k_most_fitted_lobes))
            .type_name("J")
            .check(within(1, k_most_fitted_lobes))
            .capture_default_str();
    const auto take = [&to](const std::string& text) {
        const auto at = text.find(':');
        to.first = std::stoull(text.substr(0, at));
        to.last = std::stoull(text.substr(at + 1));
    };
    of.range = sub.add_option("--texels", take, "Only texels FIRST to END - 1, for one of several machines")
                   .type_name("FIRST:END")
                   .check(texel_range());
    of.slab = sub.add_option("--slab", to.slab, "Number of texels in memory and in a file")
                  .type_name("T")
                  .check(within(std::size_t(1), k_most_texels_of_a_slab))
                  .capture_default_str();
}

void add_shared_lobes(const Subcommand& sub, MapCommand& to, MapOptions& of) {
    of.basis = sub.add_option("--basis", to.basis,
                              fmt::format("One library of all texels, which share N lobes, 1 to {}. Texels are FILE#T",
                                          k_most_basis_lobes))
                   .type_name("N")
                   .check(within(1, k_most_basis_lobes));
    of.width = sub.add_option("--width", to.width, "With --basis: texels in a row of the map, for FILE#X,Y")
                   .type_name("W")
                   .check(within(std::size_t(1), std::size_t(1) << 20));
}

std::vector<Reading> map_readings(const MapOptions& of, const MapCommand& fit) {
    return {
        {{of.lobes, of.fit.at("reciprocal"), of.fit.at("no_scale"), of.fit.at("objective"), of.range, of.slab},
         "not with --basis",
         [&] { return fit.basis == 0; }},
        {{of.width}, "only with --basis", [&] { return fit.basis > 0; }},
        {{of.output},
         "a folder, not the name of a model",
         [&] { return fit.basis > 0 || is_folder(fit.output) || !fit.output.ends_with(".srbf"); }},
    };
}

}  // namespace

void add_map(CommandLine& app, int& status) {
    struct State {
        MapCommand fit;
        MapOptions of;
    };
    const auto state = std::make_shared<State>();
    auto& [fit, of] = *state;
    const Subcommand sub =
        app.add_subcommand("map", "Fit the texels of a surface: of their own lobes, or of lobes that they share");
    for (const auto add : {add_texel_files, add_own_lobes, add_shared_lobes}) add(sub, fit, of);
    of.fit = add_fit_options(
        sub, fit.texts,
        {"form", "variates", "axial", "reciprocal", "no_scale", "objective", "max_theta", "seed", "threads"});
    sub.footer(
        "Examples:\n  srbf map texels.npy --pairs pairs.csv -o slabs --resume\n"
        "  srbf map texels.npy --pairs pairs.csv --basis 16 --width 512 -o map.srbf --resume");
    sub.callback(
        [sub, state, &status] {
            const MapOptions& given = state->of;
            MapCommand& map = state->fit;
            map.request = requested(sub, map.texts);
            std::get<PmRequest>(map.request.model).size = LobeCount{map.lobes};
            // The key has the content of inputs; texels and the width only place the coefficients.
            map.settings = sub.settings({given.texels, given.pairs, given.output, given.resume, given.range,
                                         given.width, given.fit.at("threads")});
            status = map.basis > 0 ? fit_map(map) : fit_slabs(map);
        },
        map_readings(of, fit));
}

}  // namespace srbf
