// The readers of each format, and input by its content.
#pragma once
#include "srbf/measured.h"

SRBF_BEGIN

/// Reads the bytes of a MERL `.binary`: int32 dimensions, then three planes (R, G, B) of n_h n_d n_p doubles. The
/// channels are scaled by 1/1500, 1.15/1500, 1.66/1500. A negative or non-finite value means not measured. `file_name`
/// appears in errors only.
Result<MerlTable> read_merl(std::span<const std::byte> bytes, const std::string& file_name);
/// Reads the bytes of an RGL `.bsdf` tensor file, RGB or spectral, isotropic or anisotropic. Ignores the field `valid`,
/// which distinguishes measured nodes from extrapolated ones, as the authors' own loader does.
Result<RglTable> read_rgl(std::span<const std::byte> bytes, const std::string& file_name);

/// Reads the bytes of a UTIA `.bin` (Filip & Vávra, "Template-based sampling of anisotropic BRDFs", 2014): three planes
/// (R, G, B) of doubles, 288 lights × 288 viewers, θ_l and θ_v at 0, 15, .. 75°, φ_l and φ_v at 0, 7.5, .. 352.5°. A
/// non-finite value means not measured. f_r is linear in all four angles between the nodes, like the look-up of the
/// database's own code. Between 75 and 90° it is extrapolated from 60 to 75°. NaN where one of the nodes was not
/// measured.
Result<EvaluatedTable> read_utia(std::span<const std::byte> bytes, const std::string& file_name);
/// Reads the bytes of an MBSDF file, version 1: lines key="value", then a block of reflection: type (grey or RGB), n_θ,
/// n_φ, and n_θ n_θ n_φ samples. A block of transmission may follow, which is checked and left out. A sample that is
/// not finite is masked. The row of the format reads both blocks, as reflection and transmission of light from the
/// front, in the frames of these parts.
Result<MbsdfTable> read_mbsdf(std::span<const std::byte> bytes, const std::string& file_name);

/// Joins files of samples of one material, such as one for each incidence. The first note lists the entries of their
/// headers that agree and that differ. `change_by_azimuth` decides whether the result is isotropic. Returns an error
/// for fewer than two files, if one is not of samples, or if their wavelengths, colours or names of values differ.
Result<Measured> join_measurements(std::span<const Measured> files);

/// The names of all quantities but `stated`, in their order.
inline constexpr std::array<std::string_view, 3> k_quantities{"bsdf", "factor", "cosine"};
/// The quantity of that name; `stated` if none has it.
Quantity quantity_named(std::string_view name);

/// `read_measured` that frees `bytes` before it indexes samples.
Result<Measured> read_measured(std::vector<std::byte>&& bytes, const std::string& file_name,
                               const ReadOptions& options = {});

/// The bytes of a file that may be a measurement or a model; of one that begins as neither does, its beginning alone.
/// Returns an error if `read_file` does.
Result<std::vector<std::byte>> read_input(const std::string& path, const ReadOptions& options = {});

SRBF_END
