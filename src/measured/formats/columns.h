// The columns of delimited text, recognised by their names.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "measured/samples.h"

namespace srbf {

/// One of θ_l, φ_l, θ_v, φ_v: a column or a constant.
struct AngleColumn {
    std::string name;  ///< the name in the file; empty if the file lacks the angle
    std::size_t column = k_absent;
    double constant = 0;                 ///< in `unit`, if there is no column
    std::optional<AngleUnit> unit = {};  ///< no value if the name does not state it
    bool exists() const { return !name.empty(); }
    AngleUnit unit_or_degrees() const { return unit.value_or(k_in_degrees); }
};

struct Columns {
    std::size_t count = 0;                ///< number of fields in a row
    bool has_vectors = false;             ///< if true, `vector` has the directions, otherwise `angle`
    std::array<std::size_t, 6> vector{};  ///< the components of wl and wv
    std::array<AngleColumn, 4> angle;     ///< θ_l, φ_l, θ_v, φ_v
    bool in_plane = false;                ///< no azimuths: θ_v > 0 is on the mirror side
    Values values = Values::grey;
    Quantity quantity = Quantity::bsdf;
    std::vector<std::size_t> value;
    std::vector<float> wavelengths;
    std::size_t wavelength = k_absent;  ///< a column with a wavelength for each row
    std::vector<std::string> notes;     ///< assumptions about what names do not state
};

/// True if two fields name directions, or one a direction and one a value.
bool are_names_of_columns(std::span<const std::string_view> fields);
/// Assigns columns by their names. Errors: no directions or no values; two columns of the same meaning; `constants`
/// ("phi_l_deg=180") that are not angles.
Result<Columns> assign_columns(std::span<const std::string_view> names, std::span<const std::string_view> constants,
                               const std::string& file_name, std::uint64_t line);

}  // namespace srbf
