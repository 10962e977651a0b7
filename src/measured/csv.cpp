#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "measured/samples.h"
#include "srbf/elementary.h"

namespace srbf {

namespace {

constexpr std::array<std::string_view, 6> k_vectors{"wl_x", "wl_y", "wl_z", "wv_x", "wv_y", "wv_z"};
constexpr std::array<std::string_view, 4> k_angles{"theta_l", "phi_l", "theta_v", "phi_v"};

std::string lower(std::string_view text) {
    std::string copy(text.substr(0, 100));
    for (char& c : copy) c = char(std::tolower(static_cast<unsigned char>(c)));
    return copy;
}

/// The wavelength in the name of a column: "450nm", "nm450", "450.5nm".
std::optional<float> wavelength_of(std::string_view name) {
    if (name.starts_with("nm"))
        name.remove_prefix(2);
    else if (name.ends_with("nm"))
        name.remove_suffix(2);
    else
        return {};
    return to_number<float>(trimmed(name));
}

/// Positions of the columns that a header names.
struct Columns {
    std::array<std::size_t, 6> vector{};
    std::array<std::size_t, 4> angle{};
    bool has_vectors = false;
    double unit = 1;  ///< unit of the angles [rad]
    Values values = Values::grey;
    std::vector<std::size_t> value;
    std::vector<float> wavelengths;
    std::size_t count = 0;
};

Result<Columns> columns_of(std::span<const std::string_view> header, const std::string& file_name, std::uint64_t line) {
    const auto wrong = [&](std::string expected, std::string found) {
        return at_line(file_name, line, "header", std::move(expected), std::move(found));
    };
    if (header.size() > k_most_columns)
        return wrong(fmt::format("at most {} columns", k_most_columns), fmt::format("{}", header.size()));
    Columns columns;
    columns.count = header.size();
    std::vector<std::string> names;
    for (const std::string_view name : header) names.push_back(lower(name));
    const auto place = [&](std::string_view name) {
        const auto at = std::ranges::find(names, name);
        return at == names.end() ? k_absent : std::size_t(at - names.begin());
    };

    for (std::size_t c = 0; c < 6; ++c) columns.vector[c] = place(k_vectors[c]);
    columns.has_vectors = std::ranges::find(columns.vector, k_absent) == columns.vector.end();
    if (!columns.has_vectors) {
        for (const auto& [suffix, unit] : {std::pair("_deg", k_degree), {"_rad", 1.0}}) {
            for (std::size_t a = 0; a < 4; ++a) columns.angle[a] = place(std::string(k_angles[a]) + suffix);
            columns.unit = unit;
            if (columns.angle[0] != k_absent) break;
        }
        if (columns.angle[0] == k_absent && place("theta_l") != k_absent)
            return wrong("angles with their unit, as theta_l_deg or theta_l_rad", "theta_l without one");
        for (const std::size_t a : {std::size_t(0), std::size_t(2), std::size_t(3)})
            if (columns.angle[a] == k_absent)
                return wrong("columns wl_x to wv_z, or theta_l_deg, phi_l_deg, theta_v_deg, phi_v_deg (or _rad)",
                             fmt::format("no {}", columns.angle[0] == k_absent ? "such" : std::string(k_angles[a])));
    }

    const auto use = [&](Values values, std::initializer_list<std::string_view> wanted) {
        std::vector<std::size_t> found;
        for (const std::string_view name : wanted) found.push_back(place(name));
        if (std::ranges::find(found, k_absent) != found.end()) return false;
        columns.values = values;
        columns.value = std::move(found);
        return true;
    };
    if (use(Values::rgb, {"r", "g", "b"}) || use(Values::xyz, {"x", "y", "z"}) || use(Values::grey, {"value"}))
        return columns;
    for (std::size_t i = 0; i < names.size(); ++i)
        if (const auto nm = wavelength_of(names[i])) {
            columns.values = Values::spectrum;
            columns.value.push_back(i);
            columns.wavelengths.push_back(*nm);
        }
    if (columns.value.empty())
        return wrong("values in columns r,g,b or x,y,z or value, or a spectrum in columns as 450nm", "none of them");
    if (!are_wavelengths(columns.wavelengths))
        return wrong("columns of increasing wavelengths, from 100 nm up", "others");
    return columns;
}

}  // namespace

bool is_csv(std::string_view text) {
    std::vector<std::string_view> fields;
    for (Lines lines(text); auto line = lines.next();) {
        if (line->starts_with('#')) continue;
        split_fields(line->substr(0, 100000), fields);
        return std::ranges::any_of(fields, [](std::string_view field) {
            const std::string name = lower(field);
            return name == "wl_x" || name.starts_with("theta_l");
        });
    }
    return false;
}

bool is_csv_of_both_sides(std::string_view text) {
    constexpr std::string_view mark = "# both sides";
    for (Lines lines(text); auto line = lines.next();) {
        if (!line->starts_with('#')) return false;
        if (lower(trimmed(line->substr(1))) == mark.substr(2)) return true;
    }
    return false;
}

namespace {

/// The directions of a sample.
struct Directions {
    Vec3d wl, wv;
};

/// Tolerance of the length of a direction: it may be printed with two digits.
constexpr double k_length_rounding = 0.01;

Directions directions_in(NumberRow& row, const Columns& columns) {
    if (!columns.has_vectors) {
        std::array<double, 4> angle{};
        for (std::size_t a = 0; a < angle.size(); ++a)
            if (columns.angle[a] != k_absent) angle[a] = columns.unit * row.number<double>(columns.angle[a]);
        return {spherical(angle[0], angle[1]), spherical(angle[2], angle[3])};
    }
    std::array<double, 6> x{};
    for (std::size_t c = 0; c < x.size(); ++c) x[c] = row.number<double>(columns.vector[c]);
    const auto unit = [&](const char* what, const Vec3d& w) {
        const double length = std::sqrt(dot(w, w));
        if (!(std::abs(length - 1) <= k_length_rounding)) row.fail(what, "length 1", fmt::format("{:.6g}", length));
        return normalize(w);
    };
    const Vec3d wl = unit("direction wl", {x[0], x[1], x[2]}), wv = unit("direction wv", {x[3], x[4], x[5]});
    return {wl, wv};
}

/// Samples as they are read; of both sides for each part, in its frame.
struct Collected {
    std::array<std::optional<SampleBuilder>, k_parts> part;
    bool isotropic = false;
};

Result<Collected> collect(std::span<const std::byte> bytes, const std::string& file_name, bool both_sides) {
    Lines lines(as_text(bytes));
    std::optional<Columns> columns;
    std::optional<NumberRow> row;
    Collected collected;
    std::vector<float> f;
    bool is_isotropic = false;
    LightAzimuths azimuths;
    while (auto line = lines.next()) {
        if (line->starts_with('#')) {
            is_isotropic |= lower(trimmed(line->substr(1))) == "isotropic";
            continue;
        }
        if (!columns) {
            std::vector<std::string_view> header;
            split_fields(*line, header);
            auto named = columns_of(header, file_name, lines.number());
            if (!named) return named.error();
            columns = *std::move(named);
            row.emplace(columns->count, file_name);
            for (auto& builder : std::span(collected.part).first(both_sides ? k_parts : 1))
                builder.emplace(columns->values, columns->wavelengths, bytes.size(), lines_of(bytes));
            f.resize(collected.part[0]->width());
            continue;
        }
        row->read(*line, lines.number());
        const auto [wl, wv] = directions_in(*row, *columns);
        for (std::size_t v = 0; v < f.size(); ++v) f[v] = float(row->number<double>(columns->value[v]));
        if (row->error()) return *row->error();
        azimuths.add(wl);
        const auto part = both_sides ? folded(to_float(wl), to_float(wv)) : std::nullopt;
        if (part)
            collected.part[std::size_t(part->part)]->add({wl.x, wl.y, std::abs(wl.z)}, {wv.x, wv.y, std::abs(wv.z)}, f);
        else
            collected.part[0]->add(wl, wv, f);  // where it is masked, if it is not above the horizon
    }
    if (!collected.part[0])
        return at_line(file_name, std::max<std::uint64_t>(lines.number(), 1), "header", "names of columns",
                       "an empty file");
    collected.isotropic = is_isotropic || azimuths.are_one();
    return collected;
}

}  // namespace

Result<ScatteredSamples> read_columns(std::span<const std::byte> bytes, const std::string& file_name,
                                      const std::string& names) {
    std::vector<std::string_view> header;
    for (std::string_view rest = names, name = next_word(rest, " ,"); !name.empty(); name = next_word(rest, " ,"))
        header.push_back(name);
    auto columns = columns_of(header, file_name, 0);
    if (!columns) {
        Error error = columns.error();
        error.what = "--columns", error.code = ErrorCode::argument;
        return error;
    }
    Lines lines(as_text(bytes));
    NumberRow row(columns->count, file_name);
    SampleBuilder builder(columns->values, columns->wavelengths, bytes.size(), lines_of(bytes));
    std::vector<float> f(builder.width());
    std::string description;
    LightAzimuths azimuths;
    while (auto line = lines.next()) {
        if (line->starts_with('#')) {
            const std::string_view comment = trimmed(line->substr(1));
            if (description.size() < 300 && !comment.empty())
                description += (description.empty() ? "" : " ") + std::string(comment);
            continue;
        }
        row.read_words(*line, lines.number());
        const Directions at = directions_in(row, *columns);
        for (std::size_t v = 0; v < f.size(); ++v) f[v] = float(row.number<double>(columns->value[v]));
        if (row.error()) return *row.error();
        azimuths.add(at.wl);
        builder.add(at.wl, at.wv, f);
    }
    return std::move(builder).finish(file_name, description.substr(0, 300), azimuths.are_one());
}

Result<ScatteredSamples> read_csv_samples(std::span<const std::byte> bytes, const std::string& file_name) {
    auto collected = collect(bytes, file_name, false);
    if (!collected) return collected.error();
    return std::move(*collected->part[0]).finish(file_name, {}, collected->isotropic);
}

Result<BsdfTable> read_csv_of_both_sides(std::span<const std::byte> bytes, const std::string& file_name) {
    auto collected = collect(bytes, file_name, true);
    if (!collected) return collected.error();
    BsdfTable table{{{}}, 0, {}};
    bool any = false;
    for (std::size_t p = 0; p < k_parts; ++p) any = any || !collected->part[p]->empty();
    for (std::size_t p = 0; p < k_parts; ++p) {
        if (any && collected->part[p]->empty()) continue;
        auto samples = indexed(std::move(*collected->part[p]).finish(file_name, {}, collected->isotropic));
        if (!samples) return samples.error();
        Measured part{file_name, "CSV", 0, *std::move(samples)};
        table.bands[0].part[p] = std::make_shared<const Measured>(std::move(part));
    }
    return table;
}

Result<ScatteredSamples> read_csv(std::span<const std::byte> bytes, const std::string& file_name) {
    return indexed(read_csv_samples(bytes, file_name));
}

}  // namespace srbf
