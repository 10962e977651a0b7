#include <fmt/ranges.h>

#include <memory>

#include "api/table_file.h"
#include "app/commands.h"
#include "app/fit_options.h"
#include "app/output.h"
#include "app/peak.h"
#include "base/printable.h"
#include "brdf/directions.h"
#include "brdf/values.h"
#include "measured/tables.h"
#include "models/bsdf/bsdf_functions.h"
#include "srbf/file.h"
#include "srbf/map.h"

namespace srbf {
namespace {

void print_row(std::string_view name, const std::string& value) {
    std::string text;
    add_row(text, name, value);
    fmt::print("{}", text);
}

template <typename Pixels> void print_channel_ranges(std::string_view name, const Pixels& pixels) {
    std::string text;
    add_channel_ranges(text, name, pixels);
    fmt::print("{}", text);
}

void print_table(const MerlTable& table) {
    print_row("dimensions", fmt::format("{} θh × {} θd × {} φd", table.size[0], table.size[1], table.size[2]));
    print_row("masked entries", fmt::format("{} of {}", grouped(table.masked), grouped(table.cells.size())));
    print_channel_ranges("value [1/sr]", table.cells);
}

void print_table(const RglTable& table) {
    if (!table.description.empty()) print_row("description", table.description);
    print_row("dimensions",
              fmt::format("{}{} θl × {} × {}, microfacet distribution {}, area {}",
                          table.phi_l.empty() ? "" : fmt::format("{} φl × ", table.phi_l.size()), table.theta_l.size(),
                          table.colour.width, table.colour.height, table.ndf.width, table.sigma.width));
    if (!table.wavelengths.empty()) print_row("wavelengths", wavelengths_text(table.wavelengths));
    if (!table.theta_l.empty())
        print_row("θl", fmt::format("{:.2f}° to {:.2f}°", double(table.theta_l.front()) / k_degree,
                                    double(table.theta_l.back()) / k_degree));
    print_row("masked entries", "none");
    print_channel_ranges("colour", table.colour.nodes);
}

void print_table(const MbsdfTable& table) {
    for (const auto& [key, text] : table.metadata) print_row(key, text);
    print_row("dimensions",
              fmt::format("{0} θl × {0} θv × {1} φ, {2}", table.polar, table.azimuths, table.grey ? "grey" : "RGB"));
    print_row("masked entries", fmt::format("{} of {}", grouped(table.masked), grouped(table.cells.size())));
    print_channel_ranges("value [1/sr]", table.cells);
}

/// Prints what limits a fit: samples in the plane of incidence alone, and values at the instrument's floor.
void print_geometry(const ScatteredSamples& samples) {
    std::size_t in_plane = 0, smallest_count = 0;
    float smallest = std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < samples.wl.size(); ++i) {
        in_plane += is_in_plane(samples.wl[i], samples.wv[i]);
        if (samples.colour[i].g < smallest) {
            smallest = samples.colour[i].g;
            smallest_count = 0;
        }
        smallest_count += samples.colour[i].g == smallest;
    }
    if (in_plane == samples.wl.size())
        print_row("geometry", "the plane of incidence alone; nothing was measured out of it");
    else
        print_row("geometry", fmt::format("{} samples in the plane of incidence", grouped(in_plane)));
    constexpr std::size_t hundredth = 100;
    if (smallest_count > 2 && smallest_count * hundredth >= samples.wl.size())
        print_row("floor",
                  fmt::format("{} samples have the smallest value, {:.4g}: perhaps the noise floor, see --floor",
                              grouped(smallest_count), smallest));
}

void print_table(const ScatteredSamples& samples) {
    if (!samples.description.empty()) print_row("description", samples.description);
    print_row("samples", fmt::format("{} pairs of directions, {}", grouped(samples.wl.size()),
                                     samples.isotropic ? "isotropic" : "anisotropic"));
    if (!samples.wavelengths.empty()) print_row("wavelengths", wavelengths_text(samples.wavelengths));
    if (!samples.receiver.empty()) print_row("receiver [nm, sr]", fmt::format("{}", samples.receiver));
    print_geometry(samples);
    ValueRange theta_l, theta_v, spectrum;
    for (const Vec3f& w : samples.wl) theta_l.add(float(std::acos(double(w.z)) / k_degree));
    for (const Vec3f& w : samples.wv) theta_v.add(float(std::acos(double(w.z)) / k_degree));
    for (const float f : samples.spectrum) spectrum.add(f);
    print_row("θl", theta_l.text() + " degrees");
    print_row("θv", theta_v.text() + " degrees");
    print_row("masked entries",
              fmt::format("{} of {}", grouped(samples.masked), grouped(samples.masked + samples.wl.size())));
    if (!samples.spectrum.empty()) print_row("spectrum [1/sr]", spectrum.text());
    print_channel_ranges("value [1/sr]", samples.colour);
}

void print_table(const EvaluatedTable& table) {
    for (const auto& [name, value, colours] : table.functions->lines())
        if (colours.empty())
            print_row(name, value);
        else
            print_channel_ranges(name, colours);
}

void print_table(const BsdfTable& table) {
    if (!table.description.empty()) print_row("description", table.description);
    std::vector<std::string> names;
    for (std::size_t b = 0; b < table.bands.size(); ++b)
        if (!table.bands[b].name.empty()) names.push_back(table.bands[b].name + (b == table.chosen ? " (here)" : ""));
    if (!names.empty()) print_row("bands", fmt::format("{}", fmt::join(names, ", ")));
    std::string text;
    add_beams(text, table.band().beam);
    fmt::print("{}", text);
    for (std::size_t p = 0; p < k_parts; ++p) {
        if (!table.band().part[p]) continue;
        const Measured& part = *table.band().part[p];
        fmt::print("\n  {}{}\n", k_part_names[p], is_isotropic(part) ? "" : ", anisotropic");
        std::visit([](const auto& values) { print_table(values); }, part.table);
    }
}

/// Polar angles for directional albedo [degrees].
constexpr std::array<double, 7> k_info_theta{0, 15, 30, 45, 60, 75, 85};

/// Directional albedos, and deviations from the physical laws of a BRDF.
void print_behaviour(const LoadedFile& subject) {
    const Evaluate brdf = evaluator(subject);
    fmt::print("\n  {:<18}", "θv");
    for (const double theta : k_info_theta) fmt::print("{:>9}°", theta);
    std::array<Rgb, k_info_theta.size()> albedos;
    for (std::size_t i = 0; i < albedos.size(); ++i) albedos[i] = albedo(brdf, k_info_theta[i] * k_degree, k_pi / 2);
    const std::vector<std::string> names = channel_names("albedo", albedos);
    for (int c = 0; c < int(names.size()); ++c) {
        fmt::print("\n  {:<18}", names[std::size_t(c)]);
        for (const Rgb& albedo_rgb : albedos) fmt::print("{:>#10.4g}", albedo_rgb[c]);
    }
    fmt::print("\n");
    std::vector<std::string> bright;
    for (std::size_t i = 0; i < albedos.size(); ++i)
        if (std::max({albedos[i].r, albedos[i].g, albedos[i].b}) > 1)
            bright.push_back(fmt::format("{}°", k_info_theta[i]));
    if (!bright.empty())
        print_row("warning",
                  fmt::format("it reflects more light than it receives at θv = {}", fmt::join(bright, ", ")));

    const auto* measured = std::get_if<Measured>(&subject.content);
    print_row("peak", peak_text(measured ? peak_of(*measured) : peak_of(brdf)));
    const Evaluate other[] = {exchanged(brdf)};
    constexpr double max_theta = 80;
    const Measures reciprocity =
        compare(brdf, other, {.max_theta = max_theta * k_degree, .pictures = false}, {})[0].heldout;
    print_row("reciprocity error", fmt::format("{} of f cosθl, squared, between f(wl, wv) and f(wv, wl), θ ≤ {}°",
                                               percent(reciprocity.squared_error_ratio_cosine), max_theta));
    if (const auto errors = reciprocity_errors(subject.content)) print_row("reciprocal", reciprocity_text(*errors));
    // The measurement before negative values are set to 0.
    const Evaluate as_measured = measured ? signed_evaluator(*measured) : brdf;
    const std::vector<Vec3f> directions = fibonacci_directions(512, max_theta * k_degree);
    std::vector<Rgb> f(directions.size());
    ValueRange range;
    for (const Vec3f& wv : directions) {
        as_measured(directions, std::vector<Vec3f>(f.size(), wv), f);
        for (const Rgb& value : f)
            for (int c = 0; c < 3; ++c) range.add(value[c]);
    }
    print_row("smallest value", fmt::format("{:.4g} 1/sr, θ ≤ {}°", range.min, max_theta));
}

/// The light that leaves a surface lit from each direction: directional-hemispherical sums of each part and its beam.
void print_sides(const LoadedFile& subject) {
    const Evaluate bsdf = evaluator(subject);
    const auto* measured = std::get_if<Measured>(&subject.content);
    const Beams beams = beams_of(subject.content);
    fmt::print("\n  {:<22}", "light from θl =");
    for (const double theta : k_info_theta) fmt::print("{:>9}°", theta);
    fmt::print("\n");
    std::array<std::array<double, k_info_theta.size()>, 2> side_sums{};
    std::string peaks;
    for (std::size_t p = 0; p < k_parts; ++p) {
        const Part part = Part(p);
        if (!has_part(subject.content, part)) continue;
        const Evaluate from_light = exchanged(part_of(bsdf, part));
        fmt::print("  {:<22}", name(part));
        for (std::size_t i = 0; i < k_info_theta.size(); ++i) {
            const double theta = k_info_theta[i] * k_degree;
            const double sum = double(albedo(from_light, theta, k_pi / 2).g) +
                               double(fraction_at(beams, part, to_float(spherical(theta, 0.0))).g);
            side_sums[std::size_t(is_back(part))][i] += sum;
            fmt::print("{:>#10.4g}", sum);
        }
        fmt::print("\n");
        const auto data = measured ? std::get<BsdfTable>(measured->table).band().part[p] : nullptr;
        peaks += fmt::format("  {:<22}{}\n", name(part),
                             peak_text(data ? peak_of(*data) : peak_of(part_of(bsdf, part)), is_transmission(part)));
    }
    for (const std::size_t side : {0, 1}) {
        fmt::print("  {:<22}", side ? "total, from the back" : "total, from the front");
        for (const double sum : side_sums[side]) fmt::print("{:>#10.4g}", sum);
        fmt::print("\n");
        if (std::ranges::any_of(side_sums[side], [](double sum) { return sum > 1; }))
            print_row("warning", "more light leaves this side than it receives");
    }
    fmt::print("\n{}", peaks);
}

void print_provenance(const std::map<std::string, std::string>& provenance) {
    for (const auto& [key, text] : provenance) fmt::print("  {:<36}{}\n", printable(key), printable(text));
}

/// Describes a map of texels that share their lobes.
void print_map(const TexelMap& map) {
    print_row("map", fmt::format("{} × {} texels of {} shared lobes", map.width, map.height(), map.basis.lobes));
    const std::size_t texel_bytes = 6 * std::size_t(map.basis.lobes);
    print_row("bytes", fmt::format("{} shared, {} each", grouped(payload_bytes(map.basis) - texel_bytes), texel_bytes));
    ValueRange error;
    for (const float texel_error : map.error) error.add(texel_error);
    print_row("error", error.text());
    fmt::print("\n");
    print_provenance(map.provenance);
}

int run(const std::string& file, const ReadOptions& read) {
    const auto loaded = load_file_or_map(file, read);
    if (!loaded) return complain(loaded.error());
    fmt::print("{}\n", printable(file));
    if (const auto* map = std::get_if<TexelMap>(&*loaded)) {
        print_map(*map);
        return k_done;
    }
    const auto* subject = std::get_if<LoadedFile>(&*loaded);
    if (const auto* measured = std::get_if<Measured>(&subject->content)) {
        print_row("format", fmt::format("{}, {} bytes", measured->format, grouped(measured->bytes)));
        std::visit([](const auto& table) { print_table(table); }, measured->table);
    } else {
        const auto& model = std::get<Model>(subject->content);
        fmt::print("{}", rows_text(model));
        if (!model.provenance.empty()) fmt::print("\n");
        print_provenance(model.provenance);
    }
    if (is_two_sided(subject->content))
        print_sides(*subject);
    else
        print_behaviour(*subject);
    return k_done;
}

}  // namespace

void add_info(CommandLine& app, int& status) {
    struct InfoCommand {
        std::string file;
        ReadOptions read;
    };
    const auto command = std::make_shared<InfoCommand>();
    const Subcommand sub = app.add_subcommand("info", "Describe a file: dimensions, ranges, parameters, albedo");
    sub.add_option("FILE", command->file, "A measurement, a model or a map").type_name("").required();
    add_read_options(sub, command->read);
    sub.footer("Example:\n  srbf info paper_white_rgb.bsdf");
    sub.callback([command, &status] { status = run(command->file, command->read); });
}

}  // namespace srbf
