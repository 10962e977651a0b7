#include "app/pairs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "srbf/text.h"

namespace srbf {

Result<Pairs> read_pairs(std::string_view csv, const std::string& file_name) {
    Pairs pairs;
    std::array<std::size_t, 6> column{};
    std::vector<std::string_view> fields;
    bool has_header = false;
    Lines lines(csv);
    while (const auto line = lines.next()) {
        split_fields(*line, fields);
        if (!has_header) {
            has_header = true;
            for (std::size_t c = 0; c < 6; ++c) {
                const auto found = std::find(fields.begin(), fields.end(), k_pair_columns[c]);
                if (found == fields.end())
                    return at_line(file_name, lines.number(), "header", fmt::format("a column {}", k_pair_columns[c]),
                                   "none");
                column[c] = std::size_t(found - fields.begin());
            }
            continue;
        }
        std::array<std::string, 6> text;
        std::array<double, 6> number{};
        for (std::size_t c = 0; c < 6; ++c) {
            const std::string_view field = column[c] < fields.size() ? fields[column[c]] : std::string_view();
            const auto parsed = to_number<double>(field);
            if (!parsed || !std::isfinite(*parsed))
                return at_line(file_name, lines.number(), fmt::format("column {}", k_pair_columns[c]), "a number",
                               quoted(field));
            number[c] = *parsed;
            text[c] = field;
        }
        const auto direction = [&](std::size_t c) { return Vec3d{number[c], number[c + 1], number[c + 2]}; };
        for (const std::size_t c : {std::size_t(0), std::size_t(3)}) {
            const double length = std::sqrt(dot(direction(c), direction(c)));
            if (!(std::abs(length - 1) <= 0.01))
                return at_line(file_name, lines.number(), fmt::format("direction {}", k_pair_columns[c].substr(0, 2)),
                               "length 1", fmt::format("{:.6g}", length));
        }
        const Vec3d wl = normalize(direction(0)), wv = normalize(direction(3));
        pairs.wl.push_back({float(wl.x), float(wl.y), float(wl.z)});
        pairs.wv.push_back({float(wv.x), float(wv.y), float(wv.z)});
        pairs.text.push_back(std::move(text));
    }
    if (!has_header) return at_line(file_name, 1, "header", "columns wl_x to wv_z", "an empty file");
    return pairs;
}

}  // namespace srbf
