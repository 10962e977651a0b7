// The readers of optical design: their recognition and reading.
#pragma once
#include "measured/samples.h"

namespace srbf {

bool is_zemax(std::string_view text);
bool is_speos(std::string_view text);
bool is_fred(std::string_view text);
bool is_openmaterial(std::string_view text);
bool is_bird(std::string_view text);
Result<ScatteredSamples> read_openmaterial_samples(std::span<const std::byte> bytes, const std::string& file_name);
Result<ScatteredSamples> read_bird_samples(std::span<const std::byte> bytes, const std::string& file_name);
/// FRED's text: `type bsdf_data`, `format angles=deg bsdf=value scale=1`, then lines of θ_l φ_l and of θ_v φ_v f [1/sr].
Result<ScatteredSamples> read_fred_samples(std::span<const std::byte> bytes, const std::string& file_name);

}  // namespace srbf
