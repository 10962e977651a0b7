#include "measured/formats/columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

namespace SRBF_NAMESPACE {

namespace {

/// True if `word` is one of `words`, which blanks and commas separate.
bool is_one_of(std::string_view word, std::string_view words) {
    while (!words.empty() && !word.empty())
        if (next_word(words, " ,") == word) return true;
    return false;
}

/// The name of a column for comparison: letters and digits in lower case, without the unit.
struct ColumnName {
    std::string key;
    std::optional<AngleUnit> unit;  ///< unit of an angle, if the name has it
    std::string text;               ///< the unit as it is written
};

std::optional<AngleUnit> unit_in(std::string_view text) {
    constexpr std::pair<std::string_view, AngleUnit> units[] = {
        {"deg", k_in_degrees}, {"grad", k_in_degrees}, {"mrad", {1e-3, "milliradians"}}, {"rad", k_in_radians}};
    for (const auto& [word, unit] : units)
        if (text.find(word) != text.npos) return unit;
    return {};
}

/// Returns the text in lower case, with the names of Greek letters and of unit signs in their place.
std::string spelt_out(std::string_view text) {
    constexpr std::pair<std::string_view, std::string_view> letters[] = {
        {"θ", "theta"}, {"Θ", "theta"}, {"ϑ", "theta"}, {"φ", "phi"}, {"Φ", "phi"},          {"ϕ", "phi"}, {"°", "deg"},
        {"Δ", "delta"}, {"µ", "u"},     {"μ", "u"},     {"⁻", "-"},   {"\xe2\x88\x92", "-"}, {"¹", "1"}};
    std::string words;
    for (text = text.substr(0, 100); !text.empty();) {
        const auto letter =
            std::ranges::find_if(letters, [&](const auto& entry) { return text.starts_with(entry.first); });
        if (letter != std::end(letters)) words += letter->second;
        if (letter == std::end(letters)) words += char(std::tolower(static_cast<unsigned char>(text[0])));
        text.remove_prefix(letter == std::end(letters) ? 1 : letter->first.size());
    }
    return words;
}

ColumnName column_name(std::string_view text) {
    const std::string words = spelt_out(text);
    const std::size_t bracket = std::min(words.find_first_of("([{%"), words.size());
    ColumnName name{{}, {}, words.substr(bracket)};
    name.unit = unit_in(name.text);
    std::erase_if(name.text, [](char c) { return std::string_view(" ([{}])").find(c) != std::string_view::npos; });
    for (const char c : words.substr(0, bracket))
        if (std::isalnum(static_cast<unsigned char>(c))) name.key += c;
    for (const std::string_view unit : {"degrees", "degree", "deg", "radians", "radian", "mrad", "rad", "percent",
                                        "pct", "db", "1sr", "sr1", "persr"})
        if (name.key.size() > unit.size() && name.key.ends_with(unit)) {
            name.key.resize(name.key.size() - unit.size());
            if (!name.unit) name.unit = unit_in(unit);
            if (name.text.empty() && !unit_in(unit) && unit.find("sr") == unit.npos) name.text = unit;
            break;
        }
    return name;
}

/// The size of a unit of values in 1/sr or 1, such as "1/sr", "%", "1e-3/sr" or "10^-3 sr^-1". Other units, such as
/// dB, have no value.
std::optional<double> factor_of(std::string unit) {
    for (const std::string_view per_sr : {"1/sr", "/sr", "sr^-1", "sr**-1", "sr-1"})
        if (unit.ends_with(per_sr)) {
            unit.resize(unit.size() - per_sr.size());
            break;
        }
    if (unit.starts_with("10^")) unit.replace(0, 3, "1e");
    if (unit.empty() || unit == "-" || unit.ends_with("nm") || unit.ends_with("um")) return 1;  // or a wavelength
    if (is_one_of(unit, "% percent pct")) return 0.01;
    const auto number = to_number<double>(unit);
    return number && *number > 0 && *number < 1e12 ? number : std::nullopt;
}

/// The direction that an angle or a component belongs to; `both` if light and viewer share the angle.
enum class Role { light, viewer, both };
/// The role that a word names.
std::optional<Role> role_of(std::string_view word) {
    constexpr std::string_view words[] = {
        "l i in inc incident incidence incoming light lightsource source src sun solar illumination illuminant illum "
        "lamp laser emitter",
        "v o out outgoing r refl reflected reflection s sc scat scatter scattered scattering view viewer viewing "
        "observer observation obs e exit emission emergence d det detector sensor satellite receiver measure measured "
        "measurement",
        "both lv retro lidar monostatic"};
    if (word.starts_with("to")) word.remove_prefix(2);  // "to-sun", "to-sensor"
    for (std::size_t role = 0; role < std::size(words); ++role)
        if (is_one_of(word, words[role])) return Role(role);
    return {};
}

/// Names of the viewer's azimuth relative to the light.
constexpr std::string_view k_relative_azimuths =
    "phi dphi deltaphi phirel relphi azimuth relazimuth relativeazimuth azimuthdifference relaz raz raa";

/// Returns the index of a named angle in `Columns::angle`; `k_both` for θ_l and θ_v in one.
constexpr std::size_t k_both = 6;
std::optional<std::size_t> angle_named(std::string_view key) {
    constexpr std::string_view whole[] = {
        "aoi angleofincidence incidence sza", "saa", "vza emission", "vaa", "phase phaseangle",
        "aspecular aspecularangle aspec"};
    constexpr std::string_view angles[] = {"theta polarangle zenithangle polar zenith zen zn angle",
                                           "phi azimuthangle azimuthal azimuth azim az"};
    for (std::size_t index = 0; index < std::size(whole); ++index)
        if (is_one_of(key, whole[index])) return index;
    if (key == "angles") return {};
    if (is_one_of(key, k_relative_azimuths)) return k_phi_v;
    for (std::size_t index = 0; index < std::size(angles); ++index)
        for (std::string_view rest = angles[index], angle = next_word(rest); !angle.empty(); angle = next_word(rest)) {
            auto role = key.starts_with(angle) ? role_of(key.substr(angle.size())) : std::nullopt;
            if (!role && key.ends_with(angle)) role = role_of(key.substr(0, key.size() - angle.size()));
            if (role) return *role == Role::both ? k_both : (*role == Role::light ? k_theta_l : k_theta_v) + index;
        }
    return {};
}

/// The light's polar angle and the aspecular angle [degrees] of a column as "45as15" of multi-angle instruments.
std::optional<std::array<double, 2>> geometry_of(std::string_view name) {
    const auto as = std::min(name.find("as"), name.size());
    const auto light = to_number<double>(name.substr(0, as)),
               from_mirror = to_number<double>(name.substr(std::min(as + 2, name.size())));
    return light && from_mirror ? std::optional(std::array{*light, *from_mirror}) : std::nullopt;
}

/// Returns the index of a named component (wl_x, wi_x, light_x) among those of wl and wv.
std::optional<std::size_t> component_of(std::string_view key) {
    if (key.size() < 2 || key.back() < 'x' || key.back() > 'z') return {};
    const std::size_t axis = std::size_t(key.back() - 'x');
    key.remove_suffix(1);
    auto role = role_of(key);
    if (!role && key.starts_with('w')) role = role_of(key.substr(1));
    if (!role || *role == Role::both) return {};
    return *role == Role::light ? axis : 3 + axis;
}

/// Names of values: of each kind the names of its columns.
struct ValueNames {
    Values values;
    Quantity quantity;
    std::string_view kinds;
    bool is_lesser = false;  ///< beside other values, a stage's position, or a part of the light
};
/// The names of values in the order of preference.
constexpr ValueNames k_values[] = {
    {Values::rgb, Quantity::bsdf, "r g b,red green blue,brdfr brdfg brdfb,fr fg fb"},
    {Values::grey, Quantity::bsdf, "value,brdf,bsdf,btdf,f,fr"},
    {Values::grey, Quantity::factor, "brf,factor,reflectancefactor,bidirectionalreflectancefactor,reflectance"},
    {Values::grey, Quantity::cosine, "dsf,ccbrdf,ccbsdf,brdfcos,bsdfcos,fcos,cosinecorrectedbrdf,cosinecorrectedbsdf"},
    {Values::polarized, Quantity::bsdf, "brdfs brdfp,bsdfs bsdfp,btdfs btdfp,fs fp,frs frp", true},
    {Values::polarized, Quantity::factor, "brfs brfp", true},
    {Values::xyz, Quantity::bsdf, "x y z", true}};

/// The quantity of a name of grey values; no value for any other name.
std::optional<Quantity> quantity_of(std::string_view key) {
    for (const ValueNames& known : k_values)
        if (known.values == Values::grey && is_one_of(key, known.kinds)) return known.quantity;
    return {};
}

/// The wavelength [nm] and the quantity in the name of a column: "450nm", "nm450", "0.45 µm", "brdf_450nm", "BRF_450",
/// "450"; "R450" is a reflectance factor.
std::optional<std::pair<float, Quantity>> wavelength_of(std::string_view name) {
    std::string words = spelt_out(name);
    if (words.find("nm") == words.npos && words.find("um") == words.npos)
        words.resize(std::min(words.find_first_of("([{%"), words.size()));  // a unit of the values
    for (char& c : words)
        if (std::string_view("_([{}])").find(c) != std::string_view::npos) c = ' ';
    std::string_view text = trimmed(words);
    const bool has_um = text.ends_with("um"), has_unit = has_um || text.ends_with("nm") || text.starts_with("nm");
    if (has_unit) text = trimmed(text.starts_with("nm") ? text.substr(2) : text.substr(0, text.size() - 2));
    const std::size_t begin = text.find_last_not_of("0123456789.") + 1;  // npos + 1 is 0
    const auto number = to_number<double>(text.substr(begin));
    if (!number || (!has_unit && *number < 100)) return {};
    const std::string key = column_name(text.substr(0, begin)).key;
    const auto quantity = key.empty() ? Quantity::bsdf : is_one_of(key, "r rho") ? Quantity::factor : quantity_of(key);
    if (!quantity) return {};
    return std::pair(float(*number * (has_um ? 1000 : 1)), *quantity);
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
    bool has_other_names = false;                              ///< some names are not those that `srbf` writes
    std::optional<std::pair<std::string, std::string>> error;  ///< expected, found

    void refuse(std::string expected, std::string found) {
        if (!error) error.emplace(std::move(expected), std::move(found));
    }
    void refuse_duplicate(std::size_t first, std::size_t second) {
        refuse("one column for each, here or in --columns",
               fmt::format("columns {} and {}, {} and {}", first + 1, second + 1, quoted(names[first]),
                           quoted(names[second])));
    }
    /// Where a header has both "src_z" and "src_a", they are a zenith angle and an azimuth.
    std::optional<std::size_t> short_angle(std::string_view key) const {
        if (key.size() < 2 || (key.back() != 'z' && key.back() != 'a')) return {};
        const std::string stem(key.substr(0, key.size() - 1));
        const auto role = role_of(stem);
        const auto has = [&](char c) { return std::ranges::find(keys, stem + c, &ColumnName::key) != keys.end(); };
        if (!role || *role == Role::both || !has('z') || !has('a')) return {};
        return (*role == Role::light ? k_theta_l : k_theta_v) + (key.back() == 'a');
    }
    void assign_directions() {
        columns.vector.fill(k_absent);
        for (std::size_t i = 0; i < names.size(); ++i) {
            const std::string& key = keys[i].key;
            const auto component = short_angle(key) ? std::nullopt : component_of(key);
            const auto a = short_angle(key) ? short_angle(key) : angle_named(key);
            if (component) {
                if (columns.vector[*component] != k_absent) refuse_duplicate(columns.vector[*component], i);
                columns.vector[*component] = i;
                has_other_names |= key != k_own_components[*component];
            } else if (a) {
                columns.both |= *a == k_both;
                for (const std::size_t angle : *a == k_both ? std::vector{k_theta_l, k_theta_v} : std::vector{*a}) {
                    if (columns.angle[angle].exists()) refuse_duplicate(columns.angle[angle].column, i);
                    columns.angle[angle] = {std::string(names[i].substr(0, 40)), i, 0, keys[i].unit};
                }
                has_other_names |= *a >= k_own_angles.size() || key != k_own_angles[*a];
            } else if (key.starts_with("wavelength") || key.starts_with("lambda")) {
                columns.wavelength = i;
            } else {
                continue;
            }
            used[i] = true;
        }
        columns.has_vectors = std::ranges::find(columns.vector, k_absent) == columns.vector.end();
        for (std::size_t i = 0; i < names.size() && !columns.has_vectors && !columns.angle[k_theta_v].exists(); ++i)
            if (const auto geometry = columns.angle[k_theta_l].exists() ? std::nullopt : geometry_of(names[i])) {
                columns.geometry.push_back(*geometry);
                columns.value.push_back(i);
                has_other_names = true;
            }
    }
    void assign_constant(std::string_view constant) {
        const auto sign = constant.find('=');
        const ColumnName name = column_name(constant.substr(0, sign));
        const auto a = angle_named(name.key);
        const auto number = to_number<double>(constant.substr(sign + 1));
        if (!a || *a >= columns.angle.size() || !name.unit || !number || !std::isfinite(*number) ||
            !expected_angle(kind_of_angle(*a), *number, *name.unit).empty())
            return refuse("a constant angle as phi_l_deg=180", quoted(constant));
        if (columns.angle[*a].exists()) return refuse("one column or constant for each", quoted(constant) + " again");
        columns.angle[*a] = {std::string(constant), k_absent, *number, name.unit};
    }
    /// Takes angles of the light from lines as "intheta 10" or "incident_angle 10 0". `theta` then is the viewer's.
    void assign_stated(std::span<const std::string_view> header) {
        auto& angle = columns.angle;
        if (columns.has_vectors || angle[k_theta_l].exists()) return;
        for (const std::string_view line : header) {
            std::string_view rest = line.substr(std::min(line.find_first_of("-.0123456789"), line.size()));
            const ColumnName name = column_name(line.substr(0, line.size() - rest.size()));
            for (std::size_t a = angle_named(name.key).value_or(k_theta_v); a < k_theta_v; ++a) {
                const auto number = to_number<double>(next_word(rest, " \t,°dr"));
                if (!number || !expected_angle(k_angle_kinds[a], *number, k_in_degrees).empty()) break;
                if (!angle[a].exists() && (a == k_theta_l || angle[k_phi_v].exists()))
                    angle[a] = {std::string(line.substr(0, 40)), k_absent, *number,
                                name.unit ? name.unit : unit_in(rest)};
            }
        }
        for (std::size_t i = 0; i < names.size(); ++i)
            if (keys[i].key == "theta" && angle[k_theta_l].exists() && !angle[k_theta_v].exists()) {
                angle[k_theta_v] = {std::string(names[i].substr(0, 40)), i, 0, keys[i].unit};
                used[i] = true;
            }
    }
    void require_angles() {
        if (columns.has_vectors || !columns.geometry.empty()) return;
        constexpr std::array<std::string_view, 4> names_of_angles{"theta_l", "phi_l", "theta_v", "phi_v"};
        const auto& angle = columns.angle;
        const auto lacks = [&](std::size_t a) {
            refuse(
                "columns wl_x to wv_z, or theta_l_deg, phi_l_deg, theta_v_deg, phi_v_deg (or _rad), or theta_both_deg "
                "of a light and a viewer at one place, or one of them as theta_l_deg=30 in --columns",
                fmt::format("no {}", names_of_angles[a]));
        };
        if (!angle[k_theta_l].exists()) lacks(k_theta_l);
        if (!angle[k_theta_v].exists() && !angle[k_aspecular].exists()) lacks(k_theta_v);
        if (angle[k_phi_l].exists() && !angle[k_phi_v].exists() && !columns.both) lacks(k_phi_v);
    }
    /// Assigns the only kind of values, or the first quantity if others state the same values as another quantity.
    /// Refuses columns if there is none, if two have one quantity, or if a unit is not known.
    void assign_values() {
        struct Kind {
            Values values;
            Quantity quantity;
            std::vector<std::size_t> columns;
        };
        std::vector<Kind> kinds;
        std::vector<bool> claimed = used;
        const auto add = [&](Kind kind) {
            for (const std::size_t i : kind.columns) claimed[i] = true;
            if (!kind.columns.empty()) kinds.push_back(std::move(kind));
        };
        Kind spectrum{Values::spectrum, Quantity::bsdf, {}};
        for (std::size_t i = 0; i < names.size(); ++i)
            if (const auto wavelength = used[i] ? std::nullopt : wavelength_of(names[i])) {
                if (!spectrum.columns.empty() && wavelength->second != spectrum.quantity)
                    refuse("wavelengths of one quantity", quoted(names[i]));
                spectrum.quantity = wavelength->second;
                spectrum.columns.push_back(i);
                columns.wavelengths.push_back(wavelength->first);
            }
        add(spectrum);
        if (!columns.geometry.empty()) add({Values::grey, Quantity::factor, columns.value});
        for (const ValueNames& known : k_values)
            for (std::string_view rest = known.kinds, kind = next_word(rest, ","); !kind.empty();
                 kind = next_word(rest, ",")) {
                std::vector<std::size_t> found;
                for (auto key = next_word(kind); !key.empty(); key = next_word(kind)) {
                    const auto column = std::ranges::find(keys, key, &ColumnName::key);
                    found.push_back(std::size_t(column - keys.begin()));
                }
                if (std::ranges::any_of(found, [&](std::size_t i) { return i == keys.size() || claimed[i]; })) continue;
                for (const std::size_t i : found)
                    for (std::size_t k = i + 1; k < keys.size(); ++k)
                        if (keys[k].key == keys[i].key) refuse_duplicate(i, k);
                if (!known.is_lesser || kinds.empty()) add({known.values, known.quantity, std::move(found)});
            }
        if (kinds.empty())
            return refuse("values in columns r,g,b or x,y,z or value, or a spectrum in columns as 450nm",
                          "none of them");
        std::ranges::sort(kinds, {}, [](const Kind& kind) { return std::pair(kind.quantity, kind.columns[0]); });
        if (kinds.size() > 1 && kinds[0].quantity == kinds[1].quantity)
            refuse("one kind of value, with other names for the others in --columns",
                   fmt::format("{} and {}", quoted(names[kinds[0].columns[0]]), quoted(names[kinds[1].columns[0]])));
        columns.values = kinds[0].values;
        columns.quantity = kinds[0].quantity;
        columns.value = kinds[0].columns;
        if (columns.values != Values::spectrum)
            columns.wavelengths.clear();
        else if (!are_wavelengths(columns.wavelengths))
            refuse("columns of increasing wavelengths, from 100 nm up", "");
        const std::string& first = keys[columns.value[0]].key;
        has_other_names |= kinds.size() > 1 || (columns.values != Values::spectrum && !is_one_of(first, "r x value"));
        for (const std::size_t i : columns.value) {
            const auto unit = factor_of(keys[i].text);
            if (!unit || (i != columns.value[0] && *unit != columns.unit))
                refuse("values in one unit, as 1/sr, 1e-3/sr or %, or names without it in --columns",
                       fmt::format("the unit of {}", quoted(names[i])));
            columns.unit = unit.value_or(1);
        }
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
        for (std::size_t a = 0; a < columns.angle.size() && !columns.has_vectors; ++a)
            if (columns.angle[a].exists()) add(text[std::min<std::size_t>(a / 2, 1)], columns.angle[a].name);
        for (std::size_t i = 0; i < names.size() && ignored.size() < 100; ++i)
            if (!used[i] && !names[i].empty()) add(ignored, names[i].substr(0, 40));
        std::string value;
        if (columns.value.size() <= 3)
            for (const std::size_t i : columns.value) add(value, names[i]);
        if (!columns.geometry.empty()) {
            text[0] = "at the first angle of a name";
            text[1] = "at the second one from the mirror direction to the light";
        }
        columns.notes.push_back(fmt::format("light: {}; viewer: {}{}{}{}{}", text[0], text[1],
                                            value.empty() ? "" : "; value: ", value,
                                            ignored.empty() ? "" : "; not read: ", ignored));
    }
    void note_assumptions() {
        if (columns.quantity == Quantity::factor) columns.notes.push_back("values are reflectance factors");
        if (columns.quantity == Quantity::cosine) columns.notes.push_back("values are f cosθ of the viewer");
        if (columns.unit != 1) columns.notes.push_back(fmt::format("values are in units of {:g}", columns.unit));
        if (columns.values == Values::polarized) columns.notes.push_back("values are the means of both polarizations");
        if (columns.both) columns.notes.push_back("light and viewer are at one place");
        if (columns.angle[k_aspecular].exists() && !columns.angle[k_theta_v].exists())
            columns.notes.push_back("aspecular angles > 0 are from the mirror direction towards the light");
        if (columns.has_vectors || columns.angle[k_phi_l].exists() || !columns.angle[k_phi_v].exists()) return;
        const bool is_relative = columns.angle[k_phi_v].column != k_absent &&
                                 is_one_of(keys[columns.angle[k_phi_v].column].key, k_relative_azimuths);
        columns.notes.push_back(
            fmt::format("{}, so that the mirror direction is at 180 degrees; --columns with phi_l_deg=180 puts it at 0",
                        is_relative ? "a relative azimuth of 0 is taken as backward, on the side of the light"
                                    : "the azimuth of the light is not stated and taken as 0"));
    }
};

}  // namespace

bool are_units(std::span<const std::string_view> fields) {
    return std::ranges::any_of(fields, [](std::string_view field) { return unit_in(spelt_out(field)).has_value(); }) &&
           std::ranges::none_of(fields, [](std::string_view field) { return number_in<double>(field).has_value(); });
}

bool are_names_of_columns(std::span<const std::string_view> fields) {
    std::size_t directions = 0, values = 0;
    for (const std::string_view field : fields) {
        const std::string key = column_name(field).key;
        if (key.empty()) continue;
        directions +=
            component_of(key) || angle_named(key) || geometry_of(field) || (key == "angle" && fields.size() < 4);
        values += !to_number<double>(field) && wavelength_of(field);
        values += quantity_of(key).has_value();
    }
    return directions >= 2 || (directions == 1 && values > 0);
}

Result<Columns> assign_columns(std::span<const std::string_view> names, std::span<const std::string_view> constants,
                               std::span<const std::string_view> header, const std::string& file_name,
                               std::uint64_t line) {
    if (names.size() > k_max_columns)
        return at_line(file_name, line, "header", fmt::format("at most {} columns", k_max_columns),
                       fmt::format("{}", names.size()));
    ColumnAssignment assignment{names, {}, std::vector<bool>(names.size()), {}, false, {}};
    assignment.columns.count = names.size();
    for (const std::string_view name : names) assignment.keys.push_back(column_name(name));
    assignment.assign_directions();
    for (const std::string_view constant : constants) assignment.assign_constant(constant);
    assignment.assign_stated(header);
    assignment.require_angles();
    assignment.assign_values();
    if (assignment.error) return at_line(file_name, line, "header", assignment.error->first, assignment.error->second);
    assignment.note_names();
    assignment.note_assumptions();
    return std::move(assignment.columns);
}

}  // namespace
