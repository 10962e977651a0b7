// Scatter tables of optical design. The other formats have samples, which `read_measured` reads.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "srbf/measured.h"

namespace [[gnu::visibility("default")]] srbf {

/// Scatter on grids of angles, as Zemax and Speos keep it: for rotations of the sample and angles of incidence, values at
/// polar angles and azimuths about the mirror direction of the light or about the normal. With the light at azimuth φ_l the
/// rotation is φ_l − 90° about the mirror direction, from x to the normal of the plane of incidence (Zemax), and 180° − φ_l
/// about the normal, from the plane of incidence to x (Speos). Rotations to 180° alone repeat after a half turn, those to
/// 90° are mirrored too. About the normal azimuth 0 is the side of the mirror direction; about the mirror direction 180°
/// goes on towards grazing, 0 back towards the normal. Look-up is linear in both angles of a slice over what was measured,
/// and between slices and rotations at the same place about the mirror direction. Before the first angle of incidence and
/// beyond the last one it is constant. Beyond the angles of a slice nothing was measured.
struct ScatterTable {
    struct Slice {
        float theta_l = 0;                  ///< [rad]
        std::vector<float> polar, azimuth;  ///< [rad], rising; azimuths to π alone: mirrored at the plane of incidence
        std::vector<float> f;               ///< [1/sr], channel × polar × azimuth. NaN: a gap
    };
    std::size_t channels = 1;          ///< 1: grey; 3: CIE X, Y, Z
    bool about_mirror = false;         ///< otherwise about the normal
    bool transmission = false;         ///< the viewer is behind the surface, and stands mirrored at it (bsdf.h)
    std::vector<float> rotation;       ///< [rad], rising; one: isotropic
    std::vector<std::uint32_t> first;  ///< the first slice of each rotation, and the number of slices
    std::vector<Slice> slices;
    Rgb tint{1, 1, 1};         ///< of all values
    std::uint64_t masked = 0;  ///< values that were 0 in the file
};
/// ∫ f cosθ dω of a channel of a slice [1], over cells of half a degree by a degree. What was not measured counts as 0.
double scatter_integral(const ScatterTable& table, const ScatterTable::Slice& slice, std::size_t channel = 0);
/// f by interpolation over the measured ones of the surrounding nodes; NaN if none was measured, or beyond the nodes.
Rgb signed_value(const ScatterTable& table, Vec3f wl, Vec3f wv);
bool is_isotropic(const ScatterTable& table);
/// A table as that of a measurement (measured.h); `own_table` gives it back.
EvaluatedTable evaluated(ScatterTable table);

/// Reads Zemax' text of BSDFs: PlaneSymmetrical, Asymmetrical or Asymmetrical4D, Monochrome, BRDF or BTDF. The TIS that it states
/// is not used.
Result<ScatterTable> read_zemax(std::span<const std::byte> bytes, const std::string& file_name);
/// Reads Speos' texts of anisotropic BSDFs, and of isotropic ones by wavelength: reflection and transmission of light
/// from the front, of which at least one is there. Values are π f or f cosθ; where their integral is off the percentage
/// that the file states by more than a tenth of it, they are scaled to it. By wavelength the table is the mean, tinted
/// by the percentages. Errors: a binary file.
Result<std::array<std::optional<ScatterTable>, 2>> read_speos(std::span<const std::byte> bytes,
                                                              const std::string& file_name);
/// A part of a BSDF, in its own frame, as a scatter table: 18 angles of incidence, of anisotropic ones at 25 rotations, about the
/// mirror direction dense near it.
ScatterTable to_scatter(const Evaluate& part, bool about_mirror, bool isotropic, int threads = 0);
/// Zemax' text. TIS is ∫ f cosθ dω. Slices have one grid. read_zemax(write_zemax(table)) is `table`.
std::string write_zemax(const ScatterTable& table);
/// Speos' text of anisotropic BSDFs, of one table of reflection or transmission, or both. read_speos gives the same again.
std::string write_speos(std::span<const ScatterTable* const> tables);
/// A table of ASAM OpenMATERIAL 3D, of isotropic samples; of colours the smoothest spectra (`reflectance_spectrum`).
std::string write_openmaterial(const ScatteredSamples& samples);
}  // namespace srbf
