#include "measured/formats/columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

namespace srbf {

namespace {

/// The name of a column for comparison: letters and digits in lower case, without text in brackets and without the
/// unit.
struct ColumnName {
    std::string key;
    std::optional<AngleUnit> unit;
};

std::optional<AngleUnit> unit_in(std::string_view text) {
    if (text.find("deg") != text.npos) return k_in_degrees;
    if (text.find("rad") != text.npos) return k_in_radians;
    return {};
}

ColumnName column_name(std::string_view text) {
    constexpr std::pair<std::string_view, std::string_view> letters[] = {
        {"θ", "theta"}, {"Θ", "theta"}, {"ϑ", "theta"}, {"φ", "phi"}, {"Φ", "phi"}, {"ϕ", "phi"}, {"°", "deg"}};
    std::string keys;
    for (text = text.substr(0, 100); !text.empty();) {
        const auto letter =
            std::ranges::find_if(letters, [&](const auto& entry) { return text.starts_with(entry.first); });
        if (letter != std::end(letters)) keys += letter->second;
        if (letter == std::end(letters)) keys += char(std::tolower(static_cast<unsigned char>(text[0])));
        text.remove_prefix(letter == std::end(letters) ? 1 : letter->first.size());
    }
    const std::size_t bracket = std::min(keys.find_first_of("([{"), keys.size());
    ColumnName name{{}, unit_in(std::string_view(keys).substr(bracket))};
    for (const char c : keys.substr(0, bracket))
        if (std::isalnum(static_cast<unsigned char>(c))) name.key += c;
    for (const std::string_view unit : {"degrees", "degree", "deg", "radians", "radian", "rad"})
        if (name.key.size() > unit.size() && name.key.ends_with(unit)) {
            name.key.resize(name.key.size() - unit.size());
            if (!name.unit) name.unit = unit_in(unit);
            break;
        }
    for (const std::string_view unit : {"1sr", "sr1"})  // units of BRDF values
        if (name.key.size() > unit.size() && name.key.ends_with(unit)) name.key.resize(name.key.size() - unit.size());
    return name;
}

/// Returns 0 for a word that names the light, 1 for the viewer.
std::optional<std::size_t> role_of(std::string_view word) {
    constexpr std::string_view lights[] = {"l",        "i",     "in",     "inc",          "incident", "incidence",
                                           "incoming", "light", "source", "illumination", "lamp"};
    constexpr std::string_view viewers[] = {
        "v",    "o",       "out",       "outgoing",   "r",      "refl",     "reflected", "s",        "sc",
        "scat", "scatter", "scattered", "scattering", "view",   "viewer",   "viewing",   "observer", "observation",
        "e",    "exit",    "det",       "detector",   "sensor", "receiver", "measure",   "measured", "measurement"};
    if (std::ranges::find(lights, word) != std::end(lights)) return 0;
    if (std::ranges::find(viewers, word) != std::end(viewers)) return 1;
    return {};
}

/// True for names of the viewer's azimuth relative to the light.
bool is_relative_azimuth(std::string_view key) {
    constexpr std::string_view names[] = {
        "phi", "dphi", "deltaphi", "phirel", "relphi", "azimuth", "relazimuth", "relativeazimuth", "azimuthdifference",
        "raa"};
    return std::ranges::find(names, key) != std::end(names);
}

/// Returns the index of a named angle among θ_l, φ_l, θ_v, φ_v.
std::optional<std::size_t> angle_named(std::string_view key) {
    constexpr std::pair<std::string_view, std::size_t> angles[] = {
        {"theta", 0}, {"polarangle", 0},   {"zenithangle", 0}, {"polar", 0},   {"zenith", 0}, {"angle", 0},
        {"phi", 1},   {"azimuthangle", 1}, {"azimuthal", 1},   {"azimuth", 1}, {"azim", 1}};
    constexpr std::pair<std::string_view, std::size_t> whole[] = {
        {"aoi", 0}, {"angleofincidence", 0}, {"sza", 0}, {"saa", 1}, {"vza", 2}, {"vaa", 3}};
    for (const auto& [name, index] : whole)
        if (key == name) return index;
    if (key == "angles") return {};
    if (is_relative_azimuth(key)) return 3;
    for (const auto& [angle, index] : angles) {
        if (key.starts_with(angle))
            if (const auto role = role_of(key.substr(angle.size()))) return 2 * *role + index;
        if (key.ends_with(angle))
            if (const auto role = role_of(key.substr(0, key.size() - angle.size()))) return 2 * *role + index;
    }
    return {};
}

/// Returns the index of a named component (wl_x, wi_x, light_x) among those of wl and wv.
std::optional<std::size_t> component_of(std::string_view key) {
    if (key.size() < 2 || key.back() < 'x' || key.back() > 'z') return {};
    const std::size_t axis = std::size_t(key.back() - 'x');
    key.remove_suffix(1);
    auto role = role_of(key);
    if (!role && key.starts_with('w')) role = role_of(key.substr(1));
    return role ? std::optional(3 * *role + axis) : std::nullopt;
}

/// The wavelength in the name of a column: "450nm", "nm450", "450.5 nm", "brdf_450nm".
std::optional<float> wavelength_of(std::string_view name) {
    std::string lower(name.substr(0, 100));
    for (char& c : lower) c = char(std::tolower(static_cast<unsigned char>(c)));
    std::string_view text = trimmed(lower);
    if (text.starts_with("nm")) return to_number<float>(trimmed(text.substr(2)));
    if (!text.ends_with("nm")) return {};
    text = trimmed(text.substr(0, text.size() - 2));
    const auto before = text.find_last_not_of("0123456789.");
    const std::string key = column_name(text.substr(0, before == text.npos ? 0 : before + 1)).key;
    for (const std::string_view known : {"", "brdf", "bsdf", "btdf", "f", "fr", "value"})
        if (key == known) return to_number<float>(before == text.npos ? text : text.substr(before + 1));
    return {};
}

struct ValueNames {
    Values values;
    Quantity quantity;
    std::vector<std::string_view> keys;
};
/// The names of values, in order of preference.
const std::vector<ValueNames>& names_of_values() {
    static const std::vector<ValueNames> names = [] {
        std::vector<ValueNames> all;
        for (const auto& rgb : std::initializer_list<std::vector<std::string_view>>{
                 {"r", "g", "b"}, {"red", "green", "blue"}, {"brdfr", "brdfg", "brdfb"}, {"fr", "fg", "fb"}})
            all.push_back({Values::rgb, Quantity::bsdf, rgb});
        all.push_back({Values::xyz, Quantity::bsdf, {"x", "y", "z"}});
        for (const std::string_view key : {"value", "brdf", "bsdf", "btdf", "f", "fr"})
            all.push_back({Values::grey, Quantity::bsdf, {key}});
        for (const std::string_view key : {"brf", "factor", "reflectancefactor", "bidirectionalreflectancefactor"})
            all.push_back({Values::grey, Quantity::factor, {key}});
        for (const std::string_view key :
             {"ccbrdf", "ccbsdf", "brdfcos", "bsdfcos", "fcos", "cosinecorrectedbrdf", "cosinecorrectedbsdf"})
            all.push_back({Values::grey, Quantity::cosine, {key}});
        return all;
    }();
    return names;
}

/// The keys of the names that `srbf` writes.
constexpr std::array<std::string_view, 4> k_own_angles{"thetal", "phil", "thetav", "phiv"};
constexpr std::array<std::string_view, 6> k_own_components{"wlx", "wly", "wlz", "wvx", "wvy", "wvz"};

/// Assigns columns by their names, and keeps the first error.
struct ColumnAssignment {
    std::span<const std::string_view> names;
    std::vector<ColumnName> keys;
    std::vector<bool> used;
    Columns columns;
    bool is_relative = false;      ///< the azimuth of the viewer is named as relative to the light
    bool has_other_names = false;  ///< some names are not those that `srbf` writes
    std::optional<std::pair<std::string, std::string>> error;  ///< expected, found

