#include "measured/formats.h"

#include <fmt/ranges.h>

#include <cassert>

#include "base/errors.h"
#include "base/floating_point.h"
#include "base/text.h"
#include "brdf/directions.h"
#include "brdf/parts.h"
#include "brdf/values.h"
#include "measured/readers.h"
#include "measured/tables.h"

namespace SRBF_NAMESPACE {

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
    return true;
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
        measured.is_exchanged = !measured.is_exchanged;
    }
}

Rgb signed_value(const EvaluatedTable& table, Vec3f wl, Vec3f wv) {
    Rgb f;
    table.values({&wl, 1}, {&wv, 1}, {&f, 1});
    return f;
}

namespace {

bool is_normal(Vec3f w) { return w.x == 0 && w.y == 0; }

/// True if look-up may need the azimuth of a direction along the normal, which has none. RGL's needs the light's
/// azimuth.
bool lacks_azimuth(const Measured& measured, Vec3f wl, Vec3f wv) {
    return (is_normal(wl) || (!std::holds_alternative<RglTable>(measured.table) && is_normal(wv))) &&
           !std::holds_alternative<ScatteredSamples>(measured.table);
}

/// The mean of the values that look_up(wl, wv, f) sets, over all azimuths of a direction that has none. The direction
/// is moved to each azimuth by less than rounding. If a value was not measured, the result is the value of the pair
/// itself.
template <typename LookUp> void look_up_mean(Vec3f wl, Vec3f wv, std::span<float> f, const LookUp& look_up) {
    constexpr int k_turns = 16;
    look_up(wl, wv, f);
    Vec3f& turned = is_normal(wl) ? wl : wv;
    if (is_normal(wv)) wv.x = 1e-12f;  // also turned relative to this
    std::vector<float> values(f.size());
    std::vector<double> mean(f.size());
    for (int k = 0; k < k_turns; ++k) {
        const double phi = 2 * k_pi * (k + 0.5) / k_turns;
        turned = {1e-18f * float(elementary::cos(phi)), 1e-18f * float(elementary::sin(phi)), turned.z};
        look_up(wl, wv, std::span(values));
        for (std::size_t c = 0; c < f.size(); ++c) mean[c] += double(values[c]) / k_turns;
    }
    for (std::size_t c = 0; c < f.size(); ++c)
        if (std::isfinite(mean[c])) f[c] = float(mean[c]);
}
[[gnu::noinline]] Rgb mean_value(const Measured& measured, Vec3f wl, Vec3f wv) {  // pairs look up faster without it
    Rgb f;
    look_up_mean(wl, wv, {&f.r, 3}, [&](Vec3f l, Vec3f v, std::span<float> to) {
        const Rgb at = std::visit([&](const auto& table) { return signed_value(table, l, v); }, measured.table);
        std::copy_n(&at.r, 3, to.begin());
    });
    return f;
}

bool is_same_fraction(float a, float b) {
    constexpr float k_relative = 0.01f, k_absolute = 0.001f;
    return std::abs(a - b) <= std::max(k_relative * 0.5f * (a + b), k_absolute);
}

}  // namespace

Rgb signed_value(const Measured& measured, Vec3f wl, Vec3f wv) {
    if (measured.is_exchanged) std::swap(wl, wv);
    if (lacks_azimuth(measured, wl, wv)) [[unlikely]]
        return mean_value(measured, wl, wv);
    return std::visit([&](const auto& table) { return signed_value(table, wl, wv); }, measured.table);
}

Evaluate signed_evaluator(const Measured& measured) {
    return [&measured](auto wl, auto wv, auto f) {
        const StandardArithmetic mode;
        require_equal_lengths(wl.size(), wv.size(), f.size());
        if (measured.is_exchanged) std::swap(wl, wv);
        const auto evaluate = [&](const auto& table) {
            if constexpr (std::is_same_v<decltype(table), const EvaluatedTable&>)
                table.values(wl, wv, f);
            else if constexpr (requires { evaluate_signed(table, wl, wv, f); })
                evaluate_signed(table, wl, wv, f);
            else
                for (std::size_t i = 0; i < wl.size(); ++i) f[i] = signed_value(table, wl[i], wv[i]);
        };
        std::visit(evaluate, measured.table);
        int normals = 0;
        for (std::size_t i = 0; i < wl.size(); ++i) normals |= int(is_normal(wl[i])) | int(is_normal(wv[i]));
        for (std::size_t i = 0; normals != 0 && i < wl.size(); ++i)
            if (lacks_azimuth(measured, wl[i], wv[i])) f[i] = mean_value(measured, wl[i], wv[i]);
    };
}

