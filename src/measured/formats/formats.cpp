#include "measured/formats/formats.h"

#include <fmt/format.h>

#include <algorithm>

#include "extras/daylight/formats.h"
#include "extras/optics/formats.h"
#include "measured/bytes.h"
#include "measured/samples.h"
#include "srbf/file.h"

namespace srbf {

namespace {

using Bytes = std::span<const std::byte>;

template <typename Table> Result<Measured> measurement_of(Result<Table> table) {
    if (!table) return table.error();
    return Measured{{}, {}, 0, *std::move(table)};
}

template <auto read> Result<Measured> read_by(Bytes bytes, const std::string& file_name, const ReadOptions&) {
    return measurement_of(read(bytes, file_name));
}

template <auto is_format> bool in_text(Bytes head) { return is_format(as_text(head)); }

Result<Measured> read_any_mbsdf(Bytes bytes, const std::string& file_name, const ReadOptions&) {
    auto table = read_mbsdf(bytes, file_name);
    return table && table->has_transmission ? measurement_of(read_mbsdf_of_both_sides(bytes, file_name))
                                            : measurement_of(std::move(table));
}

Result<Measured> read_any_csv(Bytes bytes, const std::string& file_name, const ReadOptions& options) {
    return is_csv_of_both_sides(as_text(bytes)) ? measurement_of(read_csv_of_both_sides(bytes, file_name))
                                                : measurement_of(read_csv_samples(bytes, file_name, options));
}

Result<Measured> read_matrices_or_trees(Bytes bytes, const std::string& file_name, const ReadOptions&) {
    auto measured = measurement_of(read_bsdf_xml(bytes, file_name));
    if (!measured) return measured;
    const auto& parts = std::get<BsdfTable>(measured->table).band().part;
    const auto is_tree = [](const auto& part) { return part && std::holds_alternative<TreeTable>(part->table); };
    if (std::ranges::any_of(parts, is_tree)) measured->format = "BSDF tree";
    return measured;
}

/// A scatter table of reflection is a BRDF; one of transmission, or both, a BSDF.
Measured of_scatter(std::array<std::optional<ScatterTable>, 2> tables, const std::string& file_name,
                    const char* format) {
    if (!tables[1]) return {file_name, format, 0, *std::move(tables[0])};
    BsdfTable all{{{}}, 0, {}};
    for (std::size_t s = 0; s < 2; ++s)
        if (tables[s])
            all.bands[0].part[std::size_t(s == 0 ? Part::reflection_front : Part::transmission_front)] =
                std::make_shared<const Measured>(Measured{file_name, format, 0, *std::move(tables[s])});
    return {file_name, format, 0, std::move(all)};
}

Result<Measured> read_any_speos(Bytes bytes, const std::string& file_name, const ReadOptions&) {
    auto tables = read_speos(bytes, file_name);
    if (!tables) return tables.error();
    return of_scatter(*std::move(tables), file_name, "Speos");
}

Result<Measured> read_any_zemax(Bytes bytes, const std::string& file_name, const ReadOptions&) {
    auto table = read_zemax(bytes, file_name);
    if (!table) return table.error();
    const bool transmission = table->transmission;
    std::array<std::optional<ScatterTable>, 2> tables;
    tables[std::size_t(transmission)] = *std::move(table);
    return of_scatter(std::move(tables), file_name, "Zemax");
}

std::uint64_t utia_size(Bytes) { return utia_bytes(); }

constexpr Format k_formats[] = {
    {"RGL", false, is_rgl, read_by<read_rgl>},
    {"MBSDF", false, is_mbsdf, read_any_mbsdf},
    {"MERL", false, is_merl, read_by<read_merl>, merl_bytes},
    {"Speos", false, in_text<is_speos>, read_any_speos},  // a binary one is refused there
    {"Zemax", true, in_text<is_zemax>, read_any_zemax},
    {"FRED", true, in_text<is_fred>, read_by<read_fred_samples>},
    {"OpenMATERIAL", true, in_text<is_openmaterial>, read_by<read_openmaterial_samples>},
    {"BiRD", true, in_text<is_bird>, read_by<read_bird_samples>},
    {"ALTA", true, in_text<is_alta>, read_by<read_alta_samples>},
    {"ASTM E1392", true, in_text<is_astm>, read_by<read_astm_samples>},
    {"BSDF XML", true, in_text<is_xml>, read_matrices_or_trees},
    {"Cornell", true, in_text<is_cornell>, read_by<read_cornell_samples>},
    {"CSV", true, in_text<is_csv>, read_any_csv},
    {"UTIA", false, is_utia, read_by<read_utia>, utia_size},
};

bool begins(const Format& format, Bytes head) { return (!format.is_text || is_text(head)) && format.recognise(head); }

}  // namespace

std::span<const Format> formats() { return k_formats; }

Result<Measured> read_as(const Format& format, Bytes bytes, const std::string& file_name, const ReadOptions& options) {
    auto measured = format.read(bytes, file_name, options);
    if (!measured) return measured;
    measured->source = file_name, measured->bytes = bytes.size();
    if (measured->format.empty()) measured->format = format.name;
    return measured;
}

const Format* format_of(Bytes bytes) {
    const auto found = std::ranges::find_if(k_formats, [&](const Format& format) { return begins(format, bytes); });
    return found == std::end(k_formats) ? nullptr : found;
}

std::uint64_t most_bytes(Bytes head) {
    std::uint64_t most = 0;
    for (const Format& format : k_formats)
        most = std::max(most, format.size ? format.size(head) : begins(format, head) ? k_largest_file : 0);
    return most;
}

std::string names_of_formats() {
    std::string names;
    for (const Format& format : k_formats)
        names += fmt::format("{}{}",
                             names.empty()                        ? ""
                             : &format == std::end(k_formats) - 1 ? " or "
                                                                  : ", ",
                             format.name);
    return names;
}

}  // namespace srbf
