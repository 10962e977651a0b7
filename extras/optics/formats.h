// The formats of optical design software.
#pragma once
#include "extras/optics/scatter.h"
#include "measured/formats/format_rows.h"
#include "measured/samples.h"

namespace SRBF_NAMESPACE {

bool is_zemax(std::string_view text);
Result<Measured> read_as_zemax(std::span<const std::byte> bytes, const std::string& file_name, const ReadOptions&);
Result<std::vector<std::byte>> write_as_zemax(const TableSource& source, const TableOptions& options);
bool is_speos(std::string_view text);
Result<Measured> read_as_speos(std::span<const std::byte> bytes, const std::string& file_name, const ReadOptions&);
Result<std::vector<std::byte>> write_as_speos(const TableSource& source, const TableOptions& options);
bool is_fred(std::string_view text);
/// Reads FRED's text: `type bsdf_data`, `format angles=deg bsdf=value scale=1`, then lines of θ_l φ_l and of θ_v
/// φ_v f [1/sr].
Result<ScatteredSamples> read_fred(std::span<const std::byte> bytes, const std::string& file_name);
bool is_openmaterial(std::string_view text);
/// Reads a BRDF table of ASAM OpenMATERIAL 3D: rows of wavelength [m], θ_l, θ_v, φ_v relative to the light [rad], f
/// [1/sr]. Pairs of directions that lack a wavelength are masked.
Result<ScatteredSamples> read_openmaterial(std::span<const std::byte> bytes, const std::string& file_name);
Result<std::vector<std::byte>> write_as_openmaterial(const TableSource& source, const TableOptions& options);
bool is_bird(std::string_view text);
/// Reads the JSON of the project BiRD (national metrology institutes): theta_i, phi_i, theta_r, phi_r, wavelength_i
/// and BRDF, one number for each point. Polarizations at the same pair are averaged; uBRDF determines the weights
/// of samples.
Result<ScatteredSamples> read_bird(std::span<const std::byte> bytes, const std::string& file_name);

inline constexpr Format k_optics_formats[] = {
    {.name = "Speos",
     .recognise = in_text<is_speos>,  // the reader refuses binary files
     .read = read_as_speos,
     .extension = ".anisotropicbsdf",
     .used_by = "Speos",
     .anisotropic = true,
     .write = write_as_speos},
    {.name = "Zemax",
     .is_text = true,
     .recognise = in_text<is_zemax>,
     .read = read_as_zemax,
     .extension = ".zemax.bsdf",
     .anisotropic = true,
     .write = write_as_zemax},
    {.name = "FRED", .is_text = true, .recognise = in_text<is_fred>, .read = read_by<read_fred>},
    {.name = "OpenMATERIAL",
     .is_text = true,
     .recognise = in_text<is_openmaterial>,
     .read = read_by<read_openmaterial>,
     .extension = ".xompt",
     .used_by = "OpenMATERIAL",
     .one_sided = true,
     .write = write_as_openmaterial},
    {.name = "BiRD", .is_text = true, .recognise = in_text<is_bird>, .read = read_by<read_bird>},
};

}  // namespace
