// Files that list a number for each pair of directions and wavelength: private to their readers.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "measured/samples.h"

namespace srbf {

/// θ_l, φ_l, θ_v, φ_v [rad], wavelength [nm], f [1/sr], weight. f may be NaN: not measured.
using SpectralRow = std::array<float, 7>;
inline constexpr std::size_t k_of_wavelength = 4, k_of_value = 5, k_of_weight = 6;

/// Pairs of directions with their spectra: rows that differ in nothing but the value, such as polarizations, are averaged. Pairs
/// that lack a wavelength are masked. Errors: wavelengths out of range; no samples. `rows` are sorted.
Result<ScatteredSamples> samples_of_rows(std::vector<SpectralRow>& rows, std::size_t bytes,
                                         const std::string& file_name, std::string description, bool isotropic);

}  // namespace srbf