Evaluate evaluator(const Measured& measured) { return non_negative(signed_evaluator(measured)); }

TableSource table_source(const Measured& measured) {
    const auto* bsdf = std::get_if<BsdfTable>(&measured.table);
    TableSource source{
        .values = signed_evaluator(measured), .isotropic = is_isotropic(measured), .measured = &measured};
    if (bsdf) set_parts(source, bsdf->band().part, bsdf->band().beam);
    if (!wavelengths(measured).empty()) source.spectra = signed_spectra(measured);
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
                if (measured.is_exchanged) std::swap(wl, wv);
                const auto evaluate = [&](const auto& table) {
                    const auto look_up = [&](Vec3f l, Vec3f v, auto to) { signed_spectrum(table, l, v, to); };
                    for (std::size_t i = 0; i < wl.size(); ++i)
                        if (const auto to = f.subspan(i * C, C); lacks_azimuth(measured, wl[i], wv[i]))
                            look_up_mean(wl[i], wv[i], to, look_up);
                        else
                            look_up(wl[i], wv[i], to);
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

bool are_same_fraction(const Rgb& a, const Rgb& b) {
    return is_same_fraction(a.r, b.r) && is_same_fraction(a.g, b.g) && is_same_fraction(a.b, b.b);
}

Rgb mean_fraction(std::span<const Rgb> values) {
    std::array<double, 3> sum{};
    for (const Rgb& value : values)
        for (int c = 0; c < 3; ++c) sum[std::size_t(c)] += double(value[c]);
    const double n = double(values.size());
    return {float(sum[0] / n), float(sum[1] / n), float(sum[2] / n)};
}

void unite_transmissions(Beams& beams) {
    Beam &front = beams[std::size_t(Part::transmission_front)], &back = beams[std::size_t(Part::transmission_back)];
    if (front.empty() || back.empty()) return;
    std::vector<Rgb> means;
    for (std::size_t ring = 0; ring < front.theta.size(); ++ring)
        for (int k = 0; k < front.nodes(ring); ++k) {
            const Vec3f wl = to_float(spherical(double(front.theta[ring]), 2 * k_pi * k / front.nodes(ring)));
            const Rgb a = front.fraction[means.size()], b = fraction_at(back, mirror(wl));
            if (!are_same_fraction(a, b)) return;
            means.push_back(mean_fraction(std::array{a, b}));
        }
    front.fraction = std::move(means);
    back = {};
}

Rgb signed_value(const BsdfTable& table, Vec3f wl, Vec3f wv) {
    const auto pair = to_part_frame(wl, wv);
    if (!pair) return {};
    const PartSource<Measured> used = part_source(table.band().part, pair->part);
    if (!used.brdf) return {};
    return used.is_exchanged ? signed_value(*used.brdf, pair->wv, pair->wl)
                             : signed_value(*used.brdf, pair->wl, pair->wv);
}

Result<Done> choose_band(Measured& measured, std::string_view name) {
    std::vector<std::string> names;
    if (auto* table = std::get_if<BsdfTable>(&measured.table))
        for (std::size_t b = 0; b < table->bands.size(); ++b) {
            if (equal_ignoring_case(table->bands[b].name, name)) {
                table->chosen = b;
                return Done{};
            }
            names.push_back(table->bands[b].name);
        }
    return argument_error(measured.source, "band of wavelengths",
                          names.empty() ? "a measurement in bands" : fmt::format("{}", fmt::join(names, " or ")),
                          std::string(name));
}

}  // namespace
