#include "srbf/load.h"

#include <fmt/format.h>

#include <filesystem>

#include "measured/bytes.h"
#include "models/texel.h"
#include "srbf/convert.h"
#include "srbf/directions.h"
#include "srbf/file.h"
#include "srbf/library.h"
#include "srbf/text.h"

namespace srbf {

namespace {

/// The stack or library and the texel or material that "FILE#NAME" names.
struct TexelName {
    std::string file, name;
};
std::optional<TexelName> texel_named(const std::string& path) {
    const auto sign = path.rfind('#');
    std::error_code none;
    if (sign == path.npos || std::filesystem::exists(path, none)) return {};
    return TexelName{path.substr(0, sign), path.substr(sign + 1)};
}

Result<AnyBrdf> any(Result<Model> model) {
    if (!model) return model.error();
    return AnyBrdf(*std::move(model));
}

/// The model that a name stands for in a library or a stack.
Result<AnyBrdf> named(std::span<const std::byte> bytes, const TexelName& of, const std::string& path) {
    if (is_library(bytes)) {
        const auto library = read_library(bytes, of.file);
        if (!library) return library.error();
        if (const auto t = find_material(*library, of.name)) return AnyBrdf(material(*library, *t));
        return Error{path,
                     {},
                     "material",
                     library->names.empty() ? fmt::format("0 to {}", library->count() - 1)
                                            : fmt::format("a name such as {}", library->names[0]),
                     fmt::format("{:.80}", of.name),
                     ErrorCode::argument};
    }
    const auto texel = to_number<std::uint64_t>(of.name);
    if (!texel) return Error{path, {}, "texel", "a number", fmt::format("{:.80}", of.name), ErrorCode::argument};
    return any(read_texel(bytes, *texel, path));
}

}  // namespace

Result<AnyBrdf> load_brdf(const std::string& path, const ReadOptions& options) {
    return within_memory(path, [&]() -> Result<AnyBrdf> {
        const auto of_stack = texel_named(path);
        auto bytes = read_input(of_stack && options.columns.empty() ? of_stack->file : path, options);
        if (!bytes) return bytes.error();
        if (is_safetensors(*bytes) && options.any())
            return Error{path,
                         {},
                         "input",
                         "samples, for --columns, --quantity and --floor",
                         "a fitted model",
                         ErrorCode::argument};
        if (of_stack) return named(*bytes, *of_stack, path);
        if (is_safetensors(*bytes)) return any(read_model(*bytes, path));
        auto measured = read_measured(*std::move(bytes), path, options);
        if (!measured) return measured.error();
        return AnyBrdf(*std::move(measured));
    });
}

bool is_two_sided(const AnyBrdf& brdf) {
    if (const auto* measured = std::get_if<Measured>(&brdf)) return std::holds_alternative<BsdfTable>(measured->table);
    return std::holds_alternative<BsdfModel>(std::get<Model>(brdf).model);
}

bool has_part(const AnyBrdf& brdf, Part part) {
    if (const auto* measured = std::get_if<Measured>(&brdf)) {
        if (const auto* bsdf = std::get_if<BsdfTable>(&measured->table))
            return answering(bsdf->band().part, part).brdf != nullptr;
    } else if (const auto* bsdf = std::get_if<BsdfModel>(&std::get<Model>(brdf).model)) {
        return answering(bsdf->part, part).brdf != nullptr;
    }
    return part == Part::reflection_front;
}

namespace {

/// CSV of all parts.
std::string csv_of_both_sides(const AnyBrdf& brdf, const Evaluate& values, bool isotropic,
                              const TableOptions& options) {
    ScatteredSamples all;
    all.isotropic = isotropic;
    for (std::size_t p = 0; p < k_parts; ++p) {
        const Part part = Part(p);
        if (!has_part(brdf, part)) continue;
        const ScatteredSamples samples =
            to_samples(part_of(values, part), isotropic, options.directions, options.max_theta);
        for (std::size_t i = 0; i < samples.wl.size(); ++i) {
            all.wl.push_back(to_side(samples.wl[i], side_of_light(part)));
            all.wv.push_back(to_side(samples.wv[i], side_of_viewer(part)));
            all.colour.push_back(samples.colour[i]);
        }
    }
    return "# both sides\n" + write_csv(all, options.progress);
}

/// The values of `of`; none once it is cancelled, so that what asks for them ends soon.
Evaluate until_cancelled(Evaluate of, const ProgressToken& token) {
    return [of = std::move(of), token](auto wl, auto wv, auto f) {
        if (!token.cancelled()) of(wl, wv, f);
    };
}

std::vector<std::byte> table_bytes(const AnyBrdf& brdf, const Evaluate& values, TableFormat format, bool isotropic,
                                   const TableOptions& options) {
    switch (format) {
        case TableFormat::merl:
            return write_merl(to_merl(values, k_merl_size, options.threads));
        case TableFormat::rgl: {
            const RglTable table = to_rgl(values, {.description = options.description, .threads = options.threads});
            if (options.progress.cancelled()) return {};
            return write_rgl(table, options.spectra);
        }
        case TableFormat::mbsdf: {
            const MbsdfOptions of{.metadata = {{"description", options.description}}, .threads = options.threads};
            if (!has_part(brdf, Part::transmission_front)) return write_mbsdf(to_mbsdf(values, of));
            const MbsdfTable transmission = to_mbsdf(part_of(values, Part::transmission_front), of);
            return write_mbsdf(to_mbsdf(values, of), &transmission);
        }
        case TableFormat::csv:
        case TableFormat::bsdf_xml:
        case TableFormat::zemax:
        case TableFormat::speos:
        case TableFormat::openmaterial:  // the last four: `instrument_bytes`
            break;
    }
    const auto* measured = std::get_if<Measured>(&brdf);
    const auto* samples = measured ? std::get_if<ScatteredSamples>(&measured->table) : nullptr;
    const std::string csv =
        is_two_sided(brdf) ? csv_of_both_sides(brdf, values, isotropic, options)
        : samples          ? write_csv(*samples, options.progress)
                  : write_csv(to_samples(values, isotropic, options.directions, options.max_theta), options.progress);
    const auto bytes = as_bytes(csv);
    return {bytes.begin(), bytes.end()};
}

/// A part as a matrix of that basis: the measured one, if it has it.
KlemsTable klems_of(const std::shared_ptr<const Measured>& own, const Evaluate& values, const Beams& beams, Part part,
                    const TableOptions& options) {
    const AngleBasis basis = klems_basis(options.basis);
    const auto* matrix = own ? std::get_if<KlemsTable>(&own->table) : nullptr;
    if (matrix && matrix->incident.name == basis.name && matrix->outgoing.name == basis.name) return *matrix;
    KlemsTable table = to_klems(part_of(values, part), basis, options.threads);
    add_beam(table, beams, part);
    return table;
}

/// All bands and parts as matrices; a beam is that of the part.
BsdfTable patches_of(const AnyBrdf& brdf, const TableOptions& options) {
    BsdfTable all;
    all.description = options.description;
    const auto add_band = [&](const std::string& name, const AnyBrdf& of, const Parts<Measured>& own,
                              const Beams& beams) {
        const Evaluate values =
            until_cancelled(std::visit([](const auto& content) { return evaluator(content); }, of), options.progress);
        BsdfTable::Band& band = all.bands.emplace_back();
        band.name = name;
        for (std::size_t p = 0; p < k_parts; ++p)
            if (const Part part = Part(p); has_part(of, part))
                band.part[p] = std::make_shared<const Measured>(
                    Measured{{}, {}, 0, klems_of(own[p], values, beams, part, options)});
    };
    if (const auto* measured = std::get_if<Measured>(&brdf)) {
        const auto* bsdf = std::get_if<BsdfTable>(&measured->table);
        for (std::size_t b = 0; bsdf && b < bsdf->bands.size(); ++b) {
            Measured of = *measured;
            std::get<BsdfTable>(of.table).chosen = b;
            const AnyBrdf band = of;
            add_band(bsdf->bands[b].name, band, measured->exchanged ? Parts<Measured>{} : bsdf->bands[b].part,
                     bsdf->bands[b].beam);
        }
        if (!bsdf) add_band("Visible", brdf, {}, {});
        return all;
    }
    const auto* bsdf = std::get_if<BsdfModel>(&std::get<Model>(brdf).model);
    add_band("Visible", brdf, {}, bsdf ? bsdf->beam : Beams{});
    return all;
}

/// The table of a part: the measured one, if it is of that kind.
ScatterTable scatter_of(const AnyBrdf& brdf, Part part, const Evaluate& values, bool about_mirror, bool isotropic,
                        int threads) {
    const auto* measured = std::get_if<Measured>(&brdf);
    if (measured && !measured->exchanged) {
        const auto* bsdf = std::get_if<BsdfTable>(&measured->table);
        const Measured* own = bsdf ? bsdf->band().part[std::size_t(part)].get() : measured;
        const auto* table = own ? std::get_if<ScatterTable>(&own->table) : nullptr;
        if (table && table->about_mirror == about_mirror) return *table;
    }
    ScatterTable table = to_scatter(part_of(values, part), about_mirror, isotropic, threads);
    table.transmission = is_transmission(part);
    return table;
}

/// Zemax' file of a BRDF, or of a BSDF that only transmits light from the front; Speos' of either.
Result<std::string> scatter_text(const AnyBrdf& brdf, const Evaluate& values, bool isotropic, TableFormat format,
                                 int threads) {
    std::vector<ScatterTable> tables;
    for (const Part part : {Part::reflection_front, Part::transmission_front})
        if (has_part(brdf, part))
            tables.push_back(scatter_of(brdf, part, values, format == TableFormat::zemax, isotropic, threads));
    if (format == TableFormat::zemax) {
        if (tables.size() > 1)
            return Error{"table", {}, "input", "reflection or transmission alone", "both", ErrorCode::argument};
        return write_zemax(tables[0]);
    }
    std::vector<const ScatterTable*> all;
    for (const ScatterTable& table : tables) all.push_back(&table);
    return write_speos(all);
}

/// Samples at a grid of angles every 5°, of azimuths every 15°.
ScatteredSamples gridded(const Evaluate& brdf, std::string description) {
    ScatteredSamples samples;
    samples.description = std::move(description);
    for (int l = 0; l < 18; ++l)
        for (int v = 0; v < 18; ++v)
            for (int phi = 0; phi <= (v == 0 ? 0 : 12); ++phi) {
                samples.wl.push_back(to_float(spherical(5 * l * k_degree, 0.0)));
                samples.wv.push_back(to_float(spherical(5 * v * k_degree, 15 * phi * k_degree)));
            }
    samples.colour.resize(samples.wl.size());
    brdf(samples.wl, samples.wv, samples.colour);
    ScatteredSamples measured;
    measured.description = std::move(samples.description);
    for (std::size_t i = 0; i < samples.wl.size(); ++i) {
        if (!is_finite(samples.colour[i])) continue;
        measured.wl.push_back(samples.wl[i]), measured.wv.push_back(samples.wv[i]);
        measured.colour.push_back(samples.colour[i]);
    }
    return measured;
}

std::vector<std::byte> text_bytes(const std::string& text) {
    const auto bytes = as_bytes(text);
    return {bytes.begin(), bytes.end()};
}

bool is_of_instruments(TableFormat format) {
    return format == TableFormat::bsdf_xml || format == TableFormat::zemax || format == TableFormat::speos ||
           format == TableFormat::openmaterial;
}

/// The file of one of these formats.
Result<std::vector<std::byte>> instrument_bytes(const AnyBrdf& brdf, const Evaluate& values, TableFormat format,
                                                bool isotropic, const TableOptions& options) {
    if (format == TableFormat::bsdf_xml) return text_bytes(write_bsdf_xml(patches_of(brdf, options)));
    if (format == TableFormat::openmaterial) {
        const auto* measured = std::get_if<Measured>(&brdf);
        const auto* own = measured ? std::get_if<ScatteredSamples>(&measured->table) : nullptr;
        return text_bytes(write_openmaterial(own ? *own : gridded(values, options.description)));
    }
    const auto text = scatter_text(brdf, values, isotropic, format, options.threads);
    if (!text) return text.error();
    return text_bytes(*text);
}

}  // namespace

const TableFormatRow* table_format(std::string_view path) {
    for (const TableFormatRow& row : k_table_formats)
        if (path.size() > row.extension.size() && path.ends_with(row.extension)) return &row;
    return nullptr;
}

Result<std::vector<std::byte>> table_file(const AnyBrdf& brdf, TableFormat format, const TableOptions& options) {
    const auto* measured = std::get_if<Measured>(&brdf);
    const bool isotropic = !measured || is_isotropic(*measured);
    const bool may_turn = format == TableFormat::csv || format == TableFormat::bsdf_xml ||
                          format == TableFormat::zemax || format == TableFormat::speos;
    if (!may_turn && !isotropic)
        return Error{"table", {}, "input", "an isotropic BRDF", "an anisotropic one", ErrorCode::argument};
    const bool of_front =
        format == TableFormat::merl || format == TableFormat::rgl || format == TableFormat::openmaterial;
    if (is_two_sided(brdf) && of_front) return Error{"table", {}, "input", "a BRDF", "a BSDF", ErrorCode::argument};
    const Evaluate values = until_cancelled(!measured                     ? evaluator(std::get<Model>(brdf))
                                            : format == TableFormat::merl ? evaluator(*measured)
                                                                          : signed_evaluator(*measured),
                                            options.progress);
    auto bytes = is_of_instruments(format)
                     ? instrument_bytes(brdf, values, format, isotropic, options)
                     : Result<std::vector<std::byte>>(table_bytes(brdf, values, format, isotropic, options));
    if (options.progress.cancelled()) return cancelled_error("table");
    return bytes;
}

}  // namespace srbf
