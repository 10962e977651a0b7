#include "srbf/measured.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

#include "floating_point.h"
#include "measured/bytes.h"
#include "measured/samples.h"
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

bool is_known_text(std::string_view text) {
    return is_alta(text) || is_astm(text) || is_xml(text) || is_csv(text) || is_cornell(text);
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
    if (is_text(bytes)) {
        const std::string_view text = as_text(bytes);
        if (is_alta(text)) return labelled(read_alta_samples(bytes, file_name), file_name, "ALTA", bytes.size());
        if (is_astm(text)) return labelled(read_astm_samples(bytes, file_name), file_name, "ASTM E1392", bytes.size());
        if (is_xml(text)) return labelled(read_bsdf_xml(bytes, file_name), file_name, "BSDF XML", bytes.size());
        if (is_csv(text) && is_csv_of_both_sides(text))
            return labelled(read_csv_of_both_sides(bytes, file_name), file_name, "CSV", bytes.size());
        if (is_csv(text)) return labelled(read_csv_samples(bytes, file_name), file_name, "CSV", bytes.size());
        if (is_cornell(text))
            return labelled(read_cornell_samples(bytes, file_name), file_name, "Cornell", bytes.size());
    }
    if (is_safetensors(bytes))
        return Error{file_name, {}, "input", "a measurement", "a fitted model", ErrorCode::wrong_kind};
    if (is_utia(bytes)) return labelled(read_utia(bytes, file_name), file_name, "UTIA", bytes.size());
    return Error{file_name,
                 {},
                 "unknown format",
                 "MERL, RGL, UTIA, MBSDF, Cornell, ASTM E1392, ALTA, CSV or BSDF XML",
                 opening(bytes)};
}

Result<Measured> indexed(Result<Measured> measured) {
    if (!measured) return measured;
    if (auto* samples = std::get_if<ScatteredSamples>(&measured->table)) make_index(*samples);
    return measured;
}

}  // namespace

std::uint64_t most_bytes_of(std::span<const std::byte> head) {
    if (is_rgl(head) || is_mbsdf(head) || is_safetensors(head)) return k_largest_file;
    if (is_text(head) && is_known_text(as_text(head))) return k_largest_file;
    return std::max(merl_bytes(head), utia_bytes());
}

Result<Measured> read_measured(std::span<const std::byte> bytes, const std::string& file_name) {
    return indexed(read_unindexed(bytes, file_name));
}

Result<Measured> read_measured(std::vector<std::byte>&& bytes, const std::string& file_name) {
    auto measured = read_unindexed(bytes, file_name);
    std::vector<std::byte>().swap(bytes);
    return indexed(std::move(measured));
}

Result<Measured> load_measured(const std::string& path) {
    return within_memory(path, [&]() -> Result<Measured> {
        auto bytes = read_file(path, most_bytes_of);
        if (!bytes) return bytes.error();
        return read_measured(*std::move(bytes), path);
    });
}

bool is_isotropic(const Measured& measured) {
    if (const auto* rgl = std::get_if<RglTable>(&measured.table)) return rgl->phi_l.empty();
    if (const auto* samples = std::get_if<ScatteredSamples>(&measured.table)) return samples->isotropic;
    if (const auto* klems = std::get_if<KlemsTable>(&measured.table)) return is_isotropic(*klems);
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
        if (const auto* rgl = std::get_if<RglTable>(&measured.table))
            return measured.exchanged ? evaluate_signed(*rgl, wv, wl, f) : evaluate_signed(*rgl, wl, wv, f);
        const FlushSubnormals mode;
        for (std::size_t i = 0; i < wl.size(); ++i) f[i] = signed_value(measured, wl[i], wv[i]);
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
                const FlushSubnormals mode;
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
