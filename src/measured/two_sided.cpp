// Measurements of reflection and transmission.
#include "measured/two_sided.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "brdf/directions.h"
#include "brdf/parts.h"
#include "measured/tables.h"

namespace srbf {

namespace {

/// Shares of a ring, and of the front and the back, are one if they differ by no more than this or by so much of their mean: as
/// near as a fit is to a sum.
constexpr float k_same_share = 0.01f, k_same_beam = 0.001f;
bool alike(float a, float b) { return std::abs(a - b) <= std::max(k_same_share * 0.5f * (a + b), k_same_beam); }

}  // namespace

bool are_same_share(const Rgb& a, const Rgb& b) { return alike(a.r, b.r) && alike(a.g, b.g) && alike(a.b, b.b); }

Rgb mean_share(std::span<const Rgb> values) {
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
            const Rgb a = front.share[means.size()], b = share_at(back, mirror(wl));
            if (!are_same_share(a, b)) return;
            means.push_back(mean_share(std::array{a, b}));
        }
    front.share = std::move(means);
    back = {};
}

Rgb signed_value(const BsdfTable& table, Vec3f wl, Vec3f wv) {
    const auto at = to_part_frame(wl, wv);
    if (!at) return {};
    const Answering<Measured> of = answering(table.band().part, at->part);
    if (!of.brdf) return {};
    return of.exchanged ? signed_value(*of.brdf, at->wv, at->wl) : signed_value(*of.brdf, at->wl, at->wv);
}

Result<Done> choose_band(Measured& measured, std::string_view name) {
    const auto lower = [](std::string_view text) {
        std::string copy(text);
        for (char& c : copy) c = char(std::tolower(static_cast<unsigned char>(c)));
        return copy;
    };
    std::vector<std::string> names;
    if (auto* table = std::get_if<BsdfTable>(&measured.table))
        for (std::size_t b = 0; b < table->bands.size(); ++b) {
            if (lower(table->bands[b].name) == lower(name)) {
                table->chosen = b;
                return Done{};
            }
            names.push_back(table->bands[b].name);
        }
    return Error{
        measured.source,       {},
        "band of wavelengths", names.empty() ? "a measurement in bands" : fmt::format("{}", fmt::join(names, " or ")),
        std::string(name),     ErrorCode::argument};
}

}  // namespace srbf
