// The columns of delimited text, recognised by their names.
#pragma once
#include <span>
#include <string_view>

#include "measured/samples.h"

namespace SRBF_NAMESPACE {

/// One of the angles of a sample: a column or a constant.
struct AngleColumn {
    std::string name;  ///< the name in the file; empty if the file lacks the angle
    std::size_t column = k_absent;
    double constant = 0;                 ///< the angle in `unit`, if there is no column
    std::optional<AngleUnit> unit = {};  ///< no value if the name does not state it
    bool exists() const { return !name.empty(); }
    AngleUnit unit_or_degrees() const { return unit.value_or(k_in_degrees); }
};

/// Indices of the angles of `Columns`. The phase angle is between light and viewer; the aspecular angle is from the
/// mirror direction to the viewer, in the plane of incidence towards the light.
inline constexpr std::size_t k_theta_l = 0, k_phi_l = 1, k_theta_v = 2, k_phi_v = 3, k_phase = 4, k_aspecular = 5;
constexpr AngleKind kind_of_angle(std::size_t a) { return a < 4 ? k_angle_kinds[a] : AngleKind::polar; }

struct Columns {
    std::size_t count = 0;                ///< number of fields in a row
    bool has_vectors = false;             ///< if true, `vector` has the directions, otherwise `angle`
    std::array<std::size_t, 6> vector{};  ///< the components of wl and wv
    std::array<AngleColumn, 6> angle;
    bool both = false;  ///< the viewer is at the light
    std::vector<std::array<double, 2>>
        geometry;           ///< θ_l and the aspecular angle [degrees] of each value, if names have them
    bool in_plane = false;  ///< no azimuths: θ_v > 0 is on the mirror side
    Values values = Values::grey;
    Quantity quantity = Quantity::bsdf;
    double unit = 1;  ///< factor of the values
    std::vector<std::size_t> value;
    std::vector<float> wavelengths;
    std::size_t wavelength = k_absent;  ///< a column with a wavelength for each row
    std::vector<std::string> notes;     ///< assumptions about what names do not state
};

/// True if a row has units of angles and no numbers.
bool are_units(std::span<const std::string_view> fields);
/// True if two fields name directions, or one a direction and one a value.
bool are_names_of_columns(std::span<const std::string_view> fields);
/// Assigns columns by their names. `constants` are angles ("phi_l_deg=180"). Lines of `header` give angles of the light
/// that neither states. Returns an error if there are no directions or no values, if two columns have the same meaning,
/// or if a constant is not an angle.
Result<Columns> assign_columns(std::span<const std::string_view> names, std::span<const std::string_view> constants,
                               std::span<const std::string_view> header, const std::string& file_name,
                               std::uint64_t line);

}  // namespace
