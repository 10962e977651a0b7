// Scatter tables of optical design. Other formats of this folder give samples, which `read_measured` reads.
#pragma once
#include <optional>

#include "srbf/measured.h"

SRBF_BEGIN

/// Scatter on grids of angles, in the form of Zemax and Speos. For each rotation of the sample and each angle of
/// incidence, a slice has values at polar angles and azimuths around the mirror direction of the light or around
/// the normal.
/// Rotations: for light at azimuth φ_l, the rotation is φ_l − 90° around the mirror direction, measured from x to
/// the normal of the plane of incidence (Zemax), and 180° − φ_l around the normal, measured from the plane of
/// incidence to x (Speos). Rotations up to 180° repeat after a half turn; rotations up to 90° are also mirrored.
/// Azimuths: around the normal, 0 is on the side of the mirror direction. Around the mirror direction, 180° points
/// towards grazing and 0 towards the normal.
/// Look-up is linear in both angles of a slice where values were measured. Between slices and rotations it
/// interpolates values at the same position relative to the mirror direction. It is constant before the first and
/// after the last angle of incidence. Beyond the angles of a slice nothing was measured.
struct ScatterTable {
    static constexpr std::string_view k_name = "ScatterTable";
    struct Slice {
        float theta_l = 0;                  ///< [rad]
        std::vector<float> polar, azimuth;  ///< [rad], rising; azimuths up to π are mirrored at the plane of incidence
        std::vector<float> f;               ///< [1/sr], channel × polar × azimuth; NaN: a gap
    };
    std::size_t channels = 1;          ///< 1: grey; 3: CIE X, Y, Z
    bool about_mirror = false;         ///< true: around the mirror direction; false: around the normal
    bool transmission = false;         ///< the viewer is behind the surface and mirrored at it (brdf.h)
    std::vector<float> rotation;       ///< [rad], rising; a single one: isotropic
    std::vector<std::uint32_t> first;  ///< the first slice of each rotation, then the number of slices
    std::vector<Slice> slices;
    Rgb tint{1, 1, 1};         ///< factor of all values
    std::uint64_t masked = 0;  ///< values that were 0, or −999 and the like, in the file
};
/// ∫ f cosθ dω of a channel of a slice [1], over cells of half a degree by one degree. Directions without a
/// measurement count as 0.
double scatter_integral(const ScatterTable& table, const ScatterTable::Slice& slice, std::size_t channel = 0);
/// f [1/sr], interpolated over the measured ones among the surrounding nodes; NaN if none was measured, and beyond
/// the nodes.
Rgb signed_value(const ScatterTable& table, Vec3f wl, Vec3f wv);
bool is_isotropic(const ScatterTable& table);
/// The table for `Measured::table` (measured.h); `table_as` returns the original.
EvaluatedTable as_evaluated_table(ScatterTable table);

/// Reads Zemax' text of BSDFs: PlaneSymmetrical, Asymmetrical or Asymmetrical4D; Monochrome or XYZ; BRDF or BTDF.
/// The stated TIS is not used.
Result<ScatterTable> read_zemax(std::span<const std::byte> bytes, const std::string& file_name);
/// Reads Speos' text files of anisotropic BSDFs, and of isotropic ones by wavelength. They describe reflection,
/// transmission or both for light from the front. Values are π f or f cosθ. If their integral differs from the
/// stated percentage by more than a tenth of it, they are scaled to it. By wavelength, the table is the mean,
/// tinted by the percentages. Returns an error for a binary file.
Result<std::array<std::optional<ScatterTable>, 2>> read_speos(std::span<const std::byte> bytes,
                                                              const std::string& file_name);
/// Evaluates a part of a BSDF, in its own frame, as a scatter table with 18 angles of incidence, and 25 rotations
/// if anisotropic. Around the mirror direction, the polar angles are dense near it.
ScatterTable to_scatter(const Evaluate& part, bool about_mirror, bool isotropic, int threads = 0);
/// Writes Zemax' text. TIS is ∫ f cosθ dω. All slices must have the same grid. read_zemax(write_zemax(table)) is
/// `table`.
std::string write_zemax(const ScatterTable& table);
/// Writes Speos' text of anisotropic BSDFs, for reflection, transmission or both. read_speos returns the same tables.
std::string write_speos(std::span<const ScatterTable* const> tables);
/// Writes isotropic samples as a table of ASAM OpenMATERIAL 3D. Colours become the smoothest spectra
/// (`reflectance_spectrum`).
std::string write_openmaterial(const ScatteredSamples& samples);
SRBF_END
