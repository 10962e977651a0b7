#include "measured/formats.h"

#include <algorithm>
#include <cassert>

#include "base/floating_point.h"
#include "brdf/parts.h"
#include "brdf/values.h"
#include "measured/readers.h"
#include "measured/tables.h"

namespace srbf {

Quantity quantity_named(std::string_view name) {
    const auto found = std::ranges::find(k_quantities, name);
    return found == k_quantities.end() ? Quantity::stated : Quantity(found - k_quantities.begin() + 1);
}

bool is_isotropic(const Measured& measured) {
    if (const auto* rgl = std::get_if<RglTable>(&measured.table)) return rgl->phi_l.empty();
    if (const auto* samples = std::get_if<ScatteredSamples>(&measured.table)) return samples->isotropic;
    if (const auto* table = std::get_if<EvaluatedTable>(&measured.table)) return table->isotropic;
    if (const auto* bsdf = std::get_if<BsdfTable>(&measured.table))
        return std::ranges::all_of(bsdf->band().part, [](const auto& part) { return !part || is_isotropic(*part); });
    return !std::holds_alternative<UtiaTable>(measured.table);
}

std::vector<std::string> notes(const Measured& measured) {
    if (const auto* samples = std::get_if<ScatteredSamples>(&measured.table)) return samples->notes;
    std::vector<std::string> all;
    if (const auto* bsdf = std::get_if<BsdfTable>(&measured.table))
        for (const auto& part : bsdf->band().part)
            if (part)
                for (std::string& note : notes(*part))
                    if (std::ranges::find(all, note) == all.end()) all.push_back(std::move(note));
    return all;
}

void exchange(Measured& measured) {
    if (auto* samples = std::get_if<ScatteredSamples>(&measured.table)) {  // fits use the samples directly
        std::swap(samples->wl, samples->wv);
        make_index(*samples);
    } else {
        measured.exchanged = !measured.exchanged;
    }
}

Rgb signed_value(const EvaluatedTable& table, Vec3f wl, Vec3f wv) {
    Rgb f;
    table.values({&wl, 1}, {&wv, 1}, {&f, 1});
    return f;
}

Rgb signed_value(const Measured& measured, Vec3f wl, Vec3f wv) {
    if (measured.exchanged) std::swap(wl, wv);
    return std::visit([&](const auto& table) { return signed_value(table, wl, wv); }, measured.table);
}

Evaluate signed_evaluator(const Measured& measured) {
    return [&measured](auto wl, auto wv, auto f) {
        const StandardArithmetic mode;
        require_equal_lengths(wl.size(), wv.size(), f.size());
        if (measured.exchanged) std::swap(wl, wv);
        const auto evaluate = [&](const auto& table) {
            if constexpr (std::is_same_v<decltype(table), const EvaluatedTable&>)
                table.values(wl, wv, f);
            else if constexpr (requires { evaluate_signed(table, wl, wv, f); })
                evaluate_signed(table, wl, wv, f);
            else
                for (std::size_t i = 0; i < wl.size(); ++i) f[i] = signed_value(table, wl[i], wv[i]);
        };
        std::visit(evaluate, measured.table);
    };
}

Evaluate evaluator(const Measured& measured) { return non_negative(signed_evaluator(measured)); }

TableSource table_source(const Measured& measured) {
    const auto* bsdf = std::get_if<BsdfTable>(&measured.table);
    TableSource source{signed_evaluator(measured), is_isotropic(measured), bsdf != nullptr, {true}, {}, &measured};
    if (!bsdf) return source;
    for (std::size_t p = 0; p < k_parts; ++p) source.has[p] = answering(bsdf->band().part, Part(p)).brdf != nullptr;
    source.beams = bsdf->band().beam;
    return source;
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
                require_equal_lengths(C * wl.size(), C * wv.size(), f.size());
                if (measured.exchanged) std::swap(wl, wv);
                const auto evaluate = [&](const auto& table) {
                    for (std::size_t i = 0; i < wl.size(); ++i)
                        signed_spectrum(table, wl[i], wv[i], f.subspan(i * C, C));
                };
                if (const auto* rgl = std::get_if<RglTable>(&measured.table)) return evaluate(*rgl);
                evaluate(std::get<ScatteredSamples>(measured.table));
            }};
}

Channels spectra(const Measured& measured) {
    Channels channels = signed_spectra(measured);
    channels.evaluate = [evaluate = std::move(channels.evaluate)](auto wl, auto wv, auto f) {
        evaluate(wl, wv, f);
        for (float& x : f) x = std::max(x, 0.0f);
    };
    return channels;
}

}  // namespace srbf
