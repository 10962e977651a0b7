// From spectra to colours: level 0.
#pragma once
#include <array>
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

/// Whether these are wavelengths [nm] as a spectrum needs them: one at least, increasing, between 100 and 100,000.
bool are_wavelengths(std::span<const float> wavelengths);

/// Σ_i spectrum_i weight_i, as linear in the spectrum as it stands: a saturated colour may have a negative channel.
Rgb to_rgb(std::span<const float> spectrum, std::span<const Rgb> weights);

/// The other way: a smooth spectrum of the colour, at the wavelengths `k_primary_wavelengths` [nm],
///   R(λ) = r R_r(λ) + g R_g(λ) + b R_b(λ),
/// whose `to_rgb` is the colour again within 2e-6. The three are the smoothest (least sum of squared steps) that lie between 0 and 1, sum to
/// 1 and have the colours (1,0,0), (0,1,0), (0,0,1): after Mallett & Yuksel, "Spectral primary decomposition for rendering with sRGB
/// reflectance", 2019. So white is 1 throughout, and what reflects no more than it receives still does.
inline constexpr std::array<float, 18> k_primary_wavelengths{380, 400, 420, 440, 460, 480, 500, 520, 540,
                                                             560, 580, 600, 620, 640, 660, 680, 700, 720};
std::array<float, 18> reflectance_spectrum(const Rgb& colour);

}  // namespace srbf
