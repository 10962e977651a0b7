// Measurements of both sides.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "srbf/measured.h"

namespace srbf {

Rgb value(const BsdfTable& table, Vec3f wl, Vec3f wv) { return value(table.band().part, wl, wv); }

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