    void refuse(std::string expected, std::string found) {
        if (!error) error.emplace(std::move(expected), std::move(found));
    }
    void refuse_duplicate(std::size_t first, std::size_t second) {
        refuse("one column for each, here or in --columns",
               fmt::format("columns {} and {}, {} and {}", first + 1, second + 1, quoted(names[first]),
                           quoted(names[second])));
    }
    void assign_directions() {
        columns.vector.fill(k_absent);
        for (std::size_t i = 0; i < names.size(); ++i) {
            const std::string& key = keys[i].key;
            if (const auto c = component_of(key)) {
                if (columns.vector[*c] != k_absent) refuse_duplicate(columns.vector[*c], i);
                columns.vector[*c] = i, used[i] = true, has_other_names |= key != k_own_components[*c];
            } else if (const auto a = angle_named(key)) {
                if (columns.angle[*a].exists()) refuse_duplicate(columns.angle[*a].column, i);
                columns.angle[*a] = {std::string(names[i].substr(0, 40)), i, 0, keys[i].unit};
                is_relative |= *a == 3 && is_relative_azimuth(key);
                used[i] = true, has_other_names |= key != k_own_angles[*a];
            } else if (key.starts_with("wavelength") || key.starts_with("lambda")) {
                columns.wavelength = i;
            }
        }
        columns.has_vectors = std::ranges::find(columns.vector, k_absent) == columns.vector.end();
    }
    void assign_constant(std::string_view constant) {
        const auto sign = constant.find('=');
        const ColumnName name = column_name(constant.substr(0, sign));
        const auto a = angle_named(name.key);
        const auto number = to_number<double>(constant.substr(sign + 1));
        if (!a || !name.unit || !number || !std::isfinite(*number) ||
            !expected_angle(k_angle_kinds[*a], *number, *name.unit).empty())
            return refuse("a constant angle as phi_l_deg=180", quoted(constant));
        if (columns.angle[*a].exists()) return refuse("one column or constant for each", quoted(constant) + " again");
        columns.angle[*a] = {std::string(constant), k_absent, *number, name.unit};
    }
    void require_angles() {
        if (columns.has_vectors) return;
        constexpr std::array<std::string_view, 4> names_of_angles{"theta_l", "phi_l", "theta_v", "phi_v"};
        const auto& angle = columns.angle;
        const auto lacks = [&](std::size_t a) {
            refuse(
                "columns wl_x to wv_z, or theta_l_deg, phi_l_deg, theta_v_deg, phi_v_deg (or _rad), or one of "
                "them as theta_l_deg=30 in --columns",
                fmt::format("no {}", names_of_angles[a]));
        };
        if (!angle[0].exists()) lacks(0);
        if (!angle[2].exists()) lacks(2);
        if (angle[1].exists() && !angle[3].exists()) lacks(3);
    }
    void assign_values() {
        const auto find_column = [&](std::string_view key) {
            const auto found = std::ranges::find(keys, key, &ColumnName::key);
            return found == keys.end() ? k_absent : std::size_t(found - keys.begin());
        };
        for (const ValueNames& known : names_of_values()) {
            std::vector<std::size_t> found;
            for (const std::string_view key : known.keys) found.push_back(find_column(key));
            if (std::ranges::any_of(found, [&](std::size_t i) { return i == k_absent || used[i]; })) continue;
            columns.values = known.values, columns.quantity = known.quantity, columns.value = std::move(found);
            has_other_names |= known.keys[0] != "r" && known.keys[0] != "x" && known.keys[0] != "value";
            for (const std::size_t i : columns.value)
                for (std::size_t k = i + 1; k < keys.size(); ++k)
                    if (keys[k].key == keys[i].key) refuse_duplicate(i, k);
            return;
        }
        for (std::size_t i = 0; i < names.size(); ++i)
            if (const auto nm = wavelength_of(names[i])) {
                columns.values = Values::spectrum;
                columns.value.push_back(i), columns.wavelengths.push_back(*nm);
            }
        if (columns.value.empty())
            refuse("values in columns r,g,b or x,y,z or value, or a spectrum in columns as 450nm", "none of them");
        else if (!are_wavelengths(columns.wavelengths))
            refuse("columns of increasing wavelengths, from 100 nm up", "others");
    }
    /// Notes the columns of light and viewer if their names are not those of `srbf`.
    void note_names() {
        if (!has_other_names) return;
        for (const std::size_t i : columns.value) used[i] = true;
        std::string text[2], ignored;
        const auto add = [](std::string& list, std::string_view name) {
            list += fmt::format("{}{}", list.empty() ? "" : ", ", name);
        };
        for (std::size_t k = 0; k < 6 && columns.has_vectors; ++k) add(text[k / 3], names[columns.vector[k]]);
        for (std::size_t a = 0; a < 4 && !columns.has_vectors; ++a)
            if (columns.angle[a].exists()) add(text[a / 2], columns.angle[a].name);
        for (std::size_t i = 0; i < names.size() && ignored.size() < 100; ++i)
            if (!used[i] && !names[i].empty()) add(ignored, names[i].substr(0, 40));
        std::string value;
        if (columns.value.size() <= 3)
            for (const std::size_t i : columns.value) add(value, names[i]);
        columns.notes.push_back(fmt::format("light: {}; viewer: {}{}{}{}{}", text[0], text[1],
                                            value.empty() ? "" : "; value: ", value,
                                            ignored.empty() ? "" : "; not read: ", ignored));
    }
    void note_assumptions() {
        if (columns.quantity == Quantity::factor) columns.notes.push_back("values are reflectance factors");
        if (columns.quantity == Quantity::cosine) columns.notes.push_back("values are f cosθ of the viewer");
        if (columns.has_vectors || columns.angle[1].exists() || is_relative || !columns.angle[3].exists()) return;
        columns.notes.push_back(
            "the azimuth of the light is not stated and taken as 0, so that the mirror direction is at 180 degrees; "
            "if it is at 0, say --columns with phi_l_deg=180");
    }
};

}  // namespace

bool are_names_of_columns(std::span<const std::string_view> fields) {
    std::size_t directions = 0, values = 0;
    for (const std::string_view field : fields) {
        const std::string key = column_name(field).key;
        if (key.empty()) continue;
        directions += component_of(key) || angle_named(key);
        values += wavelength_of(field).has_value();
        for (const ValueNames& known : names_of_values()) values += known.keys.size() == 1 && known.keys[0] == key;
    }
    return directions >= 2 || (directions == 1 && values > 0);
}

Result<Columns> assign_columns(std::span<const std::string_view> names, std::span<const std::string_view> constants,
                               const std::string& file_name, std::uint64_t line) {
    if (names.size() > k_most_columns)
        return at_line(file_name, line, "header", fmt::format("at most {} columns", k_most_columns),
                       fmt::format("{}", names.size()));
    ColumnAssignment assignment{names, {}, std::vector<bool>(names.size()), {}, false, false, {}};
    assignment.columns.count = names.size();
    for (const std::string_view name : names) assignment.keys.push_back(column_name(name));
    assignment.assign_directions();
    for (const std::string_view constant : constants) assignment.assign_constant(constant);
    assignment.require_angles();
    assignment.assign_values();
    if (assignment.error) return at_line(file_name, line, "header", assignment.error->first, assignment.error->second);
    assignment.note_names();
    assignment.note_assumptions();
    return std::move(assignment.columns);
}

}  // namespace srbf
