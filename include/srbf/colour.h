// From spectra to colours: level 0.
#pragma once
#include <span>
#include <vector>

#include "srbf/vec.h"

namespace srbf {

/// CIE 1931 tristimulus values (2° observer); Y of the perfect white reflector is 1.
struct Xyz {
    double x = 0, y = 0, z = 0;
};

/// Of the perfect white reflector under D65: (0.9504, 1, 1.0890).
Xyz white_point();

/// Linear sRGB, 3 × 3 from the chromaticities of the primaries (IEC 61966-2-1) and `white_point()`, which becomes (1, 1, 1).
Rgb to_rgb(const Xyz& colour);

/// What a reflectance spectrum contributes to linear sRGB, for each of its samples: with R(λ) linear between the samples at
/// `wavelengths` [nm] (increasing, one at least) and constant beyond them,
///   X = ∫ R D65 x̄ dλ / ∫ D65 ȳ dλ,  Y, Z likewise,  (R, G, B) = M (X, Y, Z) = Σ_i R(λ_i) weight_i.
/// The weights sum to (1, 1, 1): what reflects everything is white. x̄ ȳ z̄ are CIE 1931 2° and D65 is CIE's, every 5 nm from 360 to
/// 830 nm (ISO/CIE 11664-1 and -2); D65 x̄ is linear between them, and the integrals are sums at 1 nm:
/// sums at 5 nm give colours within 1e-3 of these on smooth spectra.
std::vector<Rgb> rgb_weights(std::span<const float> wavelengths);

/// Σ_i spectrum_i weight_i, as linear in the spectrum as it stands: a saturated colour may have a negative channel.
Rgb to_rgb(std::span<const float> spectrum, std::span<const Rgb> weights);

}  // namespace srbf
