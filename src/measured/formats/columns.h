// The columns of a text, recognised by their names: private to the reader of delimited text.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "measured/samples.h"

namespace srbf {

/// θ_l, φ_l, θ_v or φ_v of rows: a column, or a constant.
struct AngleColumn {
    std::string name;  ///< in the file; empty: there is none
    std::size_t column = k_absent;
    double constant = 0;                 ///< in `unit`, without a column
    std::optional<AngleUnit> unit = {};  ///< none: the name states none
    bool given() const { return !name.empty(); }
    AngleUnit in() const { return unit.value_or(k_in_degrees); }
};

/// The columns that a header, or the option --columns, names.
struct Columns {
    std::size_t count = 0;  ///< fields of a row
    bool has_vectors = false;
    std::array<std::size_t, 6> vector{};  ///< of wl and wv
    std::array<AngleColumn, 4> angle;     ///< θ_l, φ_l, θ_v, φ_v
    bool in_plane = false;                ///< without azimuths: θ_v > 0 is on the mirror side
    Values values = Values::grey;
    Quantity quantity = Quantity::bsdf;
    std::vector<std::size_t> value;
    std::vector<float> wavelengths;
    std::size_t wavelength = k_absent;  ///< a column with a wavelength for each row
    std::vector<std::string> notes;     ///< what names did not state
};

/// True for names of columns: two of directions, or one of a direction and one of a value.
bool are_names_of_columns(std::span<const std::string_view> fields);
/// Errors: no directions or no values; two columns for one; `constants` ("phi_l_deg=180") that are no angles.
Result<Columns> columns_of(std::span<const std::string_view> names, std::span<const std::string_view> constants,
                           const std::string& file_name, std::uint64_t line);

}  // namespace srbf
