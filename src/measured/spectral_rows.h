// Files that list one number for each pair of directions and wavelength. Private to their readers.
#pragma once
#include <vector>

#include "measured/samples.h"

namespace SRBF_NAMESPACE {

/// θ_l, φ_l, θ_v, φ_v [rad], wavelength [nm], f [1/sr], weight. f is NaN where nothing was measured.
using SpectralRow = std::array<float, 7>;
inline constexpr std::size_t k_wavelength_column = 4, k_value_column = 5, k_weight_column = 6;

/// Groups rows into pairs of directions with their spectra. Rows that differ only in the value, such as
/// polarizations, are averaged. Pairs that lack a wavelength are masked. Sorts `rows`. Errors: wavelengths out of
/// range; no samples.
Result<ScatteredSamples> samples_of_rows(std::vector<SpectralRow>& rows, std::size_t bytes,
                                         const std::string& file_name, std::string description, bool isotropic = false);

}  // namespace srbf
