// Reads rows of numbers in named columns: CSV, text of spreadsheets and instruments, and the option --columns.
#include <fmt/ranges.h>

#include <algorithm>
#include <deque>

#include "base/floating_point.h"
#include "brdf/parts.h"
#include "measured/formats/columns.h"
#include "measured/formats/format_rows.h"
#include "measured/readers.h"
#include "measured/samples.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {

namespace {

/// A comment that `srbf` writes and reads.
constexpr std::string_view k_both_sides = "# both sides";

/// Reads whether a comment calls the samples isotropic or anisotropic; no value if it does neither.
std::optional<bool> isotropy_in(std::string_view comment) {
    const bool isotropic = equal_ignoring_case(comment, "isotropic");
    return isotropic || equal_ignoring_case(comment, "anisotropic") ? std::optional(isotropic) : std::nullopt;
}

/// Separators, in the order in which they are tried.
constexpr char k_separators[] = {';', '\t', ',', ' ', k_any_separator};

/// Finds the separator that splits a line into names of columns.
std::optional<char> header_separator(std::string_view line) {
    constexpr std::size_t longest = 100000;
    std::vector<std::string_view> fields;
    for (const char separator : k_separators) {
        if (line.find(separator) == line.npos) continue;
        split_row(line.substr(0, longest), separator, fields);
        if (are_names_of_columns(fields)) return separator;
    }
    return {};
}

/// True if a line begins with two numbers.
bool is_row(std::string_view line) {
    for (int i = 0; i < 2; ++i)
        if (!number_in<double>(next_word(line, " \t,;"))) return false;
    return true;
}

/// The text of a comment, empty for a row without fields; no value for any other line.
std::optional<std::string_view> comment_in(std::string_view line) {
    if (line.find_first_not_of(",; \t") == line.npos) return std::string_view();
    if (!line.starts_with('#')) return {};
    line.remove_prefix(std::min(line.find_first_not_of('#'), line.size()));
    return trimmed(line);
}

/// The lines before the first row.
struct Preamble {
    std::string_view header;           ///< names of columns; empty if there are none
    char separator = k_any_separator;  ///< the separator of the header
    std::uint64_t line = 0;            ///< the line of the header
    Lines rows;
    std::vector<std::string_view> lines;  ///< comments and other text before the header
    bool both_sides = false;
    std::optional<bool> isotropic = {};
};

/// True if a row has as many fields as a header in a comment has names.
bool has_as_many_fields(std::string_view row, const Preamble& preamble) {
    std::vector<std::string_view> names, fields;
    split_row(preamble.header, preamble.separator, names);
    return std::ranges::any_of(k_separators, [&](char separator) {
        split_row(row, separator, fields);
        return fields.size() == names.size();
    });
}

/// If `has_names`, the option --columns names columns, and no line is a header.
Preamble read_preamble(std::string_view text, bool has_names) {
    constexpr int max_metadata = 200;
    Lines lines(text);
    Preamble preamble{{}, k_any_separator, 0, lines, {}};
    const auto set_header = [&](std::string_view header, char separator) {
        preamble.header = header;
        preamble.separator = separator;
        preamble.line = lines.number();
    };
    int metadata = 0;
    for (auto line = lines.next(); line; preamble.rows = lines, line = lines.next()) {
        const auto comment = comment_in(*line);
        std::string_view content = comment.value_or(*line);
        if (constexpr std::string_view format = "format:"; content.starts_with(format))  // pab's goniophotometers
            content = trimmed(content.substr(format.size()));
        const bool both_sides = comment && equal_ignoring_case(content, k_both_sides.substr(2));
        const auto isotropic = comment ? isotropy_in(content) : std::nullopt;
        preamble.both_sides |= both_sides;
        if (isotropic) preamble.isotropic = isotropic;
        if (both_sides || isotropic) continue;
        if (!comment && (has_names || !preamble.header.empty()) && is_row(*line)) {
            if (!has_names && !has_as_many_fields(*line, preamble)) preamble.header = {};
            break;
        }
        if (const auto separator = has_names ? std::nullopt : header_separator(content)) {
            set_header(content, *separator);
            if (comment) continue;
            preamble.rows = lines;
            break;
        }
        if (!comment && (is_row(*line) || ++metadata > max_metadata)) break;
        if (!content.empty() && preamble.lines.size() < max_metadata) preamble.lines.push_back(content.substr(0, 300));
    }
    return preamble;
}

/// Finds the separator that splits the first row into as many fields as columns, with numbers in those that are read.
char row_separator(Lines rows, const Columns& columns, char preferred) {
    auto line = rows.next();
    while (line && comment_in(*line)) line = rows.next();
    std::vector<std::string_view> fields;
    std::vector<char> separators{preferred};
    separators.insert(separators.end(), std::begin(k_separators), std::end(k_separators));
    for (const char separator : separators) {
        split_row(line.value_or(std::string_view()), separator, fields);
        const auto is_number = [&](std::size_t column) {
            return column == k_absent || number_in<double>(fields[column]).has_value();
        };
        const auto is_value = [&](std::size_t column) { return fields[column].empty() || is_number(column); };
        if (fields.size() == columns.count && std::ranges::all_of(columns.value, is_value) &&
            (columns.has_vectors ? std::ranges::all_of(columns.vector, is_number)
                                 : std::ranges::all_of(columns.angle, is_number, &AngleColumn::column)))
            return separator;
    }
    return preferred;
}

struct Table {
    Columns columns;
    Lines rows;
    char separator;
    std::string description;
    std::optional<bool> isotropic;
};

/// Bounds of the angles of all rows, in the unit of the file.
struct PolarAngles {
    double min_light = 0, max_light = 0;  ///< bounds of θ_l
    double nearest_light = 1e300;         ///< the smallest |θ_l|
    double largest_phi = 0;               ///< the largest |φ_l|
    double largest = 0;                   ///< the largest |θ_l| or |θ_v|
};
PolarAngles polar_angles(const Table& table, const std::string& file_name) {
    PolarAngles all;
    NumberRow row(table.columns.count, file_name);
    for (Lines rows = table.rows; auto line = rows.next();) {
        if (comment_in(*line)) continue;
        row.read(*line, rows.number(), table.separator);
        for (const std::size_t a : {std::size_t(0), std::size_t(2)}) {
            const AngleColumn& angle = table.columns.angle[a];
            const double theta = angle.column == k_absent ? angle.constant : row.number<double>(angle.column);
            if (row.error()) return all;
            if (a == 0) all.min_light = std::min(all.min_light, theta), all.max_light = std::max(all.max_light, theta);
            all.largest = std::max(all.largest, std::abs(theta));
            if (a == 0) all.nearest_light = std::min(all.nearest_light, std::abs(theta));
        }
        if (const std::size_t phi = table.columns.angle[k_phi_l].column; phi != k_absent)
            all.largest_phi = std::max(all.largest_phi, std::abs(row.number<double>(phi)));
    }
    return all;
}

/// Infers from the rows what names do not state: the unit of angles, and azimuths of a scan in the plane of incidence.
std::optional<Error> infer_angles(Table& table, const std::string& file_name, std::uint64_t line) {
    Columns& columns = table.columns;
    auto& angle = columns.angle;
    const auto lacks_unit = [](const AngleColumn& column) { return column.exists() && !column.unit; };
    columns.in_plane = !columns.has_vectors && !columns.both && columns.geometry.empty() &&
                       std::ranges::none_of(std::array{k_phi_l, k_phi_v, k_phase, k_aspecular},
                                            [&](std::size_t a) { return angle[a].exists(); });
    const bool guesses_unit = !columns.has_vectors && std::ranges::any_of(angle, lacks_unit);
    if (!guesses_unit && !columns.in_plane) return {};
    const PolarAngles polar = polar_angles(table, file_name);
    if (guesses_unit) {
        const auto stated = std::ranges::find_if(angle, [](const auto& column) { return column.unit.has_value(); });
        constexpr double min_radians = 0.5, rounding = 1e-3;
        std::optional<AngleUnit> unit;
        if (stated != angle.end())
            unit = stated->unit;
        else if (polar.largest > k_pi + rounding)
            unit = k_in_degrees;
        else if (polar.largest >= min_radians && polar.largest <= k_pi / 2 + rounding)
            unit = k_in_radians;
        if (!unit)
            return at_line(file_name, line, "header",
                           "angles with their unit, as theta_l_deg or theta_l_rad, here or in --columns",
                           fmt::format("{} without one, and polar angles up to {:g}",
                                       srbf::quoted(std::ranges::find_if(angle, lacks_unit)->name), polar.largest));
        for (AngleColumn& column : angle)
            if (lacks_unit(column)) column.unit = unit;
        columns.notes.push_back(fmt::format("angles are in {}, which their names do not state", unit->name));
        // If no light is above the horizon, theta and phi are exchanged.
        const double horizon = k_pi / 2 / unit->radians;
        if (angle[k_phi_l].exists() && polar.nearest_light > horizon && polar.largest_phi <= horizon) {
            std::swap(angle[k_theta_l], angle[k_phi_l]);
            std::swap(angle[k_theta_v], angle[k_phi_v]);
            columns.notes.push_back(fmt::format("{} and {} are polar angles, {} and {} azimuths", angle[k_theta_l].name,
                                                angle[k_theta_v].name, angle[k_phi_l].name, angle[k_phi_v].name));
        }
    }
    if (columns.in_plane) {
        if (polar.min_light < 0 && polar.max_light > 0)
            return at_line(file_name, line, "header", "azimuths, as columns or as phi_l_deg=0,phi_v_deg=0 in --columns",
                           fmt::format("none, and lights on either side of the normal, from {:g} to {:g}",
                                       polar.min_light, polar.max_light));
        columns.notes.push_back(
            fmt::format("a scan in the plane of incidence, {} > 0 on the mirror side; --columns with "
                        "phi_l_deg=0,phi_v_deg=0 puts it on the side of the light",
                        angle[k_theta_v].name));
    }
    return {};
}

/// Returns an error if `assign_columns` or `infer_angles` does.
Result<Table> open_table(std::string_view text, const std::string& file_name, const std::string& option) {
    std::vector<std::string_view> names, constants;
    for (std::string_view rest = option, name = next_word(rest, " ,"); !name.empty(); name = next_word(rest, " ,"))
        (name.find('=') == name.npos ? names : constants).push_back(name);
    const bool has_names = !names.empty();
    Preamble preamble = read_preamble(text, has_names);
    if (!has_names && preamble.header.empty()) {
        const auto found = preamble.rows.next();
        return at_line(file_name, std::max<std::uint64_t>(preamble.rows.number(), 1), "header", "names of columns",
                       found ? quoted(*found) : "an empty file");
    }
    std::deque<std::string> names_with_units;
    if (!has_names) {
        split_row(preamble.header, preamble.separator, names);
        std::vector<std::string_view> units;
        Lines rows = preamble.rows;
        if (const auto row = rows.next()) split_row(*row, preamble.separator, units);
        if (units.size() <= names.size() && are_units(units)) {  // `Lines` trims empty fields
            preamble.rows = rows;
            for (std::size_t i = 0; i < units.size(); ++i)
                if (!units[i].empty())
                    names[i] = names_with_units.emplace_back(fmt::format("{} ({})", names[i], units[i]));
        }
    }
    auto columns = assign_columns(names, constants, preamble.lines, file_name, preamble.line);
    if (!columns) {
        Error error = columns.error();
        if (!option.empty()) error.what = "--columns", error.code = ErrorCode::argument;
        return error;
    }
    Table table{*std::move(columns), preamble.rows, k_any_separator,
                fmt::format("{:.2000}", fmt::format("{}", fmt::join(preamble.lines, k_line_end))), preamble.isotropic};
    table.separator = row_separator(table.rows, table.columns, preamble.separator);
    if (auto error = infer_angles(table, file_name, preamble.line)) return *std::move(error);
    return table;
}

struct Directions {
    Vec3d wl, wv;
};

/// Tolerance of the length of a direction, which may be printed with two digits.
constexpr double k_length_rounding = 0.01;

Directions directions_in(NumberRow& row, const Columns& columns) {
    if (!columns.has_vectors) {
        std::array<double, std::tuple_size_v<decltype(columns.angle)>> angle{};
        for (std::size_t a = 0; a < angle.size(); ++a) {
            const AngleColumn& column = columns.angle[a];
            const AngleUnit unit = column.unit_or_degrees();
            angle[a] = column.column == k_absent ? column.constant * unit.radians
                                                 : row.angle(column.column, column.name, kind_of_angle(a), unit);
        }
        if (columns.in_plane || !columns.angle[k_theta_v].exists()) {
            angle[k_theta_l] = std::abs(angle[k_theta_l]);
            angle[k_phi_l] = k_pi;
        }
        if (!columns.angle[k_theta_v].exists()) angle[k_theta_v] = angle[k_theta_l] - angle[k_aspecular];
        if (columns.both) angle[k_phi_v] = angle[k_phi_l];
        if (columns.angle[k_phase].exists() && !columns.angle[k_phi_v].exists()) {  // spherical law of cosines
            const Vec3d l = spherical(angle[k_theta_l], 0.0), v = spherical(angle[k_theta_v], 0.0);
            const double cosine = (elementary::cos(angle[k_phase]) - l.z * v.z) / std::max(l.x * v.x, 1e-9);
            angle[k_phi_v] = angle[k_phi_l] + elementary::acos(std::clamp(cosine, -1.0, 1.0));
        }
        return {spherical(angle[k_theta_l], angle[k_phi_l]), spherical(angle[k_theta_v], angle[k_phi_v])};
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

/// The samples of a file. A two-sided file has samples of each part, in its frame; others have one part, the first.
struct CollectedSamples {
    std::array<std::optional<SampleBuilder>, k_parts> part;
    std::vector<SpectralRow> rows;  ///< rows of a table with a row for each wavelength, which has no `part`
    std::optional<bool> isotropic;  ///< whether the samples are isotropic, if the file states it
    Columns columns;
    std::string description;
};

/// True if the rows of grey values have several wavelengths.
bool is_long(const Table& table, const std::string& file_name) {
    const std::size_t column = table.columns.wavelength;
    if (column == k_absent || table.columns.values != Values::grey) return false;
    NumberRow row(table.columns.count, file_name);
    std::optional<double> first;
    for (Lines rows = table.rows; auto line = rows.next();) {
        if (comment_in(*line)) continue;
        row.read(*line, rows.number(), table.separator);
        const double nm = row.number<double>(column);
        if (row.error() || (first && nm != *first)) return !row.error();
        first = nm;
    }
    return false;
}

SpectralRow spectral_row(const Vec3d& wl, const Vec3d& wv, double nm, float f) {
    const auto theta = [](const Vec3d& w) { return float(elementary::atan2(elementary::hypot(w.x, w.y), w.z)); };
    const auto phi = [](const Vec3d& w) { return float(elementary::atan2(w.y, w.x)); };
    return {theta(wl), phi(wl), theta(wv), phi(wv), float(nm), f, 1};
}

Result<CollectedSamples> collect(std::span<const std::byte> bytes, const std::string& file_name,
                                 const std::string& option, bool both_sides) {
    auto table = open_table(as_text(bytes), file_name, option);
    if (!table) return table.error();
    const bool are_rows = !both_sides && is_long(*table, file_name);
    CollectedSamples collected{{}, {}, table->isotropic, std::move(table->columns), std::move(table->description)};
    const Columns& columns = collected.columns;
    NumberRow row(columns.count, file_name);
    for (auto& builder : std::span(collected.part).first(both_sides ? k_parts : 1))
        builder.emplace(columns.values, columns.wavelengths, bytes.size(),
                        lines_of(bytes) * std::max<std::size_t>(columns.geometry.size(), 1));
    std::vector<float> f(columns.value.size());
    std::optional<double> wavelength;
    double lowest = 1;  // the least cosine of a direction
    const auto add = [&](const Vec3d& wl, const Vec3d& wv, std::span<const float> values) {
        lowest = std::min({lowest, wl.z, wv.z});
        const auto part = both_sides ? to_part_frame(to_float(wl), to_float(wv)) : std::nullopt;
        if (are_rows && std::isfinite(*wavelength) && std::isfinite(wl.z) && std::isfinite(wv.z))
            collected.rows.push_back(spectral_row(wl, wv, *wavelength, values[0]));
        else if (part)
            collected.part[std::size_t(part->part)]->add({wl.x, wl.y, std::abs(wl.z)}, {wv.x, wv.y, std::abs(wv.z)},
                                                         values);
        else
            collected.part[0]->add(wl, wv, values);
    };
    for (Lines& lines = table->rows; const auto line = lines.next();) {
        if (const auto comment = comment_in(*line)) {
            if (const auto isotropic = isotropy_in(*comment)) collected.isotropic = isotropic;
            continue;
        }
        row.read(*line, lines.number(), table->separator);
        const auto [wl, wv] = directions_in(row, columns);
        for (std::size_t v = 0; v < f.size(); ++v) f[v] = float(row.value(columns.value[v]));
        if (columns.wavelength != k_absent && columns.values != Values::spectrum) {
            constexpr double max_micrometres = 50;
            double nm = row.number<double>(columns.wavelength, "wavelength");
            if (nm < max_micrometres) nm *= 1000;
            if (wavelength && *wavelength != nm && !are_rows)
                row.fail("wavelength", "one in all rows, or one value in a row, or a column for each as 532nm",
                         fmt::format("{:g} and {:g}", *wavelength, nm));
            wavelength = nm;
        }
        if (row.error()) return *row.error();
        if (columns.geometry.empty()) add(wl, wv, f);
        for (std::size_t v = 0; v < columns.geometry.size(); ++v) {
            const auto [light, aspecular] = columns.geometry[v];
            add(spherical(light * k_degree, k_pi), spherical((light - aspecular) * k_degree, 0.0), std::span(&f[v], 1));
        }
    }
    auto& notes = collected.columns.notes;
    if (row.has_decimal_commas()) notes.push_back("numbers have a decimal comma");
    const double polar = elementary::acos(std::clamp(lowest, -1.0, 1.0)) / k_degree;
    if (columns.angle[k_theta_l].exists() && columns.angle[k_theta_l].unit_or_degrees().name == k_in_degrees.name &&
        polar > 0.5 && polar < 1.6)
        notes.push_back(fmt::format("all polar angles are within {:.3g} degrees: radians?", polar));
    return collected;
}

/// If `quantity` is `stated`, converts the values from the quantity that the names state.
Result<ScatteredSamples> finish(SampleBuilder&& builder, CollectedSamples& collected, std::size_t bytes,
                                const std::string& file_name, Quantity quantity) {
    const bool isotropic = collected.isotropic.value_or(false);
    auto samples = collected.rows.empty()
                       ? std::move(builder).finish(file_name, collected.description, isotropic)
                       : samples_of_rows(collected.rows, bytes, file_name, collected.description, isotropic);
    if (!samples) return samples;
    if (collected.isotropic) samples->isotropic = isotropic;
    const Columns& columns = collected.columns;
    to_bsdf(*samples, quantity == Quantity::stated ? columns.quantity : Quantity::bsdf, columns.unit);
    if (!columns.notes.empty())
        samples->notes.insert(samples->notes.begin(), fmt::format("{}", fmt::join(columns.notes, "; ")));
    return samples;
}

bool is_csv(std::string_view text) {
    return !text.starts_with('{') && !text.starts_with('<') && !read_preamble(text, false).header.empty();
}

Result<Measured> read_any_csv(std::span<const std::byte> bytes, const std::string& file_name,
                              const ReadOptions& options) {
    if (!read_preamble(as_text(bytes), false).both_sides) return measurement_of(read_csv(bytes, file_name, options));
    const StandardArithmetic mode;
    auto collected = collect(bytes, file_name, {}, true);
    if (!collected) return collected.error();
    BsdfTable table{{{}}, 0, {}};
    bool any = false;
    for (std::size_t p = 0; p < k_parts; ++p) any = any || !collected->part[p]->empty();
    for (std::size_t p = 0; p < k_parts; ++p) {
        if (any && collected->part[p]->empty()) continue;
        auto samples = build_index(finish(*std::move(collected->part[p]), *collected, bytes.size(), file_name, {}));
        if (!samples) return samples.error();
        Measured part{file_name, "CSV", 0, *std::move(samples)};
        table.bands[0].part[p] = std::make_shared<const Measured>(std::move(part));
    }
    return Measured{{}, {}, 0, std::move(table)};
}

}  // namespace

Result<ScatteredSamples> read_csv(std::span<const std::byte> bytes, const std::string& file_name,
                                  const ReadOptions& options) {
    auto collected = collect(bytes, file_name, options.columns, false);
    if (!collected) return collected.error();
    return finish(*std::move(collected->part[0]), *collected, bytes.size(), file_name, options.quantity);
}

const Format k_csv_format{.name = "CSV",
                          .is_text = true,
                          .recognise = in_text<is_csv>,
                          .read = read_any_csv,
                          .extension = ".csv",
                          .anisotropic = true,
                          .write = write_as_csv};

}  // namespace
