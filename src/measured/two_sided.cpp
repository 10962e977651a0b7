#include "measured/two_sided.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.h"
#include "brdf/directions.h"
#include "brdf/parts.h"
#include "measured/tables.h"

namespace SRBF_NAMESPACE {

namespace {

bool is_same_share(float a, float b) {
    constexpr float k_relative = 0.01f, k_absolute = 0.001f;
    return std::abs(a - b) <= std::max(k_relative * 0.5f * (a + b), k_absolute);
}

}  // namespace

bool are_same_share(const Rgb& a, const Rgb& b) {
    return is_same_share(a.r, b.r) && is_same_share(a.g, b.g) && is_same_share(a.b, b.b);
}

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
    const auto pair = to_part_frame(wl, wv);
    if (!pair) return {};
    const Answering<Measured> answer = answering(table.band().part, pair->part);
    if (!answer.brdf) return {};
    return answer.exchanged ? signed_value(*answer.brdf, pair->wv, pair->wl)
                            : signed_value(*answer.brdf, pair->wl, pair->wv);
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
    return Error{
        measured.source,       {},
        "band of wavelengths", names.empty() ? "a measurement in bands" : fmt::format("{}", fmt::join(names, " or ")),
        std::string(name),     ErrorCode::argument};
}

}  // namespace srbf
