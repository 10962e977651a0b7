#include "srbf/measured.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

#include "floating_point.h"
#include "measured/bytes.h"
#include "measured/samples.h"
#include "measured/scatter.h"
#include "srbf/file.h"

namespace srbf {

namespace {

/// The first bytes as "01 02 0a ..", for readers of the error who know the format.
std::string opening(std::span<const std::byte> bytes) {
    if (bytes.empty()) return "an empty file";
    std::string text = "bytes that begin with";  // there may be more than were read
    for (const std::byte b : bytes.first(std::min<std::size_t>(bytes.size(), 12)))
        text += fmt::format(" {:02x}", std::to_integer<unsigned>(b));
    return text;
}

template <typename Table>
Result<Measured> labelled(Result<Table> table, const std::string& file_name, std::string format, std::size_t bytes) {
    if (!table) return table.error();
    return Measured{file_name, std::move(format), bytes, *std::move(table)};
}

/// Whether a BSDF is one of tensor trees, not of matrices.
bool has_trees(const BsdfTable& table) {
    return std::ranges::any_of(table.band().part,
                               [](const auto& part) { return part && std::holds_alternative<TreeTable>(part->table); });
}

constexpr const char *k_bsdf_xml = "BSDF XML", *k_bsdf_tree = "BSDF tree";

bool is_known_text(std::string_view text) {
    return is_alta(text) || is_astm(text) || is_xml(text) || is_csv(text) || is_cornell(text) || is_zemax(text) ||
           is_speos(text) || is_openmaterial(text) || is_bird(text);
}

/// A scatter table of reflection is a BRDF; one of transmission, or both, a BSDF.
Measured of_scatter(std::array<std::optional<ScatterTable>, 2> tables, const std::string& file_name, const char* format,
                    std::size_t bytes) {
    if (!tables[1]) return {file_name, format, bytes, *std::move(tables[0])};
    BsdfTable all{{{}}, 0, {}};
    for (std::size_t s = 0; s < 2; ++s)
        if (tables[s])
            all.bands[0].part[std::size_t(s == 0 ? Part::reflection_front : Part::transmission_front)] =
                std::make_shared<const Measured>(Measured{file_name, format, 0, *std::move(tables[s])});
    return {file_name, format, bytes, std::move(all)};
}

Result<Measured> read_zemax_or_speos(std::span<const std::byte> bytes, const std::string& file_name) {
    if (is_speos(as_text(bytes))) {
        auto tables = read_speos(bytes, file_name);
        if (!tables) return tables.error();
        return of_scatter(*std::move(tables), file_name, "Speos", bytes.size());
    }
    auto table = read_zemax(bytes, file_name);
    if (!table) return table.error();
    const bool transmission = table->transmission;
    std::array<std::optional<ScatterTable>, 2> tables;
    tables[std::size_t(transmission)] = *std::move(table);
    return of_scatter(std::move(tables), file_name, "Zemax", bytes.size());
}

/// Reads a measurement of any format, without the index of samples.
Result<Measured> read_unindexed(std::span<const std::byte> bytes, const std::string& file_name) {
    if (is_rgl(bytes)) return labelled(read_rgl(bytes, file_name), file_name, "RGL", bytes.size());
    if (is_mbsdf(bytes)) {
        auto table = read_mbsdf(bytes, file_name);
        if (table && table->has_transmission)
            return labelled(read_mbsdf_of_both_sides(bytes, file_name), file_name, "MBSDF", bytes.size());
        return labelled(std::move(table), file_name, "MBSDF", bytes.size());
    }
    if (is_merl(bytes)) return labelled(read_merl(bytes, file_name), file_name, "MERL", bytes.size());
    if (is_speos(as_text(bytes))) return read_zemax_or_speos(bytes, file_name);  // a binary one is refused there
    if (is_text(bytes)) {
        const std::string_view text = as_text(bytes);
        if (is_zemax(text)) return read_zemax_or_speos(bytes, file_name);
        if (is_fred(text)) return labelled(read_fred_samples(bytes, file_name), file_name, "FRED", bytes.size());
        if (is_openmaterial(text))
            return labelled(read_openmaterial_samples(bytes, file_name), file_name, "OpenMATERIAL", bytes.size());
        if (is_bird(text)) return labelled(read_bird_samples(bytes, file_name), file_name, "BiRD", bytes.size());
        if (is_alta(text)) return labelled(read_alta_samples(bytes, file_name), file_name, "ALTA", bytes.size());
        if (is_astm(text)) return labelled(read_astm_samples(bytes, file_name), file_name, "ASTM E1392", bytes.size());
        if (is_xml(text)) {
            auto table = read_bsdf_xml(bytes, file_name);
            const char* format = table && has_trees(*table) ? k_bsdf_tree : k_bsdf_xml;
            return labelled(std::move(table), file_name, format, bytes.size());
        }
        if (is_csv(text) && is_csv_of_both_sides(text))
            return labelled(read_csv_of_both_sides(bytes, file_name), file_name, "CSV", bytes.size());
        if (is_csv(text)) return labelled(read_csv_samples(bytes, file_name), file_name, "CSV", bytes.size());
        if (is_cornell(text))
            return labelled(read_cornell_samples(bytes, file_name), file_name, "Cornell", bytes.size());
    }
    if (is_safetensors(bytes))
        return Error{file_name, {}, "input", "a measurement", "a fitted model", ErrorCode::wrong_kind};
    if (is_utia(bytes)) return labelled(read_utia(bytes, file_name), file_name, "UTIA", bytes.size());
    return Error{
        file_name,
        {},
        "unknown format",
        "MERL, RGL, UTIA, MBSDF, Cornell, ASTM E1392, ALTA, CSV, BSDF XML, Zemax, FRED, Speos, OpenMATERIAL or BiRD",
        opening(bytes)};
}

Result<Measured> indexed(Result<Measured> measured) {
    if (!measured) return measured;
    if (auto* samples = std::get_if<ScatteredSamples>(&measured->table)) make_index(*samples);
    return measured;
}

/// Masks what the options say is a bound, and divides factors by π.
Result<Done> apply(const ReadOptions& options, ScatteredSamples& samples) {
    const std::size_t channels = samples.wavelengths.size();
    std::size_t kept = 0;
    for (std::size_t i = 0; i < samples.wl.size(); ++i) {
        const auto spectrum = std::span(samples.spectrum).subspan(i * channels, channels);
        const Rgb& f = samples.colour[i];
        const bool is_bound = channels > 0 ? std::ranges::any_of(spectrum, [&](float x) { return x <= options.floor; })
                                           : std::min({f.r, f.g, f.b}) <= options.floor;
        if (options.floor > 0 && is_bound) continue;
        samples.wl[kept] = samples.wl[i], samples.wv[kept] = samples.wv[i], samples.colour[kept] = f;
        if (!samples.weight.empty()) samples.weight[kept] = samples.weight[i];
        std::ranges::copy(spectrum, samples.spectrum.begin() + std::ptrdiff_t(kept * channels));
        ++kept;
    }
    samples.masked += samples.wl.size() - kept;
    samples.wl.resize(kept), samples.wv.resize(kept), samples.colour.resize(kept),
        samples.spectrum.resize(kept * channels);
    if (!samples.weight.empty()) samples.weight.resize(kept);
    if (kept == 0) return Error{{}, {}, "samples", "at least one above the floor", "none"};
    if (!options.factors) return Done{};
    for (float& f : samples.spectrum) f = float(double(f) / k_pi);
    for (Rgb& f : samples.colour)
        for (int c = 0; c < 3; ++c) f[c] = float(double(f[c]) / k_pi);
    return Done{};
}

/// The same as `read_unindexed`, of a file that does not state all.
Result<Measured> read_stated(std::span<const std::byte> bytes, const std::string& file_name,
                             const ReadOptions& options) {
    if (!options.any()) return read_unindexed(bytes, file_name);
    auto measured = options.columns.empty()
                        ? read_unindexed(bytes, file_name)
                        : labelled(read_columns(bytes, file_name, options.columns), file_name, "columns", bytes.size());
    if (!measured) return measured;
    auto* samples = std::get_if<ScatteredSamples>(&measured->table);
    if (!samples)
        return Error{file_name, {}, "input", "samples, for --unit and --floor", measured->format, ErrorCode::argument};
    if (const auto applied = apply(options, *samples); !applied) {
        Error error = applied.error();
        error.source = file_name;
        return error;
    }
    return measured;
}

}  // namespace

Result<std::vector<std::byte>> read_input(const std::string& path, const ReadOptions& options) {
    if (!options.columns.empty()) return read_file(path);
    return read_file(path, [](std::span<const std::byte> head) {
        if (is_rgl(head) || is_mbsdf(head) || is_safetensors(head)) return k_largest_file;
        if (is_text(head) && is_known_text(as_text(head))) return k_largest_file;
        return std::max(merl_bytes(head), utia_bytes());  // they have no mark, but a size of their own
    });
}

Result<Measured> read_measured(std::span<const std::byte> bytes, const std::string& file_name,
                               const ReadOptions& options) {
    return indexed(read_stated(bytes, file_name, options));
}

Result<Measured> read_measured(std::vector<std::byte>&& bytes, const std::string& file_name,
                               const ReadOptions& options) {
    auto measured = read_stated(bytes, file_name, options);
    std::vector<std::byte>().swap(bytes);
    return indexed(std::move(measured));
}

Result<Measured> load_measured(const std::string& path, const ReadOptions& options) {
    return within_memory(path, [&]() -> Result<Measured> {
        auto bytes = read_input(path, options);
        if (!bytes) return bytes.error();
        return read_measured(*std::move(bytes), path, options);
    });
}

bool is_isotropic(const Measured& measured) {
    if (const auto* rgl = std::get_if<RglTable>(&measured.table)) return rgl->phi_l.empty();
    if (const auto* samples = std::get_if<ScatteredSamples>(&measured.table)) return samples->isotropic;
    if (const auto* klems = std::get_if<KlemsTable>(&measured.table)) return is_isotropic(*klems);
    if (const auto* scatter = std::get_if<ScatterTable>(&measured.table)) return scatter->rotation.size() == 1;
    if (const auto* tree = std::get_if<TreeTable>(&measured.table)) return tree->y.rank == 3;
    if (const auto* bsdf = std::get_if<BsdfTable>(&measured.table))
        return std::ranges::all_of(bsdf->band().part, [](const auto& part) { return !part || is_isotropic(*part); });
    return !std::holds_alternative<UtiaTable>(measured.table);
}

void exchange(Measured& measured) {
    if (auto* samples = std::get_if<ScatteredSamples>(&measured.table)) {  // a fit uses the samples themselves
        std::swap(samples->wl, samples->wv);
        make_index(*samples);
    } else {
        measured.exchanged = !measured.exchanged;
    }
}

Rgb value(const Measured& measured, Vec3f wl, Vec3f wv) {
    if (measured.exchanged) std::swap(wl, wv);
    return std::visit([&](const auto& table) { return value(table, wl, wv); }, measured.table);
}

Rgb signed_value(const Measured& measured, Vec3f wl, Vec3f wv) {
    if (measured.exchanged) std::swap(wl, wv);
    return std::visit([&](const auto& table) { return signed_value(table, wl, wv); }, measured.table);
}

Evaluate signed_evaluator(const Measured& measured) {
    return [&measured](auto wl, auto wv, auto f) {
        const StandardArithmetic mode;
        if (measured.exchanged) std::swap(wl, wv);
        const auto each = [&](const auto& table) {
            if constexpr (requires { evaluate_signed(table, wl, wv, f); })
                evaluate_signed(table, wl, wv, f);
            else
                for (std::size_t i = 0; i < wl.size(); ++i) f[i] = signed_value(table, wl[i], wv[i]);
        };
        std::visit(each, measured.table);
    };
}

Evaluate evaluator(const Measured& measured) {
    return [of = signed_evaluator(measured)](auto wl, auto wv, auto f) {
        of(wl, wv, f);
        for (Rgb& c : f)
            for (int k = 0; k < 3; ++k) c[k] = c[k] < 0 ? 0 : c[k];  // NaN is kept
    };
}

std::span<const float> wavelengths(const Measured& measured) {
    if (const auto* rgl = std::get_if<RglTable>(&measured.table)) return rgl->wavelengths;
    if (const auto* samples = std::get_if<ScatteredSamples>(&measured.table)) return samples->wavelengths;
    return {};
}

Channels signed_spectra(const Measured& measured) {
    const auto nm = wavelengths(measured);
    assert(!nm.empty());
    return {{nm.begin(), nm.end()}, [&measured, C = nm.size()](auto wl, auto wv, auto f) {
                const StandardArithmetic mode;
                if (measured.exchanged) std::swap(wl, wv);
                const auto each = [&](const auto& table) {
                    for (std::size_t i = 0; i < wl.size(); ++i)
                        signed_spectrum(table, wl[i], wv[i], f.subspan(i * C, C));
                };
                if (const auto* rgl = std::get_if<RglTable>(&measured.table)) return each(*rgl);
                each(std::get<ScatteredSamples>(measured.table));
            }};
}

Channels spectra(const Measured& measured) {
    Channels channels = signed_spectra(measured);
    channels.evaluate = [of = std::move(channels.evaluate)](auto wl, auto wv, auto f) {
        of(wl, wv, f);
        for (float& x : f) x = std::max(x, 0.0f);
    };
    return channels;
}

}  // namespace srbf
